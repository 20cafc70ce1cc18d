"""Scenarios of a job that restores: what goes wrong behind its write, and while it restores."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace
from typing import Any

from plcgen.ds47.plan.access import Part
from plcgen.ds47.plan.nouns import DriveJob
from plcgen.ds47.proof.keeping import other
from plcgen.ds47.proof.points import fault, positions
from plcgen.ds47.proof.polling import not_supported
from plcgen.ds47.proof.restoration import BACK, CHECK, NOT_SAVED, NOW, OLD, OUTCOMES, RETURN, RUNS, WRITE, Restores
from plcgen.ds47.proof.scenario import DriveScenario, Event, KindScenarios
from plcgen.ds47.proof.words import DEVIATES, DONE, WORDS
from plcgen.ds47.sim.drive import Drive
from plcgen.ds47.sim.faults import Fault, FaultKind

FATAL_WRITE, FATAL_READ = 0xDF80B000, 0xDE80B000
NOT_ALLOWED = 0x11
STATES = (0x0004, 0x0800, 0x0804, 0x0000, 0xFFFF)
"""Operation enabled, pulses enabled, both, nothing, everything."""
POINTS = 8
"""Scans of a run that restores in which something happens to execute or the CPU."""
SCANS = 6
"""That a telegram takes."""
_PLAIN = {DONE, WORDS["NO_SLOT"], WORDS["OCCUPIED"], WORDS["TOO_SOON"]}


def restored(job: DriveJob, scenarios: Iterable[DriveScenario]) -> Iterator[DriveScenario]:
    """What goes wrong in any job, for one that restores: how it ends follows from what its drive has.

    What goes wrong while it saves is the cause of one result: the values are right, but not saved.
    """
    last = (NOT_SAVED,) if job.guarded else ()
    for one in scenarios:
        if one.telegram == OLD or set(one.status) <= _PLAIN:
            yield one
        elif one.checked and (one.telegram > BACK or one.status == last):
            yield replace(one, status=last or OUTCOMES).among(Restores(causes=one.status))
        elif one.checked:
            also = (DONE,) if DONE in one.status else ()
            yield replace(one, status=(*also, *OUTCOMES)).among(Restores(causes=one.status))
        else:
            yield replace(one, status=(*one.status, *OUTCOMES, *last))


def restoring(job: DriveJob, _: int) -> Iterator[DriveScenario]:
    """All of them."""
    yield from _refused(job)
    yield from _limited(job)
    yield from _changed(job)
    yield from _in_trouble(job)
    yield from _signals(job)


def _refused(job: DriveJob) -> Iterator[DriveScenario]:
    """The drive takes all values but one, or one alone."""
    for place in positions(job.telegrams[1]):
        for state in (Restores().state, *(STATES if place == 1 else ())):
            yield DriveScenario(
                name=f"parameter {place} is refused, the drive reports {state:04X}h",
                faults=(fault(job, WRITE, place, NOT_ALLOWED, 1),),
                errors={(WRITE, place): (0x8000 | NOT_ALLOWED, 0)},
                status=OUTCOMES,
                parts=(Restores(causes=(WORDS["PARAMETER_ERROR"],), state=state),),
                telegram=WRITE,
            )
    count = len(job.telegrams[1].parts)
    if count > 1:
        yield DriveScenario(
            name=f"parameter {count} alone is taken, the drive runs",
            faults=tuple(fault(job, WRITE, place, NOT_ALLOWED, 1) for place in range(1, count)),
            errors={(WRITE, place): (0x8000 | NOT_ALLOWED, 0) for place in range(1, count)},
            status=OUTCOMES,
            parts=(Restores(causes=(WORDS["PARAMETER_ERROR"],), state=RUNS),),
            telegram=WRITE,
        )


def _relax(drive: Drive) -> None:
    """The drive keeps what it is given."""
    for item in drive.objects.values():
        for parameter in item.parameters.values():
            parameter.keeps = None


def _limits(job: DriveJob, place: int, what: str, state: int = Restores().state, **more: Any) -> DriveScenario:
    """The drive makes another value of one, until old values are written back: that is restored."""
    part = _part(job, place)
    events = {RETURN: _relax, **more.pop("events", {})}
    return DriveScenario(
        name=f"the drive makes another value of parameter {place}, {what}",
        keeps={part.use.parameter.pnu: other(part, 0, 0)},
        events=events,
        errors={(BACK, place): (DEVIATES, part.subindex)},
        status=OUTCOMES,
        parts=(Restores(state, (WORDS["DEVIATES"],)),),
        telegram=BACK,
        **more,
    )


def _part(job: DriveJob, place: int) -> Part:
    return job.telegrams[1].parts[place - 1]


def _limited(job: DriveJob) -> Iterator[DriveScenario]:
    """The drive limits a value without a word."""
    for place in positions(job.telegrams[1]):
        yield _limits(job, place, "restored")
    for state in STATES:
        yield _limits(job, 1, f"it reports {state:04X}h", state=state, follow=False)
    yield _limits(job, 1, "inputs change", meddle=True, guarded=True)


def _change(part: Part, octet: int) -> Event:
    """Somebody else changes the first value of a parameter."""
    change = other(part, 0, octet)

    def event(drive: Drive) -> None:
        for item in drive.objects.values():
            parameter = item.parameters[part.use.parameter.pnu]
            parameter.values = [change(index, value) for index, value in enumerate(parameter.values)]

    return event


def _changed(job: DriveJob) -> Iterator[DriveScenario]:
    """Somebody else changes a value in front of one of the last telegrams."""
    for place in positions(job.telegrams[1]):
        part = _part(job, place)
        for octet in dict.fromkeys((0, part.size // part.count - 1)):
            event = _change(part, octet)
            name = f"somebody changes octet {octet} of {place} before telegram"
            for telegram in (NOW, CHECK):
                yield _limits(job, 1, f"{name} {telegram}", events={telegram: event}, follow=False)
            yield DriveScenario(
                name=f"the answer to the write is lost, {name} {NOW}",
                reads={BACK: FATAL_READ},
                events={NOW: event},
                status=OUTCOMES,
                parts=(Restores(causes=(WORDS["READ_ERROR"],)),),
                telegram=BACK,
                answered=False,
                again=None,
                follow=False,
            )
            yield DriveScenario(
                name=f"parameter {place} is refused, {name} {NOW}",
                faults=(fault(job, WRITE, place, NOT_ALLOWED, 1),),
                errors={(WRITE, place): (0x8000 | NOT_ALLOWED, 0)},
                events={BACK: event},
                status=OUTCOMES,
                parts=(Restores(causes=(WORDS["PARAMETER_ERROR"],)),),
                telegram=WRITE,
                follow=False,
            )


def _in_trouble(job: DriveJob) -> Iterator[DriveScenario]:
    """A telegram is refused or gets no answer."""
    failing: dict[str, Any] = {"status": OUTCOMES, "again": None}
    for name, how, word in (
        ("WRREC of the write fails", {"writes": {WRITE: FATAL_WRITE}}, "WRITE_ERROR"),
        ("it fails while the drive runs", {"writes": {WRITE: FATAL_WRITE}}, "WRITE_ERROR"),
        ("RDREC of the write fails", {"reads": {WRITE: FATAL_READ}}, "READ_ERROR"),
        ("the write is not supported", {"reads": {WRITE: not_supported}}, "NOT_SUPPORTED"),
    ):
        more: dict[str, Any] = {**failing, **how}
        state = RUNS if "runs" in name else Restores().state
        parts = (Restores(state, (WORDS[word],)),)
        yield DriveScenario(name=name, parts=parts, telegram=WRITE, answered=False, **more)
    for call, calls, status, word in (
        ("WRREC", "writes", FATAL_WRITE, "WRITE_ERROR"),
        ("RDREC", "reads", FATAL_READ, "READ_ERROR"),
    ):
        more = {**failing, calls: {BACK: status}, "parts": (Restores(causes=(WORDS[word],)),)}
        yield DriveScenario(name=f"{call} of telegram {BACK} fails", telegram=BACK, answered=False, **more)
        for telegram in (NOW, RETURN, CHECK):
            more = {"again": None, calls: {telegram: status}}
            yield _limits(job, 1, f"{call} of telegram {telegram} fails", **more)
    for telegram in (NOW, RETURN, CHECK):
        error = Fault(FaultKind.ERROR, after=telegram - 1, number=NOT_ALLOWED, position=1, words=1)
        yield _limits(job, 1, f"telegram {telegram} is refused", faults=(error,))


def _signals(job: DriveJob) -> Iterator[DriveScenario]:
    """Execute falls, rises again, the CPU restarts, the unit is lost while values are restored."""
    last = CHECK * SCANS
    for at in range(SCANS, last, (last - SCANS) // POINTS):
        yield _limits(job, 1, f"execute falls before scan {at}", happens={at: "drop"}, follow=False)
        happens = {at: "drop", at + 1: "rise"}
        yield _limits(job, 1, f"execute falls before scan {at} and rises", happens=happens, follow=False)
        for kind in ("cold", "warm", "lost"):
            what = f"{kind if kind == 'lost' else f'{kind} restart'} before scan {at}"
            found = _limits(job, 1, what, happens={at: kind}, again=None, checked=False)
            yield replace(found, status=(DONE, WORDS["LOST"], *OUTCOMES))
    yield _limits(job, 1, "then another slot", follow=False)
    yield DriveScenario(name="another slot after it", slot=0, status=(WORDS["NO_SLOT"],), checked=False)


SCENARIOS = (KindScenarios(80, lambda job: job.restores, restoring, restored),)
