"""Memory layouts as rows, text and data: one table a block, footnotes of places that no compiled block confirms."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import islice
from typing import TYPE_CHECKING, Any, NamedTuple

from plcgen.base.diagnostics import Diagnostic, has_errors
from plcgen.base.display.cells import clean, cut, pad
from plcgen.base.display.data import diagnostic_data, head
from plcgen.base.display.table import text_table
from plcgen.base.display.view import View
from plcgen.s7.layout.layout import Entry, layout_block, leaves
from plcgen.s7.types.blocks import Block, BlockKind, block_title
from plcgen.s7.types.literals import type_text

if TYPE_CHECKING:
    from plcgen.s7.layout.evidence import Rule
    from plcgen.s7.layout.shapes import Shape
    from plcgen.s7.types.data_types import Member

HEADER = ("offset", "address", "name", "type", "size", "start value", "comment")
_MARKS = 5
"""Footnotes of one row that are spelled out."""

_UNSAID = "the source has no S7_Optimized_Access: on S7-1200/1500 these offsets hold for standard access only"

MEMBER, GAP, MORE = "member", "gap", "more"


class LayoutRow(NamedTuple):
    """One line of a layout: a member, a gap that nothing uses, or a fold of further array elements.

    ``byte``.``bit`` from the start of the block (bit None for whole bytes, byte None in optimized blocks), size
    in ``bits``; ``rules`` are the keys of the rules that no compiled block confirms and on which place or size rest.
    ``role`` says what a byte of a telegram is for (see ``review.sheet``), empty in all other blocks.
    """

    byte: int | None
    bit: int | None
    bits: int
    address: str
    name: str
    type: str
    start: str
    depth: int = 0
    comment: str = ""
    kind: str = MEMBER
    rules: tuple[str, ...] = ()
    role: str = ""

    @property
    def offset(self) -> str:
        """Offset as S7 editors write it: ``6.0``."""
        return "" if self.byte is None else f"{self.byte}.{self.bit or 0}"

    @property
    def size(self) -> str:
        """``2 B``, ``1 bit`` or ``1 B 5 bit``."""
        return "" if self.byte is None else size_text(self.bits)

    def cells(self) -> tuple[str, ...]:
        """Texts of the table's columns."""
        name = "  " * self.depth + self.name
        return (self.offset, self.address, name, self.type, self.size, self.start, self.comment)


@dataclass(frozen=True, slots=True)
class BlockTable:
    """One block: identity, size in bytes (None if its access is optimized), rows.

    ``data`` and ``role`` if it is a telegram's buffer; ``unused`` counts the bits of all gaps, those inside folded
    arrays included; ``shape`` is the memory the rows were made from, ``begin`` the values of the BEGIN part
    by lower-case path; ``file`` and ``line`` where it is declared; ``unsaid`` if its source could state the access
    and does not; ``inner`` if only its own code goes by its offsets: a function block, or an instance of one.
    """

    kind: str
    name: str
    number: int | None
    size: int | None
    rows: tuple[LayoutRow, ...]
    role: str = ""
    data: bytes | None = None
    unused: int = 0
    rules: tuple[Rule, ...] = ()
    comment: str = ""
    file: str = ""
    line: int = 0
    unsaid: bool = False
    inner: bool = False
    shape: Shape | None = field(default=None, repr=False, compare=False)
    begin: Mapping[str, str] = field(default_factory=dict, repr=False, compare=False)

    @property
    def title(self) -> str:
        """``DB3 "WR_DataBuffer"``, ``DB3`` alone if it has no other name."""
        return clean(block_title(self.kind, self.number, self.name))

    @property
    def summary(self) -> str:
        """``10 bytes, 3 B unused, request of read_speed``; optimized blocks have no offsets."""
        unused = f", {size_text(self.unused)} unused" if self.unused else ""
        size = "optimized access: no offsets" if self.size is None else f"{self.size} bytes{unused}"
        return f"{size}, {clean(self.role)}" if self.role else size

    def mark(self, row: LayoutRow) -> str:
        """Letters of the footnotes of a row: ``a``, ``a b``; of many the first, and how many more."""
        if not row.rules:
            return ""
        keys = [rule.key for rule in self.rules]
        marks = [letter(keys.index(key)) for key in row.rules if key in keys]
        more = [f"+{len(marks) - _MARKS}"] if len(marks) > _MARKS else []
        return " ".join(marks[:_MARKS] + more)

    @property
    def footnotes(self) -> list[tuple[str, str]]:
        """(letter, sentence) of every rule that no compiled block confirms and that a row rests on; then the access."""
        notes = [(letter(n), f"{r.text}: {r.evidence}, no compiled block") for n, r in enumerate(self.rules)]
        return [*notes, *([("*", _UNSAID)] if self.unsaid else [])]


