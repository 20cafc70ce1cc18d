"""Memory layouts as rows: one table a block, with the footnotes of places that no compiled block confirms."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, NamedTuple

from plcgen.base.diagnostics import Diagnostic, has_errors
from plcgen.base.display.cells import clean
from plcgen.s7.types.blocks import block_title

if TYPE_CHECKING:
    from plcgen.s7.layout.evidence import Rule
    from plcgen.s7.layout.shapes import Shape

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
