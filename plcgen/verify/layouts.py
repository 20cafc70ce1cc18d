"""Offsets of every buffer, computed three times and compared: from the telegram, the text sources, the SimaticML."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from plcgen.diagnostics import Diagnostic, DiagnosticError
from plcgen.plan.model import BlockRef, Field, Project, Telegram
from plcgen.s7.blocks import Block
from plcgen.s7.layout import Layout, layout_block
from plcgen.s7.types import DataType, Elementary
from plcgen.verify.folder import Folder
from plcgen.verify.model import Check, Outcome

_WIDTH = {16: ":W", 32: ":D", 64: ":L"}


@dataclass(frozen=True, slots=True)
class Row:
    """A member as one calculator sees it: offset and size in bytes."""

    name: str
    offset: int
    size: int
    type: DataType


def check_layouts(project: Project, folder: Folder) -> Iterator[Check]:
    """Checks of the group ``layout``: one per buffer DB."""
    for job in project.jobs:
        for telegram in job.telegrams:
            yield _buffer(project, folder, telegram.request_db, telegram.request_type, telegram.request_fields, None)
            yield _buffer(
                project, folder, telegram.response_db, telegram.response_type, telegram.response_fields, telegram
            )


def _buffer(
    project: Project,
    folder: Folder,
    db: BlockRef,
    type_block: BlockRef,
    fields: tuple[Field, ...],
    answers: Telegram | None,
) -> Check:
    size = fields[-1].offset + fields[-1].size
    subject = f'DB{db.number} "{db.name}"'
    figures = " ".join(f"{f.name}@{f.offset}{_width(f.type)}" for f in fields if f.role != "reserve")
    text = f"{size} B  {figures}"
    planned = [Row(f.name, f.offset, f.size, f.type) for f in fields]
    problem, calculators = _compare(project, folder, db, type_block, planned, size)
    if problem is None and answers is not None:
        problem = _room(answers, size, folder)
        text = f"{size} B  positive {answers.positive_length} / negative {answers.negative_length}  {figures}"
    if problem is not None:
        return Check(f"layout.{db.name}", subject, text, Outcome.ERROR, problem.message, problem)
    return Check(f"layout.{db.name}", subject, text, Outcome.OK, f"{calculators} calculators agree")


def _compare(
    project: Project, folder: Folder, db: BlockRef, type_block: BlockRef, planned: list[Row], size: int
) -> tuple[Diagnostic | None, int]:
    """First disagreement, and how many independent calculations took part."""
    calculators = 1
    for origin, blocks in (("text source", folder.text), ("SimaticML", folder.xml)):
        if origin == "SimaticML" and project.target.xml_version is None:
            continue
        calculators += 1
        for ref in (db, type_block):
            block = blocks.get(ref.name.upper())
            if block is None:
                message = f'{ref.kind} "{ref.name}" is missing in the {origin}s'
                return Diagnostic("PG608", message, folder.place(ref.name), help="run plcgen generate"), calculators
            problem = _one(project, block, blocks, planned, size, origin)
            if problem is not None:
                return Diagnostic(problem[0], problem[1], folder.place(ref.name)), calculators
    return None, calculators


def _one(
    project: Project, block: Block, blocks: dict[str, Block], planned: list[Row], size: int, origin: str
) -> tuple[str, str] | None:
    what = f'{origin} of {block.kind} "{block.name}"'
    if project.target.t15 and block.kind == "DB" and block.optimized is not False:
        return "PG609", f"{what}: access is optimized, offsets are lost"
    try:
        layout = layout_block(block, blocks)
    except DiagnosticError as problem:
        return problem.diagnostics[0].code, f"{what}: {problem.diagnostics[0].message}"
    found = rows(layout)
    for expected, actual in zip(planned, found, strict=False):
        if expected != actual:
            there = f"{actual.name}@{actual.offset} ({actual.size} B)"
            wanted = f"{expected.name}@{expected.offset} ({expected.size} B)"
            return "PG603", f"{what}: {there}, the telegram has {wanted}"
    if len(found) != len(planned):
        return "PG603", f"{what}: {len(found)} members, the telegram has {len(planned)}"
    if layout.size != size + size % 2:
        return "PG603", f"{what}: {layout.size} bytes, the telegram has {size}"
    return None


def rows(layout: Layout) -> list[Row]:
    """Members on the first level as (name, byte offset, bytes, type)."""
    return [Row(e.path.strip('"'), e.byte, (e.size + 7) // 8, e.type) for e in layout.entries if e.depth == 0]


def _room(telegram: Telegram, size: int, folder: Folder) -> Diagnostic | None:
    need = max(telegram.positive_length, telegram.negative_length)
    if size >= need:
        return None
    message = f"response buffer {need - size} bytes too small"
    return Diagnostic("PG605", message, folder.place(telegram.response_db.name), help=f"an answer needs {need} bytes")


def _width(type_: DataType) -> str:
    return _WIDTH.get(type_.bits, "") if isinstance(type_, Elementary) else ""
