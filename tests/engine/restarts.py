"""Restart of the CPU and download of data blocks in the middle of jobs."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator
from functools import partial

from plcgen.ds47.proof.words import DONE, WORDS
from plcgen.proof.scenario import ScenarioError
from tests.engine.errands import READ_SPLIT, TRIGGER, WRITE_SPLIT, Errand
from tests.engine.field import JobField
from tests.engine.mailboxes import ORDERS, three
from tests.engine.partner import STATE_CONFLICT
from tests.engine.scenario import EngineScenario

Run = Callable[[JobField], None]
PARTS = (("Unit1", ""), ("Channel1", ""), ("Job1", ""), ("Job1", "statTicket"), ("Gate", ""), ("GateData", ""))
"""What is loaded: data block, and the part of it."""
ENDS = frozenset(
    WORDS[word] for word in ("DONE", "LOST", "SLOT_TAKEN", "OCCUPIED", "UNKNOWN", "STILL_DRAINING", "IDLE", "NO_SLOT")
)
"""How a job may end whose unit, channel, gate or ticket was loaded again."""
SCANS = range(1, 34)
WITHIN = 12_000
"""Time in ms within which everything has ended: LEASE twice, DRAIN_LIMIT, a job."""


def restarts(*, classic: bool, thorough: bool = False) -> Iterator[tuple[str, Run]]:
    """Names and procedures; ``thorough`` loads every set of blocks behind every scan."""
    yield "first reference after a start", partial(_first_reference, classic=classic)
    for kind in ("warm", "lost"):
        yield f"{kind} with three jobs on one unit", partial(_together, kind)
    yield "channel loaded while nobody else waits", _load_alone
    for at in (3, 4, 5):
        yield f"channel loaded after scan {at} of the first job of the last slot", partial(_load_first, at)
    for errand in (READ_SPLIT, WRITE_SPLIT, TRIGGER):
        for count in range(1, len(PARTS)):
            for parts in itertools.combinations(PARTS, count):
                if (PARTS[2] in parts and PARTS[3] in parts) or not (thorough or _chosen(errand, parts)):
                    continue
                shown = ", ".join(f"{name}.{part}".rstrip(".") for name, part in parts)
                scans = SCANS if thorough else SCANS[:: 1 if count == 1 else 3]
                yield f"{errand.key}: {shown} loaded", partial(_load, errand, parts, scans)
        yield f"{errand.key}: who holds the unit is lost", partial(_load, errand, (("Unit1", "unit.turn"),), SCANS)


def _chosen(errand: Errand, parts: tuple[tuple[str, str], ...]) -> bool:
    """One block alone; of jobs that write two, and all."""
    return len(parts) == 1 if errand is READ_SPLIT else len(parts) in {1, 2, 5}


def _first_reference(field: JobField, *, classic: bool) -> None:
    """On S7-1200/1500 it comes from the milliseconds of the clock (255 and 510 count as 0), on S7-300/400 it is 1."""
    for at in (0, 100, 245, 254, 255, 500, 700, 990):
        field.cpu.restart("cold")
        field.rig.begin(EngineScenario(name="start"))
        field.rig.call(ORDERS[0])
        field.give(1, READ_SPLIT)
        field.step(at - field.cpu.clock % 1000 + 1000)
        field.start(1)
        begun = field.cpu.clock
        field.expect(field.until_end((1,)), {1: (DONE,)})
        sent = next(e.data[0] for e in field.rig.drives[0].journal if e.direction == "write")
        within = range(begun, begun + 50, 10)
        if sent not in ({1} if classic else {ms % 1000 % 255 + 1 for ms in within}):
            raise ScenarioError(f"the first reference {begun % 1000} ms after a full second is {sent}")
        field.idle(1)


def _together(kind: str, field: JobField) -> None:
    """Every job ends well: none of them is a trigger."""
    three(field)
    field.rig.call(ORDERS[0])
    field.step()
    for at in range(1, 60):
        field.start(1, 2, 3)
        field.steps(at)
        if kind == "warm":
            field.cpu.restart("warm")
        else:
            field.cpu.drop_records()
        field.done(1, 2, 3)
        field.wire()
        field.idle(1, 2, 3)


def _load_alone(field: JobField) -> None:
    """Behind each scan of a job: it is told, and the unit is free at once."""
    three(field)
    field.rig.call(ORDERS[0])
    field.tolerated = ("PG830",)
    field.step()
    for at in SCANS:
        field.start(1)
        field.steps(at)
        _told(field, 1, at)
        field.drop(1)
        field.steps(10)
        field.again(1)


def _told(field: JobField, number: int, at: int) -> None:
    """The channel is loaded again: the job ends, and how is right."""
    field.rig.load("Channel1")
    status = field.until_end((number,), most=WITHIN)[number]
    if status not in ENDS - {WORDS["NO_SLOT"]}:
        raise ScenarioError(f"job {number}, its channel loaded after scan {at}, ends with 16#{status:04X}")


def _load_first(at: int, field: JobField) -> None:
    """The order has the number 1, which is below that of its slot: it is told all the same, and not done twice."""
    three(field)
    slots = field.rig.engine.sizes.slots
    field.rig.plan.set("slots", slots)
    field.give(3, TRIGGER, slot=slots, drive_object=4)
    field.rig.call(ORDERS[0])
    field.tolerated = ("PG830",)
    field.step()
    field.start(3)
    field.steps(at)
    _told(field, 3, at)
    if field.times_sent(3) > 1:
        raise ScenarioError(f"a trigger was sent twice, its channel loaded after scan {at}")


def _load(errand: Errand, parts: tuple[tuple[str, str], ...], scans: range, field: JobField) -> None:
    """Behind each scan of a job: nothing wrong is sent, everything ends, the next jobs work."""
    three(field)
    field.tolerated = ("PG830",)  # who loads the data block changes RECORD of a running WRREC
    for at in scans:
        field.rig.call(ORDERS[at % len(ORDERS)])
        field.give(1, errand)
        field.rig.begin(EngineScenario(name="load", reads={1: STATE_CONFLICT}))
        field.steps(3)
        field.start(1)
        field.step()
        field.start(2)
        field.steps(at)
        if at % 11 == 10:
            field.step(200)
        for name, part in parts:
            field.rig.load(name, part)
        loaded = ("Job1", "") in parts
        if loaded:
            field.give(1, errand)
            for number, request in enumerate(field.job(1).requests(), 1):
                field.job(1).db.put(f"letters[{number}].request", request)
            if not errand.once:
                field.job(1).db.set("execute", 1)
        waiting = (2,) if loaded and errand.once else (1, 2)
        found = field.until_end(waiting, most=WITHIN)
        for number, status in found.items():
            if status not in ENDS:
                raise ScenarioError(f"job {number}, loaded after scan {at}, ends with 16#{status:04X}")
            if status == DONE and field.job(number).db.flag("execute"):
                field.right(number)
        field.wire()
        if errand.once and field.times_sent(1) > 1 and ("Job1", "statTicket") not in parts:
            raise ScenarioError(f"a trigger was sent twice, loaded after scan {at}")
        field.drop(1, 2)
        for _ in range(350):
            field.step(20 if field.rig.units[0].get("state") else 0)
            if not field.rig.units[0].get("state") and not field.job(1).signals()[0]:
                break
        field.again(1, 2, 3)
