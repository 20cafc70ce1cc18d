"""Restart of the CPU and download of data blocks in the middle of jobs."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator
from functools import partial

from plcgen.proof.scenario import ScenarioError
from plcgen.protocols.ds47.proof.engine.errands import READ_SPLIT, TRIGGER, WRITE_SPLIT, Errand
from plcgen.protocols.ds47.proof.engine.field import JobField
from plcgen.protocols.ds47.proof.engine.mailboxes import ORDERS, three
from plcgen.protocols.ds47.proof.engine.partner import STATE_CONFLICT
from plcgen.protocols.ds47.proof.engine.scenario import EngineScenario
from plcgen.protocols.ds47.proof.words import DONE, WORDS

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


def restarts(*, thorough: bool = False) -> Iterator[tuple[str, Run]]:
    """Names and procedures; ``thorough`` loads every set of blocks behind every scan."""
    for kind in ("warm", "lost"):
        yield f"{kind} with three jobs on one unit", partial(_together, kind)
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


def _together(kind: str, field: JobField) -> None:
    """Every job ends well: none of them is a trigger."""
    three(field)
    field.rig.call(ORDERS[0])
    field.step()
    for at in range(1, 60):
        field.start(1, 2, 3)
        for _ in range(at):
            field.step()
        if kind == "warm":
            field.cpu.restart("warm")
        else:
            field.cpu.drop_records()
        field.expect(field.until_end((1, 2, 3)), dict.fromkeys((1, 2, 3), (DONE,)))
        field.right(1, 2, 3)
        field.wire()
        field.idle(1, 2, 3)


def _load(errand: Errand, parts: tuple[tuple[str, str], ...], scans: range, field: JobField) -> None:
    """Behind each scan of a job: nothing wrong is sent, everything ends, the next jobs work."""
    three(field)
    field.tolerated = ("PG830",)  # who loads the data block changes RECORD of a running WRREC
    for at in scans:
        field.rig.call(ORDERS[at % len(ORDERS)])
        field.give(1, errand)
        field.rig.begin(EngineScenario(name="load", reads={1: STATE_CONFLICT}))
        for _ in range(3):
            field.step()
        field.start(1)
        field.step()
        field.start(2)
        for _ in range(at):
            field.step()
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
                raise ScenarioError(f"job {number}, loaded behind scan {at}, ends with 16#{status:04X}")
            if status == DONE and field.job(number).db.flag("execute"):
                field.right(number)
        field.wire()
        sent = [e.data[1:] for e in field.rig.drives[0].journal if e.direction == "write" and not e.status]
        if errand.once and sent.count(field.job(1).requests()[0][1:]) > 1 and ("Job1", "statTicket") not in parts:
            raise ScenarioError(f"a trigger was sent twice, loaded behind scan {at}")
        field.drop(1, 2)
        for _ in range(350):
            field.step(20 if field.rig.units[0].get("state") else 0)
            if not field.rig.units[0].get("state") and not field.job(1).signals()[0]:
                break
        field.again(1, 2, 3)
