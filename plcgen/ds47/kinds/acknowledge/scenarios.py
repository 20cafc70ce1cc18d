"""Scenarios of a job that acknowledges: how long the drive takes, and faults that remain."""

from __future__ import annotations

from collections.abc import Iterator

from plcgen.ds47.kind import Poll
from plcgen.ds47.plan.nouns import DriveJob
from plcgen.ds47.proof.points import replaced_values
from plcgen.ds47.proof.polling import MANY, SLACK_SCANS, before, polling
from plcgen.ds47.proof.scenario import DriveScenario, KindScenarios
from plcgen.ds47.proof.words import WORDS

FAULTS = 945
"""Codes of the present faults."""


def acknowledging(job: DriveJob, _: int) -> Iterator[DriveScenario]:
    """All of them."""
    assert job.poll is not None  # of such jobs only
    yield from polling(job, job.poll, WORDS["NOT_ACKNOWLEDGED"])
    yield from _remaining(job, job.poll)


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
            reads=dict.fromkeys(range(before(job) + 2, MANY), replaced_values(question, {place: codes})),
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


SCENARIOS = (KindScenarios(20, lambda job: job.poll is not None and not job.guarded, acknowledging),)
