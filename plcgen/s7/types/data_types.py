"""S7 data types as frozen values; sizes and alignment live in ``layout``, literals in ``literals``."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from types import MappingProxyType
from typing import TYPE_CHECKING, TypeAlias

from plcgen.base.diagnostics import PlcgenError
from plcgen.base.frozen import frozen

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from plcgen.base.diagnostics import Span


@dataclass(frozen=True, slots=True)
class Elementary:
    """An elementary type by its canonical upper-case name, for example ``BOOL``; ``bits`` is its width."""

    name: str
    bits: int


@dataclass(frozen=True, slots=True)
class StringType:
    """``STRING[length]`` or ``WSTRING[length]``; ``length`` counts characters."""

    name: str
    length: int


@frozen
class ArrayType:
    """``ARRAY[low..high, ...] OF element``; ``bounds`` has one (low, high) pair per dimension.

    ``ARRAY[*, *]`` has no bounds, but ``open_dimensions``.
    """

    bounds: tuple[tuple[int, int], ...]
    element: DataType
    open_dimensions: int = 1

    @property
    def bounds_text(self) -> str:
        """What stands in brackets: ``0..3, 1..2`` or ``*``."""
        return ", ".join(f"{low}..{high}" for low, high in self.bounds) or ", ".join("*" * self.open_dimensions)


@frozen
class StructType:
    """An anonymous ``STRUCT``."""

    members: tuple[Member, ...]


@frozen
class NamedType:
    """A type known by name: a UDT, an FB or SFB (multi-instance), a system type such as ``TON_TIME``."""

    name: str
    quoted: bool = False


DataType: TypeAlias = Elementary | StringType | ArrayType | StructType | NamedType


@frozen
class Member:
    """One declared variable: ``start`` is the literal text of its start value, exactly as written.

    ``attributes`` are the pairs in braces, such as (InstructionName, WRREC), (LibVersion, 1.1).
    """

    name: str
    type: DataType
    start: str | None = None
    comment: str = ""
    at: str | None = None
    span: Span | None = None
    attributes: tuple[tuple[str, str], ...] = ()


_WIDTHS = {
    "BOOL": 1,
    "BYTE": 8, "CHAR": 8, "SINT": 8, "USINT": 8,
    "WORD": 16, "INT": 16, "UINT": 16, "WCHAR": 16, "S5TIME": 16, "DATE": 16,
    "TIMER": 16, "COUNTER": 16, "BLOCK_DB": 16, "BLOCK_FB": 16, "BLOCK_FC": 16, "BLOCK_SDB": 16,
    "BLOCK_SFB": 16, "BLOCK_SFC": 16,
    "HW_IO": 16, "HW_ANY": 16, "HW_DEVICE": 16, "HW_SUBMODULE": 16, "HW_INTERFACE": 16, "HW_MODULE": 16,
    "HW_IOSYSTEM": 16, "HW_DPMASTER": 16, "HW_DPSLAVE": 16, "HW_IEPORT": 16, "HW_HSC": 16, "HW_PWM": 16, "HW_PTO": 16,
    "HW_INTERRUPT": 16,
    "OB_ANY": 16, "OB_DELAY": 16, "OB_TOD": 16, "OB_CYCLIC": 16, "OB_ATT": 16, "OB_PCYCLE": 16, "OB_HWINT": 16,
    "OB_DIAG": 16, "OB_TIMEERROR": 16, "OB_STARTUP": 16,
    "PORT": 16, "RTM": 16, "PIP": 16, "CONN_ANY": 16, "CONN_OUC": 16, "CONN_PRG": 16, "DB_ANY": 16, "DB_WWW": 16,
    "DB_DYN": 16,
    "CONN_R_ID": 32, "AOM_IDENT": 32, "EVENT_ANY": 32, "EVENT_ATT": 32, "EVENT_HWINT": 32,
    "DWORD": 32, "DINT": 32, "UDINT": 32, "REAL": 32, "TIME": 32, "TIME_OF_DAY": 32,
    "LWORD": 64, "LINT": 64, "ULINT": 64, "LREAL": 64, "LTIME": 64, "LTIME_OF_DAY": 64, "LDT": 64,
    "DATE_AND_TIME": 64,
    "DTL": 96,
    "ANY": 80,
    "POINTER": 48,
}  # fmt: skip

ELEMENTARY = MappingProxyType({name: Elementary(name, bits) for name, bits in _WIDTHS.items()})
"""Every elementary type by canonical name; widths from the S7 manuals, ANY/POINTER/DTL included."""

HARDWARE = frozenset(
    name for name in _WIDTHS if name.startswith(("HW_", "OB_", "EVENT_", "CONN_")) or name in {"PORT", "RTM", "PIP"}
) | {"AOM_IDENT", "DB_ANY", "DB_WWW", "DB_DYN"}
"""Numbers of hardware, organization blocks, events and connections (TIA Portal, "hardware data types")."""

ALIASES = MappingProxyType(
    {"TOD": "TIME_OF_DAY", "DT": "DATE_AND_TIME", "LTOD": "LTIME_OF_DAY", "DATE_AND_LTIME": "LDT"}
)
"""Short names that mean a canonical one."""


def innermost(type_: DataType) -> DataType:
    """What an array is made of, also one of arrays; any other type as it is."""
    while isinstance(type_, ArrayType):
        type_ = type_.element
    return type_


def inner_members(type_: DataType) -> tuple[Member, ...]:
    """Members of a structure, or of the structures that an array is made of."""
    inner = innermost(type_)
    return inner.members if isinstance(inner, StructType) else ()


def nested(members: Iterable[Member]) -> Iterator[Member]:
    """Every member in the order of declaration, each followed by those of the structures in it."""
    pending = [*members]
    pending.reverse()
    while pending:
        member = pending.pop()
        yield member
        pending += reversed(inner_members(member.type))


@lru_cache(maxsize=1024)
def elementary(name: str) -> Elementary | None:
    """Look an elementary type up by any spelling (case-insensitive, aliases allowed)."""
    upper = name.upper()
    return ELEMENTARY.get(ALIASES.get(upper, upper))


class UnknownPathError(PlcgenError, KeyError):
    """A path, name or address that nothing has, or an index out of its bounds."""


class UnfitValueError(PlcgenError, ValueError):
    """A value that its type cannot hold, or bytes that mean nothing in it."""
