"""Scenarios of a job that asks until a drive has finished: how long it takes, what it says meanwhile."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from plcgen.ds47.kind import Poll
from plcgen.ds47.plan.nouns import DriveJob
from plcgen.ds47.proof.block_clock import STANDSTILL_MS
from plcgen.ds47.proof.scenario import DriveScenario, Edit
from plcgen.ds47.proof.words import WORDS
from plcgen.ds47.sim.faults import Fault, FaultKind

LOST, STATE_CONFLICT, FATAL_WRITE = 0xDE80A000, 0xDE80B500, 0xDF80B000
SLACK_SCANS = 30
"""Scans that the telegrams of a save take at most besides its questions."""
TELEGRAM_SCANS = 15
"""And each telegram in front of them."""
MANY = 20_000
"""More answers than a run has."""
OCCUPIED_MS = 300
"""Another job has the unit for so long: the time for the drive does not begin before its answer."""
_NOT_SUPPORTED = bytes.fromhex("80 01 01 44 01 00 21")
"""The answer to a service that a device does not have, behind the reference (PROFIdrive profile 4.2)."""


def polling(job: DriveJob, poll: Poll, never: int) -> Iterator[DriveScenario]:
    """All of them; a job ends with ``never`` if the drive does not finish."""
    yield from _durations(job, poll, never)
    yield from _questions(job, poll)


def _durations(job: DriveJob, poll: Poll, never: int) -> Iterator[DriveScenario]:
    """The drive is fast, slow, slower than allowed."""
    wide = max(10, min(poll.limit // 10_000, (job.timeout - poll.limit - poll.interval) // 30))
    size = job.telegrams[-1].parts[0].size
    for byte in range(size):
        value = bytes(int(byte == at) for at in range(size))
        yield DriveScenario(
            name=f"the drive says {value.hex()} once", saving=0, reads={before(job) + 2: _says(value)}, follow=False
        )
    slack = SLACK_SCANS + TELEGRAM_SCANS * before(job)
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
            status=(never,),
            scan=wide,
            took=(poll.limit, poll.limit + between + poll.interval + STANDSTILL_MS),
            sharp=end,
        )


def _several(poll: Poll) -> int:
    """Two questions and a half, if that is not too long."""
    return min(poll.interval * 5 // 2, poll.limit * 9 // 10)


def _questions(job: DriveJob, poll: Poll) -> Iterator[DriveScenario]:
    """A later question is refused, gets lost, is never answered."""
    long, first = _several(poll), before(job)
    if long > 2 * poll.interval:
        yield DriveScenario(
            name="the drive refuses the second question",
            saving=long,
            faults=(Fault(FaultKind.ERROR, after=first + 2, number=0x11, position=1, words=2, info=7),),
            status=(WORDS["PARAMETER_ERROR"],),
            telegram=first + 2,
            errors={(first + 2, 1): (0x8011, 7)},
        )
        sent_again: dict[str, Any] = {"again": 1}
        if not job.retries:
            sent_again = {"status": (WORDS["RETRIES"],), "telegram": first + 2, "answered": False}
        yield DriveScenario(name="the second question gets lost", saving=long, reads={first + 3: LOST}, **sent_again)
    words = [name for name in ("RETRIES", "TIMEOUT", "NO_PLACE") if name == "RETRIES" or job.retries > 1]
    yield DriveScenario(
        name="no question is answered",
        reads=dict.fromkeys(range(first + 2, MANY), STATE_CONFLICT),
        status=tuple(WORDS[name] for name in words),
        telegram=first + 2,
        answered=False,
        again=None,
        scan=50,
        follow=False,
    )
    yield DriveScenario(
        name="the first question after a run without answers", saving=0, took=(poll.interval, 2 * job.timeout)
    )


def before(job: DriveJob) -> int:
    """Telegrams in front of the one that saves."""
    return len(job.telegrams) - 2


def _says(value: bytes) -> Edit:
    """The answer has another first value."""
    return lambda answer: answer[:6] + value + answer[6 + len(value) :]


def not_supported(answer: bytes) -> bytes:
    """The drive does not support the service."""
    return answer[:1] + _NOT_SUPPORTED
