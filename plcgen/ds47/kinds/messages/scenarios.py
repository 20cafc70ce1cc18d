"""Scenarios of a job that lists messages: how many there are, and a buffer that changes while it is read."""

from __future__ import annotations

from collections.abc import Iterator

from plcgen.ds47.plan.nouns import DriveJob
from plcgen.ds47.proof.message_lists import COUNTERS, GROUP, Messages, columns, counted, groups
from plcgen.ds47.proof.scenario import DriveScenario, Event, KindScenarios
from plcgen.ds47.proof.words import WORDS
from plcgen.ds47.sim.drive import Drive
from plcgen.ds47.sim.faults import Fault, FaultKind

FATAL_WRITE = 0xDF80B000
NOT_ALLOWED = 0x11
"""Error number of a drive that does not take a request in its state."""


def listing(job: DriveJob, _: int) -> Iterator[DriveScenario]:
    """All of them."""
    for count in range(GROUP + 1):
        yield DriveScenario(name=f"{count} messages", parts=(Messages(messages=count),), follow=False)
    yield from _changes(job)
    yield from _second_try(job)


def _changes(job: DriveJob) -> Iterator[DriveScenario]:
    """A message comes before, within or behind the telegrams of some of the tries."""
    telegrams, tries = len(job.telegrams), _tries(job)
    yield DriveScenario(name="a message comes before the first telegram", events={1: comes(job)}, follow=False)
    for tried in range(1, tries + 1):
        for at in range(2, telegrams + 1):
            events = {telegrams * before + at: comes(job) for before in range(tried)}
            where = f"before telegram {at} of the first {tried} tries"
            yield _run(job, f"a message comes {where}", events, tried)
    for step in (0x100, 0x10000 - 1, 0x10000 - 0x100) if counted(job) else ():
        name = f"a message comes, and {step} is added to the counter"
        yield _run(job, name, {telegrams: comes(job, step)}, 1)
    for place in () if counted(job) else (GROUP * group + at for group in range(groups(job)) for at in (0, GROUP - 1)):
        for bit in (0, 15):
            yield _run(job, f"bit {bit} of code {place} changes", {telegrams: _turns(job, place, bit)}, 1)


def _run(job: DriveJob, name: str, events: dict[int, Event], tried: int) -> DriveScenario:
    """A buffer that changes in so many tries."""
    tries = _tries(job)
    status = WORDS["CHANGED" if tried == tries else "DONE"]
    return DriveScenario(
        name=name,
        events=events,
        parts=(Messages(rounds=min(tried + 1, tries), messages=2),),
        status=(status,),
    )


def _second_try(job: DriveJob) -> Iterator[DriveScenario]:
    """What goes wrong when the buffer is read again: nothing is listed."""
    if _tries(job) < 2:
        return
    telegrams = len(job.telegrams)
    events = {telegrams: comes(job)}
    for telegram in (1, telegrams):
        refused = Fault(FaultKind.ERROR, after=telegrams + telegram - 1, number=NOT_ALLOWED, position=1, words=1)
        yield DriveScenario(
            name=f"the drive refuses telegram {telegram} of the second try",
            events=events,
            parts=(Messages(rounds=2),),
            faults=(refused,),
            status=(WORDS["PARAMETER_ERROR"],),
            telegram=telegram,
            errors={(telegram, 1): (0x8000 | NOT_ALLOWED, 0)},
        )
        yield DriveScenario(
            name=f"WRREC of telegram {telegram} of the second try fails",
            events=events,
            parts=(Messages(rounds=2),),
            writes={telegrams + telegram: FATAL_WRITE},
            status=(WORDS["WRITE_ERROR"],),
            telegram=telegram,
            answered=False,
        )


def comes(job: DriveJob, step: int = 1) -> Event:
    """A message more, or another latest one where the buffer is full; the counter has another value, if it is read."""
    numbers, counter = dict(columns(job)), COUNTERS[job.kind]

    def event(drive: Drive) -> None:
        parameters = drive.objects[job.drive.drive_object].parameters
        codes = parameters[numbers["code"]].values
        place = next((index for index in range(GROUP) if not codes[index]), GROUP - 1)
        for pnu in numbers.values():
            parameter = parameters[pnu]
            parameter.values[place] = 1 if parameter.values[place] != 1 else 2
        if counted(job):
            changes = parameters[counter].values
            changes[0] = (int(changes[0]) + step) % 0x10000

    return event


def _turns(job: DriveJob, place: int, bit: int) -> Event:
    """One bit of one code is another one."""
    number = dict(columns(job))["code"]

    def event(drive: Drive) -> None:
        codes = drive.objects[job.drive.drive_object].parameters[number].values
        codes[place] = int(codes[place]) ^ 1 << bit

    return event


def _tries(job: DriveJob) -> int:
    return job.messages.settings.tries if job.messages is not None else 0


SCENARIOS = (KindScenarios(30, lambda job: job.messages is not None, listing),)
