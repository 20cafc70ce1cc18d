"""LAYOUT.md line by line: headings and telegrams against the protocols, every row against the block on disk."""

from __future__ import annotations

import re
import struct
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field

from plcgen.base.diagnostics import DiagnosticError
from plcgen.project.nouns import Project
from plcgen.proof.folder import Folder, plain, rendered, table_rows
from plcgen.proof.wording.model import Wording, untitled
from plcgen.s7.layout.layout import Entry, Layout, layout_block
from plcgen.s7.types.blocks import Block, BlockKind
from plcgen.s7.types.data_types import Elementary, Member, inner_members
from plcgen.s7.types.literals import type_text

FILE = "LAYOUT.md"
_STANDARD = "Standard access, big-endian; offsets in bytes."
_JOBS = (
    "Programs and panels address {} by name: a structure for each job. Its offsets and those of all other blocks: "
    "`plcgen layout` with this folder."
)
_COLUMNS = ["offset", "address", "name", "type", "bytes", "start value", "meaning"]
_PART = re.compile(r'### (?:DB(?P<number>\d+) )?"(?P<name>.+)", (?P<size>\d+) bytes')
_ADDRESS = re.compile(r"DB(\d+)\.(DB[XBWDL])(\d+)(?:\.\d)?")
_LITERAL = re.compile(r"(?:(?:[A-Z]+#)?16#([0-9A-F]+)|(?:[A-Z]+#)?(-?\d+(?:\.\d+)?))?")
_LETTERS = {1: "DBB", 2: "DBW", 4: "DBD"}
Said = tuple[int, str]
"""Number of a line from 1, and what is wrong with it."""


@dataclass(slots=True)
class _Table:
    """The table of a block: its layout, its members as they are declared, its start values as they are planned."""

    block: Block
    number: int | None
    layout: Layout
    entries: Mapping[str, Entry]
    image: bytes
    members: dict[str, Member]
    starts: dict[str, str]
    stated: Sequence[Wording]
    seen: set[str] = field(default_factory=set)
    place: int = -1

    def texts(self, name: str, offset: int) -> set[str]:
        """What a member may say: a sheet says it in English where its source says it in another language."""
        said = (one.member(self.block, name.split("."), offset) for one in self.stated)
        return {plain(text) for texts in said for text in texts or ()}


@dataclass(slots=True)
class _Sheet:
    """What a layout sheet must say."""

    project: Project
    folder: Folder
    stated: Sequence[Wording]
    numbers: Mapping[str, int]
    images: Mapping[str, bytes]
    wanted: dict[str, list[frozenset[str]]]
    jobs: str
    waiting: list[frozenset[str]] = field(default_factory=list)
    table: _Table | None = None
    seen: set[str] = field(default_factory=set)


def check_sheet(project: Project, folder: Folder, stated: Sequence[Wording], text: str) -> Iterator[Said]:
    """Everything that the layout sheet says."""
    buffers = [buffer for job in project.jobs for one in job.telegrams for buffer in one.buffers]
    wanted = {block.name.upper(): lists for block in folder.text.values() if (lists := _lists(block, folder, stated))}
    numbers = {ref.name.upper(): ref.number for ref in project.blocks}
    images = {buffer.home.name: buffer.image for buffer in buffers}
    controls = [f"`{folder.text[name].name}`" for one in stated for name in one.controls if name in folder.text]
    sheet = _Sheet(project, folder, stated, numbers, images, wanted, _JOBS.format(", ".join(controls)))
    lines = text.split("\n")
    top = f"# {project.name}: layout of the data blocks"
    if rendered(lines[0]) != plain(top):
        yield 1, f'the heading is not "{top}"'
    for number, line in enumerate(lines[1:], 2):
        yield from ((number, what) for what in _line(sheet, line))
    yield from ((len(lines), what) for what in _ended(sheet))
    yield from ((2, f'the line "{line}" is missing') for line in (_STANDARD, sheet.jobs) if line not in lines)
    yield from ((len(lines), f"the part of {name} is missing") for name in sheet.wanted)
    missing = len(set(images) - sheet.seen)
    if missing:
        yield len(lines), f"{missing} buffers are missing"


def _line(sheet: _Sheet, line: str) -> Iterator[str]:
    if line.startswith("## "):
        yield from _ended(sheet)
        name, _, title = rendered(line.removeprefix("## ")).partition(": ")
        block = sheet.folder.text.get(name.upper())
        sheet.waiting = [frozenset(map(plain, texts)) for texts in sheet.wanted.pop(name.upper(), [])]
        if block is None or untitled(title) not in _titles(block, sheet.stated):
            yield f'"{line}": the block has another title'
    elif line.startswith("- "):
        said = rendered(line.removeprefix("- "))
        at = next((at for at, texts in enumerate(sheet.waiting) if said in texts), None)
        if at is None:
            yield f'no source for "{line}"; the telegrams say "{min(sheet.waiting[0]) if sheet.waiting else "nothing"}"'
        else:
            del sheet.waiting[at]
    elif line.startswith("### "):
        yield from _ended(sheet)
        part = _PART.fullmatch(line)
        block = sheet.folder.text.get(rendered(part["name"]).upper()) if part is not None else None
        if part is None or block is None:
            yield f"{line} is not a block"
        else:
            yield from _opened(sheet, block, part["number"], int(part["size"]))
    elif line.startswith("| "):
        row = next(table_rows(line))
        if row != _COLUMNS and sheet.table is not None:
            yield from _row(sheet.table, row)
    elif line not in {"", _STANDARD, sheet.jobs, "|---:|---|---|---|---:|---|---|"}:
        yield f'no source for "{line}"'


