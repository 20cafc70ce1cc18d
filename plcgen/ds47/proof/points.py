"""Which places of a job are tried one by one, and how a drive refuses one of them."""

from __future__ import annotations

from plcgen.ds47.plan.nouns import DriveJob, DriveTelegram
from plcgen.ds47.proof.scenario import Edit
from plcgen.ds47.sim.faults import Fault, FaultKind
from plcgen.ds47.wire.formats import padded

FEW = 4
"""So many parameters of a telegram are tried one by one; of more the first, the middle and the last."""


def positions(telegram: DriveTelegram) -> list[int]:
    """Places of a telegram that are tried."""
    count = len(telegram.parts)
    return list(range(1, count + 1)) if count <= FEW else [1, (count + 1) // 2, count]


def ends(job: DriveJob) -> list[DriveTelegram]:
    """The first and the last telegram."""
    return list(dict.fromkeys((job.telegrams[0], job.telegrams[-1])))


def fault(job: DriveJob, telegram: int, place: int, error: int, words: int) -> Fault:
    """The parameter is refused in the n-th request: each telegram has one."""
    count = len(job.telegrams[telegram - 1].parts)
    before = sum(place <= len(other.parts) for other in job.telegrams[: telegram - 1])
    assert place <= count  # a fault that never strikes would prove nothing
    return Fault(
        FaultKind.ERROR, after=before, number=error, position=place, words=2 if words == 2 else 1, info=0x100 + place
    )


def replaced_values(telegram: DriveTelegram, values: dict[int, bytes]) -> Edit:
    """Other values at some places of a good answer, as long as those."""

    def edit(answer: bytes) -> bytes:
        for place, data in values.items():
            at = value_at(telegram, place)
            answer = answer[:at] + data + answer[at + len(data) :]
        return answer

    return edit


def value_at(telegram: DriveTelegram, place: int) -> int:
    """Where the values of a parameter begin in a good answer."""
    return 4 + sum(2 + padded(part.size) for part in telegram.parts[: place - 1]) + 2


def soon_out_of_retries(job: DriveJob) -> bool:
    """Whether a job may end without retries before it sends a request anew that its drive has forgotten.

    It does so behind a third of its timeout, and that takes a retry too.
    """
    return (job.retries - 1) * job.retry_pause <= job.timeout // 3 + 1000
