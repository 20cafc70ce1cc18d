"""Scenarios: what line, station, module and CPU do to a job of a PPI master."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from plcgen.ppi.plan.nouns import PlannedMaster, PpiJob
from plcgen.ppi.proof.scenario import (
    FRAME_MS,
    GAP_MS,
    LATE_MS,
    LOST_SCANS,
    POLL_MS,
    SCAN_MS,
    TOO_MANY,
    Edit,
    PpiScenario,
    answered_again,
    bends,
    changed,
    edits,
    fault,
    loose,
    lost_once,
    others,
    reply_length,
    with_data,
)
from plcgen.ppi.proof.words import CLOCK_END, CP_RESET_CALLS, DONE, DRAIN_MS, WORDS
from plcgen.ppi.sim.faults import At

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


RECEIVE_FAULT = {"RECEIVE_P2P": 0x80E1, "P_RCV_RK": 0x080C}
"""STATUS of a parity error: TIA Portal information system, "Error messages"; CP 341, event class 8."""


def module_scenarios(master: PlannedMaster, job: PpiJob, *, classic: bool) -> Iterator[PpiScenario]:
    """Everything a module can do wrong."""
    most = master.retries
    for transmission, at in ((1, "request"), (2, "poll")):
        yield PpiScenario(
            name=f"sending of the {at} fails once",
            port={transmission: 0x80D1},
            module=0x80D1,
            status=(DONE,) if most else (WORDS["SEND_ERROR"],),
            retries=min(1, most),
            polls=1 if most or at == "poll" else 0,
        )
    first = 3 if most else 2  # noise in front of E5 costs a repetition, or is taken for one
    yield PpiScenario(
        name="noise before E5, then sending of the poll fails forever",
        faults=(fault("noise", "request"),),
        port=dict.fromkeys(range(first, first + max(1, most)), 0x80D1),
        module=0x80D1,
        status=(WORDS["SEND_ERROR"],),
        retries=most,
    )
    yield PpiScenario(
        name="sending fails forever",
        port={0: 0x80D1},
        status=(WORDS["SEND_ERROR"],),
        retries=most,
        polls=0,
        module=0x80D1,
    )
    word = "SEND_ERROR" if classic else "CONFIG_ERROR"
    yield PpiScenario(
        name="module missing", gone=True, status=(WORDS[word],), retries=None, polls=0, fresh=True,
        module=0x1E0E if classic else 0x8080,
    )  # fmt: skip
    if not classic:
        yield from _settings(most)
    yield from hangs(master, job, classic=classic)
    deaf = RECEIVE_FAULT["P_RCV_RK" if classic else "RECEIVE_P2P"]
    yield PpiScenario(
        name="receiving fails", refusals={"P_RCV_RK" if classic else "RECEIVE_P2P": deaf},
        status=(WORDS["NO_ANSWER"],), retries=most, polls=0, module=deaf,
    )  # fmt: skip
    if classic:
        yield PpiScenario(
            name="module hangs, and RESET too",
            hang=True,
            stuck=True,
            status=(WORDS["DRAIN_TIMEOUT"],),
            polls=0,
            took=(job.timeout + DRAIN_MS, job.timeout + DRAIN_MS + 50),
        )
        yield _failed(most)
        yield PpiScenario(
            name="a timeout before the first frame", happens={2: "jump"}, status=(WORDS["TIMEOUT"],), polls=0
        )


def _failed(most: int) -> PpiScenario:
    """A failure whose repetitions the next job must not show."""
    return PpiScenario(
        name="sending fails forever, and another job after it", port={0: 0x80D1}, status=(WORDS["SEND_ERROR"],),
        retries=most, polls=0, module=0x80D1, follow=False,
    )  # fmt: skip


def _settings(most: int) -> Iterator[PpiScenario]:
    yield PpiScenario(
        name="the module forgets its settings", forgets=True, status=(WORDS["NO_ANSWER"],), retries=most, polls=0
    )
    for block, fresh in (("Port_Config", True), ("Receive_Config", True), ("Receive_Reset", False)):
        refused = 0x81C1 if block == "Receive_Config" else 0x81A1
        yield PpiScenario(
            name=f"{block} fails", refusals={block.upper(): refused}, fresh=fresh,
            status=(WORDS["CONFIG_ERROR"],), polls=0, retries=None, module=refused,
        )  # fmt: skip
    yield _failed(most)
    yield PpiScenario(
        name="Port_Config fails after a failure", refusals={"PORT_CONFIG": 0x81A1},
        status=(WORDS["CONFIG_ERROR"],), polls=0, module=0x81A1,
    )  # fmt: skip


def hangs(master: PlannedMaster, job: PpiJob, *, classic: bool) -> Iterator[PpiScenario]:
    """A module that never ends: every job has a timeout of its own, also across the end of the clock."""
    for clock in (None, CLOCK_END - job.timeout // 2):
        # a clock that is 2 ms wrong behind its end shows if so little is missing from a scan to the timeout
        steps = (n for n in (9, 7, 6, 3) if job.timeout % n in {1, 2} and n <= master.ob1_cycle)
        scan = next(steps, 2) if clock and classic else 10
        scan = min(scan, master.ob1_cycle)
        begun = scan * (1 - (-job.timeout // scan))  # the job starts in the first scan
        end = begun + (scan * CP_RESET_CALLS if classic else scan * -(-DRAIN_MS // scan))
        late = LOST_SCANS * scan if clock and not classic else 0
        yield PpiScenario(
            name=f"module hangs{', the clock starts again' if clock else ''}",
            hang=True,
            status=(WORDS["TIMEOUT"] if classic else WORDS["DRAIN_TIMEOUT"],),
            polls=0,
            clock=clock,
            scan=scan,
            took=(end, end + late),
        )


RETURN_CODES = (0x01, 0x03, 0x05, 0x06, 0x07, 0x0A, 0x42)
"""Return codes of items: those of the S7-200 and one that nobody knows."""
HEADER_ERRORS = (0x8001, 0x8104, 0x8404, 0x8500, 0xD602)


def ready(polls: int) -> Iterator[PpiScenario]:
    """E5 to polls, a bounded number of times and forever."""
    for times in sorted({1, 2, polls - 1}):
        if 0 < times < polls:
            yield PpiScenario(
                name=f"not ready {times} times", faults=(fault("not_ready", times=times),), polls=times + 1
            )
    yield PpiScenario(
        name="never ready", faults=(fault("not_ready", times=None),), status=(WORDS["NOT_READY"],), polls=polls
    )


def _codes(number: int, count: int, *, every: bool) -> tuple[int, ...]:
    """What one of so many items refuses with: the outer ones with every code, those between with one each in turn."""
    if every or number in {1, count}:
        return RETURN_CODES
    return (RETURN_CODES[number % len(RETURN_CODES)],)


def refusals(job: PpiJob, *, every: bool) -> Iterator[PpiScenario]:
    """Return codes at every position, and refusals of the whole job."""
    for code in HEADER_ERRORS:
        yield PpiScenario(
            name=f"job refused with {code:04X}h",
            faults=(fault("header", code=code),),
            status=(WORDS["REFUSED"],),
            header=code,
        )
    yield loose(
        name="job refused with an acknowledgement (ROSCTR 2)",
        faults=(fault("header", code=HEADER_ERRORS[0]),),
        edit=lambda pdu: pdu[:1] + b"\x02" + pdu[2:],
        status=(WORDS["REFUSED"],),
        header=HEADER_ERRORS[0],
    )
    if job.telegrams[0].response is not None:
        yield loose(
            name="an item refused in a reply with a byte too many",
            faults=tuple(fault("item", item=n, code=5) for n, _ in enumerate(job.telegrams[0].items, 1)),
            edit=lambda pdu: with_data(pdu, pdu[14:] + b"\xff"),
            status=(WORDS["REPLY_FORMAT"],),
        )
    for after, telegram in enumerate(job.telegrams):
        for number, wire in enumerate(telegram.items if telegram.response is not None else (), 1):
            positions = sorted({placed.value.position for placed in wire.values})
            for code in _codes(number, len(telegram.items), every=every):
                yield loose(
                    name=f"item {number} of telegram {telegram.number} refused with {code:02X}h",
                    faults=(fault("item", item=number, code=code, after=after),),
                    status=(WORDS["ITEM_ERROR"],),
                    errors=dict.fromkeys(positions, 0x8000 | code),
                )
        count = len(telegram.items) if telegram.response is not None else 0
        for name, numbers in (("first and last item", (1, count)), ("last two items", (count - 1, count))):
            if count < len(numbers) or (numbers[0] == 1 and name != "first and last item"):
                continue
            wrong = [telegram.items[number - 1] for number in numbers]
            places = sorted({placed.value.position for wire in wrong for placed in wire.values})
            yield loose(
                name=f"{name} of telegram {telegram.number} refused",
                faults=tuple(fault("item", item=n, code=5, after=after) for n in numbers),
                status=(WORDS["ITEM_ERROR"],),
                errors=dict.fromkeys(places, 0x8005),
            )


def wrong_replies(job: PpiJob) -> Iterator[PpiScenario]:
    """The read in front of the first write with an item or a parameter too many; then every other wrong reply."""
    for name in ("an item", "a parameter") if job.kind != "read" else ():
        yield loose(
            name=f"first read with {name} too many", edit=TOO_MANY[name], status=(WORDS["REPLY_FORMAT"],), fresh=True
        )
    for name, edit in edits(job):
        yield loose(name=f"reply with {name}", edit=edit, status=(WORDS["REPLY_FORMAT"],))


def line_scenarios(master: PlannedMaster, job: PpiJob, *, every: bool) -> Iterator[PpiScenario]:
    """Everything a line and a station can do wrong; with ``every`` each return code at each item."""
    most, polls = master.retries, master.polls
    silent = (WORDS["NO_ANSWER"],)
    again = answered_again(master)
    yield loose(name="first job after power-up", fresh=True)
    yield from _spoilt(master)
    for spot, byte in ((4, "high"), (5, "low")):
        yield PpiScenario(
            name=f"reference with another {byte} byte",
            edit=_flipped(spot),
            status=silent,
            retries=most,
            polls=None,
        )
    repeats: tuple[tuple[int | None, str], ...] = ((1, "once"), (None, "forever"))
    for number, how in repeats:  # the second answer before is the right one
        stale = (fault("stale", "poll", number),)
        yield PpiScenario(name=f"an old answer {how}", faults=stale, retries=min(1, most), status=again)
    yield from ready(polls)
    yield PpiScenario(name="the module hears what it sends", echo=True)
    for name, bend, ignored in bends():
        yield PpiScenario(
            name=f"reply with {name}", bend=bend, ignored=ignored, damaged=1 - ignored, **lost_once(master)
        )
    yield PpiScenario(name="a reply of high priority (0Ah)", bend=changed(6, 0x02, sums=True), ignored=0, damaged=0)
    broken = (fault("cut", "poll", None, value=20),)
    yield PpiScenario(
        name="replies that break off, forever", faults=broken, status=silent, retries=most, polls=None, follow=False
    )
    yield PpiScenario(name="a job after a reply that broke off")
    yield PpiScenario(name="reply that breaks off twice and goes on", broken=9, again=7)
    yield from _in_front(master)
    yield from _alone()
    for octets in (1, 3, 4, 20, -1):
        yield PpiScenario(name=f"reply that breaks off after {octets} bytes and goes on", broken=octets)
    yield loose(
        name="reply that breaks off, its rest after the next poll",
        broken=20,
        rest=master.reply_timeout,
        status=(*again, WORDS["NO_ANSWER"]),
    )
    for kind in ("count", "length"):
        if job.kind == "read" or (kind == "count" and job.kind == "write"):
            yield PpiScenario(
                name=f"reply with a wrong {kind}", faults=(fault(kind, "poll"),), status=(WORDS["REPLY_FORMAT"],)
            )
    yield from _line_refusals(master)
    yield from _late(master)
    yield from in_the_pause(master, job)
    yield from refusals(job, every=every)
    yield from _short(master, job)
    yield from wrong_replies(job)


def _flipped(spot: int) -> Edit:
    return lambda pdu: pdu[:spot] + bytes((pdu[spot] ^ 1,)) + pdu[spot + 1 :]


def _spoilt(master: PlannedMaster) -> Iterator[PpiScenario]:
    """Requests that are not heard and answers that are lost or damaged: as often as is repeated, and forever."""
    most = master.retries
    damaged: tuple[tuple[At, tuple[str, ...]], ...] = (
        ("request", ("deaf", "silence", "garbage", "clipped")),
        ("poll", ("deaf", "silence", "garbage", "fcs", "cut", "address", "function", "reference")),
    )
    for at, kinds in damaged:
        for kind in kinds:
            for times in sorted({1, max(1, most)}):
                if times <= most:
                    name = f"{kind} at the {at}, {times} times"
                    yield PpiScenario(name=name, faults=(fault(kind, at, times),), retries=times)
            doubtful = at == "request" and kind in {"garbage", "clipped"}  # it may have been E5: the station is asked
            yield PpiScenario(
                name=f"{kind} at the {at}, forever",
                faults=(fault(kind, at, None),),
                status=(DONE,) if doubtful else (WORDS["NO_ANSWER"],),
                retries=most,
                polls=None if at == "poll" else int(doubtful),
            )
    yield PpiScenario(
        name="clipped at the request, forever, and no reply",
        faults=(fault("clipped", "request", None), fault("deaf", "poll", None)),
        status=(WORDS["NO_ANSWER"],), retries=most, polls=1,
    )  # fmt: skip


def _in_front(master: PlannedMaster) -> Iterator[PpiScenario]:
    """Frames of others, tokens and noise in front of answers; an answer that is late for another reason."""
    most, polls, strange = master.retries, master.polls, others(master)
    in_front: tuple[tuple[str, At], ...] = (("token", "any"), ("foreign", "any"), ("noise", "poll"))
    for kind, at in in_front:
        yield PpiScenario(name=f"{kind} before every answer", faults=(fault(kind, at, None),))
    yield PpiScenario(
        name="a frame of others right behind E5",
        faults=(replace(fault("garbage", "request"), data=b"\xe5" + strange),), ignored=1, damaged=0,
    )  # fmt: skip
    yield PpiScenario(name="noise before E5", faults=(fault("noise", "request"),), retries=min(1, most))
    yield PpiScenario(
        name="a frame of others and noise before the reply",
        bend=lambda reply: strange + b"\xff" + reply,
        ignored=1,
        damaged=1,
    )
    yield PpiScenario(
        name="a frame of others after the reply", bend=lambda reply: reply + strange, ignored=0, damaged=0
    )
    yield PpiScenario(
        name="a frame of others and a reply that breaks off",
        bend=lambda reply: strange + reply,
        broken=len(strange) + 20,
        ignored=1,
    )
    if polls > 2 and most:
        lost = (fault("deaf", "request"), fault("not_ready", times=2))
        yield PpiScenario(name="a request that is lost, then no data yet", faults=lost, retries=1, polls=3)


def _line_refusals(master: PlannedMaster) -> Iterator[PpiScenario]:
    """A station that refuses the request on the line (10h 02h ...)."""
    most, silent = master.retries, (WORDS["NO_ANSWER"],)
    for value, word in ((1, "LINE_REFUSED"), (3, "LINE_REFUSED")):
        yield PpiScenario(
            name=f"refused with {value:02X}h",
            faults=(fault("nack", "request", value=value),),
            status=(WORDS[word],),
            polls=0,
            ignored=0,
            damaged=0,
        )
    refused = fault("nack", "request", None, value=2)
    yield PpiScenario(name="refused with 02h forever", faults=(refused,), status=silent, retries=most, polls=0)
    yield PpiScenario(
        name="refused with 02h forever after noise, and no reply",
        faults=(refused, fault("noise", "request", None), fault("deaf", "poll", None)),
        status=silent, retries=most, polls=1,
    )  # fmt: skip
    yield PpiScenario(
        name="refused with 02h once", faults=(fault("nack", "request", value=2),), **lost_once(master, polls=0)
    )


def _late(master: PlannedMaster) -> Iterator[PpiScenario]:
    # a late E5 looks like "not ready" to the poll of a repeated request: the job may fail, but says so
    ends = (DONE, WORDS["NOT_READY"], WORDS["NO_ANSWER"])
    for late in (100, 200, 400, 900):
        once = (fault("late", milliseconds=late),)
        always = (fault("late", times=None, milliseconds=late),)
        good = (DONE,) if late < master.ack_timeout else ends
        yield loose(name=f"answer {late} ms late", faults=once, status=good)
        yield loose(name=f"every answer {late} ms late", faults=always, status=(*ends, WORDS["TIMEOUT"]))


def in_the_pause(master: PlannedMaster, job: PpiJob) -> Iterator[PpiScenario]:
    """The only reply comes in a pause: in each single scan of that before a repetition, which follows the time for the
    reply, and of that between two polls. Every other poll is answered with E5, so nothing else ends the job well.

    A message is handed over in up to eight scans by a CP 341, in two by others.
    """
    frame = reply_length(job.telegrams[0]) * 11 * 1000 // master.baud + GAP_MS
    scan = min(SCAN_MS, master.ob1_cycle)
    pauses = ((False, "", master.reply_timeout, master.retry_pause), (True, "E5 and ", POLL_MS, master.poll_pause))
    for unready, before, begin, pause in pauses:
        for late in range(max(1, begin - frame - 8 * scan), max(2, begin + pause - frame + 4 * scan), scan):
            yield loose(
                name=f"{before}one reply, {late} ms late, and E5 to every other poll",
                only=late,
                unready=unready,
                status=(DONE, WORDS["NOT_READY"], WORDS["NO_ANSWER"]),
            )


def _short(master: PlannedMaster, job: PpiJob) -> Iterator[PpiScenario]:
    """Short answers that are none of the usual ones, and a frame without a PDU of an answer."""

    def frame(body: bytes, *, variable: bool) -> bytes:
        body = bytes((master.own_address, job.station.address)) + body
        head = bytes((0x68, len(body), len(body), 0x68)) if variable else b"\x10"
        return head + body + bytes((sum(body) & 0xFF, 0x16))

    for function, what in ((0x09, "no data yet"), (0x00, "taken")):
        answer = frame(bytes((function,)), variable=False)
        asked = replace(fault("garbage", "request"), data=answer)
        yield PpiScenario(name=f"{what} instead of E5", faults=(asked,))
        polled = replace(fault("garbage", "poll"), data=answer)  # the reply itself is lost with it
        lost = (WORDS["NOT_READY"],)
        yield PpiScenario(name=f"{what} instead of the reply", faults=(polled,), polls=master.polls, status=lost)
    short = replace(fault("garbage", "poll"), data=frame(b"\x08\x32\x03", variable=True))
    yield PpiScenario(name="a frame without an answer", faults=(short,), **lost_once(master))


def _alone() -> Iterator[PpiScenario]:
    """Messages that hold nothing but a token, or the beginning of one or of a short frame; the answer comes later."""
    for data, what, damaged in (
        (b"\xdc\x03\x05", "a token", 0),
        (b"\xdc\x03", "two bytes of a token", 1),
        (b"\x68\x10\x11\x00", "a head with two lengths", 1),
        (b"\x10\x03\x05\x49\x51", "a short frame without its end", 1),
    ):
        noise = replace(fault("noise", "poll"), data=data)
        yield loose(
            name=f"{what} alone",
            faults=(noise, fault("late", "poll", milliseconds=LATE_MS)),
            damaged=damaged,
            ignored=0,
        )
