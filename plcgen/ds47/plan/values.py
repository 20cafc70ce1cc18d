"""Constants and start values of a use as a person reads them."""

from __future__ import annotations

from plcgen.ds47.plan.access import Use
from plcgen.ds47.plan.fields import interface_type
from plcgen.ds47.wire.bico import read_bico
from plcgen.ds47.wire.formats import unpack_values
from plcgen.project.target import Target
from plcgen.s7.types.data_types import ArrayType, Elementary
from plcgen.s7.types.values import unpack_value

_SHOWN = 4


def literals_text(use: Use, where: Target) -> str:
    """The literals of its values, the first four of many; octets as hexadecimal digits."""
    from plcgen.s7.types.literals import format_literal

    if use.bits:
        return "; ".join(f"bit {one.bit} = {_bit_text(one)}" for one in use.bits)
    type_ = interface_type(use.format, use.count, use.subindex, where)
    element = type_.element if isinstance(type_, ArrayType) else type_
    if not isinstance(element, Elementary):
        return use.data.hex(" ")
    step = max(1, element.bits // 8)
    pieces = [use.data[i : i + step] for i in range(0, len(use.data), step)]
    texts = (format_literal(unpack_value(piece, element), element.name, where.v5) for piece in pieces[:_SHOWN])
    if use.sources:
        texts = (str(read_bico(int.from_bytes(piece))) for piece in pieces[:_SHOWN])
    return ", ".join(texts) + (", .." if len(pieces) > _SHOWN else "")


def amount_text(use: Use, where: Target) -> str:
    """The same with the unit; of a fixed point value the amount, and what the drive counts: ``3.5 s (350)``."""
    parameter, literals = use.parameter, literals_text(use, where)
    if not parameter.scale or use.bits:
        return f"{literals} {parameter.unit}".strip()
    values = unpack_values(use.format, use.count, use.data)[:_SHOWN]
    amounts = ", ".join(f"{value * parameter.scale:g}" for value in values if isinstance(value, int))
    unit = parameter.unit.removeprefix(f"{parameter.scale:g}").strip()
    return f"{amounts} {unit} ({literals})".replace("  ", " ")


def _bit_text(one: Use) -> str:
    value = str(int(any(one.data)))
    return value if one.constant else f"input {one.member}, {value} if nothing is connected"
