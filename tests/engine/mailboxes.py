"""Jobs that share a unit: who is served when, slots, limits, and those that are not called any more."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial
from itertools import product

from plcgen.ds47.proof.words import CALLS_LIMIT, COUNTERS, DONE, GRANT, LEASE_MS, PAUSE, WORDS, state_name
from plcgen.proof.rig import Members
from plcgen.proof.scenario import STARTED, ScenarioError
from tests.engine.errands import READ_SPLIT, TRIGGER, WRITE_SPLIT, Errand
from tests.engine.field import ALL, JobField
from tests.engine.partner import STATE_CONFLICT
from tests.engine.scenario import EngineScenario

OFFSETS = 14
RUNS = 9
"""Scans in which a job of two telegrams with busy calls runs at least."""
STUCK = ("without a place", "WRREC has no resources", "no answer comes")
"""What a job may wait for longer than LEASE."""
NO_RESOURCES = 0xC080C300
FREES = 2
"""Calls of the channel after which a unit is free that its job has lost."""
ORDERS = ((1, 2, 5, 6, 7), (7, 6, 5, 2, 1), (5, 2, 6, 1, 7))
Run = Callable[[JobField], None]


def mailboxes() -> Iterator[tuple[str, Run]]:
    """Names and procedures."""
    for order in ORDERS:
        yield f"start offsets of three jobs, called in the order {order}", partial(_offsets, order)
        yield f"a slot used twice, called in the order {order}", partial(_twice, order)
    yield "order of service", _order
    yield "wait limit", _wait_limit
    yield "wait limit of the first slot, to the millisecond", _wait_limit_exact
    yield "no such slot", _no_slot
    yield "counters wrap", _wrap
    for conflicts in (0, 1):
        yield f"a job is not called any more, {conflicts} retries", partial(_silent_job, conflicts)
        yield f"a channel is not called any more, {conflicts} retries", partial(_silent_channel, conflicts)
    yield "the next job has the sign of life of the silent one", _same_mark
    yield "a job starts again while its channel is not called", _waits_anew_for_the_channel
    for stuck in STUCK:
        yield f"a job is not called any more, {stuck}", partial(_stuck, stuck)
    yield "a job is not called any more, to the millisecond", _lease
    yield "no answer comes, to the millisecond", _silence
    yield "scans of 0 ms", _no_time
    yield "execute comes again with the end", _at_once
    for fast, calls in product((True, False), ((2,), (1, 2), (2, 5), (1, 2, 5))):
        where = "more" if fast else "less"
        yield f"{calls} are called {where} often than the rest", partial(_two_levels, calls, fast=fast)


def three(field: JobField) -> None:
    """Three jobs on three drive objects of one unit: two reads and a write."""
    field.give(1, READ_SPLIT, slot=1)
    field.give(2, WRITE_SPLIT, slot=3, drive_object=3)
    field.give(3, READ_SPLIT, slot=4, drive_object=4)


def _offsets(order: tuple[int, ...], field: JobField) -> None:
    three(field)
    field.rig.call(order)
    field.step()
    for one, other in product(range(0, OFFSETS, 2), range(1, OFFSETS, 3)):
        starts = {1: 0, 2: one, 3: other}
        for scan in range(OFFSETS):
            field.start(*(number for number, at in starts.items() if at == scan))
            field.step()
        field.done(1, 2, 3)
        field.wire()
        field.idle(1, 2, 3)


def _twice(order: tuple[int, ...], field: JobField) -> None:
    three(field)
    field.rig.call(order)
    field.step()
    taken = WORDS["SLOT_TAKEN"]
    for offset in range(RUNS):
        for number in (1, 2):
            field.job(number).db.set("slot", 2)
        field.start(1)
        field.steps(offset)
        field.start(2)
        field.expect(field.until_end((1, 2)), {1: (taken,), 2: (taken,)})
        field.wire()
        field.job(2).db.set("slot", 3)
        field.again(1, 2)


def _order(field: JobField) -> None:
    """While a job waits, none of the others has the unit twice."""
    three(field)
    field.rig.call(ORDERS[0])
    field.step()
    since: dict[int, dict[int, int]] = {}
    slot_of = {1: 1, 2: 3, 3: 4}
    before, served = 0, dict.fromkeys(slot_of, 0)
    for scan in range(1500):
        for number in slot_of:
            job = field.job(number)
            if not job.signals()[0]:
                if job.db.flag("execute"):
                    field.expect({number: job.signals()[3]}, {number: (DONE,)})
                    served[number] += 1
                    field.drop(number)
                elif scan % (number + 1) == 0:
                    field.start(number)
                    since[number] = dict.fromkeys(slot_of.values(), 0)
        field.step()
        grant = field.rig.units[0].get("turn.grant")
        if grant != before and grant:
            holder = grant // GRANT
            for number, passed in since.items():
                passed[holder] += 1
                if slot_of[number] != holder and passed[holder] > 1 and not passed[slot_of[number]]:
                    raise ScenarioError(f"job {number} was passed twice by the one with slot {holder}")
        before = grant
    if min(served.values()) < 10 or max(served.values()) > min(served.values()) + 2:
        raise ScenarioError(f"jobs were served {served} times")


def _wait_limit(field: JobField) -> None:
    """The unit is held for 4000 ms; jobs 2 and 3 wait for 2000 ms each, from when they ask."""
    three(field)
    field.rig.call(ORDERS[0])
    field.rig.plan.set("waitLimit", 2000)
    field.rig.bus.write_busy = 400
    field.step()
    field.start(1)
    field.steps(30)
    field.rig.bus.write_busy = 1
    began = {}
    for number in (2, 3):
        field.start(number)
        began[number] = field.cpu.clock
        field.steps(50)
    for number in (2, 3):
        field.expect(field.until_end((number,)), {number: (WORDS["OCCUPIED"],)})
        waited = field.cpu.clock - began[number]
        if not 2000 <= waited <= 2050:
            raise ScenarioError(f"job {number} waited {waited} ms instead of 2000")
    field.expect(field.until_end((1,)), {1: (DONE,)})
    field.wire()
    field.idle(1, 2, 3)
    field.again(1, 2, 3)
    _waits_anew(field)


def _wait_limit_exact(field: JobField) -> None:
    """The job of slot 1 hears it when the limit is over, not a millisecond before."""
    three(field)
    field.give(2, WRITE_SPLIT, slot=3, drive_object=3, timeout=60_000)
    field.rig.call(ORDERS[0])
    field.rig.plan.set("waitLimit", 2000)
    field.step()
    field.start(1)
    field.expect(field.until_end((1,)), {1: (DONE,)})
    field.drop(1)
    field.rig.bus.write_busy = 700
    field.start(2)
    field.steps(100)  # a slot that was served and does not ask does not wait
    for _ in range(2):  # the second one waits in a slot that has waited before
        field.start(1)
        for length in (*[0] * FREES, *[10] * 199, 9, *[0] * FREES):
            field.step(length)
            if not field.job(1).signals()[0]:
                raise ScenarioError("a job hears that the unit is taken before the wait limit is over")
        field.step(1)
        field.steps(FREES, 0)
        field.expect(field.statuses(1), {1: (WORDS["OCCUPIED"],)})
        field.drop(1)
        field.step()
    field.rig.bus.write_busy = 1
    field.expect(field.until_end((2,)), {2: (DONE,)})
    field.again(1, 2, 3)


def _waits_anew(field: JobField) -> None:
    """What a job waited does not count for the next one in its slot."""
    for _ in range(3):
        field.rig.bus.write_busy = 150
        field.start(1)
        field.steps(5)
        field.start(2)
        field.steps(3)
        field.rig.bus.write_busy = 1
        field.expect(field.until_end((1, 2)), {1: (DONE,), 2: (DONE,)})
        field.idle(1, 2)


def _no_slot(field: JobField) -> None:
    three(field)
    # before the first call of the channel nobody knows how many it has: it is waited for
    field.rig.call((5, 1))
    field.start(1)
    field.expect(field.until_end((1,)), {1: (WORDS["NOT_CALLED"],)})
    field.job(1).db.set("slot", slots := field.rig.engine.sizes.slots)
    loaded = Members(field.cpu, field.rig.program, "Unit1", ("unit.turn.slotCount",))
    for count in (slots - 1, 1):
        field.drop(1)
        field.rig.call((5, 1))
        field.step()
        loaded.set("unit.turn.slotCount", 0)
        field.rig.plan.set("slots", count)
        field.start(1)
        field.step()
        field.expect(field.statuses(1), {1: (STARTED,)})
        field.rig.call(ORDERS[0])
        field.step()
        field.expect(field.statuses(1), {1: (WORDS["NO_SLOT"],)})
    field.rig.plan.set("slots", 4)
    for slot in (0, -1, -30000, 5, max(5, slots), slots + 1, 32767):
        field.drop(1)
        field.steps(3)
        field.job(1).db.set("slot", slot)
        field.start(1)
        field.step()
        if field.job(1).signals() != (False, False, True, WORDS["NO_SLOT"]):
            raise ScenarioError(f"slot {slot} gives 16#{field.job(1).signals()[3]:04X}")
    if field.rig.drives[0].journal:
        raise ScenarioError("a job without a slot was served")
    for count, slot, good in ((0, 1, True), (0, 2, False), (-5, 1, True), (99, slots, True)):
        field.idle(1)
        field.rig.plan.set("slots", count)
        field.step()
        field.job(1).db.set("slot", slot)
        field.start(1)
        field.step()
        field.expect(field.statuses(1), {1: (STARTED if good else WORDS["NO_SLOT"],)})
        field.expect(field.until_end((1,)), {1: (DONE if good else WORDS["NO_SLOT"],)})


def _wrap(field: JobField) -> None:
    """Numbers of orders and requests for places and signs of life just before they begin again, at 1."""
    three(field)
    field.rig.call(ORDERS[0])
    field.step()
    unit, gate = field.rig.units[0], field.rig.gate
    channel = Members(field.cpu, field.rig.program, "Channel1", ("statAsk",))
    for at in (COUNTERS - 4, COUNTERS - 1, COUNTERS):
        unit.set("turn.beat", at)
        channel.set("statAsk", at)
        for slot in (1, 3, 4):
            unit.set(f"asks[{slot}].want", -at)
            unit.set(f"asks[{slot}].mark", at)
            unit.set(f"ended[{slot}]", at)
        wants: list[int] = []
        seen: dict[str, set[int]] = {"beat": set(), "mark": set(), "ask": set()}
        for _ in range(6):
            field.start(1, 2, 3)
            for _ in range(40):
                field.step()
                seen["beat"].add(unit.get("turn.beat"))
                seen["mark"].add(unit.get("asks[1].mark"))
                seen["ask"].add(gate.get("channels[1].ask") or 1)
            field.done(1, 2, 3)
            wants.append(-unit.get("asks[3].want", signed=True))
            field.idle(1, 2, 3)
        if wants != [(at + n) % COUNTERS + 1 for n in range(6)]:
            raise ScenarioError(f"orders count {wants}")
        for name, numbers in seen.items():
            if not {1, at % COUNTERS + 1} <= numbers or max(numbers) > COUNTERS:
                raise ScenarioError(f"{name} counts {sorted(numbers)}")


def _running(conflicts: int, step: int, field: JobField) -> Iterator[tuple[Errand, int]]:
    """What job 1 does, and each number of scans behind which it still runs."""
    reads = dict.fromkeys(range(1, conflicts + 1), STATE_CONFLICT)
    for errand, calls in product((READ_SPLIT, TRIGGER), range(1, 14 + 20 * conflicts, step)):
        three(field)
        field.give(1, errand)
        field.rig.call(ORDERS[0])
        field.rig.begin(EngineScenario(name="silent", reads=reads))
        field.step()
        field.start(1)
        field.steps(calls)
        if field.job(1).signals()[0]:
            yield errand, calls
        else:
            field.idle(1)


def _silent_job(conflicts: int, field: JobField) -> None:
    """Behind each scan of a run; the unit is free after LEASE, the next job works, the silent one has lost."""
    for errand, calls in _running(conflicts, 1 + conflicts, field):
        field.rig.call((1, 2, 6, 7))
        began = field.cpu.clock
        field.start(2)
        field.expect(field.until_end((2,)), {2: (DONE,)})
        took = field.cpu.clock - began
        if not LEASE_MS - 200 <= took <= LEASE_MS + 700:
            raise ScenarioError(f"a job that was silent after {calls} scans blocked the unit for {took} ms")
        field.right(2)
        if errand.once and field.times_sent(1) > 1:
            raise ScenarioError("a trigger was sent twice")
        field.rig.call(ORDERS[0])
        field.expect(field.until_end((1,)), {1: (WORDS["LOST"], WORDS["OCCUPIED"])})
        field.wire()
        field.idle(1, 2)
        field.again(1, 2)


def _waits_anew_for_the_channel(field: JobField) -> None:
    """Behind NOT_CALLED the next start waits CALLS_LIMIT calls again, and works if the channel comes back meanwhile."""
    three(field)
    field.rig.call(ORDERS[0])
    field.step()
    field.rig.call((1, 5, 6, 7))
    for seen in (False, True):
        field.start(1)
        field.step()
        before = field.scans
        field.expect(field.until_end((1,)), {1: (WORDS["NOT_CALLED"],)})
        _heard(field.scans - before, seen=seen)
        field.drop(1)
        field.step()
    field.start(1)
    field.steps(CALLS_LIMIT // 2)
    if not field.job(1).signals()[0]:
        raise ScenarioError(f"the next start ends at once with 16#{field.job(1).signals()[3]:04X}")
    field.rig.call(ORDERS[0])
    field.done(1)
    field.idle(1)


def _same_mark(field: JobField) -> None:
    """Signs of life are numbers: the next job may have the last one of the job that is gone, and is there."""
    three(field)
    field.rig.call(ORDERS[0])
    unit = field.rig.units[0]
    channel = Members(field.cpu, field.rig.program, "Channel1", ("statMark",))
    field.step()
    field.start(1)
    field.steps(5)
    field.rig.call((1, 2, 6, 7))
    field.start(2)
    for _ in range(2 * LEASE_MS // 10):
        field.step()
        if unit.get("turn.grant") // GRANT == 3:
            break
    channel.set("statMark", unit.get("asks[3].mark"))
    field.done(2)
    field.rig.call(ORDERS[0])
    field.expect(field.until_end((1,)), {1: (WORDS["LOST"],)})
    field.idle(1, 2)


def _stuck(stuck: str, field: JobField) -> None:
    """Whatever the job of 60 s waits for: behind LEASE the unit and its place are free, and nothing more is sent."""
    three(field)
    field.give(1, READ_SPLIT, timeout=60_000).times(60_000, 200, 1000)
    field.rig.call((2, 5, 6, 7) if stuck == STUCK[0] else ORDERS[0])
    writes = {0: NO_RESOURCES} if stuck == STUCK[1] else {}
    reads = {0: STATE_CONFLICT} if stuck == STUCK[2] else {}
    unit = field.rig.units[0]
    for scans in range(30, 70, 7):
        field.rig.begin(EngineScenario(name="stuck", writes=writes, reads=reads))
        field.step()
        field.start(1)
        field.steps(scans)
        field.rig.call((2, 6, 7) if stuck == STUCK[0] else (1, 2, 6, 7))
        began = field.cpu.clock
        while unit.get("state") and field.cpu.clock - began < 2 * LEASE_MS:
            field.step()
        took = field.cpu.clock - began
        if not LEASE_MS - 200 <= took <= LEASE_MS + 100 or field.rig.gate.get("channels[1].ask"):
            raise ScenarioError(f"a job that is gone, {stuck}, has the unit for {took} ms")
        count = len(field.rig.drives[0].journal)
        field.steps(50)
        if len(field.rig.drives[0].journal) != count:
            raise ScenarioError("something is sent for a job that is gone")
        field.rig.begin(EngineScenario(name="again"))
        field.rig.call(ORDERS[0])
        field.expect(field.until_end((1,)), {1: (WORDS["LOST"],)})
        field.again(2, 3)
        field.idle(1)
        field.rig.call((2, 5, 6, 7) if stuck == STUCK[0] else ORDERS[0])


def _lease(field: JobField) -> None:
    """The unit is free LEASE after the channel saw the last sign of life, not a millisecond before."""
    three(field)
    field.give(1, READ_SPLIT, timeout=60_000).times(60_000, 200, 1000)
    unit = field.rig.units[0]
    field.rig.begin(EngineScenario(name="lease", writes={0: NO_RESOURCES}))
    field.rig.call(ORDERS[0])
    field.step()
    field.start(1)
    field.steps(15)
    field.rig.call((1, 2, 6, 7))
    for length in (*[10] * (LEASE_MS // 10), 9, *[0] * FREES, 1):
        if not unit.get("turn.grant"):
            raise ScenarioError(f"the unit is free before {LEASE_MS} ms are over")
        field.step(length)
    field.steps(FREES, 0)
    if unit.get("turn.grant"):
        raise ScenarioError(f"the unit is not free when {LEASE_MS} ms are over")


def _silence(field: JobField) -> None:
    """The request counts as lost a third of the timeout after it was taken, not a millisecond before."""
    three(field)
    field.give(1, READ_SPLIT, timeout=3000).times(3000, 100, 1000)
    field.rig.call(ORDERS[0])
    for pauses, times in (([111] * 9, 1), ([100] * 10, 2)):  # the last of these answers comes after 999 and 1000 ms
        field.rig.begin(EngineScenario(name="silence", reads={0: STATE_CONFLICT}))
        field.step(0)
        field.start(1)
        for length in (0, *pauses, 100):
            field.step(length)
            _until_pause(field)
        if field.times_sent(1) != times:
            raise ScenarioError(f"after {sum(pauses)} ms without an answer it was sent {field.times_sent(1)} times")
        field.rig.begin(EngineScenario(name="again"))
        field.expect(field.until_end((1,)), {1: (DONE,)})
        field.idle(1)


def _until_pause(field: JobField) -> None:
    """Scans of 0 ms until the channel pauses."""
    for _ in range(40):
        if field.rig.units[0].get("state") == PAUSE:
            return
        field.step(0)
    raise ScenarioError(f"no pause, the channel is in {state_name(field.rig.units[0].get('state'))}")


def _no_time(field: JobField) -> None:
    """Scans in which the clock stands still, as on a CPU with a cycle below a millisecond: nothing runs out."""
    three(field)
    field.give(1, READ_SPLIT, timeout=100).times(100, 20, 1000)
    field.rig.begin(EngineScenario(name="no time", reads={0: STATE_CONFLICT}))
    field.rig.call(ORDERS[0])
    field.step()
    field.start(1)
    began = field.cpu.clock
    field.steps(10, 0)
    count = len(field.rig.drives[0].journal)
    field.steps(300, 0)
    if not field.job(1).signals()[0] or len(field.rig.drives[0].journal) != count:
        raise ScenarioError("time passes although the clock stands still")
    field.expect(field.until_end((1,)), {1: (WORDS["TIMEOUT"],)})
    took = field.cpu.clock - began
    if not 100 <= took <= 120:
        raise ScenarioError(f"the job took {took} ms instead of 100")
    field.idle(1)


def _at_once(field: JobField) -> None:
    """Execute falls while the job runs, and rises in the call behind its end: nothing of that job is left.

    Also if its channel has not been called since, and does not know of the end.
    """
    three(field)
    field.rig.call(ORDERS[0])
    ends = (0, DONE), (0xDF809000, WORDS["WRITE_ERROR"])
    for (status, word), called in product(ends, (ORDERS[0], (5,))):
        field.rig.begin(EngineScenario(name="at once", writes={1: status}))
        field.step()
        field.start(1)
        field.step()
        field.drop(1)
        field.expect(field.until_end((1,)), {1: (word,)})
        field.rig.begin(EngineScenario(name="again"))
        field.start(1)
        field.rig.call(called)
        field.step()
        field.rig.call(ORDERS[0])
        if field.job(1).signals() != (True, False, False, STARTED):
            raise ScenarioError(f"busy, done, error and status of the next job are {field.job(1).signals()}")
        field.done(1)
        field.idle(1)


def _silent_channel(conflicts: int, field: JobField) -> None:
    """Behind each scan of a run; the job hears it after CALLS_LIMIT calls, and works again when the channel does."""
    for errand, calls in _running(conflicts, 1 + 6 * conflicts, field):
        field.rig.call((1, 5, 6, 7))
        before = field.scans
        found = field.until_end((1,))
        _heard(field.scans - before, seen=calls > 1)
        field.expect(found, {1: (WORDS["NOT_CALLED"],)})
        field.rig.call(ORDERS[0])
        field.steps(20, 500)
        field.wire()
        sent = [e for e in field.rig.drives[0].journal if e.direction == "write"]
        if errand.once and len(sent) > 1:
            raise ScenarioError("a trigger was sent twice")
        field.idle(1)
        field.again(1, 2, 3)


def _heard(calls: int, *, seen: bool) -> None:
    """In the first call behind CALLS_LIMIT ones; a sign of life that the job has not ``seen`` yet takes one more."""
    if calls != CALLS_LIMIT + (1 if seen else 2):
        raise ScenarioError(f"it took {calls} calls until the job heard that nobody calls the channel")


def _two_levels(calls: tuple[int, ...], field: JobField, *, fast: bool) -> None:
    """Some are called three times as often as the others, or a third as often."""
    three(field)
    rest = tuple(number for number in ALL if number not in calls)
    field.rig.call(rest, calls)
    field.step()
    field.step(block="OB35")
    for number in range(12):
        for drive in field.rig.drives:
            drive.journal.clear()
        field.start(1, 2, 3)
        for scan in range(800):
            slow = "OB1" if fast else "OB35"
            field.step(10, block=slow if scan % 3 == number % 3 else "OB35" if fast else "OB1")
            if set(field.statuses(1, 2, 3).values()) == {DONE}:
                break
        field.expect(field.statuses(1, 2, 3), dict.fromkeys((1, 2, 3), (DONE,)))
        field.right(1, 2, 3)
        field.wire()
        field.drop(1, 2, 3)
        for scan in range(12):
            field.step(10, block="OB35" if scan % 2 else "OB1")
