"""The gate: as many record jobs at once as there are places, in turn, whoever is called how often."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial

from plcgen.ds47.proof.words import DONE, GATE, LEASE_MS, READ, STEP_MS, WORDS, WRITE
from plcgen.proof.rig import Source
from plcgen.proof.scenario import ScenarioError
from tests.engine.errands import READ_ONE, READ_SPLIT, WRITE_SPLIT
from tests.engine.field import JobField
from tests.engine.stimulus import SHARED_PLACE

CALLS = (1, 2, 3, 4, 5, 8, 9)
"""The gate, three channels, a job of each unit."""
JOBS = (1, 4, 5)
GATE_CALL = CALLS[0]
MANY = 32
"""Channels of a gate that every engine has room for."""
NO_RESOURCE = 0x80C3
IN_TIME = 3
"""Calls of the gate within which a channel that waits has a free place, those behind LEASE included."""
Run = Callable[[JobField], None]


def places() -> Iterator[tuple[str, Run]]:
    """Names and procedures."""
    for count in (1, 2, 3):
        for calls in (CALLS, CALLS[::-1], (5, 2, 1, 8, 3, 9, 4)):
            yield f"{count} places for three channels, called in the order {calls}", partial(_never_more, count, calls)
    for gate in ("OB1", "OB35"):
        yield f"channels in OB1 get their turns beside one in OB35, the gate is in {gate}", partial(_fair, gate)
    for state in (GATE, WRITE, READ):
        yield f"a channel that is not called any more in state {state}", partial(_dead, state)
    yield "a channel that is not called any more, to the millisecond", _lease
    yield "the gate is not called", _no_gate
    yield "nobody asks for a place", _nobody
    yield "numbers of channels and places", _numbers
    yield "two channels have one place", _twice


def _three(field: JobField) -> None:
    """A job of each unit."""
    for number, errand in zip(JOBS, (READ_SPLIT, WRITE_SPLIT, READ_ONE), strict=True):
        field.give(number, errand)


def restless(field: JobField, served: dict[int, int]) -> None:
    """Jobs that have ended well are started again."""
    for number in JOBS:
        job = field.job(number)
        busy, done, error, status = job.signals()
        if error:
            raise ScenarioError(f"job {number} ends with 16#{status:04X}")
        if done and job.db.flag("execute"):
            field.right(number)
            served[number] += 1
            field.drop(number)
        elif not busy and not job.db.flag("execute") and not done:
            field.start(number)


def _never_more(count: int, calls: tuple[int, ...], field: JobField) -> None:
    """As many record jobs as places, never more; no channel is passed twice; the CPU never has to refuse one."""
    _three(field)
    field.rig.plan.set("places", count)
    field.rig.call(calls)
    field.rig.bus.write_busy, field.rig.bus.read_busy = 3, 2
    served = dict.fromkeys(JOBS, 0)
    field.step()
    free = 0
    for _ in range(1500):
        restless(field, served)
        field.step()
        if field.cpu.jobs > count:
            raise ScenarioError(f"{field.cpu.jobs} record jobs at {count} places")
        granted = sum(bool(field.rig.gate.get(f"channels[{n}].grant")) for n in (1, 2, 3))
        if granted > count:
            raise ScenarioError(f"{granted} channels have one of {count} places")
        waits = any(
            field.rig.gate.get(f"channels[{n}].ask") and not field.rig.gate.get(f"channels[{n}].grant")
            for n in (1, 2, 3)
        )
        free = free + 1 if waits and granted < count else 0
        if free > IN_TIME:
            raise ScenarioError(f"a channel waits although {count - granted} places are free")
        if any(unit.get("recordStatus") >> 8 & 0xFFFF == NO_RESOURCE for unit in field.rig.units):
            raise ScenarioError("the CPU refused a record job")
    # a turn is for one telegram: a job of two has half as many, unless there is a place for each
    if min(served.values()) < 15 or served[1] + 2 < served[4] or served[4] + 2 < served[1]:
        raise ScenarioError(f"jobs were served {served} times")
    if served[5] + 2 < (2 if count < 3 else 1) * served[1]:
        raise ScenarioError(f"jobs were served {served} times")


def _fair(gate: str, field: JobField) -> None:
    """One place; unit 1 in OB35 every 10 ms, the others in OB1 every 30 ms."""
    _three(field)
    field.rig.plan.set("places", 1)
    rest, fast = (3, 4, 8, 9), (2, 5)
    field.rig.call((1, *rest) if gate == "OB1" else rest, fast if gate == "OB1" else (1, *fast))
    served = dict.fromkeys(JOBS, 0)
    field.step()
    field.step(block="OB35")
    for scan in range(3000):
        restless(field, served)
        field.step(block="OB35")
        if scan % 3 == 0:
            field.step(0)
        if field.cpu.jobs > 1:
            raise ScenarioError("two record jobs at one place")
    # a place is for one record job: a job of two telegrams needs four of them, that of one telegram two
    if min(served.values()) < 20 or served[1] > 3 * served[4]:
        raise ScenarioError(f"jobs were served {served} times")


def _dead(state: int, field: JobField) -> None:
    """A channel with the only place is not called any more: others have it after LEASE, or twice that at most."""
    _three(field)
    field.rig.plan.set("places", 1)
    field.rig.call(CALLS)
    field.rig.bus.write_busy = field.rig.bus.read_busy = 5
    field.step()
    for delay in (0, 500, 1500, 2500):
        field.steps(delay // 10)
        field.start(1)
        for _ in range(60):
            field.step()
            if field.rig.units[0].get("state") == state and field.rig.gate.get("channels[1].grant"):
                break
        else:
            if state != GATE:
                raise ScenarioError("the state was not reached")
        field.rig.call((1, 3, 4, 5, 8, 9))
        began = field.cpu.clock
        field.start(4)
        field.expect(field.until_end((4,)), {4: (DONE,)})
        took = field.cpu.clock - began
        if not (0 if state == GATE else LEASE_MS - 200) <= took <= 2 * LEASE_MS + 1000:
            raise ScenarioError(f"it took {took} ms until another channel had its place")
        field.right(4)
        field.drop(4)
        field.rig.call(CALLS)
        field.steps(400, 20)
        field.wire()
        field.idle(1, 4)
        field.again(1, 4, 5)


def _lease(field: JobField) -> None:
    """A place is free LEASE after the gate has looked at its channel, not a millisecond before.

    It looks every LEASE, and takes the place of the first channel away then; the second one is called for the last time
    in the same scan.
    """
    _three(field)
    field.rig.plan.set("places", 2)
    field.rig.call(CALLS)
    field.rig.bus.write_busy = 5000
    field.step()
    field.start(1, 4)
    field.steps(10)
    first, second = (f"channels[{number}].grant" for number in (1, 2))
    field.rig.call((3, 1))
    while field.rig.gate.get(first):
        field.step()
    field.rig.call((1,))
    for length in (2 * STEP_MS, 10, *[0] * 50, STEP_MS - 10, LEASE_MS - 2 * STEP_MS - 1, 0):
        if not field.rig.gate.get(second):
            raise ScenarioError(f"the place is free before {LEASE_MS} ms are over")
        field.step(length)
    field.step(1)
    if field.rig.gate.get(second):
        raise ScenarioError(f"the place is not free when {LEASE_MS} ms are over")


def _nobody(field: JobField) -> None:
    """An idle scan is short: the gate looks at each channel once, with six statements at most."""
    _three(field)
    field.rig.call(CALLS)
    field.rig.plan.set("channels", MANY)
    field.again(*JOBS)
    field.rig.call((GATE_CALL,))
    program = field.rig.program
    file = Source(program, field.rig.engine.names["gate"]).file
    counted = zip(program.probes, program.link.counted_by, strict=True)
    own = [number for probe, number in counted if probe.file == file and probe.kind == "statement"]
    for _ in range(400):
        before = sum(field.cpu.counters[n] for n in own)
        field.step()
        passed = sum(field.cpu.counters[n] for n in own) - before
        if passed > 6 * MANY:
            raise ScenarioError(f"an idle gate of {MANY} channels runs {passed} statements")
    field.rig.call(CALLS)
    field.again(*JOBS)


def _no_gate(field: JobField) -> None:
    """Without a place a job ends when its time is over, here 2000 ms."""
    _three(field)
    field.give(1, READ_SPLIT, timeout=2000)
    field.rig.call((2, 5))
    field.start(1)
    began = field.cpu.clock
    field.expect(field.until_end((1,)), {1: (WORDS["NO_PLACE"],)})
    if not 2000 <= field.cpu.clock - began <= 2060:
        raise ScenarioError(f"it took {field.cpu.clock - began} ms instead of 2000")
    if field.rig.drives[0].journal:
        raise ScenarioError("something was sent without a place")
    field.idle(1)
    field.rig.call(CALLS)
    field.again(1, 4, 5)


def _numbers(field: JobField) -> None:
    """A number of channels beyond the gate is limited; without places nobody gets one."""
    _three(field)
    field.rig.call(CALLS)
    for channels, served in ((1, (1,)), (0, (1,)), (-7, (1,)), (2, (1, 4)), (30_000, JOBS)):
        field.rig.plan.set("channels", channels)
        field.again(*served)
    field.rig.plan.set("channels", 1)
    field.give(4, READ_ONE, timeout=2000)
    field.start(4)
    field.expect(field.until_end((4,)), {4: (WORDS["NO_PLACE"],)})
    field.idle(4)
    field.rig.plan.set("channels", 3)
    for count in (0, -1):
        field.rig.plan.set("places", count)
        field.give(1, READ_ONE, timeout=2000)
        field.start(1)
        field.expect(field.until_end((1,)), {1: (WORDS["NO_PLACE"],)})
        field.idle(1)
    for name in ("ask", "beat"):
        field.rig.gate.set(f"channels[1].{name}", 29_999)
    field.rig.plan.set("places", 4)
    for _ in range(3):
        field.again(*JOBS)


def _twice(field: JobField) -> None:
    """Nobody notices it, but nothing wrong is sent: every job is done, or hears in its time that there is no place."""
    _three(field)
    field.give(1, READ_SPLIT, timeout=2000)
    field.give(4, WRITE_SPLIT, timeout=2000)
    ends = (DONE, WORDS["NO_PLACE"])
    for calls in ((1, 2, SHARED_PLACE, 5, 8), (1, SHARED_PLACE, 2, 5, 8), (8, 5, SHARED_PLACE, 2, 1)):
        field.rig.call(calls)
        for offset in range(12):
            field.start(1)
            field.steps(offset)
            field.start(4)
            found = field.until_end((1, 4))
            field.expect(found, {1: ends, 4: ends})
            field.right(*(number for number, status in found.items() if status == DONE))
            field.wire()
            field.idle(1, 4)
    field.rig.call(CALLS)
    field.again(*JOBS)
