"""Values of a recorded run as an engineer writes them."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from plcgen.report.trace.model import Value

SHOWN = 6
"""Elements of a list that a sentence names."""


def value_text(value: Value | bytes, *, bits: int = 0) -> str:
    """A value as an engineer writes it; ``bits`` makes a number hexadecimal; long arrays are cut."""
    from plcgen.s7.types.literals import format_real

    if isinstance(value, bool):
        return "TRUE" if value else "FALSE"
    if isinstance(value, float):
        return format_real(value) if value - value == 0 else str(value)
    if isinstance(value, int):
        return f"16#{value:0{bits // 4}X}" if bits else str(value)
    if isinstance(value, bytes):
        return value.hex(" ").upper()
    if isinstance(value, list):
        shown = ", ".join(value_text(item, bits=bits) for item in value[:SHOWN])
        return f"[{shown}, .. {len(value)} values]" if len(value) > SHOWN else f"[{shown}]"
    if isinstance(value, dict):
        return "(" + ", ".join(f"{name} := {value_text(item)}" for name, item in value.items()) + ")"
    return f"'{value}'"
