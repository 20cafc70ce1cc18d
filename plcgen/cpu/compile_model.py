"""What the compiler passes around: values, places, symbols, probes and compiled blocks."""

from __future__ import annotations

from dataclasses import dataclass, field
from types import CodeType

from plcgen.diagnostics import Diagnostic, Span
from plcgen.s7.blocks import Block, SectionKind
from plcgen.s7.shapes import Shape
from plcgen.scl import ast
from plcgen.scl.parser import ParseResult

UNKNOWN = "?"
"""Type of an expression that has been reported already."""


@dataclass(slots=True)
class Place:
    """Somewhere in memory.

    ``mem`` is the generated name of the memory, ``off`` the fixed offset in bits; ``dyn`` and ``dynbit`` are
    generated expressions added to it in bytes and bits. ``region`` names the memory for the cache of values, None
    if anything may lie there. ``local`` is set instead for a variable that is a plain Python local.
    """

    shape: Shape
    mem: str = ""
    off: int = 0
    dyn: str = ""
    dynbit: str = ""
    region: str | None = None
    local: str = ""
    section: SectionKind | None = None
    overlay: bool = False

    @property
    def fixed(self) -> bool:
        """Whether the offset is known at compile time."""
        return not self.dyn and not self.dynbit


@dataclass(slots=True)
class Val:
    """A compiled expression.

    ``type`` is a canonical elementary type, STRING, a constant type, empty for structures, or UNKNOWN. ``raw``
    says that the integer in ``code`` still has to be wrapped to the type. ``const`` is the value of a constant.
    """

    code: str
    type: str
    const: object = None
    place: Place | None = None
    raw: bool = False
    pure: bool = True
    parts: tuple[str, list[str]] | None = None


@dataclass(slots=True)
class Symbol:
    """A declared name: a place, a constant, or both None if its declaration was wrong."""

    name: str
    section: SectionKind
    place: Place | None = None
    constant: Val | None = None
    type_name: str = ""


@dataclass(slots=True)
class ProgramBlock:
    """A block of the program: the tree, the declarations, where it lies in the generated code."""

    index: int
    unit: ast.Unit
    block: Block
    result: ParseResult
    shape: Shape | None = None
    number: int | None = None

    @property
    def name(self) -> str:
        """Name as declared."""
        return self.block.name


@dataclass(frozen=True, slots=True)
class Probe:
    """One thing coverage counts: a statement or the outcome of a branch."""

    file: str
    line: int
    column: int
    kind: str


@dataclass(slots=True)
class Compiled:
    """A block as Python code; ``lines`` maps a line of ``source`` to the line of the SCL file."""

    name: str
    function: str
    source: str
    lines: list[int]
    file: str
    code: CodeType | None = None
    diagnostics: list[Diagnostic] = field(default_factory=list)
    calls: dict[str, Span] = field(default_factory=dict)
    moving: bool = False
