"""Values of a job -> telegrams: the fewest that ``ppi.pack`` finds, with the place of every value in them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from plcgen.ppi.plan.nouns import Placed, PpiValue
from plcgen.ppi.wire.model import Item, ItemWrite
from plcgen.ppi.wire.pack import pack_read, pack_write


@dataclass(frozen=True, slots=True)
class Packed:
    """One item of a telegram with the values it carries; ``data`` is what is written."""

    item: Item
    values: tuple[Placed, ...]
    data: bytes = b""


def pack(values: Sequence[PpiValue], *, write: bool, merge: bool) -> list[tuple[Packed, ...]]:
    """Telegrams of a job, in order. PpiError if values that are written overlap."""
    if write:
        plan = pack_write([ItemWrite(value.item, value.data) for value in values], merge=merge)
        return [
            tuple(_written(values, entry, numbers) for entry, numbers in zip(telegram, served, strict=True))
            for telegram, served in zip(plan.telegrams, plan.serves, strict=True)
        ]
    return [
        tuple(
            Packed(
                planned.item,
                tuple(Placed(values[p.asked], p.at, p.start, p.length, p.bit) for p in planned.parts),
            )
            for planned in telegram
        )
        for telegram in pack_read([value.item for value in values], merge=merge).telegrams
    ]


def _written(values: Sequence[PpiValue], entry: ItemWrite, numbers: Sequence[int]) -> Packed:
    """An item that is written: which bytes of which values it carries."""
    placed = []
    for number in numbers:
        value = values[number]
        offset = entry.item.byte - value.item.byte
        start, at = max(0, offset), max(0, -offset)
        length = min(value.item.octets - start, entry.item.octets - at)
        placed.append(Placed(value, at, start, length))
    return Packed(entry.item, tuple(placed), entry.data)
