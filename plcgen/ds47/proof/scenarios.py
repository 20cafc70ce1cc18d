"""Scenarios of a job block: what is its own, of its telegrams, values and signals. The rest is the engine's."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import chain

from plcgen.base.diagnostics.counting import shortlist
from plcgen.ds47.plan.access import Part
from plcgen.ds47.plan.nouns import DriveJob, DriveTelegram
from plcgen.ds47.proof.points import FEW, ends, fault, positions, replaced_values, soon_out_of_retries, value_at
from plcgen.ds47.proof.rig import VALUE_SETS
from plcgen.ds47.proof.scenario import DriveScenario, Edit
from plcgen.ds47.proof.step_facts import triggers
from plcgen.ds47.proof.words import WORDS
from plcgen.ds47.registry import brought
from plcgen.ds47.wire import formats
from plcgen.ds47.wire.formats import Format, padded

STATE_CONFLICT = 0xDE80B500
FATAL_WRITE, FATAL_READ = 0xDF80B000, 0xDE80B000
CALLS_MS = 250
"""Time that a try takes at most besides its pause."""
TRY_SCANS = 5
MOST_CALLS = 10_000
"""So many calls at most are in a timeout: a long one has long scans, with which a try takes longer too."""
NAN = {4: bytes.fromhex("7FC00000"), 8: bytes.fromhex("7FF8000000000000")}
"""A quiet NaN of each size (IEEE 754)."""
WRONG_SLOTS = (0, -1, 3, 4, 16, 17, 32767)
"""Slots that the proof's unit does not have; 3 is the last it has."""


def polls(job: DriveJob) -> int:
    """State conflicts in a row that a job bears without sending its request again: two if there is time."""
    each = job.retry_pause + CALLS_MS // 2
    return next((n for n in (2, 1) if n <= job.retries and (n + 1) * each * 3 < job.timeout), 0)


