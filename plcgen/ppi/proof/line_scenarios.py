"""Scenarios: everything that can happen to frames between a PPI master and its station."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from plcgen.ppi.plan.nouns import PlannedMaster, PpiJob
from plcgen.ppi.proof.replies import Edit, bends, changed
from plcgen.ppi.proof.reply_scenarios import ready, refusals, wrong_replies
from plcgen.ppi.proof.scenario import (
    GAP_MS,
    LATE_MS,
    POLL_MS,
    SCAN_MS,
    PpiScenario,
    answered_again,
    fault,
    loose,
    lost_once,
    others,
    reply_length,
)
from plcgen.ppi.proof.words import DONE, WORDS
from plcgen.ppi.sim.faults import At


def line_scenarios(master: PlannedMaster, job: PpiJob, *, every: bool) -> Iterator[PpiScenario]:
    """Everything a line and a station can do wrong; with ``every`` each return code at each item."""
    most, polls = master.retries, master.polls
    silent = (WORDS["NO_ANSWER"],)
    again = answered_again(master)
    yield loose(name="first job after power-up", fresh=True)
    yield from _spoilt(master)
    for spot, byte in ((4, "high"), (5, "low")):
        yield PpiScenario(
            name=f"reference with another {byte} byte", edit=_flipped(spot), status=silent, retries=most, polls=None
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
    yield from _broken_off(silent, most)
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


def _broken_off(silent: tuple[int, ...], most: int) -> Iterator[PpiScenario]:
    broken = (fault("cut", "poll", None, value=20),)
    yield PpiScenario(
        name="replies that break off, forever", faults=broken, status=silent, retries=most, polls=None, follow=False
    )
    yield PpiScenario(name="a job after a reply that broke off")
    yield PpiScenario(name="reply that breaks off twice and goes on", broken=9, again=7)


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
