"""Scenarios of a job that saves: how long the drive takes, what it says meanwhile, and how often it may be asked to."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from plcgen.ds47.kind import Poll
from plcgen.ds47.plan.access import Verify
from plcgen.ds47.plan.nouns import DriveJob
from plcgen.ds47.proof.block_clock import STANDSTILL_MS
from plcgen.ds47.proof.pace import SCAN
from plcgen.ds47.proof.points import replaced_values
from plcgen.ds47.proof.scenario import DriveScenario, Edit
from plcgen.ds47.proof.verifying import another
from plcgen.ds47.proof.words import WORDS
from plcgen.ds47.sim.faults import Fault, FaultKind

LOST, STATE_CONFLICT, FATAL_WRITE = 0xDE80A000, 0xDE80B500, 0xDF80B000
SLACK_SCANS = 30
"""Scans that the telegrams of a save take at most besides its questions."""
TELEGRAM_SCANS = 15
"""And each telegram in front of them."""
MANY = 20_000
"""More answers than a run has."""
FAULTS = 945
"""Codes of the present faults."""
OCCUPIED_MS = 300
"""Another job has the unit for so long: the time for the drive does not begin before its answer."""
CLOCK_MS = 3000
"""What a clock loses when it begins again, once an hour on an S7-1200/1500: three of the longest calls that count."""
_NOT_SUPPORTED = bytes.fromhex("80 01 01 44 01 00 21")
"""The answer to a service that a device does not have, behind the reference (PROFIdrive profile 4.2)."""


def saving(job: DriveJob, poll: Poll) -> Iterator[DriveScenario]:
    """All of them."""
    yield from _durations(job, poll)
    yield from _questions(job, poll)
    if job.guarded:
        yield from _guard(job, poll)
    else:
        yield from _remaining(job, poll)
    if job.verified:
        yield from _deviation(job)


def _durations(job: DriveJob, poll: Poll) -> Iterator[DriveScenario]:
    """The drive is fast, slow, slower than allowed."""
    wide = max(10, min(poll.limit // 10_000, (job.timeout - poll.limit - poll.interval) // 30))
    size = job.telegrams[-1].parts[0].size
    for byte in range(size):
        value = bytes(int(byte == at) for at in range(size))
        yield DriveScenario(
            name=f"the drive says {value.hex()} once", saving=0, reads={_before(job) + 2: _says(value)}, follow=False
        )
    slack = SLACK_SCANS + TELEGRAM_SCANS * _before(job)
    between = poll.interval + slack * wide
    yield DriveScenario(name="the drive saves at once", saving=0, scan=wide, took=(poll.interval, between))
    yield DriveScenario(
        name="the unit is free after a while",
        saving=0,
        occupied=OCCUPIED_MS,
        took=(OCCUPIED_MS + poll.interval, OCCUPIED_MS + poll.interval + 10 * slack),
        follow=False,
    )
    for name, time in (("two questions and a half", _several(poll)), ("almost the limit", poll.limit * 49 // 50)):
        yield DriveScenario(name=f"the drive saves for {name}", saving=time, scan=wide, took=(time, time + between))
    for end in (-1, 0):
        yield DriveScenario(
            name=f"the drive never finishes saving, a question comes {end} ms behind the limit",
            saving=100 * poll.limit,
            status=(WORDS["NOT_SAVED" if job.guarded else "NOT_ACKNOWLEDGED"],),
            scan=wide,
            took=(poll.limit, poll.limit + between + poll.interval + STANDSTILL_MS),
            sharp=end,
        )


def _remaining(job: DriveJob, poll: Poll) -> Iterator[DriveScenario]:
    """Faults whose cause is still there: the drive is asked until the limit, in case it is slow to take them out."""
    wide = max(10, min(poll.limit // 10_000, (job.timeout - poll.limit - poll.interval) // 30))
    for name, time in (("at once", 0), ("late", poll.limit // 2)):
        for count in (1, 8):
            yield DriveScenario(
                name=f"the drive acknowledges {name}, {count} faults remain",
                saving=time,
                remaining=count,
                status=(WORDS["FAULTS_REMAIN"],),
                scan=wide,
                took=(poll.limit, poll.limit + poll.interval + SLACK_SCANS * wide),
            )
    question = job.telegrams[-1]
    place = next(n for n, part in enumerate(question.parts, 1) if part.use.parameter.pnu == FAULTS)
    size = question.parts[place - 1].size
    for at in (0, size - 1):
        codes = bytes(int(byte == at) for byte in range(size))
        yield DriveScenario(
            name=f"one fault remains, which is octet {at} of all of them",
            saving=0,
            remaining=8,
            reads=dict.fromkeys(range(_before(job) + 2, MANY), replaced_values(question, {place: codes})),
            delivers={(question.number, place): codes},
            status=(WORDS["FAULTS_REMAIN"],),
            follow=False,
        )
    yield DriveScenario(name="the drive has no faults", values="low")
    yield DriveScenario(
        name="the drive has no faults, but never finishes acknowledging",
        values="low",
        saving=100 * poll.limit,
        status=(WORDS["NOT_ACKNOWLEDGED"],),
        scan=wide,
    )


def _several(poll: Poll) -> int:
    """Two questions and a half, if that is not too long."""
    return min(poll.interval * 5 // 2, poll.limit * 9 // 10)


def _questions(job: DriveJob, poll: Poll) -> Iterator[DriveScenario]:
    """A later question is refused, gets lost, is never answered."""
    long, before = _several(poll), _before(job)
    if long > 2 * poll.interval:
        yield DriveScenario(
            name="the drive refuses the second question",
            saving=long,
            faults=(Fault(FaultKind.ERROR, after=before + 2, number=0x11, position=1, words=2, info=7),),
            status=(WORDS["PARAMETER_ERROR"],),
            telegram=before + 2,
            errors={(before + 2, 1): (0x8011, 7)},
        )
        yield DriveScenario(name="the second question gets lost", saving=long, reads={before + 3: LOST}, again=1)
    words = [name for name in ("RETRIES", "TIMEOUT", "NO_PLACE") if name == "RETRIES" or job.retries > 1]
    yield DriveScenario(
        name="no question is answered",
        reads=dict.fromkeys(range(before + 2, MANY), STATE_CONFLICT),
        status=tuple(WORDS[name] for name in words),
        telegram=before + 2,
        answered=False,
        again=None,
        scan=50,
        follow=False,
    )
    yield DriveScenario(
        name="the first question after a run without answers", saving=0, took=(poll.interval, 2 * job.timeout)
    )


def _guard(job: DriveJob, poll: Poll) -> Iterator[DriveScenario]:
    """Once in ``distance``: counted from a save that the drive has taken or may have taken, not from a refused one."""
    soon = (WORDS["TOO_SOON"],)
    save = _before(job) + 1
    refused = Fault(FaultKind.ERROR, after=save - 1, number=0x11, position=1, words=1)
    near, far = poll.distance - 15, poll.distance + CLOCK_MS
    yield DriveScenario(name="a save before another", follow=False)
    yield DriveScenario(name="at once again", since=0, status=soon, checked=False, follow=False)
    yield DriveScenario(name="again just within the distance", since=near, status=soon, checked=False, follow=False)
    yield DriveScenario(name="again after the distance", since=far, follow=False)
    yield DriveScenario(name="1 ms too soon", left=SCAN + 1, status=soon, checked=False, follow=False)
    yield DriveScenario(name="again behind the start that was too soon", since=0, follow=False)
    yield DriveScenario(
        name="a save of which nobody knows whether the drive took it",
        reads={save: LOST}, status=(WORDS["UNKNOWN"],), telegram=save, answered=False, follow=False,
    )  # fmt: skip
    yield DriveScenario(name="at once again, it may have", since=0, status=soon, checked=False, follow=False)
    for name, how in (
        ("refuses", {"faults": (refused,), "errors": {(save, 1): (0x8011, 0)}, "status": (WORDS["PARAMETER_ERROR"],)}),
        ("does not get", {"writes": {save: FATAL_WRITE}, "answered": False, "status": (WORDS["WRITE_ERROR"],)}),
        ("does not know", {"reads": {save: not_supported}, "answered": False, "status": (WORDS["NOT_SUPPORTED"],)}),
    ):
        yield DriveScenario(name=f"a save that the drive {name}", telegram=save, follow=False, **how)
        yield DriveScenario(name=f"at once again: the drive {name} the first", since=0, follow=False)


def _deviation(job: DriveJob) -> Iterator[DriveScenario]:
    """What is not as written is not saved; the next start may be at once."""
    telegram = next(one for one in job.telegrams if one.parts[0].use.as_(Verify))
    yield replace(another(telegram, 1), follow=False)
    yield DriveScenario(name="at once again: nothing was saved", since=0, follow=False)


def _before(job: DriveJob) -> int:
    """Telegrams in front of the one that saves."""
    return len(job.telegrams) - 2


def _says(value: bytes) -> Edit:
    """The answer has another first value."""
    return lambda answer: answer[:6] + value + answer[6 + len(value) :]


def not_supported(answer: bytes) -> bytes:
    """The drive does not support the service."""
    return answer[:1] + _NOT_SUPPORTED
