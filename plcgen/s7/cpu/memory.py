"""Byte memory of the CPU and the codecs between its bytes and Python values.

Values while code runs: BOOL is anything Python takes as true or false; integers, bit strings, characters and
times are ``int`` as they lie in memory (S5TIME and DATE included); REAL and LREAL ``float``; STRING ``str``;
DATE_AND_TIME, DTL, ANY and POINTER ``bytes``.
"""

from __future__ import annotations

import math
import struct
from collections.abc import Callable
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any

from plcgen.s7.cpu.type_rules import SIGNED_WIDTHS, WIDTHS

Reference = tuple["Memory | None", int, int]
"""What ANY, VARIANT and a structured parameter mean at run time: memory, first byte, bytes; None: no such DB."""

AREA_L = "L"


class Memory(bytearray):
    """The bytes of one area: ``area`` is DB, I, Q, M, P or L (local data), ``number`` that of a DB.

    ``optimized``: with optimised access, on an S7-1200/1500.
    """

    __slots__ = ("area", "name", "number", "optimized")

    def __init__(
        self, content: bytes | bytearray | int, area: str, number: int = 0, name: str = "", *, optimized: bool = False
    ) -> None:
        super().__init__(content)
        self.optimized = optimized
        self.area = area
        self.number = number
        self.name = name


@dataclass(frozen=True, slots=True)
class Codec:
    """How a type is read and written in generated code: templates with m (memory), o (offset), v (value)."""

    size: int
    read: str
    write: str
    default: str = "0"


_FORMATS = {(8, True): "b", (16, False): "H", (16, True): "h", (32, False): "I", (32, True): "i"}
_FORMATS |= {(64, False): "Q", (64, True): "q"}


def _codecs() -> dict[str, Codec]:
    table: dict[str, Codec] = {}
    for name, bits in WIDTHS.items():
        if name == "REAL":
            table[name] = Codec(4, "r_f({m},{o})[0]", "w_f({m},{o},{v})", "0.0")
        elif name == "LREAL":
            table[name] = Codec(8, "r_d({m},{o})[0]", "w_d({m},{o},{v})", "0.0")
        elif bits == 8 and name not in SIGNED_WIDTHS:
            table[name] = Codec(1, "{m}[{o}]", "{m}[{o}]={v}")
        else:
            letter = _FORMATS[bits, name in SIGNED_WIDTHS]
            table[name] = Codec(bits // 8, f"r_{letter}({{m}},{{o}})[0]", f"w_{letter}({{m}},{{o}},{{v}})")
    for name, size in (("DATE_AND_TIME", 8), ("DTL", 12), ("ANY", 10), ("POINTER", 6)):
        table[name] = Codec(size, f"r_x({{m}},{{o}},{size})", f"w_x({{m}},{{o}},{{v}},{size})", repr(bytes(size)))
    return table


CODECS = MappingProxyType(_codecs())
"""Codec of every elementary type but BOOL."""


def read_bytes(memory: bytearray, offset: int, size: int) -> bytes:
    """Bytes of a place; IndexError beyond the end."""
    if offset < 0 or offset + size > len(memory):
        raise IndexError(offset)
    return bytes(memory[offset : offset + size])


def write_bytes(memory: bytearray, offset: int, data: bytes, size: int) -> None:
    """Store ``size`` bytes at a place; IndexError beyond the end."""
    if offset < 0 or offset + size > len(memory):
        raise IndexError(offset)
    memory[offset : offset + size] = data[:size].ljust(size, b"\0")


def read_string(memory: bytearray, offset: int) -> str:
    """Read a STRING."""
    length = min(memory[offset], memory[offset + 1])
    return memory[offset + 2 : offset + 2 + length].decode("latin-1")


def write_string(memory: bytearray, offset: int, room: int, value: str) -> None:
    """Store a STRING of ``room`` characters; what does not fit is cut off."""
    data = value.encode("latin-1", "replace")[:room]
    memory[offset] = room
    memory[offset + 1] = len(data)
    memory[offset + 2 : offset + 2 + len(data)] = data


def read_wide(memory: bytearray, offset: int) -> str:
    """Read a WSTRING."""
    length = min(int.from_bytes(memory[offset : offset + 2]), int.from_bytes(memory[offset + 2 : offset + 4]))
    return memory[offset + 4 : offset + 4 + 2 * length].decode("utf-16-be", "surrogatepass")


def write_wide(memory: bytearray, offset: int, room: int, value: str) -> None:
    """Store a WSTRING of ``room`` characters; what does not fit is cut off."""
    data = value.encode("utf-16-be", "surrogatepass")[: 2 * room]
    memory[offset : offset + 4] = room.to_bytes(2) + (len(data) // 2).to_bytes(2)
    memory[offset + 4 : offset + 4 + len(data)] = data


def single(value: float) -> float:
    """Round to a 32-bit REAL; too large becomes infinite."""
    try:
        result: float = struct.unpack(">f", struct.pack(">f", value))[0]
    except OverflowError:
        return math.copysign(math.inf, value)
    return result


def codec_functions() -> dict[str, Callable[..., Any]]:
    """The functions that the codec templates name."""
    found: dict[str, Callable[..., Any]] = {"r_x": read_bytes, "w_x": write_bytes}
    for letter in "bhHiIqQfd":
        compiled = struct.Struct(f">{letter}")
        found[f"r_{letter}"] = compiled.unpack_from
        found[f"w_{letter}"] = compiled.pack_into
    found |= {"r_s": read_string, "w_s": write_string, "r_ws": read_wide, "w_ws": write_wide}
    return found
