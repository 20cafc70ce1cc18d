"""Scenarios of a job that reads back: a drive that rounds, that clips without a word, that somebody else writes to."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import product

from plcgen.ds47.plan.access import Part, Running, Use, Verify
from plcgen.ds47.plan.nouns import DriveJob, DriveTelegram
from plcgen.ds47.proof.deviating import deviates, index_of
from plcgen.ds47.proof.keeping import anything, moved, only, other
from plcgen.ds47.proof.points import fault, positions
from plcgen.ds47.proof.rig import VALUE_SETS
from plcgen.ds47.proof.scenario import Contents, DriveScenario, KindScenarios
from plcgen.ds47.proof.words import DEVIATES, WORDS
from plcgen.ds47.sim.parameters import Keeps
from plcgen.ds47.wire.formats import FormatKind

NOT_ALLOWED = 0x11
"""Error number of a drive that does not take a request in its state."""


def verifying(job: DriveJob, _: int) -> Iterator[DriveScenario]:
    """All of them."""
    telegrams = [telegram for telegram in job.telegrams if telegram.parts[0].use.as_(Verify)]
    for telegram in telegrams:
        for place, part in _compared(telegram):
            yield from _each(job, telegram, place, part)
        yield from _near_zero(job, telegram)
    for telegram in dict.fromkeys((telegrams[0], telegrams[-1])):
        for place in positions(telegram):
            if not telegram.parts[place - 1].use.as_(Running):
                yield from _one_octet(telegram, place)
        if len(_compared(telegram)) > 1:
            yield from _several(job, telegram)
    yield from _rounded([part.use for telegram in telegrams for part in telegram.parts], telegrams[0])


def _each(job: DriveJob, telegram: DriveTelegram, place: int, part: Part) -> Iterator[DriveScenario]:
    """The first and last value of every parameter, and of every piece that was sent apart."""
    starts = _pieces(job, part)
    ends = {start - 1 for start in starts if start} | {part.count - 1}
    for at in sorted({*starts, *ends}):
        name = f"the drive keeps another value {at} of parameter {place} of telegram {telegram.number}"
        keeps = {part.use.parameter.pnu: other(part, at, 0)}
        yield replace(deviates(name, telegram, {place: at}, keeps=keeps), follow=False)


def _compared(telegram: DriveTelegram) -> list[tuple[int, Part]]:
    """The parts that are read back, with their places: the state of the drive is not."""
    return [(place, part) for place, part in enumerate(telegram.parts, 1) if part.use.as_(Verify)]


def _pieces(job: DriveJob, part: Part) -> list[int]:
    """Where in a part that is read begins what one telegram has written."""
    back = part.use.as_(Verify)
    written = [one for sent in job.telegrams for one in sent.parts if back is not None and one.use is back.of]
    return sorted({max(one.start - part.start, 0) for one in written if one.start < part.start + part.count})


def _near_zero(job: DriveJob, telegram: DriveTelegram) -> Iterator[DriveScenario]:
    """In every piece a number in floating point, zero in one of the sets, is two units of the last place away."""
    floats = [(n, part) for n, part in enumerate(telegram.parts, 1) if part.use.format.kind is FormatKind.FLOAT]
    pieces = [(place, part, _pieces(job, part)) for place, part in floats]
    for number in range(max((len(starts) for _, _, starts in pieces), default=0)):
        found = [(place, part, starts[number]) for place, part, starts in pieces if number < len(starts)]
        keeps: dict[int, Keeps] = {}
        for pnu in {part.use.parameter.pnu for _, part, _ in found}:
            own = [(part, at) for _, part, at in found if part.use.parameter.pnu == pnu]
            keeps[pnu] = only({index_of(part, at) for part, at in own}, moved(own[0][0].use, 2))
        places = {place: at for place, _, at in found}
        for turn in range(1, VALUE_SETS + 1):
            name = f"piece {number + 1} of telegram {telegram.number} is near to what was sent, set {turn}"
            yield replace(deviates(name, telegram, places, keeps=keeps, values="odd"), follow=False)
        if number == 0:
            far: dict[int, Keeps] = {}
            for pnu in keeps:
                own = [(part, at) for _, part, at in found if part.use.parameter.pnu == pnu]
                far[pnu] = only({index_of(part, at) for part, at in own}, anything(own[0][0].use))
            odd: list[Contents] = ["odd"] * VALUE_SETS
            for values in ("factory", *odd):
                name = f"numbers of telegram {telegram.number} are far from what was sent, values {values}"
                yield replace(deviates(name, telegram, places, keeps=far, values=values), follow=False)


def _one_octet(telegram: DriveTelegram, place: int) -> Iterator[DriveScenario]:
    """The first or last octet of the first or last value of a parameter is another one."""
    part = telegram.parts[place - 1]
    for at in dict.fromkeys((0, part.count - 1)):
        for octet in dict.fromkeys((0, part.use.format.size - 1)):
            keeps = {part.use.parameter.pnu: other(part, at, octet)}
            where = f"octet {octet} of value {at} of parameter {place} of telegram {telegram.number}"
            yield deviates(f"the drive keeps another {where}", telegram, {place: at}, keeps=keeps)
    keeps = {part.use.parameter.pnu: other(part, 0, 0)}
    name = f"somebody else changes parameter {place} of telegram {telegram.number}"
    yield deviates(name, telegram, {place: 0}, meanwhile=keeps)
    name = f"parameter {place} of telegram {telegram.number} is another one, in a format 41h to 43h"
    yield deviates(name, telegram, {place: 0}, keeps=keeps, generic=True)


def _several(job: DriveJob, telegram: DriveTelegram) -> Iterator[DriveScenario]:
    """Every parameter is another one; the first cannot be read, the last is another one."""
    number, (last, part) = telegram.number, _compared(telegram)[-1]
    found = {part.use.parameter.pnu: anything(part.use) for _, part in _compared(telegram)}
    places = dict.fromkeys(range(1, last + 1), 0)
    yield deviates(f"the drive keeps other values of telegram {number}", telegram, places, keeps=found)
    if part.use.parameter.pnu == telegram.parts[0].use.parameter.pnu:
        return
    yield DriveScenario(
        name=f"the first parameter of telegram {number} cannot be read, the last one is another one",
        faults=(fault(job, number, 1, NOT_ALLOWED, 1),),
        keeps={part.use.parameter.pnu: other(part, 0, 0)},
        status=(WORDS["PARAMETER_ERROR"],),
        telegram=number,
        errors={(number, 1): (0x8000 | NOT_ALLOWED, 0), (number, last): (DEVIATES, index_of(part, 0))},
    )


def _rounded(uses: list[Use], telegram: DriveTelegram) -> Iterator[DriveScenario]:
    """One unit in the last place, up or down, is what rounding may do; two are not. Both zeros are one number."""
    floats = [use for use in uses if use.format.kind is FormatKind.FLOAT]
    if not floats:
        return
    odd: list[Contents] = ["odd"] * VALUE_SETS
    for values in ("factory", "next", "low", "high", *odd):
        for step in (1, -1):
            keeps = {use.parameter.pnu: moved(use, step) for use in floats}
            name = f"the drive rounds by {step} unit in the last place, values {values}"
            yield DriveScenario(name=name, keeps=keeps, values=values, follow=False)
    places = [n for n, part in enumerate(telegram.parts, 1) if part.use.format.kind is FormatKind.FLOAT]
    for values, step in product(("factory", *odd), (2, -2) if places else ()):
        keeps = {use.parameter.pnu: moved(use, step) for use in floats}
        name = f"the drive rounds by {step} units in the last place, values {values}"
        yield deviates(name, telegram, dict.fromkeys(places, 0), keeps=keeps, values=values)


SCENARIOS = (KindScenarios(10, lambda job: job.verified, verifying),)
