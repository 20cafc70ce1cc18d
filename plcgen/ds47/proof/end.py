"""What must hold at the end of a run: values, errors of every parameter, telegrams on the wire."""

from __future__ import annotations

from collections.abc import Sequence

from plcgen.ds47.plan.nouns import DriveJob
from plcgen.ds47.proof.contents import held, kept
from plcgen.ds47.proof.message_lists import Messages
from plcgen.ds47.proof.records import REFUSED, Record
from plcgen.ds47.proof.restoration import BACK, WRITE, Restoration
from plcgen.ds47.proof.rig import JobRig
from plcgen.ds47.proof.scenario import DriveScenario
from plcgen.ds47.proof.step_facts import overwritten
from plcgen.ds47.proof.words import DEVIATES, DONE, NO_ANSWER, WORDS
from plcgen.proof.scenario import OtherTelegramError, ScenarioError

Result = tuple[int, int]
"""Error and info of a parameter."""


def check_end(
    rig: JobRig,
    scenario: DriveScenario,
    requests: Sequence[bytes],
    before: list[list[bytes]],
    wanted: list[list[bytes]],
    status: int,
    polled: int,
    restoration: Restoration | None,
) -> None:
    """All of it; ``polled`` is how often the last telegram was repeated. Raises ScenarioError."""
    check_wire(rig, scenario, requests, status, polled, 0 if restoration is None else restoration.begin)
    if not scenario.checked:
        return
    results = told = telegram_results(rig.job, scenario)
    if restoration is not None and BACK in restoration.starts:
        wanted = restoration.came(wanted)
        if scenario.telegram == WRITE:
            results = [*results[:2], restoration.read_back(), *results[3:]]
        told = restoration.remembered(results)
    check_errors(rig, use_results(rig.job, told))
    if status == DONE or status >> 8 in _ANSWERED:
        _check_record(rig)
    _check_values(rig, results, before, wanted, asked_again=polled > 0)
    if status == DONE:
        for use in rig.job.uses:
            if not use.writes or use in rig.job.saving or overwritten(rig.job, use):
                continue  # what saves has returned to 0
            found = held(rig.drive, rig.drive_object, use)
            given = kept(use, rig.values.given[use.position], (scenario.keeps, scenario.meanwhile))
            if found != given:
                raise ScenarioError(f"the drive has {found.hex(' ')} for {use.label}, the input was {given.hex(' ')}")


def telegram_results(job: DriveJob, scenario: DriveScenario) -> list[list[Result]]:
    """What the parameters of each telegram must report."""
    last = scenario.telegram or len(job.telegrams)
    found = []
    for telegram in job.telegrams:
        good = (
            scenario.answered if telegram.number == last else telegram.number < last or scenario.of(Messages).rounds > 1
        )
        default = (0, 0) if good else (NO_ANSWER, 0)
        places = range(1, len(telegram.parts) + 1)
        found.append([scenario.errors.get((telegram.number, place), default) for place in places])
    return found


def use_results(job: DriveJob, results: list[list[Result]]) -> list[Result]:
    """Of a parameter in several telegrams the first error counts; behind the end of the job nothing more is known."""
    found: dict[int, Result] = {}
    ended = False
    for telegram, errors in zip(job.telegrams, results, strict=True):
        for part, result in zip(telegram.parts, errors, strict=True):
            before = found.get(part.use.position)
            if before is None or (before[0] == 0 and not ended):
                found[part.use.position] = result
        ended = ended or any(error for error, _ in errors)
    return [found[use.position] for use in job.uses]


def check_errors(rig: JobRig, wanted: list[Result]) -> None:
    """``errors`` and ``errorInfos`` of every parameter."""
    pairs = zip(rig.words("errors"), rig.words("errorInfos"), strict=True)
    for position, (found, right) in enumerate(zip(pairs, wanted, strict=True), 1):
        if found != right:
            shown = f"16#{found[0]:04X}, {found[1]}"
            raise ScenarioError(
                f"errors[{position}], errorInfos[{position}] are {shown} instead of 16#{right[0]:04X}, {right[1]}"
            )