@dataclass(frozen=True, slots=True)
class LayoutResult:
    """Memory layouts: of a spec's telegram buffers, or of the blocks in source files.

    ``subject`` names the project, or the only path; ``origins`` are the paths with the hash of their texts;
    ``agreed`` counts offsets that exports state and that are the same here.
    """

    blocks: tuple[BlockTable, ...]
    diagnostics: tuple[Diagnostic, ...]
    subject: str = ""
    origins: tuple[tuple[str, str], ...] = ()
    agreed: int = 0

    @property
    def ok(self) -> bool:
        """Whether no diagnostic is an error."""
        return not has_errors(self.diagnostics)


def letter(position: int) -> str:
    """``a`` to ``z``, then ``aa``, ``ab``."""
    head, tail = divmod(position, 26)
    return (letter(head - 1) if head else "") + chr(ord("a") + tail)


def size_text(bits: int) -> str:
    """``2 B``, ``1 bit``, ``1 B 5 bit``."""
    size, rest = divmod(bits, 8)
    parts = ([f"{size} B"] if size or not rest else []) + ([f"{rest} bit"] if rest else [])
    return " ".join(parts)


_LETTERS = {8: "B", 16: "W", 32: "D"}


def member_address(db: int | None, byte: int, bit: int | None, bits: int) -> str:
    """``DB3.DBW6``; ``DBW6`` without a number; larger members show their first byte."""
    block = "" if db is None else f"DB{db}."
    return f"{block}DB{_LETTERS.get(bits, 'B')}{byte}" if bit is None else f"{block}DBX{byte}.{bit}"


def layout_data(result: LayoutResult) -> dict[str, Any]:
    """Blocks with their members; offsets and sizes as numbers."""
    return {
        **head("layout", ok=result.ok),
        "blocks": [_block_data(block) for block in result.blocks],
        "diagnostics": [diagnostic_data(d) for d in result.diagnostics],
    }


def _block_data(block: BlockTable) -> dict[str, Any]:
    return {
        "kind": block.kind,
        "name": block.name,
        "number": block.number,
        "size": block.size,
        "unused_bits": block.unused,
        "optimized": block.size is None,
        "role": block.role,
        "comment": block.comment,
        "file": block.file,
        "line": block.line,
        "data": None if block.data is None else block.data.hex().upper(),
        "members": [_member(row, path) for row, path in zip(block.rows, member_paths(block.rows), strict=True)],
        "unconfirmed_rules": {rule.key: rule.text for rule in block.rules},
    }


def member_paths(rows: Sequence[LayoutRow]) -> Iterator[str]:
    """``drive[1].speed`` for every member and element, empty for gaps and folds."""
    above: list[str] = []
    for row in rows:
        del above[row.depth :]
        if row.kind in {GAP, MORE}:
            yield ""
            continue
        parent = above[-1] if above else ""
        above.append(parent + row.name if row.name.startswith("[") or not parent else f"{parent}.{row.name}")
        yield above[-1]


def _member(row: LayoutRow, path: str) -> dict[str, Any]:
    return {
        "name": row.name,
        "path": path,
        "byte": row.byte,
        "bit": row.bit,
        "bits": None if row.byte is None else row.bits,
        "address": row.address,
        "type": row.type,
        "start": row.start,
        "depth": row.depth,
        "comment": row.comment,
        "role": row.role,
        "kind": row.kind,
        "unconfirmed": list(row.rules),
    }


_RIGHT = frozenset({0, 4})
_LONG = 6
"""Rows after which the picture shortens a member to its first and last two bytes."""

_CELL = 31
"""Columns of a byte in the picture."""
_START = 36
"""Columns of start values on a screen; files have them whole."""


def layout_text(blocks: Sequence[BlockTable], view: View) -> str:
    """Tables for people; telegram buffers get their picture below the table.

    A screen cuts long lines with ``...``; files have them whole.
    """
    return "\n".join(_block(block, view) for block in blocks)


