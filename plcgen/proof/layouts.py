"""Offsets of every buffer in two ways from three sources: places in the telegram; the layout of text and SimaticML."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import zip_longest

from plcgen.base.diagnostics import Diagnostic, DiagnosticError, Span
from plcgen.project.nouns import BlockRef, Frame
from plcgen.proof.checks import Check, Outcome
from plcgen.proof.folder import Folder
from plcgen.proof.making import Pending
from plcgen.proof.suite import LaidOut
from plcgen.s7.layout.layout import Layout, layout_block
from plcgen.s7.types.blocks import Block
from plcgen.s7.types.data_types import DataType, Elementary
from plcgen.s7.types.literals import type_text

TELEGRAM, TEXT, XML = "telegram", "text source", "SimaticML"
"""The three sources, as messages name them; the last two are laid out by one engine."""

_WIDTH = {16: ":W", 32: ":D", 64: ":L"}


@dataclass(frozen=True, slots=True)
class Row:
    """A member as one source has it: offset and size in bytes."""

    name: str
    offset: int
    size: int
    type: DataType


def layout_pending(frame: Frame, folder: Folder, laid: LaidOut) -> Pending:
    """The check of one buffer before it is made."""
    home = laid.buffer.home
    make = partial(check_layout, frame, folder, laid)
    return Pending(f"layout.{home.name}", f'{home.kind} "{home.name}"', partial(folder.place, home.name), make)


def check_layout(frame: Frame, folder: Folder, laid: LaidOut) -> Check:
    """The check of one buffer, of the group ``layout``."""
    home, fields = laid.buffer.home, laid.buffer.fields
    size = fields[-1].offset + fields[-1].size
    number = home.number if home.kind == "DB" else ""
    name, subject = f"layout.{home.name}", f'{home.kind}{number} "{home.name}"'
    figures = " ".join(f"{f.name}@{f.offset}{width_mark(f.type)}" for f in fields if laid.shown(f))
    planned = [Row(f.name, f.offset, f.size, f.type) for f in fields]
    places = dict.fromkeys(((home, laid.prefix), (laid.buffer.type, "")))
    problem = _compare(frame, folder, tuple(places), planned, size)
    text = f"{size} B  {laid.note}{figures}"
    if problem is None and size < laid.room:
        message = f"response buffer {laid.room - size} bytes too small"
        help_ = f"an answer needs {laid.room} bytes"
        problem = Diagnostic("PG605", message, folder.place(home.name), help=help_)
    if problem is not None:
        return Check(name, subject, text, Outcome.ERROR, problem.message, problem)
    return Check(name, subject, text, Outcome.OK, agreement(frame))


def agreement(frame: Frame) -> str:
    """``3 sources agree``; which ones, where there are fewer."""
    if frame.target.xml_version is not None:
        return "3 sources agree"
    return f"2 sources agree: {TELEGRAM}, {TEXT}; no {XML}"


def _compare(
    frame: Frame, folder: Folder, refs: tuple[tuple[BlockRef, str], ...], planned: list[Row], size: int
) -> Diagnostic | None:
    """The first disagreement between the sources, about the DB and then about its type.

    ``refs`` are the blocks with the planned members, and the path of the structure they lie in (``telegram.``).
    """
    sources = [(TEXT, folder.text)]
    if frame.target.xml_version is not None:
        sources.append((XML, folder.xml))
    for ref, prefix in refs:
        sizes = {TELEGRAM: (planned, size + size % 2)}
        for origin, blocks in sources:
            block = blocks.get(ref.name.upper())
            if block is None:
                message = f'{ref.kind} "{ref.name}" is missing in the {origin}s'
                return Diagnostic("PG608", message, folder.place(ref.name), help="run plcgen generate")
            found = _laid_out(frame, block, blocks, origin, prefix)
            if isinstance(found, Diagnostic):
                return Diagnostic(found.code, found.message, folder.place(ref.name))
            sizes[origin] = found
        message = _disagreement(sizes)
        if message:
            return Diagnostic("PG603", f'{ref.kind} "{ref.name}": {message}', folder.place(ref.name))
    return None


def _laid_out(
    frame: Frame, block: Block, blocks: dict[str, Block], origin: str, prefix: str
) -> tuple[list[Row], int] | Diagnostic:
    """Rows and size of one block as its source declares it."""
    what = f'{origin} of {block.kind} "{block.name}"'
    if frame.target.t15 and block.kind == "DB" and block.optimized is not False:
        return Diagnostic("PG609", f"{what}: access is optimized, offsets are lost", Span(""))
    try:
        layout = layout_block(block, blocks)
    except DiagnosticError as problem:
        first = problem.diagnostics[0]
        return Diagnostic(first.code, f"{what}: {first.message}", Span(""))
    return _rows(layout, prefix), layout.size


def _disagreement(found: dict[str, tuple[list[Row], int]]) -> str:
    """What each source says where they differ first; empty if all agree. None is outvoted: two of them share a way."""
    for said in zip_longest(*(_rows for _rows, _ in found.values())):
        if any(row != said[0] for row in said):
            return _said(found, [_place(row) for row in said])
    sizes = [size for _, size in found.values()]
    return _said(found, [f"{size} bytes" for size in sizes]) if len(set(sizes)) > 1 else ""


def _said(origins: Iterable[str], texts: Sequence[str]) -> str:
    groups: dict[str, list[str]] = {}
    for origin, text in zip(origins, texts, strict=True):
        groups.setdefault(text, []).append(f"the {origin}")
    return ", ".join(f"{' and '.join(who)} {'has' if len(who) == 1 else 'have'} {text}" for text, who in groups.items())


def _place(row: Row | None) -> str:
    return "no more members" if row is None else f"{row.name}@{row.offset} ({row.size} B, {type_text(row.type)})"


def _rows(layout: Layout, prefix: str = "") -> list[Row]:
    """Members on the first level as (name, byte offset, bytes, type), or those of a structure by its path."""
    depth = prefix.count(".")
    entries = (e for e in layout.entries if e.depth == depth and e.path.startswith(prefix))
    return [Row(e.path.removeprefix(prefix).strip('"'), e.byte, (e.size + 7) // 8, e.type) for e in entries]


def width_mark(type_: DataType) -> str:
    """``:W`` behind the name of a word."""
    return _WIDTH.get(type_.bits, "") if isinstance(type_, Elementary) else ""