_ANSWERED = frozenset({0x82, 0x83, 0x84})
"""High bytes of status words with which a record job ends a telegram."""


def _check_record(rig: JobRig) -> None:
    """STATUS of the last record job as the drive gave it, and the retries that the channel has counted."""
    right, found = (rig.drive.journal[-1].status >> 8 & 0xFFFF, rig.unit.get("retries")), rig.record
    if found != right:
        shown = ["16#{:04X}, {}".format(*pair) for pair in (found, right)]
        raise ScenarioError(f"recordStatus, retries of the diagnosis are {shown[0]} instead of {shown[1]}")


def check_refused(rig: JobRig, scenario: DriveScenario, status: int) -> None:
    """What a job says of a value that is not allowed, for which it sends nothing."""
    found = tuple(rig.db.get(name) for name in REFUSED)
    if found != scenario.of(Record).refused:
        raise ScenarioError(f"{', '.join(REFUSED)} are {found} instead of {scenario.of(Record).refused}")
    if status in {WORDS["OUTSIDE"], WORDS["NO_RECORD"]} and rig.drive.journal:
        raise ScenarioError("a start that is refused sends something")


def _check_values(
    rig: JobRig,
    results: list[list[Result]],
    before: list[list[bytes]],
    wanted: list[list[bytes]],
    *,
    asked_again: bool,
) -> None:
    """What came without an error is delivered, everything else is as it was.

    Of a question that waits for the drive only the latter is looked at here, where it was asked once.
    """
    found = rig.delivered()
    for telegram, errors in zip(rig.job.telegrams, results, strict=True):
        asks = telegram.parts[0].use in rig.job.saving
        if telegram.writes or (asks and asked_again):
            continue
        for place, (part, (error, _)) in enumerate(zip(telegram.parts, errors, strict=True)):
            if asks and not error:
                continue
            at = telegram.number - 1
            right = (before if error not in {0, DEVIATES} else wanted)[at][place]
            if found[at][place] != right:
                what = "as before: it did not come" if error else "the value of the drive"
                raise ScenarioError(
                    f"{part.use.member} is {found[at][place].hex(' ')} instead of {right.hex(' ')}, {what}"
                )


def check_wire(
    rig: JobRig, scenario: DriveScenario, requests: Sequence[bytes], status: int, polled: int, begin: int
) -> None:
    """Every request is a telegram of this run, whole and exact, in order; with a reference.

    ``begin`` is where in the journal it is looked at.
    """
    at, again, exact = {-1}, 0, scenario.again is not None
    for exchange in rig.drive.journal[begin:]:
        if exchange.direction == "read":
            continue
        data = exchange.data
        if exchange.index != rig.job.drive.record_index & 0xFFFF:
            raise ScenarioError(f"data record 16#{exchange.index:04X} was written")
        same = {number for number, request in enumerate(requests) if request[1:] == data[1:]}
        after = same & {number + 1 for number in at}
        if exact:
            again += not after
            found = after or same & at
        else:  # steps may ask the same: which of them it was behind a restart shows later
            found = after | same & {0, *at}
        if not found:
            wanted = requests[min(max(at) + 1, len(requests) - 1)]
            raise OtherTelegramError("sent was", data, data[:1] + wanted[1:])
        at = found
        if not data[0]:
            raise ScenarioError("a request has the reference 0")
    if status in {WORDS["NO_TIME"], *range(WORDS["NO_REQUEST"], WORDS["NO_VALUE"] + 1)} and rig.drive.journal:
        raise ScenarioError("a start that is refused sends something")
    if status in {DONE, WORDS["CHANGED"]} and len(requests) - 1 not in at:
        raise ScenarioError(f"{max(at) + 1} of {len(requests)} telegrams were sent")
    if status == WORDS["DEVIATES"] and scenario.telegram - 1 not in at:
        raise ScenarioError(f"{max(at) + 1} telegrams were sent: the job ends with telegram {scenario.telegram}")
    again -= polled
    if exact and again != scenario.again:
        raise ScenarioError(f"{again} requests were sent again instead of {scenario.again}")
