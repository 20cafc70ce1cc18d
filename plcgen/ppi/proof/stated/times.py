"""The times of a master, measured on the virtual clock against stations that stay silent; the rows of a report."""

from __future__ import annotations

from collections.abc import Iterator

from plcgen.base.diagnostics import Diagnostic, DiagnosticError
from plcgen.base.diagnostics.counting import quantity
from plcgen.oracles.spec.place import NotStatedError
from plcgen.oracles.spec.ppi.statement import CHARACTER_BITS, GAP_BITS, LONGEST_MESSAGE, PpiStatement
from plcgen.oracles.spec.ppi.stations import READ, HeardPoll
from plcgen.ppi.plan.nouns import PlannedMaster, PpiPlan
from plcgen.ppi.proof.stated.rig import MARGIN, PAGE, STEP, StatedBed, ports_of
from plcgen.ppi.proof.stated.values import hold_values
from plcgen.ppi.proof.words import DONE, WORDS
from plcgen.proof.checks import Check, Outcome
from plcgen.proof.scenario import ScenarioError
from plcgen.s7.cpu.program import Program


def stated_checks(plan: PpiPlan, program: Program) -> Iterator[Check]:
    """Every master of the spec: what the files do against what it demands."""
    for master in plan.masters:
        problem = _problem(plan, program, master)
        text = f"{quantity(len(master.jobs), 'job')}: what is on the line, start values, outputs, times"
        name, subject = f"spec.ppi.{master.key}", f"spec {master.key}"
        if problem is None:
            yield Check(name, subject, text, Outcome.OK, "as the spec says, read a second time")
        else:
            yield Check(name, subject, text, Outcome.ERROR, problem.message, problem)


def _problem(plan: PpiPlan, program: Program, master: PlannedMaster) -> Diagnostic | None:
    place = plan.loaded.key_span(master.path)
    try:
        port = ports_of(plan.loaded)
        for check in (hold_values, hold_times):
            check(StatedBed(plan, program, master, port))
    except DiagnosticError as problem:
        return problem.diagnostics[0]
    except (NotStatedError, ScenarioError) as problem:
        return Diagnostic("PG641", f"{master.key}: {problem}", place, help=PAGE)
    except Exception as problem:  # noqa: BLE001 - changed sources may make the simulated CPU itself fail
        message = f"{master.key}: the simulated CPU stopped: {type(problem).__name__} {problem}"
        return Diagnostic("PG641", message, place, help=PAGE)
    return None


CALLS = 5
"""Calls of 1 ms behind a time: the module's blocks begin and end in calls of their own."""
PIECE = 32
"""Bytes of a frame that cost a CP 341 a call more (A5E02191071-01, table 6-15)."""
MOST_CALLS = 20
"""Calls behind which a time is surely over."""
EARLY = 2
"""Milliseconds in front: the clock counts whole ones."""
SHORTEST = 100
"""Timeouts below this end a job before it has waited for anything."""
ROUNDS = 3
LONG = 3_600_000


def hold_times(bed: StatedBed) -> None:
    """Waiting, repeating, polling; then timeout and cycle of every job."""
    job = next((job for job in bed.jobs if job.service == READ), bed.jobs[0])
    longest = _longest(bed)
    port = bed.port
    _ends(bed)
    _unanswered(bed, job, "request", port.ack_wait())
    _unanswered(bed, job, "poll", port.reply_wait(longest))
    _not_ready(bed, job)
    for each in bed.jobs:
        _timeout(bed, each)
        _again(bed, each)


def _ends(bed: StatedBed) -> None:
    """What begins and ends a message, as a CM is set by the block."""
    settings = bed.module.settings
    found = f"{'any' if settings.any_start else 'not any'} character begins a message, a gap of {settings.gap_bits} bit"
    found += f" times or {settings.max_length} bytes end it"
    said = f"any character begins a message, a gap of {GAP_BITS} bit times or {LONGEST_MESSAGE} bytes end it"
    if not bed.port.classic and found != said:
        raise bed.wrong(bed.port.path, "what begins and ends a message", said, found)


def _calls(bed: StatedBed, octets: int) -> int:
    """Milliseconds that the calls of the module take beside a time."""
    return CALLS + 3 + octets // PIECE if bed.port.classic else CALLS


def _longest(bed: StatedBed) -> int:
    for job in bed.jobs:
        bed.power_up()
        bed.run(job)
    return bed.line.longest


def _unanswered(bed: StatedBed, job: PpiStatement, what: str, timeout: int) -> None:
    """A frame that is not answered is repeated as it is, ``retries`` times, its timeout and a pause apart."""
    port = bed.port
    wait = timeout + port.retry_pause
    bed.power_up()
    bed.line.deaf, bed.line.mute = what == "request", what == "poll"
    status, began = _failing(bed, job, (timeout, wait))
    kind = HeardPoll if what == "poll" else object
    heard = [one for one in bed.line.heard if isinstance(one.meaning, kind)]
    said = f"{what} without an answer"
    if not heard:
        raise bed.wrong(job.path, f"frames of {job.key}", f"a {what}", f"none, status 16#{status:04X}")
    begins = [begin for begin, (_, frame) in zip(bed.begins(), bed.module.sent, strict=True) if frame == heard[0].frame]
    ends = [end for end, frame in bed.module.sent if frame == heard[0].frame]
    for end, again in zip(ends, begins[1:], strict=False):
        if not wait - EARLY <= again - end <= wait + _calls(bed, len(heard[0].frame)):
            raise bed.wrong(port.path, f"time to the repetition of a {said}", f"{wait} ms", f"{again - end:.0f} ms")
    if status == WORDS["TIMEOUT"] and bed.cpu.clock - began >= job.timeout:
        return
    if {one.frame for one in heard} != {heard[0].frame} or len(heard) != 1 + port.retries:
        frames = f"{len(heard)} times, {len({one.frame for one in heard})} different"
        raise bed.wrong(port.path, f"a {said} is sent", f"{1 + port.retries} times as it is", frames)
    if status != WORDS["NO_ANSWER"]:
        raise bed.wrong(port.path, f"status of {job.key} after a {said}", "16#8203", f"16#{status:04X}")


