"""Scenarios: what line, station and CPU do to a job of a PPI master, and what it must report.

Expectations come from docs/ppi-master.md, EN 50170 and the manuals of the modules, never from a run.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

from plcgen.proof.scenario import Scenario
from plcgen.protocols.ppi.plan.nouns import PlannedMaster, PpiJob
from plcgen.protocols.ppi.proof.replies import TOO_MANY, Bend, Edit, bends, changed, edits, with_data
from plcgen.protocols.ppi.proof.words import CLOCK_END, CP_RESET_CALLS, DONE, DRAIN_MS, WORDS
from plcgen.protocols.ppi.sim import Fault, FaultKind
from plcgen.protocols.ppi.sim.faults import At

RETURN_CODES = (0x01, 0x03, 0x05, 0x06, 0x07, 0x0A, 0x42)
"""Return codes of items: those of the S7-200 and one that nobody knows."""
PAUSE = 40
"""Milliseconds between the two parts of a reply: many times the gap that ends a message."""
LATE_MS = 100
POLL_MS = 60
"""Milliseconds that a poll and E5 take in scans of 2 ms."""
SCAN_MS = 10
"""Milliseconds between two calls where a scenario says nothing else."""
FRAME_MS = 300
"""Milliseconds that the longest frame takes at 9600 bit/s: 255 characters of 11 bits."""
LOST_SCANS = 3
"""When the clock of a master on S7-1200/1500 starts again, its timer needs two calls to run: that time is lost."""
RECEIVE_FAULT = {"RECEIVE_P2P": 0x80E1, "P_RCV_RK": 0x080C}
"""STATUS of a parity error: TIA Portal information system, "Error messages"; CP 341, event class 8."""
OTHERS = bytes.fromhex("10 05 03 49 51 16")
"""A frame of station 3 for station 5: SD1, DA, SA, FC, the sum of the three, ED."""
HEADER_ERRORS = (0x8001, 0x8104, 0x8404, 0x8500, 0xD602)


@dataclass(frozen=True, slots=True, kw_only=True)
class PpiScenario(Scenario):
    """One run of a job of a PPI master.

    The line: ``faults`` of the simulated stations; ``edit`` changes the PDU of every reply, whose frame stays right,
    ``bend`` the bytes of the first one, which is ``broken`` behind so many bytes (from the end if negative) and goes on
    ``rest`` ms later, with ``again`` bytes and another break if that is not 0;
    ``echo`` lets the module hear what it sends while it sends it.

    The module: ``port`` maps the n-th transmission (0: every one) to a STATUS it fails with, ``hang`` keeps
    transmissions busy, ``stuck`` a RESET, too; ``refusals`` are what its other blocks fail with, ``gone`` takes it
    away, ``forgets``: it has been without power, but not the CPU.

    The CPU: ``fresh`` restarts it first, ``wild`` scans take anything up to the longest cycle of OB1, ``twice``: every
    second one takes 0 ms, ``measured`` runs tell their longest scan.

    Expected: ``polls`` is what the diagnostics must say (None: not checked), ``errors`` those of the addresses by
    position, ``header`` and ``module`` the error words, ``pace`` the ms behind the first frame, behind every other one
    but the last, and from the last to the end of the job, ``ignored`` and ``damaged`` how many frames are counted so.
    """

    faults: tuple[Fault, ...] = ()
    port: Mapping[int, int] = field(default_factory=dict)
    hang: bool = False
    stuck: bool = False
    refusals: Mapping[str, int] = field(default_factory=dict)
    edit: Edit | None = None
    bend: Bend | None = None
    broken: int = 0
    again: int = 0
    rest: int = PAUSE
    echo: bool = False
    forgets: bool = False
    gone: bool = False
    fresh: bool = False
    polls: int | None = 1
    errors: Mapping[int, int] = field(default_factory=dict)
    header: int = 0
    module: int = 0
    pace: tuple[int, int, int] | None = None
    wild: bool = False
    twice: bool = False
    measured: bool = False
    ignored: int | None = None
    damaged: int | None = None

    @property
    def restarts(self) -> bool:
        """Whether the CPU starts again in the middle of the job: what was before is forgotten."""
        return any(happening in {"cold", "warm"} for happening in self.happens.values())


def fault(kind: str, at: At = "any", times: int | None = 1, **more: int) -> Fault:
    """One fault of the simulated line; ``times`` None is forever."""
    data = b"\xff\x00" if kind == "noise" else b""
    return Fault(FaultKind(kind), times=times, at=at, data=data, **more)


def _again(master: PlannedMaster) -> tuple[int, ...]:
    """What comes of one frame that is lost: nothing, if it may be repeated."""
    return (DONE,) if master.retries else (WORDS["NO_ANSWER"],)


def _repeated(master: PlannedMaster, polls: int = 1) -> dict[str, Any]:
    """Expectations of a run in which one frame is lost; ``polls`` is how many there were if that was the end."""
    return {
        "status": _again(master),
        "retries": min(1, master.retries),
        "polls": 1 if master.retries else polls,
    }


def in_time(master: PlannedMaster, job: PpiJob, scenario: PpiScenario) -> PpiScenario:
    """The same scenario; if all that it may take does not surely fit the timeout of the job, it may end so, too."""
    retries = master.retries if scenario.retries is None else scenario.retries
    polls = master.polls if scenario.polls is None else scenario.polls
    length = master.ob1_cycle if scenario.wild else scenario.scan
    once = FRAME_MS * 9600 // master.baud + 8 * length
    wait = max(master.ack_timeout, master.reply_timeout) + master.retry_pause
    frames = len(job.telegrams) + (job.kind != "read")  # in front of the first may be the harmless read
    slow = len(job.telegrams) * 2 * once + sum(
        each.milliseconds for each in scenario.faults if each.kind is FaultKind.LATE
    )
    # a fault that never ends strikes every telegram of a job that goes on nevertheless
    strikes = frames if DONE in scenario.status and any(each.times is None for each in scenario.faults) else 1
    lost = strikes * (retries * (wait + once) + polls * (master.poll_pause + once))
    if slow + once + lost < job.timeout or scenario.took:
        return scenario
    return replace(scenario, status=(*scenario.status, WORDS["TIMEOUT"]), retries=None, polls=None)


def line_scenarios(master: PlannedMaster, job: PpiJob, *, every: bool) -> Iterator[PpiScenario]:
    """Everything a line and a station can do wrong; with ``every`` each return code at each item."""
    most, polls = master.retries, master.polls
    silent = (WORDS["NO_ANSWER"],)
    again = _again(master)
    yield PpiScenario(name="first job after power-up", fresh=True, retries=None, polls=None)
    yield from _spoilt(master)
    for spot, byte in ((4, "high"), (5, "low")):
        yield PpiScenario(
            name=f"reference with another {byte} byte",
            edit=lambda pdu, spot=spot: pdu[:spot] + bytes((pdu[spot] ^ 1,)) + pdu[spot + 1 :],  # type: ignore[misc]
            status=silent,
            retries=most,
            polls=None,
        )
    repeats: tuple[tuple[int | None, str], ...] = ((1, "once"), (None, "forever"))
    for number, how in repeats:  # the second answer before is the right one
        stale = (fault("stale", "poll", number),)
        yield PpiScenario(name=f"an old answer {how}", faults=stale, retries=min(1, most), status=again)
    yield from _ready(polls)
    yield PpiScenario(name="the module hears what it sends", echo=True)
    for name, bend, ignored in bends():
        yield PpiScenario(
            name=f"reply with {name}", bend=bend, ignored=ignored, damaged=1 - ignored, **_repeated(master)
        )
    yield PpiScenario(name="a reply of high priority (0Ah)", bend=changed(6, 0x02, sums=True), ignored=0, damaged=0)
    yield from _broken_off(silent, most)
    yield from _in_front(most, polls)
    yield from _alone(master)
    for octets in (1, 3, 4, 20, -1):
        yield PpiScenario(name=f"reply that breaks off after {octets} bytes and goes on", broken=octets)
    yield PpiScenario(
        name="reply that breaks off, its rest after the next poll",
        broken=20,
        rest=master.reply_timeout,
        retries=None,
        polls=None,
        status=(*again, WORDS["NO_ANSWER"]),
    )
    for kind in ("count", "length"):
        if job.kind == "read" or (kind == "count" and job.kind == "write"):
            yield PpiScenario(
                name=f"reply with a wrong {kind}", faults=(fault(kind, "poll"),), status=(WORDS["REPLY_FORMAT"],)
            )
    yield from _line_refusals(master)
    yield from _late(master)
    yield from _in_the_pause(master)
    yield from _refusals(job, every=every)
    yield from _short(master, job)
    yield from _first_read(job)
    for name, edit in edits(job):
        yield PpiScenario(
            name=f"reply with {name}", edit=edit, status=(WORDS["REPLY_FORMAT"],), retries=None, polls=None
        )


def _in_front(most: int, polls: int) -> Iterator[PpiScenario]:
    """Frames of others, tokens and noise in front of answers; an answer that is late for another reason."""
    in_front: tuple[tuple[str, At], ...] = (("token", "any"), ("foreign", "any"), ("noise", "poll"))
    for kind, at in in_front:
        yield PpiScenario(name=f"{kind} before every answer", faults=(fault(kind, at, None),))
    yield PpiScenario(
        name="a frame of others right behind E5",
        faults=(replace(fault("garbage", "request"), data=b"\xe5" + OTHERS),), ignored=1, damaged=0,
    )  # fmt: skip
    yield PpiScenario(name="noise before E5", faults=(fault("noise", "request"),), retries=min(1, most))
    yield PpiScenario(
        name="a frame of others and noise before the reply",
        bend=lambda reply: OTHERS + b"\xff" + reply,
        ignored=1,
        damaged=1,
    )
    yield PpiScenario(name="a frame of others after the reply", bend=lambda reply: reply + OTHERS, ignored=0, damaged=0)
    yield PpiScenario(
        name="a frame of others and a reply that breaks off",
        bend=lambda reply: OTHERS + reply,
        broken=len(OTHERS) + 20,
        ignored=1,
    )
    if polls > 2 and most:
        lost = (fault("deaf", "request"), fault("not_ready", times=2))
        yield PpiScenario(name="a request that is lost, then no data yet", faults=lost, retries=1, polls=3)


def _broken_off(silent: tuple[int, ...], most: int) -> Iterator[PpiScenario]:
    """Replies that end before their end byte."""
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
        name="refused with 02h once", faults=(fault("nack", "request", value=2),), **_repeated(master, polls=0)
    )


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
    yield PpiScenario(name="reply without its last byte", faults=(fault("cut", "poll", value=-1),), **_repeated(master))
    frames = len(job.telegrams) + (job.kind != "read")
    if most and frames > 1 and (most + 3) * (ack + pause) + reply < job.timeout:
        lost = (fault("deaf", "request"), fault("deaf", "request", most, after=2))
        yield PpiScenario(
            name="a frame lost in the first telegram, as many as allowed in the next",
            faults=lost, fresh=True, retries=most if frames == 2 else None, polls=None,
        )  # fmt: skip


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


def _late(master: PlannedMaster) -> Iterator[PpiScenario]:
    """Answers behind their time."""
    # a late E5 looks like "not ready" to the poll of a repeated request: the job may fail, but says so
    ends = (DONE, WORDS["NOT_READY"], WORDS["NO_ANSWER"])
    for late in (100, 200, 400, 900):
        once = (fault("late", milliseconds=late),)
        always = (fault("late", times=None, milliseconds=late),)
        good = (DONE,) if late < master.ack_timeout else ends
        yield PpiScenario(name=f"answer {late} ms late", faults=once, retries=None, polls=None, status=good)
        yield PpiScenario(
            name=f"every answer {late} ms late",
            faults=always,
            retries=None,
            polls=None,
            status=(*ends, WORDS["TIMEOUT"]),
        )


def _in_the_pause(master: PlannedMaster) -> Iterator[PpiScenario]:
    """A reply that comes in the pause behind its time: one of these lengths meets it.

    A CP 341 hands a frame over in up to eight scans.
    """
    step = max(1, master.retry_pause // 2)
    begin = master.reply_timeout - FRAME_MS - 8 * SCAN_MS
    for late in range(max(step, begin), master.reply_timeout + master.retry_pause, step):
        yield PpiScenario(
            name=f"reply {late} ms late", faults=(fault("late", "poll", milliseconds=late),), retries=None, polls=None,
            status=(DONE, WORDS["NOT_READY"], WORDS["NO_ANSWER"]),
        )  # fmt: skip


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
    yield PpiScenario(name="a frame without an answer", faults=(short,), **_repeated(master))


def _alone(master: PlannedMaster) -> Iterator[PpiScenario]:
    """Messages that hold nothing but a token, or the beginning of one or of a short frame; the answer comes later."""
    for data, what, damaged in (
        (b"\xdc\x03\x05", "a token", 0),
        (b"\xdc\x03", "two bytes of a token", 1),
        (b"\x68\x10\x11\x00", "a head with two lengths", 1),
        (b"\x10\x03\x05\x49\x51", "a short frame without its end", 1),
    ):
        noise = replace(fault("noise", "poll"), data=data)
        yield PpiScenario(
            name=f"{what} alone",
            faults=(noise, fault("late", "poll", milliseconds=LATE_MS)),
            damaged=damaged if master.reply_timeout > LATE_MS + POLL_MS else None,
            ignored=0,
            retries=None,
            polls=None,
            status=(DONE,) if master.reply_timeout > LATE_MS + POLL_MS else (DONE, WORDS["NO_ANSWER"]),
        )


def _first_read(job: PpiJob) -> Iterator[PpiScenario]:
    """The read in front of the first write with an item or a parameter that nobody asked for."""
    for name in ("an item", "a parameter") if job.kind != "read" else ():
        yield PpiScenario(
            name=f"first read with {name} too many",
            edit=TOO_MANY[name],
            status=(WORDS["REPLY_FORMAT"],),
            fresh=True,
            retries=None,
            polls=None,
        )


def _ready(polls: int) -> Iterator[PpiScenario]:
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


def _refusals(job: PpiJob, *, every: bool) -> Iterator[PpiScenario]:
    """Return codes at every position, and refusals of the whole job."""
    for code in HEADER_ERRORS:
        yield PpiScenario(
            name=f"job refused with {code:04X}h",
            faults=(fault("header", code=code),),
            status=(WORDS["REFUSED"],),
            header=code,
        )
    yield PpiScenario(
        name="job refused with an acknowledgement (ROSCTR 2)", faults=(fault("header", code=HEADER_ERRORS[0]),),
        edit=lambda pdu: pdu[:1] + b"\x02" + pdu[2:], status=(WORDS["REFUSED"],), header=HEADER_ERRORS[0],
        retries=None, polls=None,
    )  # fmt: skip
    if job.telegrams[0].response is not None:
        yield PpiScenario(
            name="an item refused in a reply with a byte too many",
            faults=tuple(fault("item", item=n, code=5) for n, _ in enumerate(job.telegrams[0].items, 1)),
            edit=lambda pdu: with_data(pdu, pdu[14:] + b"\xff"), status=(WORDS["REPLY_FORMAT"],),
            retries=None, polls=None,
        )  # fmt: skip
    for after, telegram in enumerate(job.telegrams):
        for number, wire in enumerate(telegram.items if telegram.response is not None else (), 1):
            positions = sorted({placed.value.position for placed in wire.values})
            for code in _codes(number, len(telegram.items), every=every):
                yield PpiScenario(
                    name=f"item {number} of telegram {telegram.number} refused with {code:02X}h",
                    faults=(fault("item", item=number, code=code, after=after),),
                    status=(WORDS["ITEM_ERROR"],),
                    errors=dict.fromkeys(positions, 0x8000 | code),
                    retries=None,
                    polls=None,
                )
        count = len(telegram.items) if telegram.response is not None else 0
        for name, numbers in (("first and last item", (1, count)), ("last two items", (count - 1, count))):
            if count < len(numbers) or (numbers[0] == 1 and name != "first and last item"):
                continue
            wrong = [telegram.items[number - 1] for number in numbers]
            places = sorted({placed.value.position for wire in wrong for placed in wire.values})
            yield PpiScenario(
                name=f"{name} of telegram {telegram.number} refused",
                faults=tuple(fault("item", item=n, code=5, after=after) for n in numbers),
                status=(WORDS["ITEM_ERROR"],),
                errors=dict.fromkeys(places, 0x8005),
                retries=None,
                polls=None,
            )


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
    """A CM 1241 that loses or refuses its settings."""
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


def core_scenarios(master: PlannedMaster, job: PpiJob, scans: int, *, classic: bool) -> Iterator[PpiScenario]:
    """What depends on the job itself, and one fault of each kind of the rest."""
    yield PpiScenario(name="first job after power-up", fresh=True, retries=None, polls=None)
    for at, kind in (("request", "silence"), ("poll", "fcs"), ("poll", "silence")):
        once = fault(kind, "request" if at == "request" else "poll")
        yield PpiScenario(name=f"{kind} at the {at}", faults=(once,), **_repeated(master, polls=at == "poll"))
    dead = (fault("deaf", times=None),)
    yield PpiScenario(
        name="silence forever", faults=dead, status=(WORDS["NO_ANSWER"],), retries=master.retries, polls=0
    )
    yield from _ready(master.polls)
    yield from _refusals(job, every=False)
    yield from _first_read(job)
    for name, edit in edits(job):
        yield PpiScenario(
            name=f"reply with {name}", edit=edit, status=(WORDS["REPLY_FORMAT"],), retries=None, polls=None
        )
    yield from hangs(master, job, classic=classic)
    yield PpiScenario(name="execute dropped", happens={scans // 2: "drop"})
    yield PpiScenario(name="cold restart", happens={scans // 2: "cold"}, retries=None, polls=None)
    yield PpiScenario(name="scans of random length", wild=True, retries=None, polls=None)
