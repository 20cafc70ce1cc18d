"""What a drive makes of values: another one, a neighbour, anything."""

from __future__ import annotations

from plcgen.ds47.plan.access import Part, Use
from plcgen.ds47.sim.parameters import Keeps
from plcgen.ds47.wire.formats import FormatKind, Value, pack_values, unpack_values

INFINITE = {4: bytes.fromhex("7F800000"), 8: bytes.fromhex("7FF0000000000000")}
"""What comes behind the largest number of each size (IEEE 754)."""


def only(indexes: set[int], keeps: Keeps) -> Keeps:
    """Values of some indexes alone."""
    return lambda index, value: keeps(index, value) if index in indexes else value


def other(part: Part, at: int, octet: int) -> Keeps:
    """One octet of one value is another one; at the end of a number in floating point two units of the last place."""
    use = part.use
    fmt = use.format
    bit = 0x02 if octet and fmt.kind is FormatKind.FLOAT else 0x01

    def keeps(index: int, value: Value) -> Value:
        if not fmt.is_string and index != part.subindex + at:
            return value
        data = bytearray(pack_values(fmt, [value]))
        data[at if fmt.is_string else octet] ^= bit
        return unpack_values(fmt, len(data) if fmt.is_string else 1, bytes(data))[0]

    return keeps


def anything(use: Use) -> Keeps:
    """Every value of a parameter is another one."""
    fmt = use.format

    def keeps(_: int, value: Value) -> Value:
        data = bytearray(pack_values(fmt, [value]))
        data[0] ^= 0x01
        return unpack_values(fmt, len(data) if fmt.is_string else 1, bytes(data))[0]

    return keeps


def moved(use: Use, step: int) -> Keeps:
    """The number that is so many steps away from zero or nearer to it; of a zero and one step the other zero.

    What has no such number stays as it is.
    """
    fmt = use.format
    magnitude = (1 << (8 * fmt.size - 1)) - 1
    infinite = int.from_bytes(INFINITE[fmt.size])

    def keeps(_: int, value: Value) -> Value:
        bits = int.from_bytes(pack_values(fmt, [value]))
        if bits & magnitude:
            bits += step if (bits + step) & magnitude < infinite else 0
        else:
            bits ^= magnitude + 1 if abs(step) == 1 else abs(step)
        return unpack_values(fmt, 1, bits.to_bytes(fmt.size))[0]

    return keeps
