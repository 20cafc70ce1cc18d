"""Offsets of every buffer, computed three times and compared: from the telegram, the text sources, the SimaticML."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from plcgen.diagnostics import Diagnostic, DiagnosticError, Span
from plcgen.project.nouns import BlockRef, Buffer, Frame
from plcgen.proof.checks import Check, Outcome
from plcgen.proof.folder import Folder
from plcgen.protocols.ds47.plan.nouns import DriveField, DrivePlan, DriveTelegram
from plcgen.s7.blocks import Block
from plcgen.s7.layout import Layout, layout_block
from plcgen.s7.types import DataType, Elementary

TELEGRAM, TEXT, XML = "telegram", "text source", "SimaticML"
"""The three calculators, as messages name them."""

_WIDTH = {16: ":W", 32: ":D", 64: ":L"}


@dataclass(frozen=True, slots=True)
class Row:
    """A member as one calculator sees it: offset and size in bytes."""

    name: str
    offset: int
    size: int
    type: DataType


def check_layouts(plan: DrivePlan, folder: Folder) -> Iterator[Check]:
    """Checks of the group ``layout``: one per buffer DB."""
    for job in plan.jobs:
        for telegram in job.telegrams:
            yield _buffer(plan, folder, telegram.request, None)
            yield _buffer(plan, folder, telegram.response, telegram)


def _buffer(plan: DrivePlan, folder: Folder, buffer: Buffer[DriveField], answers: DriveTelegram | None) -> Check:
    db, type_block, fields = buffer.db, buffer.type, buffer.fields
    size = fields[-1].offset + fields[-1].size
    subject = f'DB{db.number} "{db.name}"'
    figures = " ".join(f"{f.name}@{f.offset}{width_mark(f.type)}" for f in fields if f.role != "reserve")
    text = f"{size} B  {figures}"
    planned = [Row(f.name, f.offset, f.size, f.type) for f in fields]
    problem = compare(plan, folder, ((db, ""), (type_block, "")), planned, size)
    if problem is None and answers is not None:
        problem = _room(answers, size, folder)
        text = f"{size} B  positive {answers.positive_length} / negative {answers.negative_length}  {figures}"
    if problem is not None:
        return Check(f"layout.{db.name}", subject, text, Outcome.ERROR, problem.message, problem)
    return Check(f"layout.{db.name}", subject, text, Outcome.OK, agreement(plan))


def agreement(project: Frame) -> str:
    """``3 calculators agree``; which ones, where there are fewer."""
    if project.target.xml_version is not None:
        return "3 calculators agree"
    return f"2 calculators agree: {TELEGRAM}, {TEXT}; no {XML}"


def compare(
    project: Frame, folder: Folder, refs: tuple[tuple[BlockRef, str], ...], planned: list[Row], size: int
) -> Diagnostic | None:
    """The first disagreement between the calculators, about the DB and then about its type.

    ``refs`` are the blocks with the planned members, and the path of the structure they lie in (``telegram.``).
    """
    sources = [(TEXT, folder.text)]
    if project.target.xml_version is not None:
        sources.append((XML, folder.xml))
    for ref, prefix in refs:
        sizes = {TELEGRAM: (planned, size + size % 2)}
        for origin, blocks in sources:
            block = blocks.get(ref.name.upper())
            if block is None:
                message = f'{ref.kind} "{ref.name}" is missing in the {origin}s'
                return Diagnostic("PG608", message, folder.place(ref.name), help="run plcgen generate")
            found = _laid_out(project, block, blocks, origin, prefix)
            if isinstance(found, Diagnostic):
                return Diagnostic(found.code, found.message, folder.place(ref.name))
            sizes[origin] = found
        message = _disagreement(sizes)
        if message:
            return Diagnostic("PG603", f'{ref.kind} "{ref.name}": {message}', folder.place(ref.name))
    return None


def _laid_out(
    project: Frame, block: Block, blocks: dict[str, Block], origin: str, prefix: str
) -> tuple[list[Row], int] | Diagnostic:
    """Rows and size of one block as its source declares it."""
    what = f'{origin} of {block.kind} "{block.name}"'
    if project.target.t15 and block.kind == "DB" and block.optimized is not False:
        return Diagnostic("PG609", f"{what}: access is optimized, offsets are lost", Span(""))
    try:
        layout = layout_block(block, blocks)
    except DiagnosticError as problem:
        first = problem.diagnostics[0]
        return Diagnostic(first.code, f"{what}: {first.message}", Span(""))
    return rows(layout, prefix), layout.size


def _disagreement(found: dict[str, tuple[list[Row], int]]) -> str:
    """Name the calculator that stands alone, and where it differs first; empty if all agree."""
    votes = {origin: sum(value == other for other in found.values()) for origin, value in found.items()}
    reference = max(found, key=votes.__getitem__)
    alone = next((origin for origin, value in found.items() if value != found[reference]), None)
    if alone is None:
        return ""
    others = [origin for origin, value in found.items() if value == found[reference]]
    (own, own_size), (agreed, agreed_size) = found[alone], found[reference]
    rest = f"{' and '.join(map(_the, others))} {'has' if len(others) == 1 else 'have'}"
    for actual, expected in zip(own, agreed, strict=False):
        if actual != expected:
            return f"{_the(alone)} has {_place(actual)}, {rest} {_place(expected)}"
    if len(own) != len(agreed):
        return f"{_the(alone)} has {len(own)} members, {rest} {len(agreed)}"
    return f"{_the(alone)} has {own_size} bytes, {rest} {agreed_size}"


def _the(origin: str) -> str:
    return f"the {origin}"


def _place(row: Row) -> str:
    type_ = row.type.name if isinstance(row.type, Elementary) else type(row.type).__name__
    return f"{row.name}@{row.offset} ({row.size} B, {type_})"


def rows(layout: Layout, prefix: str = "") -> list[Row]:
    """Members on the first level as (name, byte offset, bytes, type), or those of a structure by its path."""
    depth = prefix.count(".")
    entries = (e for e in layout.entries if e.depth == depth and e.path.startswith(prefix))
    return [Row(e.path.removeprefix(prefix).strip('"'), e.byte, (e.size + 7) // 8, e.type) for e in entries]


def _room(telegram: DriveTelegram, size: int, folder: Folder) -> Diagnostic | None:
    need = max(telegram.positive_length, telegram.negative_length)
    if size >= need:
        return None
    message = f"response buffer {need - size} bytes too small"
    return Diagnostic("PG605", message, folder.place(telegram.response.db.name), help=f"an answer needs {need} bytes")


def width_mark(type_: DataType) -> str:
    """``:W`` behind the name of a word."""
    return _WIDTH.get(type_.bits, "") if isinstance(type_, Elementary) else ""
