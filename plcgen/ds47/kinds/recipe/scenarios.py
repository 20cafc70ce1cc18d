"""Scenarios of a job with a recipe: numbers without a record, values outside their limits, which nobody may send."""

from __future__ import annotations

import math
from collections.abc import Iterator

from plcgen.ds47.plan.access import Use
from plcgen.ds47.plan.nouns import DriveJob
from plcgen.ds47.proof.points import fault
from plcgen.ds47.proof.records import Record, members
from plcgen.ds47.proof.scenario import DriveScenario, KindScenarios
from plcgen.ds47.proof.words import WORDS
from plcgen.ds47.wire.formats import Format, FormatKind, integer_range, pack_values

NOT_SETTABLE = 0x02
"""Error number that comes with a second word."""
NOT_FINITE = {
    4: tuple(bytes.fromhex(text) for text in ("7FC00000", "FFC00000", "7F800001", "7F800000", "FF800000")),
    8: tuple(bytes.fromhex(text) for text in ("7FF8000000000000", "7FF0000000000000", "FFF0000000000000")),
}
"""NaN of several kinds and the two infinities (IEEE 754)."""


def recipes(job: DriveJob, _: int) -> Iterator[DriveScenario]:
    """All of them. What the run before says of an error must not stay."""
    assert job.recipe is not None  # of such jobs only
    count = job.recipe.count
    place = len(job.telegrams[0].parts)
    yield DriveScenario(
        name=f"parameter {place} of telegram 1 is refused with a second word",
        faults=(fault(job, 1, place, NOT_SETTABLE, 2),),
        status=(WORDS["PARAMETER_ERROR"],),
        telegram=1,
        checked=False,
        follow=False,
    )
    for number in (0, -1, count + 1, -32768, 32767):
        yield DriveScenario(
            name=f"record {number}",
            parts=(Record(record=number),),
            status=(WORDS["NO_RECORD"],),
            telegram=1,
            answered=False,
            took=(0, 20),
        )
    name = "execute falls and rises, all records change"
    yield DriveScenario(name=name, happens={2: "drop", 3: "rise"}, meddle=True, busy=(3, 3), follow=False)
    if not job.writes:
        return
    limited = [(use, found) for use in members(job) if (found := list(outside(use)))]
    for use, found in limited:
        for data in found:
            for at in dict.fromkeys((0, use.count // 2, use.count - 1)):
                yield _refused(f"value {at} of {use.label} is {data.hex()}", {(use.position, at): data}, use, at)
        if use.count > 1:
            ends = {(use.position, at): found[0] for at in (0, use.count - 1)}
            yield _refused(f"both ends of {use.label} are outside", ends, use, 0)
    if len(limited) > 1:
        (first, one), (last, other) = limited[0], limited[-1]
        several = {(last.position, 0): other[0], (first.position, first.count - 1): one[0]}
        yield _refused(f"{first.label} and {last.label} are outside", several, first, first.count - 1)


def _refused(name: str, damaged: dict[tuple[int, int], bytes], use: Use, at: int) -> DriveScenario:
    return DriveScenario(
        name=name,
        parts=(Record(damaged=damaged, refused=(use.parameter.pnu, use.subindex + at)),),
        status=(WORDS["OUTSIDE"],),
        telegram=1,
        answered=False,
        took=(0, 20),
    )


def outside(use: Use) -> Iterator[bytes]:
    """Values next to the limits that are not allowed, far from them, and what is no number."""
    fmt, low, high = use.format, use.parameter.minimum, use.parameter.maximum
    if fmt.kind is FormatKind.FLOAT:
        yield from NOT_FINITE[fmt.size]
        yield from (_next(fmt, limit, step) for limit, step in ((low, -1), (high, 1)) if limit is not None)
        return
    range_ = integer_range(fmt)
    if range_ is None:
        return
    least = range_[0] if low is None else max(range_[0], math.ceil(low))
    most = range_[1] if high is None else min(range_[1], math.floor(high))
    tried = (least - 1, most + 1, *range_)
    yield from (
        pack_values(fmt, [value])
        for value in dict.fromkeys(tried)
        if range_[0] <= value <= range_[1] and not least <= value <= most
    )


def _next(fmt: Format, limit: float, step: int) -> bytes:
    """The number of a format behind a limit, which is rounded like every number of the format."""
    found = pack_values(fmt, [limit])
    sign = 1 << (8 * fmt.size - 1)
    bits = int.from_bytes(found)
    if not bits & ~sign:
        return (1 | (sign if step < 0 else 0)).to_bytes(fmt.size)
    return (bits + (step if limit > 0 else -step)).to_bytes(fmt.size)


SCENARIOS = (KindScenarios(70, lambda job: job.recipe is not None, recipes),)
