"""Elements of parameters as a drive has them, whatever the way: bytes that are checked before they count as a value.

Over the S7 protocol, as an HMI reads them, it is one element a request: data block = number of the parameter, address
in bytes = 1024 x drive object + index. docs/live.md says who observed this on real drives. Such an answer has no type.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Protocol

from plcgen.ds47.device import Parameter, limit_text
from plcgen.ds47.live.connection import Reader, ReadRefusedError
from plcgen.ds47.types import read_type
from plcgen.ds47.wire.bico import read_bico
from plcgen.ds47.wire.formats import Format, FormatKind, Value, unpack_values

OBJECT_STEP = 1024
"""Addresses of one drive object, therefore also the largest number of indexes."""
_TINY = 1e-30
"""A REAL that is smaller and not 0 is most probably a whole number that was taken for a REAL."""


Wanted = tuple[Parameter, Sequence[int]]
"""A parameter and the indexes of it that are to be read."""


class ParameterReader(Protocol):
    """What the verbs need of a drive."""

    def read(self, wanted: Sequence[Wanted], drive_object: int) -> Iterator[ElementReading]:
        """Every element in this order; one that was refused has a doubt. Raises DiagnosticError without an answer."""


@dataclass(frozen=True, slots=True)
class ElementReading:
    """One element: the bytes that came and what they mean; ``doubt`` says why they are no value (then it is None)."""

    parameter: Parameter
    index: int
    data: bytes
    value: Value | None
    doubt: str = ""

    @property
    def text(self) -> str:
        """The value for people; empty if there is none."""
        if self.value is None:
            return ""
        if self.parameter.bico and isinstance(self.value, int):
            return str(read_bico(self.value)) if self.value >> 16 else str(self.value)
        if isinstance(self.value, bytes):
            return self.value.hex(" ").upper()
        named = next((name for name, value in self.parameter.values.items() if value == self.value), "")
        if named:
            return f"{self.value} ({named})"
        return f"{self.value:.7g}" if isinstance(self.value, float) else str(self.value)


def element_address(drive_object: int, index: int) -> int:
    """Byte address of an element. Raises ValueError for an index that would lie in the next drive object."""
    if not 0 <= index < OBJECT_STEP:
        raise ValueError(f"index {index} has no address: they end at {OBJECT_STEP - 1}")
    return OBJECT_STEP * drive_object + index


@dataclass(frozen=True, slots=True)
class S7Parameters:
    """Parameters over an S7 connection. The areas of neighbouring indexes overlap: no request can cover two of them."""

    reader: Reader

    def read(self, wanted: Sequence[Wanted], drive_object: int) -> Iterator[ElementReading]:
        """One request for each element."""
        for parameter, indexes in wanted:
            fmt, octets = read_type(parameter.type)
            for index in indexes:
                address = element_address(drive_object, index)
                try:
                    data = self.reader.read(parameter.pnu, address, octets or fmt.size)
                except ReadRefusedError as problem:
                    yield ElementReading(parameter, index, b"", None, f"refused: {problem}")
                else:
                    yield element_value(parameter, index, data)


def element_value(parameter: Parameter, index: int, data: bytes, *, typed: bool = False) -> ElementReading:
    """What the bytes of an element mean, if they can be its value; ``typed`` if the answer said so of its type."""
    fmt, octets = read_type(parameter.type)
    size = octets or fmt.size
    if len(data) != size:
        return ElementReading(
            parameter, index, data, None, f"{len(data)} bytes were received, {parameter.type} has {size}"
        )
    (value,) = unpack_values(fmt, octets or 1, data) if fmt.kind is not FormatKind.OPAQUE else [data]
    doubt = _doubt(fmt, data, value) or ("" if typed else _misread(parameter, fmt, value))
    return ElementReading(parameter, index, data, None if doubt else value, doubt)


def _doubt(fmt: Format, data: bytes, value: Value) -> str:
    if fmt.kind is FormatKind.BOOLEAN and data not in {b"\0", b"\1"}:
        return "neither 0 nor 1"
    if fmt.kind is FormatKind.TEXT and not str(value).rstrip("\0 ").isprintable():
        return "text with characters that cannot be printed"
    if isinstance(value, float) and not math.isfinite(value):
        return "not a finite number, so the type is probably another one"
    return ""


def _misread(parameter: Parameter, fmt: Format, value: Value) -> str:
    """Why bytes that have no type are probably not of this one."""
    if isinstance(value, float) and value and abs(value) < _TINY:
        return f"{value:.3g} as {fmt.name}, so the type is probably another one"
    if isinstance(value, int | float) and not isinstance(value, bool) and not parameter.bico:
        low, high = parameter.minimum, parameter.maximum
        if (low is not None and value < low) or (high is not None and value > high):
            return f"{value:.7g} is outside the limits {limit_text(low)}..{limit_text(high)} of the catalogue"
    return ""
