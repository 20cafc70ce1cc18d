"""The times of a master, measured on the virtual clock against stations that stay silent or are never ready."""

from __future__ import annotations

from plcgen.oracles.spec.ppi.statement import PpiStatement
from plcgen.oracles.spec.ppi.stations import READ, HeardPoll
from plcgen.protocols.ppi.proof.stated import StatedBed
from plcgen.protocols.ppi.proof.words import DONE, WORDS

LATE = 16
"""Milliseconds behind a time in scans of 1 ms: the calls of the module, which a CP 341 takes most of."""
EARLY = 2
"""Milliseconds in front: the clock counts whole ones."""
SHORTEST = 100
"""Timeouts below this end a job before it has waited for anything."""
ROUNDS = 3
LONG = 3_600_000


def times(bed: StatedBed) -> None:
    """Waiting, repeating, polling; then timeout and cycle of every job."""
    job = next((job for job in bed.jobs if job.service == READ), bed.jobs[0])
    longest = _longest(bed)
    port = bed.port
    _unanswered(bed, job, "request", port.ack_wait() + port.retry_pause)
    _unanswered(bed, job, "poll", port.reply_wait(longest) + port.retry_pause)
    _not_ready(bed, job)
    for each in bed.jobs:
        _timeout(bed, each)
        _again(bed, each)


def _longest(bed: StatedBed) -> int:
    """Bytes of the longest reply of any job."""
    for job in bed.jobs:
        bed.power_up()
        bed.run(job)
    return bed.line.longest


def _unanswered(bed: StatedBed, job: PpiStatement, what: str, wait: int) -> None:
    """A frame that is not answered is repeated as it is, ``retries`` times, a wait and a pause apart."""
    port = bed.port
    bed.power_up()
    bed.line.deaf, bed.line.mute = what == "request", what == "poll"
    status, began = _failing(bed, job, wait)
    kind = HeardPoll if what == "poll" else object
    heard = [one for one in bed.line.heard if isinstance(one.meaning, kind)]
    begins = [begin for begin, (_, frame) in zip(bed.begins(), bed.module.sent, strict=True) if frame == heard[0].frame]
    ends = [end for end, frame in bed.module.sent if frame == heard[0].frame]
    said = f"{what} without an answer"
    for end, again in zip(ends, begins[1:], strict=False):
        if not wait - EARLY <= again - end <= wait + LATE:
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
    status, began = _failing(bed, job, port.poll_pause)
    pairs = [(end - 0.0, begin) for (end, _), begin in zip(bed.module.sent[1:], bed.begins()[2:], strict=False)]
    answer = 1 * 11_000 / port.baud + 35_000 / port.baud
    for end, again in pairs:
        gap = again - end - answer
        if not port.poll_pause - EARLY <= gap <= port.poll_pause + LATE:
            raise bed.wrong(port.path, "time from E5 to the next poll", f"{port.poll_pause} ms", f"{gap:.0f} ms")
    if status == WORDS["TIMEOUT"] and bed.cpu.clock - began >= job.timeout:
        return
    polls = sum(isinstance(one.meaning, HeardPoll) for one in bed.line.heard)
    if polls != port.polls:
        raise bed.wrong(port.path, "polls of a station that is not ready", port.polls, polls)
    if status != WORDS["NOT_READY"]:
        raise bed.wrong(port.path, f"status of {job.key} if the station is never ready", "16#8205", f"16#{status:04X}")


def _failing(bed: StatedBed, job: PpiStatement, wait: int) -> tuple[int, int]:
    """Run a job to its error, fine where something may happen: status, and when it was started."""
    began = bed.cpu.clock
    bed.start(job)
    sent, moment = 0, began
    while not bed.over(job) and bed.cpu.clock - began <= job.timeout + 10_000:
        if sent != len(bed.module.sent):
            sent = len(bed.module.sent)
            moment = bed.cpu.clock + (0 if bed.line.answers else wait)
        bed.until(min(moment, began + job.timeout))
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
    status = bed.run(job)
    if status != DONE:
        raise bed.wrong(job.path, f"status of {job.key}", "16#0000", f"16#{status:04X}")
    starts: list[float] = []
    ends: list[int] = []
    number = len(bed.module.sent)
    moment: float = bed.cpu.clock + job.cycle - 2 * SHORTEST
    busy = True
    while len(starts) < ROUNDS and bed.cpu.clock < LONG * 2:
        bed.until(moment)
        if busy and bed.over(job):
            busy = False
            ends.append(bed.cpu.clock)
            moment = starts[-1] + job.cycle - SHORTEST if starts else moment
            number = len(bed.module.sent)
        elif len(bed.module.sent) > number:
            if not busy:
                starts.append(bed.begins()[number])
            number, busy = len(bed.module.sent), True
    for start, end, again in zip(starts, ends[1:], starts[1:], strict=False):
        longest = max(job.cycle, end - start)
        if not job.cycle - EARLY <= again - start <= longest + LATE:
            raise bed.wrong(job.path, f"cycle of {job.key}", f"{job.cycle} ms", f"{again - start:.0f} ms")
    if len(starts) < ROUNDS:
        raise bed.wrong(job.path, f"cycle of {job.key}", f"{job.cycle} ms", "it does not start again")
