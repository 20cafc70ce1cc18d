"""What must hold at the end of a job that saves: done means saved, and what it says is what the drive said."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from plcgen.ds47.plan.nouns import DriveJob
from plcgen.ds47.proof.restoration import CAUSE
from plcgen.ds47.proof.rig import JobRig
from plcgen.ds47.proof.words import DONE, WORDS
from plcgen.ds47.sim.bench import SAVING_MS
from plcgen.ds47.wire import formats
from plcgen.proof.scenario import ScenarioError

SCAN = 10
READ, CHANGED = 1, 2
"""Response identifiers of good answers."""


@dataclass(frozen=True, slots=True)
class AnotherSave:
    """A scenario that starts ``since`` ms behind the last save that was handed over; None: long behind it.

    ``left`` ms of the time that must pass in between are left.
    """

    since: int | None = None
    left: int = 0


def saving_scans(job: DriveJob) -> int:
    """Scans that a good job takes at most besides its telegrams: the drive has finished at the second question."""
    waited = sum(telegram.awaited.interval for telegram in job.telegrams if telegram.awaited is not None)
    polled = job.poll.interval + SAVING_MS if job.poll is not None else 0
    return 2 * (polled + waited) // SCAN


def check_saved(rig: JobRig, status: int, before: int | None) -> None:
    """The drive has saved if the job is done, and has not if it says so.

    ``before`` is how many saves the job had counted; its count and its value are compared with what came, unless it is
    None. Raises ScenarioError.
    """
    if not rig.job.guarded:
        check_acknowledged(rig, status)
        return
    said = last_answer(rig)
    for parameter in rig.drive.saving_parameters():
        if status == DONE and (any(parameter.values) or not parameter.saved):
            raise ScenarioError(f"done, but P{parameter.pnu} is {parameter.values}: the drive has not saved")
    cause = rig.db.get(CAUSE) if rig.job.restores else status
    if cause == WORDS["NOT_SAVED"] and (said is None or not any(said)):
        raise ScenarioError("said to be not saved, but the drive has not said so")
    if status == WORDS["TOO_SOON"] and rig.drive.journal:
        raise ScenarioError("a start that comes too soon sends something")
    if before is None:
        return
    taken = sum(answer[1:2] == bytes((CHANGED,)) for answer in _answers(rig, -2))
    if rig.saves != before + taken:
        raise ScenarioError(f"{rig.saves - before} saves were counted, the drive has taken {taken}")
    use = rig.job.outputs[-1]
    shown = rig.db.bytes(use.member, use.count * use.format.size)
    if said is not None and shown != said:
        raise ScenarioError(f"{use.member} is {shown.hex(' ')}, the drive said {said.hex(' ')} last")


def check_acknowledged(rig: JobRig, status: int) -> None:
    """Done says that p3981 is 0 again and r0945[0] to [7] are 0; else the job says which of them is not.

    Raises ScenarioError.
    """
    parameters = rig.drive.objects[rig.drive_object].parameters
    back, faults = not any(parameters[3981].values), any(parameters[945].values[:8])
    ends = {DONE: back and not faults, WORDS["NOT_ACKNOWLEDGED"]: not back, WORDS["FAULTS_REMAIN"]: back and faults}
    if not ends.get(status, True):
        raise ScenarioError(f"P3981 is {parameters[3981].values}, the present faults are {parameters[945].values[:8]}")
    if status not in ends:
        return
    came = _answers(rig, -1)[-1]
    for use in rig.job.outputs:
        part = next(part for part in rig.job.telegrams[-1].parts if part.use is use)
        at = 6 if part.use.parameter.pnu == 3981 else 10
        shown = rig.db.bytes(use.member, part.size)
        if shown != came[at : at + part.size]:
            raise ScenarioError(f"{use.member} is {shown.hex(' ')}, the drive said {came.hex(' ')} last")


def check_held_back(jobs: Iterable[DriveJob], exchanges: Iterable[tuple[bytes, bytes]]) -> None:
    """From a save that the drive has taken until it says 0 nothing goes to its unit but the question whether it has.

    ``jobs`` are those of one unit, ``exchanges`` its requests and good or bad answers, in order. Raises ScenarioError.
    """
    questions = {
        _of(job, job.telegrams[-2].request.data): _of(job, job.telegrams[-1].request.data)
        for job in jobs
        if job.guarded
    }
    question = None
    for sent, answer in exchanges:
        if question is None:
            question = questions.get(sent[1:]) if answer[1] == CHANGED else None
        elif sent[1:] != question:
            raise ScenarioError(f"{sent.hex(' ').upper()} is sent while the drive saves")
        elif answer[1] == READ and not any(answer[6:]):
            question = None


def _of(job: DriveJob, request: bytes) -> bytes:
    """A request of an instance, without its reference."""
    return request[1:2] + bytes((job.drive.drive_object,)) + request[3:]


def last_answer(rig: JobRig) -> bytes | None:
    """Wire bytes of the value in the last good answer of this run; None without one."""
    part = rig.job.telegrams[-1].parts[0]
    accepted = {part.use.format.code} | {one.code for one in (formats.generic_of(part.size),) if one is not None}
    for data in reversed(_answers(rig, -1)):
        good = data[1:2] == bytes((READ,))
        if good and len(data) == rig.job.telegrams[-1].positive_length and data[4] in accepted and data[5] == 1:
            return data[6 : 6 + part.size]
    return None


def _answers(rig: JobRig, telegram: int) -> list[bytes]:
    """Answers of this run that were fetched behind a request like that of a telegram."""
    wanted, asked, found = rig.requests()[telegram][1:], b"", []
    for exchange in rig.drive.journal:
        if exchange.direction == "write":
            asked = exchange.data[1:] if not exchange.status else asked
        elif not exchange.status and asked == wanted:
            found.append(exchange.data)
    return found