def _block(block: BlockTable, view: View) -> str:
    width = view.width if view.target == "screen" else 0
    lines = [f"{view.paint(block.title, 'bold')}  {block.summary}"]
    if block.comment:
        lines.append(view.paint(f"  {cut(clean(block.comment), width or 160)}", "dim"))
    shown, right = shown_columns(block, _START if width else 0)
    header, *rows = text_table(shown[0], shown[1:], right=right)
    if width:
        header, *rows = [cut(line, width) for line in (header, *rows)]
    lines.append(view.paint(header, "dim"))
    lines += [view.paint(text, "dim" if row.kind != MEMBER else "") for row, text in zip(block.rows, rows, strict=True)]
    lines += [f"  {mark}  {text}" for mark, text in block.footnotes]
    if view.grid and block.data is not None:
        lines += ["", *picture(block)]
    return "\n".join(lines) + "\n"


def shown_columns(block: BlockTable, start: int = 0) -> tuple[list[tuple[str, ...]], frozenset[int]]:
    """Header and rows, without columns that are empty in every row; the numbers of the right-aligned ones.

    ``start`` (0: none) cuts the start values to so many columns.
    """
    table: list[tuple[str, ...]] = [(*HEADER[:5], "rule", *HEADER[5:])]
    for row in block.rows:
        *cells, value, comment = row.cells()
        table.append((*cells, block.mark(row), cut(clean(value), start) if start else value, comment))
    kept = [n for n in range(len(table[0])) if n in {2, 3} or any(row[n] for row in table[1:])]
    right = frozenset(kept.index(n) for n in _RIGHT if n in kept)
    return [tuple(row[n] for n in kept) for row in table], right


def picture(block: BlockTable) -> list[str]:
    """Draw the bytes of a telegram, two to a row, with the member each belongs to."""
    data = block.data or b""
    rule = f"       +{'-' * _CELL}+{'-' * _CELL}+"
    lines = [f"  byte  {pad('+0', _CELL)} +1", rule]
    byte = 0
    for row in block.rows:
        if row.byte is None or row.bits < 8:
            continue
        size = row.bits // 8
        if byte == 4:
            lines.append(rule)
        start = row.byte
        # rows of one member as (first byte, number of bytes); None where rows are left out
        first = start - start % 2
        pieces: list[tuple[int, int] | None] = []
        for word in range(first, start + size, 2):
            begin = max(word, start)
            pieces.append((begin, min(word + 2, start + size) - begin))
        for step in [*pieces[:2], None, *pieces[-2:]] if len(pieces) > _LONG else pieces:
            if step is None:
                lines.append(f"       |{pad(' ...', 2 * _CELL + 1)}|")
            else:
                _draw(lines, row, data, step)
        byte = row.byte + size
    if lines[-1].count("|") == 2 and byte % 2:
        lines[-1] += f"{' ' * _CELL}|"
    return [*lines, rule]


def _draw(lines: list[str], row: LayoutRow, data: bytes, step: tuple[int, int]) -> None:
    begin, count = step
    values = " ".join(f"{value:02X}" for value in data[begin : begin + count])
    name = clean(row.name) if begin == row.byte else '"'
    text = cut(f" {values}  {name}", _CELL * count + count - 1)
    drawn = pad(text, _CELL * count + count - 1)
    if begin % 2:
        lines[-1] += f"{drawn}|"
    else:
        lines.append(f"{begin:6d} |{drawn}|")


_BYTE_SIZES = (8, 16, 32)
MOST = 5_000
"""Members of a block that are listed."""


class PanelTag(NamedTuple):
    """A member of a data block for a panel.

    ``symbolic`` is how the PLC names it, ``"DriveJobs".ramps.start``: S7-1200/1500, with any access. ``absolute`` is
    ``%DB5.DBX0.0``: for a block with standard access and a number; empty for others, whose members have no address.
    """

    symbolic: str
    absolute: str
    type: str
    comment: str


def panel_tag(block: Block, entry: Entry) -> PanelTag:
    """The member at an entry of a block's layout."""
    single = None if entry.size in _BYTE_SIZES or entry.size > max(_BYTE_SIZES) else entry.bit
    reached = block.number is not None and not block.optimized
    absolute = f"%{member_address(block.number, entry.byte, single, entry.size)}" if reached else ""
    member: Member = entry.member
    return PanelTag(f'"{block.name}".{entry.path}', absolute, type_text(entry.type), member.comment)


def panel_tags(block: Block, types: Mapping[str, Block]) -> Iterator[PanelTag]:
    """Every elementary member of a data block, in the order of memory; nothing for other blocks.

    Raises DiagnosticError as :func:`layout_block` does.
    """
    if block.kind is BlockKind.DB:
        yield from (panel_tag(block, entry) for entry in islice(leaves(layout_block(block, types)), MOST))
