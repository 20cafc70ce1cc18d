"""Scenarios of a sequence that waits: values around each comparison, late, never; who has the unit meanwhile."""

from __future__ import annotations

import math
import struct
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

from plcgen.ds47.kind import Wait
from plcgen.ds47.plan.access import Part
from plcgen.ds47.plan.nouns import DriveJob, DriveTelegram
from plcgen.ds47.proof.block_clock import STANDSTILL_MS
from plcgen.ds47.proof.points import replaced_values, value_at
from plcgen.ds47.proof.scenario import Contents, DriveScenario, Edit, KindScenarios
from plcgen.ds47.proof.step_facts import Steps
from plcgen.ds47.proof.words import WORDS
from plcgen.ds47.sim.faults import Fault, FaultKind
from plcgen.ds47.wire.formats import FormatKind, integer_range, pack_values, unpack_values

STATE_CONFLICT = 0xDE80B500
NOT_ALLOWED = 0x11
LATE = 3
"""So many questions are answered with something else at most before what is waited for is there."""
TELEGRAM_SCANS = 20
"""Scans that a telegram takes at most."""
POINTS = 8
"""Scans of a run with a pause in which execute falls or the CPU restarts."""
MANY = 20_000
"""More answers than a run has."""


def refused() -> Iterator[DriveScenario]:
    """A step fails, and the next start is refused: nothing is left of what has failed before."""
    yield DriveScenario(
        name="the first parameter is refused, and the next start",
        faults=(Fault(FaultKind.ERROR, number=NOT_ALLOWED, position=1, words=1),),
        status=(WORDS["PARAMETER_ERROR"],),
        checked=False,
        follow=False,
    )
    yield DriveScenario(name="a start is refused", slot=0, status=(WORDS["NO_SLOT"],), checked=False)


def steps(job: DriveJob, scans: int) -> Iterator[DriveScenario]:
    """What fails in a step, and how steps wait."""
    yield from refused()
    if job.waits:
        yield from stepping(job, scans)


def stepping(job: DriveJob, scans: int) -> Iterator[DriveScenario]:
    """All of them; ``scans`` is how long a run takes in which everything is there at once."""
    waits = [telegram for telegram in job.telegrams if telegram.awaited is not None]
    for telegram in waits:
        assert telegram.awaited is not None  # chosen so
        for place in _conditions(telegram):
            yield from _near(telegram, place, telegram.parts[place - 1])
        yield from _late(job, telegram, telegram.awaited)
        yield from _trouble(job, telegram, telegram.awaited)
    late = _all_late(waits)
    yield late
    yield replace(late, name="every step waits, after a download", happens={1: "cold"}, meddle=False, guarded=False)
    yield from _last_never(job, waits)
    yield from _in_a_pause(waits[0], scans)


def _near(telegram: DriveTelegram, place: int, part: Part) -> Iterator[DriveScenario]:
    """Every value that a wrong comparison would take for another one: it will do, or it is asked again."""
    number = telegram.number
    if (awaited := part.use.as_(Wait)) and awaited.follows:
        yield from _apart(telegram, place, part)
        return
    for data in _values(part):
        shown = f"{data.hex(' ').upper()} comes at place {place} of telegram {number}"
        scenario = DriveScenario(name=shown, reads={number: replaced_values(telegram, {place: data})}, follow=False)
        yield scenario if _holds(part, data) else scenario.among(Steps(questions={number: 2}))


def _apart(telegram: DriveTelegram, place: int, part: Part) -> Iterator[DriveScenario]:
    """What is wanted follows what was written: every value of the input, and answers with one bit wrong."""
    number = telegram.number
    kinds: tuple[Contents, ...] = ("low", "factory", "high")
    for values in kinds:
        yield DriveScenario(name=f"telegram {number} is answered as told, values {values}", values=values, follow=False)
        for bit in (0, 1, 7, 8 * part.size - 1):
            yield DriveScenario(
                name=f"telegram {number} comes with bit {bit} wrong, values {values}",
                values=values,
                reads={number: _wrong(telegram, (place,), bit)},
                parts=(Steps(questions={number: 2}),),
                follow=False,
            )


