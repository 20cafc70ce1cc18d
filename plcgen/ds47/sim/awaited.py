"""What somebody waits for: it is there when it asks, and changes nothing for those who ask next to it."""

from __future__ import annotations

import operator

from plcgen.ds47.kind import Wait
from plcgen.ds47.plan.access import Use
from plcgen.ds47.plan.nouns import DriveJob
from plcgen.ds47.sim.parameters import DriveObject
from plcgen.ds47.wire.formats import Value, integer_range, pack_values, unpack_values

_COMPARES = {
    "=": operator.eq, "<>": operator.ne, "<": operator.lt, "<=": operator.le, ">": operator.gt, ">=": operator.ge,
}  # fmt: skip


def let_come(item: DriveObject, job: DriveJob, step: int) -> None:
    """A step of a job asks: from now on the drive object has what it waits for; a value that will do stays."""
    for use in job.uses:
        if use.step == step and use.as_(Wait):
            values = item.parameters[use.parameter.pnu].values
            values[use.subindex] = _come(use, values[use.subindex], item, job.uses[0].parameter.pnu)


def _come(use: Use, value: Value, item: DriveObject, first: int) -> Value:
    """A value as it is if it will do, else the one that is compared with or its neighbour.

    ``first`` is the parameter that the job writes first.
    """
    awaited, fmt = use.as_(Wait), use.format
    wanted = unpack_values(fmt, 1, use.data)[0]
    if awaited is None:
        return value
    if awaited.follows:  # told 1, it is active, told 0 or 2 it is not; where no list limits it, bit 0 counts
        told = item.parameters[first].values[0]
        return told & 1 if isinstance(told, int) else 0
    if awaited.bit is not None:
        mask = 1 << awaited.bit
        own = int.from_bytes(pack_values(fmt, [value])) & ~mask
        on = any(use.data) == (awaited.operator == "=")
        return unpack_values(fmt, 1, (own | mask * on).to_bytes(fmt.size))[0]
    if _COMPARES[awaited.operator](value, wanted):
        return value
    if "=" in awaited.operator:
        return wanted
    if isinstance(wanted, bytes | bool):
        return unpack_values(fmt, 1, bytes(byte ^ 1 for byte in use.data))[0]
    assert isinstance(wanted, int | float)  # texts are not waited for
    if isinstance(wanted, float):
        step: float = max(1.0, abs(wanted) / 1000)
    else:
        step = 1
    range_ = integer_range(fmt)
    down = awaited.operator == "<" or (awaited.operator == "<>" and range_ is not None and wanted == range_[1])
    return wanted - step if down else wanted + step