def _not_ready(bed: StatedBed, job: PpiStatement) -> None:
    """A station that answers E5 to every poll is polled ``polls`` times, a pause apart."""
    port = bed.port
    bed.power_up()
    bed.line.busy = True
    status, began = _failing(bed, job, ())
    answer = (CHARACTER_BITS + GAP_BITS) * 1000 / port.baud
    for (end, _), again in zip(bed.module.sent[1:], bed.begins()[2:], strict=False):
        gap = again - end - answer
        if not port.poll_pause - EARLY <= gap <= port.poll_pause + _calls(bed, 1):
            raise bed.wrong(port.path, "time from E5 to the next poll", f"{port.poll_pause} ms", f"{gap:.0f} ms")
    if status == WORDS["TIMEOUT"] and bed.cpu.clock - began >= job.timeout:
        return
    polls = sum(isinstance(one.meaning, HeardPoll) for one in bed.line.heard)
    if polls != port.polls:
        raise bed.wrong(port.path, "polls of a station that is not ready", port.polls, polls)
    if status != WORDS["NOT_READY"]:
        raise bed.wrong(port.path, f"status of {job.key} if the station is never ready", "16#8205", f"16#{status:04X}")


def _failing(bed: StatedBed, job: PpiStatement, waits: tuple[int, ...]) -> tuple[int, int]:
    """Run a job to its error: status, and when it was started.

    ``waits`` are the times behind a frame without an answer at which something happens: between them scans are long.
    """
    bed.start(job)
    bed.cpu.scan(1)
    began = bed.cpu.clock
    sent, ended = 0, began
    while not bed.over(job) and bed.cpu.clock - began <= job.timeout + 10_000:
        if sent != len(bed.module.sent):
            sent, ended = len(bed.module.sent), bed.cpu.clock
        waiting = () if bed.line.answers or not sent or bed.module.transmitting else waits
        ahead = [ended + wait for wait in waiting if ended + wait + MOST_CALLS > bed.cpu.clock]
        if ahead:
            bed.until(min(*ahead, bed.cpu.clock + max(3 * MARGIN, waits[-1] // 20)))
        else:
            bed.cpu.scan(STEP if waiting else 1)
    return bed.signal(job, "status"), began


def _timeout(bed: StatedBed, job: PpiStatement) -> None:
    """While the module hangs, a job stays where it is until its timeout is over, and not longer."""
    if job.timeout < SHORTEST:
        return
    bed.power_up()
    bed.module.hang = True
    state = f'"{bed.instance}".diagnostics.state'
    bed.start(job)
    bed.cpu.scan(1)
    began = bed.cpu.clock
    while bed.cpu.clock - began < SHORTEST // 2:
        bed.cpu.scan(1)
    before = bed.cpu[state]
    while not bed.over(job) and bed.cpu[state] == before and bed.cpu.clock - began <= job.timeout + SHORTEST:
        bed.until(began + job.timeout)
    took = bed.cpu.clock - began
    if not job.timeout - EARLY <= took <= job.timeout + EARLY:
        raise bed.wrong(job.path, f"timeout of {job.key}", f"{job.timeout} ms", f"{took} ms")


def _again(bed: StatedBed, job: PpiStatement) -> None:
    """With a cycle a job starts again and again, else once, however long execute stays."""
    bed.power_up()
    if job.cycle is None:
        bed.run(job)
        bed.line.forget()
        bed.cpu.scan(LONG)
        bed.cpu.scan(1, 5)
        if bed.line.heard or bed.module.transmitting or bed.signal(job, "status") != DONE:
            raise bed.wrong(job.path, f"{job.key} has no cycle and runs", "once", "again")
        return
    starts, ends = _rounds(bed, job, job.cycle)
    for start, end, again in zip(starts, ends, starts[1:], strict=False):
        longest = max(job.cycle, end - start + MOST_CALLS)
        if not job.cycle - EARLY <= again - start <= longest + _calls(bed, PIECE):
            raise bed.wrong(job.path, f"cycle of {job.key}", f"{job.cycle} ms", f"{again - start:.0f} ms")
    if len(starts) < ROUNDS:
        raise bed.wrong(job.path, f"cycle of {job.key}", f"{job.cycle} ms", "it does not start again")


def _rounds(bed: StatedBed, job: PpiStatement, cycle: int) -> tuple[list[float], list[float]]:
    """When the first frame of some rounds of a job began, and when each round ended; the very first is left out."""
    starts: list[float] = []
    ends: list[float] = []
    moment: float = bed.cpu.clock + cycle
    last = moment + (ROUNDS + 1) * (cycle + job.timeout)
    status = bed.run(job)
    if status != DONE:
        raise bed.wrong(job.path, f"status of {job.key}", "16#0000", f"16#{status:04X}")
    number, resting = len(bed.module.sent), True
    while len(starts) < ROUNDS and bed.cpu.clock < last:
        bed.until(moment if resting else bed.cpu.clock)
        if len(bed.module.sent) > number and resting:
            starts.append(bed.begins()[number])
            resting = False
        elif bed.over(job) and not resting:
            ends.append(bed.cpu.clock)
            resting, number, moment = True, len(bed.module.sent), starts[-1] + cycle
    return starts, ends