def _opened(sheet: _Sheet, block: Block, number: str | None, size: int) -> Iterator[str]:
    """The heading of a table."""
    sheet.seen.add(block.name)
    try:
        layout = layout_block(block, sheet.folder.text)
    except DiagnosticError:
        return  # told where it is laid out
    planned = sheet.numbers.get(block.name.upper())
    if number and int(number) != planned:
        yield f"{block.name} is DB{number}, the plan has DB{planned}"
    if size not in {layout.size, layout.size - 1}:  # an odd one is filled up
        yield f"{block.name} has {size} bytes, its source {layout.size}"
    entries = {entry.path.replace('"', ""): entry for entry in layout.entries}
    members, starts = _declared(block, sheet.folder)
    image = sheet.images.get(block.name, b"")
    sheet.table = _Table(block, planned, layout, entries, image, members, starts, sheet.stated)


def _ended(sheet: _Sheet) -> Iterator[str]:
    """What is missing above."""
    yield from (f'the line "{min(texts)}" is missing above' for texts in sheet.waiting)
    sheet.waiting = []
    table, sheet.table = sheet.table, None
    if table is not None:
        yield from (f"{table.block.name}.{name} is not listed" for name in sorted(table.members.keys() - table.seen))


def _lists(block: Block, folder: Folder, stated: Sequence[Wording]) -> list[frozenset[str]] | None:
    """Lines above the tables of a block; what is in braces is its size."""
    found = next((lines for one in stated if (lines := one.sheet(block)) is not None), None)
    if found is None or block.kind is not BlockKind.UDT:
        return found
    size = layout_block(block, folder.text).size
    return [frozenset(text.format(size=size) for text in texts) for texts in found]


def _titles(block: Block, stated: Sequence[Wording]) -> set[str]:
    known = (title for one in stated for title in one.title(block) or ())
    own = {untitled(title) for title in (block.title, *known) if title}
    return own | {found for one in stated if (found := one.sheet_title(block))}


def _declared(block: Block, folder: Folder) -> tuple[dict[str, Member], dict[str, str]]:
    """Members that a table lists by name, and the start values that a source gives them."""
    found: dict[str, Member] = {}
    for member in block.members:
        of = folder.text.get(getattr(member.type, "name", "").upper())
        for one in of.members if of is not None and len(block.members) == 1 else (member,):
            found[one.name] = one
            found |= {f"{one.name}.{inner.name}": inner for inner in inner_members(one.type)}
    starts = {name: member.start for name, member in found.items() if member.start}
    starts |= {one.path.replace('"', "").rpartition(".")[2]: one.literal for one in block.assignments}
    return found, starts


def _row(table: _Table, row: Sequence[str]) -> Iterator[str]:
    """One row: where a member lies, what it is, what it starts with, what it means."""
    if len(row) != len(_COLUMNS):
        yield f"a row has {len(row)} columns"
        return
    offset, address, name, type_, size, start, meaning = map(plain, row)
    table.seen.add(name)
    entry, of = table.entries.get(name) or table.entries.get(f"telegram.{name}"), table.block.name
    if entry is None:
        yield f"{of} has no {name}"
        return
    if entry.offset <= table.place:
        yield f"{of}.{name} is listed after what lies after it"
    table.place = entry.offset
    right = (str(entry.byte), type_text(entry.type).upper(), str((entry.size + 7) // 8))
    if (offset, type_.upper(), size) != right:
        yield f"{of}.{name} lies at {right[0]}, {right[1]}, {right[2]} bytes"
    width = entry.size // 8 if isinstance(entry.type, Elementary) else 0
    said = _ADDRESS.fullmatch(address)
    place = (table.number, _LETTERS.get(width, "DBB"), entry.byte)
    if address and (said is None or (int(said[1]), said[2], int(said[3])) != place):
        yield f"{of}.{name} is not at {address}"
    held = table.image[entry.byte : entry.byte + entry.size // 8]
    if held and width and literal_bytes(start, len(held)) not in {None, held}:
        yield f"{of}.{name} starts with {held.hex(' ').upper()}"
    elif (own := table.starts.get(name, "")) and plain(own) != start:
        yield f"{of}.{name} starts with {own}"
    elif start and not own and not any(held):
        yield f"{of}.{name} starts with nothing"
    member = table.members.get(name)
    known = member is None or plain(member.comment) == meaning or meaning in table.texts(name, entry.byte)
    if member is not None and not known:
        yield f'{of}.{name} means "{meaning}", its source says "{member.comment}"'


def literal_bytes(text: str, size: int) -> bytes | None:
    """Bytes of a number as a sheet shows it, zeros for nothing; None if it is something else."""
    found = _LITERAL.fullmatch(text)
    if found is None:
        return None
    if found[2] and "." in found[2]:
        return struct.pack(">f", float(found[2])) if size == 4 else None
    value = int(found[1], 16) if found[1] else int(found[2] or 0)
    return (value & (1 << 8 * size) - 1).to_bytes(size, "big")
