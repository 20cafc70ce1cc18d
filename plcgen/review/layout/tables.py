"""Memory layouts as tables, and a telegram as a picture: two bytes a row, every byte with its name."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, NamedTuple

from plcgen.output.cells import clean, cut, pad
from plcgen.output.paint import paint
from plcgen.output.table import markdown_table, text_table

if TYPE_CHECKING:
    from plcgen.s7.evidence import Rule
    from plcgen.s7.shapes import Shape

HEADER = ("offset", "address", "name", "type", "size", "start value", "comment")
_RULES = "rule"
_RIGHT = frozenset({0, 4})
_LONG = 6
"""Rows after which the picture shortens a member to its first and last two bytes."""
_START = 36
"""Columns of start values on a screen; files have them whole."""

_MARKS = 5
"""Footnotes of one row that are spelled out."""

_UNSAID = "the source has no S7_Optimized_Access: on S7-1200/1500 these offsets hold for standard access only"

MEMBER, GAP, MORE = "member", "gap", "more"


class LayoutRow(NamedTuple):
    """One line of a layout: a member, a gap that nothing uses, or a fold of further array elements.

    ``byte``.``bit`` from the start of the block (bit None for whole bytes, byte None in optimized blocks), size
    in ``bits``; ``rules`` are the keys of the rules that no compiled block confirms and on which place or size rest.
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
    and does not.
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
    shape: Shape | None = field(default=None, repr=False, compare=False)
    begin: Mapping[str, str] = field(default_factory=dict, repr=False, compare=False)

    @property
    def title(self) -> str:
        """``DB3 "WR_DataBuffer"``, ``DB3`` alone if it has no other name."""
        short = f"{self.kind}{'' if self.number is None else self.number}"
        return short if self.name.upper() == short else f'{short} "{clean(self.name)}"'

    @property
    def summary(self) -> str:
        """``10 bytes, 3 B unused``; optimized blocks have no offsets."""
        if self.size is None:
            return "optimized access: no offsets"
        unused = f", {size_text(self.unused)} unused" if self.unused else ""
        return f"{self.size} bytes{unused}"

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


def layout_text(blocks: Sequence[BlockTable], *, color: bool = False, grid: bool = True, width: int = 0) -> str:
    """Tables for people; telegram buffers get their picture below the table.

    ``width`` (0: none) cuts long lines with ``...``.
    """
    return "\n".join(_block(block, color=color, grid=grid, width=width) for block in blocks)


def _block(block: BlockTable, *, color: bool, grid: bool, width: int) -> str:
    role = f", {clean(block.role)}" if block.role else ""
    lines = [f"{paint(block.title, 'bold', color=color)}  {block.summary}{role}"]
    if block.comment:
        lines.append(paint(f"  {cut(clean(block.comment), width or 160)}", "dim", color=color))
    shown, right = _columns(block, width)
    header, *rows = text_table(shown[0], shown[1:], right=right)
    if width:
        header, *rows = [cut(line, width) for line in (header, *rows)]
    lines.append(paint(header, "dim", color=color))
    lines += [
        paint(text, "dim", color=color and row.kind != MEMBER) for row, text in zip(block.rows, rows, strict=True)
    ]
    lines += [f"  {mark}  {text}" for mark, text in block.footnotes]
    if grid and block.data is not None:
        lines += ["", *picture(block)]
    return "\n".join(lines) + "\n"


def _columns(block: BlockTable, width: int) -> tuple[list[tuple[str, ...]], frozenset[int]]:
    """Header and rows, without columns that are empty in every row; the numbers of the right-aligned ones."""
    rows = [row.cells() for row in block.rows]
    if width:
        rows = [(*cells[:5], cut(clean(cells[5]), _START), cells[6]) for cells in rows]
    marks = [(block.mark(row),) for row in block.rows]
    table: list[tuple[str, ...]] = [(*HEADER[:5], _RULES, *HEADER[5:])]
    table += [(*cells[:5], *mark, *cells[5:]) for cells, mark in zip(rows, marks, strict=True)]
    kept = [n for n in range(len(table[0])) if n in {2, 3} or any(row[n] for row in table[1:])]
    right = frozenset(kept.index(n) for n in _RIGHT if n in kept)
    return [tuple(row[n] for n in kept) for row in table], right


def picture(block: BlockTable, columns: int = 72) -> list[str]:
    """Draw the bytes of a telegram, two to a row, with the member each belongs to."""
    data = block.data or b""
    cell = (columns - 10) // 2
    rule = f"       +{'-' * cell}+{'-' * cell}+"
    lines = [f"  byte  {pad('+0', cell)} +1", rule]
    byte = 0
    for row in block.rows:
        if row.byte is None or row.bits < 8:
            continue
        size = row.bits // 8
        if byte == 4:
            lines.append(rule)
        for step in _steps(row.byte, size):
            if step is None:
                lines.append(f"       |{pad(' ...', 2 * cell + 1)}|")
            else:
                _draw(lines, row, data, step, cell)
        byte = row.byte + size
    if lines[-1].count("|") == 2 and byte % 2:
        lines[-1] += f"{' ' * cell}|"
    return [*lines, rule]


def _steps(start: int, size: int) -> list[tuple[int, int] | None]:
    """Rows of one member as (first byte, number of bytes); None where rows are left out."""
    first = start - start % 2
    pieces: list[tuple[int, int] | None] = []
    for word in range(first, start + size, 2):
        begin = max(word, start)
        pieces.append((begin, min(word + 2, start + size) - begin))
    return [*pieces[:2], None, *pieces[-2:]] if len(pieces) > _LONG else pieces


def _draw(lines: list[str], row: LayoutRow, data: bytes, step: tuple[int, int], cell: int) -> None:
    begin, count = step
    values = " ".join(f"{value:02X}" for value in data[begin : begin + count])
    name = clean(row.name) if begin == row.byte else '"'
    text = cut(f" {values}  {name}", cell * count + count - 1)
    drawn = pad(text, cell * count + count - 1)
    if begin % 2:
        lines[-1] += f"{drawn}|"
    else:
        lines.append(f"{begin:6d} |{drawn}|")


def _indented(cell: str) -> str:
    """A cell whose leading blanks a Markdown viewer keeps."""
    text = cell.lstrip(" ")
    return "\N{NO-BREAK SPACE}" * (len(cell) - len(text)) + text


def layout_markdown(blocks: Sequence[BlockTable]) -> str:
    """Write one heading and one table a block, its footnotes below."""
    parts = []
    for block in blocks:
        role = f", {clean(block.role)}" if block.role else ""
        shown, right = _columns(block, 0)
        table = markdown_table(shown[0], [[_indented(cell) for cell in row] for row in shown[1:]], right=right)
        title = block.title.replace("&", "&amp;").replace("<", "&lt;").replace("_", "\\_")
        notes = [f"- {mark}: {text}".replace("*", "\\*") for mark, text in block.footnotes]
        lines = [f"### {title}", "", f"{block.summary}{role}", "", *table, *([""] if notes else []), *notes]
        parts.append("\n".join(lines) + "\n")
    return "\n".join(parts)