def patient(job: DriveJob) -> bool:
    """Whether the times of a job allow three retries, one of them with a new request."""
    return not job.once and job.retries >= 3 and (job.retry_pause + CALLS_MS // 2) * 4 * 3 < job.timeout


def fault_matrix(job: DriveJob, scans: int, longest: int) -> Iterator[DriveScenario]:
    """All of it; ``scans`` is how long a good run takes, ``longest`` how many bytes a record may have."""
    own = sorted((one for one in brought("scenarios", "SCENARIOS") if one.has(job)), key=lambda one: one.precedence)
    found = chain(_matrix(job, scans, longest), *(one.make(job, scans) for one in own if one.around is None))
    for one in (one for one in own if one.around is not None):
        found = chain(one.around(job, found), one.make(job, scans))
    yield from found


def _matrix(job: DriveJob, scans: int, longest: int) -> Iterator[DriveScenario]:
    """What is tried with every job."""
    yield from _values()
    yield from _refusals(job)
    if not job.writes and not job.whole and not job.waits:
        yield from _not_numbers(job)
    yield from _blocks(job, longest)
    yield from _record_calls(job)
    yield from _signals(job, scans)


def _values() -> Iterator[DriveScenario]:
    yield DriveScenario(name="values at the lower limits", values="low")
    yield DriveScenario(name="values at the upper limits", values="high")
    for turn in range(1, VALUE_SETS + 1):
        yield DriveScenario(name=f"-1, -0.0, 2**15, 2**31, set {turn}", values="odd", follow=False)
    for generic in (False, True):
        name = "values in formats 41h to 43h where one fits" if generic else "values in their own formats"
        yield DriveScenario(name=name, generic=generic)


def _not_numbers(job: DriveJob) -> Iterator[DriveScenario]:
    """A drive may answer NaN; that is passed on like any value."""
    found: dict[tuple[int, int], bytes] = {}
    edits: dict[int, int | Edit] = {}
    for telegram in job.telegrams:
        places = [
            place for place, part in enumerate(telegram.parts, 1) if part.use.format.kind is formats.FormatKind.FLOAT
        ]
        for place in places:
            part = telegram.parts[place - 1]
            found[telegram.number, place] = NAN[part.use.format.size] * part.count
        edits[telegram.number] = replaced_values(telegram, {place: found[telegram.number, place] for place in places})
    if found:
        yield DriveScenario(name="NaN comes", reads=edits, delivers=found, generic=False, follow=False)


def _refusals(job: DriveJob) -> Iterator[DriveScenario]:
    """The drive refuses parameters: one, all, the whole telegram."""
    for telegram in job.telegrams[1:-1]:
        yield from _every_second_refused(job, telegram, 2)
    for telegram in ends(job):
        yield _miscounted(telegram)
        if patient(job):
            yield _old_refusal(telegram)
        number, count = telegram.number, len(telegram.parts)
        for words in (1, 2):
            for place in positions(telegram):
                error = 0x11 if words == 1 else 0x02
                yield DriveScenario(
                    name=f"error {error:02X}h with {words} words at parameter {place} of telegram {number}",
                    faults=(fault(job, number, place, error, words),),
                    status=(WORDS["PARAMETER_ERROR"],),
                    telegram=number,
                    errors={(number, place): _reported(error, words, place)},
                )
            every = range(1, count + 1)
            yield _refused(job, telegram, words, every)
            if words == 1 and count > FEW:
                yield from _every_second_refused(job, telegram, words)
            yield DriveScenario(
                name=f"telegram {number} is refused with {words} words",
                faults=(fault(job, number, 0, 0x19, words),),
                status=(WORDS["REFUSED" if count > 1 else "PARAMETER_ERROR"],),
                telegram=number,
                errors={(number, place): _reported(0x19, words, 0) for place in every},
            )


def _old_refusal(telegram: DriveTelegram) -> DriveScenario:
    """The refusal of an earlier request, then none: a new request, whose answer is waited for as long as ever."""
    good = b"\x40\x00" * (len(telegram.parts) - 1)

    def edit(answer: bytes) -> bytes:
        old = bytes(((answer[0] - 2) % 255 + 1, 0x80 | answer[1], *answer[2:4]))
        return old + bytes.fromhex("440200110007") + good

    return DriveScenario(
        name=f"an old refusal before the answer to telegram {telegram.number}",
        reads={telegram.number: edit, telegram.number + 2: STATE_CONFLICT},
        again=1,
        follow=False,
    )


def _miscounted(telegram: DriveTelegram) -> DriveScenario:
    """A negative answer that is right but for the number of its parameters: nothing of it can be trusted."""
    good = b"\x40\x00" * (len(telegram.parts) - 1)

    def edit(answer: bytes) -> bytes:
        header = bytes((answer[0], 0x80 | answer[1], answer[2], answer[3] % 0xFF + 1))
        return header + bytes.fromhex("440200110007") + good

    return DriveScenario(
        name=f"telegram {telegram.number} is refused with another number of parameters",
        reads={telegram.number: edit},
        status=(WORDS["PARAMETER_COUNT"],),
        telegram=telegram.number,
        answered=False,
        follow=False,
    )


def _every_second_refused(job: DriveJob, telegram: DriveTelegram, words: int) -> Iterator[DriveScenario]:
    """The first, the third and so on, then all others: nobody has the answer of a neighbour."""
    count = len(telegram.parts)
    for first in range(1, min(count, 2) + 1):
        yield _refused(job, telegram, words, range(first, count + 1, 2))


def _refused(job: DriveJob, telegram: DriveTelegram, words: int, places: range) -> DriveScenario:
    """The parameters at some places are refused."""
    number, named = telegram.number, shortlist([*map(str, places)], 3, " ..")
    return DriveScenario(
        name=f"errors with {words} words at parameters {named} of telegram {number}",
        faults=tuple(fault(job, number, place, place % 100, words) for place in places),
        status=(WORDS["PARAMETER_ERROR"],),
        telegram=number,
        errors={(number, place): _reported(place % 100, words, place) for place in places},
    )


def _reported(error: int, words: int, place: int) -> tuple[int, int]:
    return 0x8000 | error, 0x100 + place if words == 2 else 0


def _blocks(job: DriveJob, longest: int) -> Iterator[DriveScenario]:
    """Values of another type or number come, in an answer that is right otherwise: the others are delivered."""
    for telegram in ends(job):
        if telegram.writes:
            continue
        number = telegram.number
        for place in positions(telegram):
            part = telegram.parts[place - 1]
            for code, count in _wrong_blocks(part):
                size = count * formats.by_code(code).size
                if telegram.positive_length - padded(part.size) + padded(size) > longest:
                    continue
                yield DriveScenario(
                    name=f"{count} values of type {code:02X}h come for parameter {place} of telegram {number}",
                    reads={number: _exchanged(telegram, place, code, count, size)},
                    generic=False,
                    status=(WORDS["RESPONSE_FORMAT"],),
                    telegram=number,
                    errors={(number, place): (0x8100 | code, count)},
                )
            for code in _generic(part.use.format):
                edit = _exchanged(telegram, place, code, part.count, None)
                name = f"parameter {place} of telegram {number} comes as {code:02X}h"
                yield DriveScenario(name=name, reads={number: edit}, generic=False)


def _wrong_blocks(part: Part) -> list[tuple[int, int]]:
    """Types and numbers of values that were not asked for: of the same and of another size, one more, one less."""
    own: Format = part.use.format
    if part.use.untyped:  # any type is right, but for several values or none
        return [(formats.FLOATING_POINT, 2), (formats.WORD, 2), (formats.ZERO, 0)]
    accepted = {*formats.answers(own), *_generic(own)}
    same = [f.code for f in formats.FORMATS if f.writable and f.size == own.size and f.code not in accepted]
    other = [f.code for f in formats.FORMATS if f.writable and f.size != own.size]
    found = [
        (code, part.count) for code in (*same[:1], *same[-1:], *other[:1], 0x41, 0x42, 0x43) if code not in accepted
    ]
    found += [(own.code, count) for count in (part.count - 1, part.count + 1) if 0 < count <= 0xFF]
    return list(dict.fromkeys((*found, (formats.ZERO, 0))))


def _generic(own: Format) -> list[int]:
    """41h, 42h or 43h, which tells no more than the size."""
    found = formats.generic_of(own.size)
    return [found.code] if found is not None else []


def _exchanged(telegram: DriveTelegram, place: int, code: int, count: int, size: int | None) -> Edit:
    """Another block at a place of a good answer; ``size`` None keeps the values."""
    at = value_at(telegram, place) - 2
    old = padded(telegram.parts[place - 1].size)

    def edit(answer: bytes) -> bytes:
        values = answer[at + 2 : at + 2 + old] if size is None else (b"\x5a" * size).ljust(padded(size), b"\0")
        return answer[:at] + bytes((code, count)) + values + answer[at + 2 + old :]

    return edit


def _record_calls(job: DriveJob) -> Iterator[DriveScenario]:
    """What ends a telegram without an answer, or late."""
    for telegram in ends(job):
        number = telegram.number
        nothing = {"telegram": number, "answered": False, "again": None}
        yield DriveScenario(
            name=f"WRREC of telegram {number} fails",
            writes={number: FATAL_WRITE}, status=(WORDS["WRITE_ERROR"],), **nothing,  # type: ignore[arg-type]
        )  # fmt: skip
        yield DriveScenario(
            name=f"RDREC of telegram {number} fails",
            reads={number: FATAL_READ}, status=(WORDS["READ_ERROR"],), **nothing,  # type: ignore[arg-type]
        )  # fmt: skip
    scan = max(10, min(50, job.timeout // 40), job.timeout // MOST_CALLS)
    calls = max(CALLS_MS, TRY_SCANS * scan)
    yield DriveScenario(
        name="the drive never has an answer",
        reads={0: STATE_CONFLICT},
        status=_silence(job, calls),
        telegram=1,
        answered=False,
        again=None,
        scan=scan,
        took=(0, job.timeout + 2 * calls),
    )


def _silence(job: DriveJob, calls: int) -> tuple[int, ...]:
    """How a job may end whose drive never has an answer: what its times allow; where calls decide, either.

    ``calls`` is the time in ms that a try takes at most besides its pause.
    """
    short, long = job.retries * job.retry_pause, job.retries * (job.retry_pause + calls)
    once = any(triggers(part.use) for part in job.telegrams[0].parts) if job.in_steps else job.once
    if once and not job.verified:
        found = ["RETRIES"] if short <= job.timeout / 3 + job.retry_pause else []
        found += ["UNKNOWN"] if long + calls >= job.timeout / 3 else []
        found += ["TIMEOUT", "NO_PLACE"] if (job.retry_pause + calls) * 2 >= job.timeout / 3 else []
    else:
        found = ["RETRIES"] if short <= job.timeout else []
        found += ["TIMEOUT", "NO_PLACE"] if long + calls >= job.timeout else []
    return tuple(WORDS[name] for name in found)


def _forgotten(job: DriveJob) -> tuple[int, ...]:
    """How a job may end whose drive has forgotten a request: done, if retries and the rest of its timeout last."""
    found = ["DONE", "UNKNOWN"] if job.once else ["DONE"]
    found += ["RETRIES"] if soon_out_of_retries(job) else []
    rest = (job.retry_pause + CALLS_MS) * 2 + CALLS_MS * len(job.telegrams)
    return tuple(WORDS[name] for name in (*found, *(["TIMEOUT"] if rest >= job.timeout / 3 else [])))


def _signals(job: DriveJob, scans: int) -> Iterator[DriveScenario]:
    """Execute, inputs, the slot, restarts."""
    yield DriveScenario(name="all inputs change after the edge", meddle=True, busy=(3, 3))
    yield DriveScenario(name="an address with bit 15", output=True, follow=False)
    yield DriveScenario(name="the job is called twice as often as its channel", twice=True, follow=False)
    for at in (2, scans):
        name = f"execute falls before scan {at} and rises in the call after the end"
        yield DriveScenario(name=name, happens={at: "drop"}, at_once=True, follow=False)
    points = range(2, scans + 1)
    if len(points) > 2 * FEW:
        step = len(points) // (2 * FEW) + 1
        points = range(2, scans + 1, step)
    for at in points:
        yield DriveScenario(name=f"execute falls before scan {at}", happens={at: "drop"}, follow=False)
    for at in points[:-1]:
        happens = {at: "drop", at + 1: "rise"}
        yield DriveScenario(name=f"execute falls before scan {at} and rises", happens=happens, follow=False)
    yield DriveScenario(name="another job has the unit for a while", occupied=200, follow=False)
    yield DriveScenario(
        name="another job has the unit for too long",
        occupied=10_000,
        status=(WORDS["OCCUPIED"],),
        telegram=1,
        answered=False,
        took=(490, 520),
    )
    for slot in WRONG_SLOTS:
        last = slot == 3
        yield DriveScenario(
            name=f"slot {slot}",
            slot=slot,
            status=(WORDS["DONE" if last else "NO_SLOT"],),
            checked=last,
        )
    every = max(1, scans // FEW)
    for at in range(2, scans, every):
        for kind in ("cold", "warm"):
            words = ["DONE", "UNKNOWN"] if job.once and kind == "warm" else ["DONE"]
            if not job.retries and kind == "warm":
                words.append("RETRIES")  # the record job is gone, and nothing is sent again
            if job.poll is not None:
                words.append("PARAMETER_ERROR")  # the drive is still saving for the first start
            yield DriveScenario(
                name=f"{kind} restart before scan {at}",
                happens={at: kind},
                status=tuple(WORDS[word] for word in words),
                checked=False,
                again=None,
            )
        if polls(job):
            yield DriveScenario(
                name=f"the drive is switched off and on before scan {at}",
                happens={at: "off"},
                status=_forgotten(job),
                checked=False,
                again=None,
            )
