"""What the parts of the compiler pass around - values, places, symbols - and where they find each other."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from plcgen.s7.cpu.type_rules import INT_CONST, SIGNED_WIDTHS, WIDTHS
from plcgen.s7.layout.shapes import Shape
from plcgen.s7.scl import ast
from plcgen.s7.types.blocks import SectionKind
from plcgen.s7.types.data_types import Member

UNKNOWN = "?"
"""Type of an expression that has been reported already."""


@dataclass(slots=True)
class MemoryPlace:
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
    member: Member | None = None
    """The declaration, of a member of a structure."""

    @property
    def fixed(self) -> bool:
        """Whether the offset is known at compile time."""
        return not self.dyn and not self.dynbit

    def inside(self, offset: int, shape: Shape, *, overlay: bool) -> MemoryPlace:
        """Return a place inside this one, ``offset`` bits behind its start."""
        off = self.off + offset
        return MemoryPlace(shape, self.mem, off, self.dyn, self.dynbit, self.region, self.local, self.section, overlay)


@dataclass(slots=True)
class Val:
    """A compiled expression.

    ``type`` is a canonical elementary type, STRING, a constant type, empty for structures, or UNKNOWN. ``raw``
    says that the integer in ``code`` still has to be wrapped to the type. ``const`` is the value of a constant.
    """

    code: str
    type: str
    const: object = None
    place: MemoryPlace | None = None
    raw: bool = False
    pure: bool = True
    parts: tuple[str, list[str]] | None = None

    @property
    def wrapped(self) -> str:
        """The code with an integer brought into the range of its type."""
        return wrapped(self.code, self.type) if self.raw else self.code


@dataclass(slots=True)
class Symbol:
    """A declared name: a place, a constant, or both None if its declaration was wrong."""

    name: str
    section: SectionKind
    place: MemoryPlace | None = None
    constant: Val | None = None
    type_name: str = ""


def unknown() -> Val:
    """Value of something that has been reported."""
    return Val("0", UNKNOWN)


def whole_constant(number: int) -> Val:
    """Value of a whole number without a type."""
    return Val(repr(number), INT_CONST, number)


def wrapped(code: str, type_: str) -> str:
    """Return code that brings an integer into the range of its type."""
    bits = WIDTHS.get(type_, 16)
    mask = (1 << bits) - 1
    if type_ in SIGNED_WIDTHS:
        half = 1 << bits - 1
        return f"(({code}+{half}&{mask})-{half})"
    return f"(({code})&{mask})"


@dataclass(slots=True, eq=False)
class Expressions:
    """Values and their types; a problem is reported once and gives the type UNKNOWN.

    ``parts`` maps a class of nodes to what compiles it; ``watch`` is shown every value.
    """

    parts: dict[type[ast.Expression], Callable[[Any], Val]] = field(default_factory=dict)
    watch: Callable[[ast.Expression, Val], None] | None = None

    def value(self, node: ast.Expression) -> Val:
        """Compile an expression."""
        return self.shown(node, self.parts[type(node)](node))

    def shown(self, node: ast.Expression, value: Val) -> Val:
        """The value of a node, shown to who watches."""
        if self.watch is not None:
            self.watch(node, value)
        return value
