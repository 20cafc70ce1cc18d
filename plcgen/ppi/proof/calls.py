"""Scenarios: what the CPU does to a job of a PPI master, and the pace of its waits, to the millisecond."""

from __future__ import annotations

from collections.abc import Iterator

from plcgen.ppi.plan.nouns import PlannedMaster, PpiJob
from plcgen.ppi.proof.scenario import FRAME_MS, LATE_MS, POLL_MS, SCAN_MS, PpiScenario, fault, loose, lost_once
from plcgen.ppi.proof.words import CLOCK_END, DONE, WORDS

MOMENTS = 60
"""Scans of a job in which something happens to it, unless it is every one: more than a job of one telegram has."""

SENDING, LAST_CALLS = 5, 10
"""A scan in which a module sends; more calls than it takes to end if it is cancelled."""


def spread(first: int, last: int, most: int) -> list[int]:
    """At most so many numbers from ``first`` to ``last``, both among them, evenly far apart."""
    count = min(most, last - first + 1)
    return [first + (last - first) * number // max(1, count - 1) for number in range(count)]


def cpu_scenarios(scans: int, clock_end: int, ob1: int, *, retentive: bool, every: bool) -> Iterator[PpiScenario]:
    """Everything the CPU can do: execute dropped, restarts, scan times, the clock starting again.

    ``every`` takes every scan of a job, or else at most ``MOMENTS`` of them.
    """
    for scan in spread(2, scans, scans if every else MOMENTS):
        yield PpiScenario(name=f"execute dropped in scan {scan}", happens={scan: "drop"})
    for scan in spread(2, scans + 1, scans // 3 if every else min(scans, MOMENTS) // 3):
        yield loose(name=f"cold restart in scan {scan}", happens={scan: "cold"})
        status = (DONE, WORDS["TIMEOUT"], WORDS["NO_ANSWER"]) if retentive else (DONE,)
        yield loose(name=f"warm restart in scan {scan}", happens={scan: "warm"}, status=status)
    for scan in spread(scans // 4, scans * 3 // 4, scans if every else MOMENTS):
        ends = (WORDS["TIMEOUT"],) if scan <= scans // 3 else (WORDS["TIMEOUT"], DONE)  # the job may be over before
        yield loose(name=f"scan {scan} is as long as the timeout", happens={scan: "jump"}, status=ends)
    for scan in spread(2, scans // 3, scans // 6):
        yield loose(
            name=f"scans {scan} and {scan + 1} are as long as the timeout",
            happens={scan: "jump", scan + 1: "jump"},
            status=(WORDS["TIMEOUT"], WORDS["DRAIN_TIMEOUT"]),
        )
    for later in range(2, LAST_CALLS):  # the module's work ends in the very call in which nobody waits any more
        yield loose(
            name=f"scans {SENDING} and {SENDING + later} are as long as the timeout",
            happens={SENDING: "jump", SENDING + later: "jump"},
            status=(WORDS["TIMEOUT"], WORDS["DRAIN_TIMEOUT"]),
        )
    yield PpiScenario(
        name="the second scan is as long as the timeout", happens={2: "jump"}, status=(WORDS["TIMEOUT"],), polls=0
    )
    for length in sorted({1, min(3, ob1), min(20, ob1), ob1}):
        yield loose(name=f"scans of {length} ms", scan=length)
    yield loose(name="two calls in every millisecond", scan=1, twice=True)
    for number in range(5):
        yield loose(name=f"scans of random length {number}", wild=True)
    for before in (5, 60, 150):
        yield PpiScenario(name=f"the clock starts again after {before} ms", clock=clock_end - before)


def pace_scenarios(master: PlannedMaster, job: PpiJob) -> Iterator[PpiScenario]:
    """Waits and pauses held to the constants in scans of 2 ms, also across the end of the block's clock."""
    ack, reply, pause, most = master.ack_timeout, master.reply_timeout, master.retry_pause, master.retries
    waits = (("request", ack, (ack + pause,) * 2), ("poll", reply, (0, reply + pause)))
    none = WORDS["NO_ANSWER"]
    # a clock that is 1 ms wrong behind its end shows if there is a call 1 ms before a wait is over
    step = next((n for n in range(min(SCAN_MS, master.ob1_cycle), 2, -1) if (ack - 1) % n == 0), 1)
    calls = (("", None, 2), (", the clock starts again", CLOCK_END - 100, 2))
    uneven = (f", the clock starts again, scans of {step} ms", CLOCK_END - 20 * step - FRAME_MS // 4, step)
    for at, end, (first, later) in waits:
        if (most + 1) * (end + pause) + ack < job.timeout:
            for name, clock, scan in (*calls, uneven) if at == "request" else calls:
                yield PpiScenario(
                    name=f"pace of repetitions of the {at}{name}",
                    faults=(fault("silence" if at == "poll" else "deaf", "poll" if at == "poll" else "request", None),),
                    status=(none,), retries=most, polls=None if at == "poll" else 0,
                    pace=(first, later, end), scan=scan, clock=clock,
                )  # fmt: skip
    if (most + 1) * (pause + POLL_MS) < job.timeout:
        refused = (fault("nack", "request", None, value=2),)
        answer = 6 * 11 * 1000 // master.baud  # 10 DA SA 02 FCS 16
        yield PpiScenario(
            name="pace of repetitions of a refused request", faults=refused, status=(none,), retries=most, polls=0,
            pace=(answer + pause, answer + pause, answer), scan=2,
        )  # fmt: skip
    if master.polls * (master.poll_pause + POLL_MS) < job.timeout:
        yield PpiScenario(
            name="pace of the polls", faults=(fault("not_ready", times=None),), status=(WORDS["NOT_READY"],),
            polls=master.polls, pace=(0, master.poll_pause if master.polls > 1 else 0, 0), scan=2,
        )  # fmt: skip
    e5 = 46 * 1000 // master.baud  # a character and the gap behind it
    late = fault("late", "poll", None, milliseconds=LATE_MS)
    if master.polls * (master.poll_pause + POLL_MS + LATE_MS) < job.timeout and reply > LATE_MS + POLL_MS:
        wait = LATE_MS + e5 + (master.poll_pause if master.polls > 1 else 0)
        yield PpiScenario(
            name="pace of the polls, every E5 late", faults=(fault("not_ready", times=None), late),
            status=(WORDS["NOT_READY"],), polls=master.polls, pace=(0, wait, LATE_MS), scan=2,
        )  # fmt: skip
    for kind, retries, polls, possible in (("silence", 1, 1, most > 0), ("not_ready", 0, 2, master.polls > 1)):
        if possible:
            yield PpiScenario(
                name=f"{kind} at the poll, two calls in every millisecond", faults=(fault(kind, "poll"),), scan=1,
                twice=True, retries=retries, polls=polls,
            )  # fmt: skip
    yield PpiScenario(name="reply without its last byte", faults=(fault("cut", "poll", value=-1),), **lost_once(master))
    frames = len(job.telegrams) + (job.kind != "read")
    if most and frames > 1 and (most + 3) * (ack + pause) + reply < job.timeout:
        lost = (fault("deaf", "request"), fault("deaf", "request", most, after=2))
        yield PpiScenario(
            name="a frame lost in the first telegram, as many as allowed in the next",
            faults=lost, fresh=True, retries=most if frames == 2 else None, polls=None,
        )  # fmt: skip