def _late(job: DriveJob, telegram: DriveTelegram, awaited: Wait) -> Iterator[DriveScenario]:
    """What is waited for comes later, or never; of several conditions the first that is not true is told."""
    number, each = telegram.number, _conditions(telegram)
    count = max(1, min(LATE, awaited.limit // awaited.interval - 1))
    missing = _missing(telegram, each)
    slack = 10 * TELEGRAM_SCANS * (len(job.telegrams) + count)
    wide = _wide(job, awaited)
    for end, places in ((-1, tuple(each)), (0, tuple(each[-1:]))):
        where = ", ".join(map(str, places))
        yield DriveScenario(
            name=f"telegram {number} is never as wanted at {where}, a question comes {end} ms behind the limit",
            reads=dict.fromkeys(range(number, MANY), _missing(telegram, places)),
            parts=(
                Steps(
                    questions={number: awaited.limit // awaited.interval + 2},
                    missed=telegram.parts[places[0] - 1].use.parameter.pnu,
                ),
            ),
            status=(WORDS["NOT_REACHED"],),
            telegram=number,
            scan=wide,
            took=(awaited.limit, awaited.limit + 2 * awaited.interval + STANDSTILL_MS + slack * wide // 10),
            sharp=end,
            follow=False,
        )
    yield DriveScenario(
        name=f"telegram {number} is answered as wanted the {count + 1}. time",
        reads=dict.fromkeys(range(number, number + count), missing),
        parts=(Steps(questions={number: count + 1}),),
        took=(count * awaited.interval, count * awaited.interval + slack),
    )


def _trouble(job: DriveJob, telegram: DriveTelegram, awaited: Wait) -> Iterator[DriveScenario]:
    """The second question is refused, or never answered."""
    number = telegram.number
    missing = _missing(telegram, _conditions(telegram))
    before = number  # requests in front of the second question
    yield DriveScenario(
        name=f"the drive refuses telegram {number} the second time",
        reads={number: missing},
        parts=(Steps(questions={number: 2}),),
        faults=(Fault(FaultKind.ERROR, after=before, number=NOT_ALLOWED, position=1, words=1),),
        status=(WORDS["PARAMETER_ERROR"],),
        telegram=number,
        errors={(number, 1): (0x8000 | NOT_ALLOWED, 0)},
    )
    yield DriveScenario(
        name=f"telegram {number} is not answered the second time",
        reads={number: missing, **dict.fromkeys(range(number + 1, MANY), STATE_CONFLICT)},
        parts=(Steps(questions={number: 2}),),
        status=tuple(WORDS[name] for name in ("RETRIES", "TIMEOUT", "NO_PLACE")),
        telegram=number,
        answered=False,
        again=None,
        scan=min(50, max(10, job.timeout // (TELEGRAM_SCANS * len(job.telegrams)))),
        follow=False,
    )
    yield DriveScenario(
        name=f"another job is in the slot when the answer to telegram {number} says no",
        reads={number: missing},
        parts=(Steps(robbed=number),),
        status=(WORDS["SLOT_TAKEN"],),
        checked=False,
    )
    reads, twice = {number: missing}, {number: 2}
    yield DriveScenario(
        name=f"the CPU stands still when telegram {number} is answered",
        reads=reads,
        parts=(Steps(still=number, questions=twice),),
    )
    yield DriveScenario(
        name=f"another job has the unit when telegram {number} is due again",
        parts=(Steps(taken=awaited.interval + 200, questions=twice),),
        reads=reads,
    )
    yield DriveScenario(
        name=f"another job has the unit for too long when telegram {number} is due again",
        parts=(Steps(taken=awaited.interval + 10_000, questions=twice),),
        status=(WORDS["OCCUPIED"],),
        telegram=number,
        reads=reads,
    )


def _all_late(waits: list[DriveTelegram]) -> DriveScenario:
    """Every step waits for a while of its own."""
    reads: dict[int, int | Edit] = {}
    questions: dict[int, int] = {}
    for telegram in waits:
        awaited = telegram.awaited
        count = 1 if awaited is None else max(1, min(LATE, awaited.limit // awaited.interval - 1))
        questions[telegram.number] = count + 1
        first = telegram.number + sum(questions[one] - 1 for one in questions if one < telegram.number)
        missing = _missing(telegram, _conditions(telegram))
        reads.update(dict.fromkeys(range(first, first + count), missing))
    return DriveScenario(
        name="every step waits", reads=reads, parts=(Steps(questions=questions),), meddle=True, guarded=True
    )


def _wide(job: DriveJob, awaited: Wait) -> int:
    """Length in ms of the scans of a job that waits as long as it may: it asks less often if they are longer."""
    return max(10, min(awaited.limit // 5_000, job.timeout // 100))


def _last_never(job: DriveJob, waits: list[DriveTelegram]) -> Iterator[DriveScenario]:
    """Every step waits for a while, the last in vain: its time begins with its own first question."""
    last, awaited = waits[-1], waits[-1].awaited
    if len(waits) == 1 or awaited is None:
        return
    late = _all_late(waits)
    first = last.number + sum(count - 1 for number, count in late.of(Steps).questions.items() if number < last.number)
    missing = _missing(last, _conditions(last))
    wide = _wide(job, awaited)
    slack = wide * TELEGRAM_SCANS * (len(job.telegrams) + sum(late.of(Steps).questions.values()))
    waited = sum((late.of(Steps).questions[one.number] - 1) * one.awaited.interval for one in waits[:-1] if one.awaited)
    yield DriveScenario(
        name="every step waits, the last one in vain",
        reads={**late.reads, **dict.fromkeys(range(first, MANY), missing)},
        parts=(
            Steps(
                questions={**late.of(Steps).questions, last.number: awaited.limit // awaited.interval + 2},
                missed=last.parts[0].use.parameter.pnu,
            ),
        ),
        status=(WORDS["NOT_REACHED"],),
        telegram=last.number,
        scan=wide,
        sharp=0,
        took=(waited + awaited.limit, waited + awaited.limit + 2 * awaited.interval + STANDSTILL_MS + slack),
        follow=False,
    )


def _in_a_pause(telegram: DriveTelegram, scans: int) -> Iterator[DriveScenario]:
    """Execute falls, rises again, or the CPU restarts while it is waited."""
    number, awaited = telegram.number, telegram.awaited
    assert awaited is not None  # chosen so
    missing = _missing(telegram, _conditions(telegram))
    last = scans + awaited.interval // 10
    late: dict[str, Any] = {"reads": {number: missing}, "parts": (Steps(questions={number: 2}),)}
    for at in range(2, last, max(1, last // POINTS)):
        yield DriveScenario(
            name=f"execute falls before scan {at}, telegram {number} late", happens={at: "drop"}, **late
        )
        happens = {at: "drop", at + 1: "rise"}
        yield DriveScenario(
            name=f"execute falls before scan {at} and rises, telegram {number} late", happens=happens, **late
        )
        for kind in ("cold", "warm"):
            words = ("DONE", "UNKNOWN", "RETRIES") if kind == "warm" else ("DONE",)
            yield DriveScenario(
                name=f"{kind} restart before scan {at}, telegram {number} late",
                happens={at: kind},
                status=tuple(WORDS[word] for word in words),
                checked=False,
                again=None,
                **late,
            )


def _conditions(telegram: DriveTelegram) -> range:
    """Places of what is waited for; what is read with it comes after that."""
    return range(1, 1 + sum(part.use.as_(Wait) is not None for part in telegram.parts))


def _missing(telegram: DriveTelegram, places: range | tuple[int, ...]) -> Edit:
    """An answer in which the conditions at these places are not true."""
    found = {}
    for place in places:
        part = telegram.parts[place - 1]
        found[place] = next(data for data in _values(part) if not _holds(part, data))
    follows = telegram.awaited is not None and telegram.awaited.follows
    changed = _wrong(telegram, tuple(places), 0) if follows else replaced_values(telegram, found)
    # behind a restart it may be the answer to another telegram
    return lambda answer: changed(answer) if _shape(answer) == _shape_of(telegram) else answer


def _wrong(telegram: DriveTelegram, places: tuple[int, ...], bit: int) -> Edit:
    """A good answer with one bit of the values at these places turned round."""

    def edit(answer: bytes) -> bytes:
        for place in places:
            at, size = value_at(telegram, place), telegram.parts[place - 1].size
            data = int.from_bytes(answer[at : at + size]) ^ 1 << bit
            answer = answer[:at] + data.to_bytes(size) + answer[at + size :]
        return answer

    return edit


def _shape(answer: bytes) -> tuple[int, ...]:
    """Length of an answer to a read, number of parameters, number of values of the first."""
    return (len(answer), *answer[3:4], *answer[5:6]) if answer[1:2] == b"\x01" else ()


def _shape_of(telegram: DriveTelegram) -> tuple[int, ...]:
    """That of a good answer."""
    return telegram.positive_length, len(telegram.parts), telegram.parts[0].count


def _holds(part: Part, data: bytes) -> bool:
    """Whether a value is what is waited for."""
    use, awaited = part.use, part.use.as_(Wait)
    assert awaited is not None  # parts that wait
    if awaited.bit is not None:
        same = int.from_bytes(data) >> awaited.bit & 1 == int.from_bytes(use.data) >> awaited.bit & 1
        return same == (awaited.operator == "=")
    value, wanted = (unpack_values(use.format, 1, one)[0] for one in (data, use.data))
    if awaited.operator in {"=", "<>"}:
        return (value == wanted) == (awaited.operator == "=")
    assert isinstance(value, int | float)  # others have no order
    assert isinstance(wanted, int | float)
    return {"<": value < wanted, "<=": value <= wanted, ">": value > wanted, ">=": value >= wanted}[awaited.operator]


def _values(part: Part) -> list[bytes]:
    """Values on both sides of the one that is compared with."""
    use, awaited = part.use, part.use.as_(Wait)
    fmt = use.format
    if fmt.kind is FormatKind.BOOLEAN:
        return [b"\x00", b"\x01"]
    if fmt.kind is FormatKind.FLOAT:
        return _floats(part)
    if awaited is not None and awaited.bit is not None:
        mask = 1 << awaited.bit
        every = (1 << 8 * fmt.size) - 1
        return [one.to_bytes(fmt.size) for one in (mask, every ^ mask, every, 0)]
    range_ = integer_range(fmt)
    if range_ is None:
        changed = [bytes(b ^ (n == at) for n, b in enumerate(use.data)) for at in range(fmt.size)]
        return [use.data, *changed]
    wanted = unpack_values(fmt, 1, use.data)[0]
    assert isinstance(wanted, int)  # it has a range
    steps = [step << 8 * at for at in range(fmt.size) for step in (1, -1)]
    near = (wanted, *(wanted + step for step in steps), *range_, 0, -1)
    fit = [value for value in dict.fromkeys(near) if range_[0] <= value <= range_[1]]
    return [pack_values(fmt, [value]) for value in fit]


def _floats(part: Part) -> list[bytes]:
    """The number itself, its neighbours, the other sign, what is no number."""
    fmt = part.use.format
    wanted = unpack_values(fmt, 1, part.use.data)[0]
    assert isinstance(wanted, float)  # its format says so
    bits = int.from_bytes(part.use.data)
    near = [one.to_bytes(fmt.size) for one in (bits, bits + 1, max(bits, 1) - 1)]
    others = (-wanted, 0.0, math.inf, -math.inf, math.nan)
    form = ">f" if fmt.size == 4 else ">d"
    return list(dict.fromkeys((*near, *(struct.pack(form, value) for value in others))))


SCENARIOS = (KindScenarios(50, lambda job: job.in_steps, steps),)
