"""Scenarios: waits and pauses of a job of a PPI master, to the millisecond."""

from __future__ import annotations

from collections.abc import Iterator

from plcgen.ppi.plan.nouns import PlannedMaster, PpiJob
from plcgen.ppi.proof.scenario import FRAME_MS, LATE_MS, POLL_MS, SCAN_MS, PpiScenario, fault, lost_once
from plcgen.ppi.proof.words import CLOCK_END, WORDS


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
