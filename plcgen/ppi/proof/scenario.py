"""One scenario: what line, station and CPU do to a job of a PPI master, which replies are changed, what it must report.

Expectations come from docs/ppi-master.md, EN 50170 and the manuals of the modules, never from a run.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Any

from plcgen.ppi.plan.nouns import PlannedMaster, PpiJob, PpiTelegram
from plcgen.ppi.proof.words import DONE, WORDS
from plcgen.ppi.sim import Fault, FaultKind
from plcgen.ppi.sim.faults import At
from plcgen.proof.scenario import Scenario

Edit = Callable[[bytes], bytes]
"""What becomes of the PDU of a reply on its way; its frame is made anew around it."""
Bend = Callable[[bytes], bytes]
"""What becomes of the bytes of a reply on its way."""

TOO_MANY: Mapping[str, Edit] = {
    "an item": lambda pdu: pdu[:13] + bytes((pdu[13] + 1,)) + pdu[14:],
    "a parameter": lambda pdu: pdu[:7] + b"\x03" + pdu[8:14] + b"\0" + pdu[14:],
}


def edits(job: PpiJob) -> Iterator[tuple[str, Edit]]:
    """Replies whose frame and reference are right and whose PDU is not."""
    yield "a parameter length beyond its end", lambda pdu: pdu[:6] + b"\x01" + pdu[7:]
    yield "a data length of 256 more", lambda pdu: pdu[:8] + b"\x01" + pdu[9:]
    yield "a data length of one more", lambda pdu: pdu[:9] + bytes((pdu[9] + 1 & 0xFF,)) + pdu[10:]
    yield "another function", lambda pdu: pdu[:12] + bytes((pdu[12] ^ 0x20,)) + pdu[13:]
    yield "no parameters", lambda pdu: pdu[:6] + b"\0\0" + pdu[8:12] + pdu[14:] + b"\0\0\0"
    if job.kind in {"run", "stop"}:
        yield "a parameter too many", lambda pdu: pdu[:7] + b"\x02" + pdu[8:] + b"\0"
        yield "data", lambda pdu: pdu[:9] + b"\x01" + pdu[10:] + b"\xff"
        return
    yield "a byte too many", lambda pdu: with_data(pdu, pdu[14:] + b"\xff")
    yield "a byte too few", lambda pdu: with_data(pdu, pdu[14:-1])
    yield from ((f"{name} too many", edit) for name, edit in TOO_MANY.items())
    if job.kind == "read":
        yield "all items but the first", lambda pdu: with_data(pdu, b"".join(_items(pdu)[1:]))
        yield "all items but the last", lambda pdu: with_data(pdu, b"".join(_items(pdu)[:-1]))
        yield "half an item", lambda pdu: with_data(pdu, pdu[14:16])
        yield "another size code", lambda pdu: pdu[:15] + bytes((pdu[15] ^ 0x0F,)) + pdu[16:]
        yield "another value length", lambda pdu: pdu[:17] + bytes((pdu[17] ^ 0x08,)) + pdu[18:]


def _items(pdu: bytes) -> list[bytes]:
    """The items of a reply to a read: return code, size code, length in bits (04) or bytes, value, pad between two."""
    found, at = [], 14
    while at < len(pdu):
        length = int.from_bytes(pdu[at + 2 : at + 4])
        size = length // 8 if pdu[at + 1] == 4 else length
        end = min(len(pdu), at + 4 + size + size % 2)
        found.append(pdu[at:end])
        at = end
    return found


def with_data(pdu: bytes, data: bytes) -> bytes:
    """A reply with other data, whose length is right."""
    return pdu[:8] + len(data).to_bytes(2) + pdu[10:14] + data


def bends() -> Iterator[tuple[str, Bend, int]]:
    """Replies whose frame is wrong at one place, or not for this master, and otherwise right to the last bit; whether
    they are frames that are passed over (1) or damaged ones (0).
    """
    yield "another destination", changed(4, 0x40, sums=True), 1
    yield "another protocol", changed(7, 0x01, sums=True), 1
    yield "the code of a request", changed(8, 0x02, sums=True), 1
    yield "another repeated length", changed(2, 0x01), 0
    yield "another second start byte", changed(3, 0x01), 0
    yield "another end byte", changed(-1, 0x01), 0


def changed(at: int, bits: int, *, sums: bool = False) -> Bend:
    """Some bits of a byte are others, with ``sums`` the checksum is right nevertheless."""

    def bend(data: bytes) -> bytes:
        found = bytearray(data)
        found[at] ^= bits
        found[-2] = sum(found[4:-2]) & 0xFF if sums else found[-2]
        return bytes(found)

    return bend


PAUSE = 40
"""Milliseconds between the two parts of a reply: many times the gap that ends a message."""
LATE_MS = 100
POLL_MS = 60
"""Milliseconds that a poll and E5 take in scans of 2 ms."""
SCAN_MS = 10
"""Milliseconds between two calls where a scenario says nothing else."""
FRAME_MS = 300
"""Milliseconds that the longest frame takes at 9600 bit/s: 255 characters of 11 bits."""
REPLY_FRAME, SHORT_REPLY = 23, 22
"""Bytes of a reply around its data; of one to RUN or STOP."""
CHARACTER_BITS = 11
"""Start bit, 8 data bits, parity, stop bit."""
GAP_MS = 4
"""Milliseconds of the gap behind a message, 35 bit times."""
FOREIGN_BYTES, OTHER_BYTES = 68, 8
"""Bytes of an exchange of others in front of an answer: request 33, E5, poll 6, reply 28; of anything else there."""
FRAME_CALLS = 8
"""Calls that a module takes for a frame, but for the longest ones through a CP 341."""
LOST_SCANS = 3
"""When the clock of a master on S7-1200/1500 starts again, its timer needs two calls to run: that time is lost."""


@dataclass(frozen=True, slots=True, kw_only=True)
class PpiScenario(Scenario):
    """One run of a job of a PPI master.

    The line: ``faults`` of the simulated stations; ``edit`` changes the PDU of every reply, whose frame stays right,
    ``bend`` the bytes of the first one, which is ``broken`` behind so many bytes (from the end if negative) and goes on
    ``rest`` ms later, with ``again`` bytes and another break if that is not 0; ``only``: one reply comes, so many ms
    late, and E5 instead of every other one, before it too if it is ``unready``;
    ``echo`` lets the module hear what it sends while it sends it.

    The module: ``port`` maps the n-th transmission (0: every one) to a STATUS it fails with, ``hang`` keeps
    transmissions busy, ``stuck`` a RESET, too; ``refusals`` are what its other blocks fail with, ``gone`` takes it
    away, ``forgets``: it has been without power, but not the CPU.

    The CPU: ``fresh`` restarts it first, ``wild`` scans take anything up to the longest cycle of OB1, ``twice``: every
    second one takes 0 ms, as the first one of a pause does then and if ``unready``, ``measured`` runs tell their
    longest scan.

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
    only: int = 0
    unready: bool = False
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
    def intact(self) -> bool:
        """Whether a reply whose frame is right is right."""
        return self.edit is None and self.bend is None and not self.restarts

    @property
    def restarts(self) -> bool:
        """Whether the CPU starts again in the middle of the job: what was before is forgotten."""
        return any(happening in {"cold", "warm"} for happening in self.happens.values())


loose = partial(PpiScenario, retries=None, polls=None)
"""A run of which nobody counts repetitions and polls."""


def others(master: PlannedMaster) -> bytes:
    """A short frame between two addresses that nobody here has: SD1, DA, SA, FC, the sum of the three, ED."""
    known = {master.own_address, *(station.address for station in master.stations)}
    body = bytes((*[n for n in range(1, 127) if n not in known][:2], 0x49))
    return b"\x10" + body + bytes((sum(body) & 0xFF, 0x16))


def reply_length(telegram: PpiTelegram) -> int:
    """Bytes of the frame that answers a telegram, if every item is good."""
    return SHORT_REPLY if telegram.response is None else REPLY_FRAME + telegram.response.size


def fault(kind: str, at: At = "any", times: int | None = 1, **more: int) -> Fault:
    """One fault of the simulated line; ``times`` None is forever."""
    data = b"\xff\x00" if kind == "noise" else b""
    return Fault(FaultKind(kind), times=times, at=at, data=data, **more)


def answered_again(master: PlannedMaster) -> tuple[int, ...]:
    """What comes of one frame that is lost: nothing, if it may be repeated."""
    return (DONE,) if master.retries else (WORDS["NO_ANSWER"],)


def lost_once(master: PlannedMaster, polls: int = 1) -> dict[str, Any]:
    """Expectations of a run in which one frame is lost; ``polls`` is how many there were if that was the end."""
    return {
        "status": answered_again(master),
        "retries": min(1, master.retries),
        "polls": 1 if master.retries else polls,
    }


def in_time(master: PlannedMaster, job: PpiJob, scenario: PpiScenario) -> PpiScenario:
    """The same scenario; where it does not surely fit the times of the spec, it may end as it does when they end."""
    scenario = _waited(master, job, scenario)
    retries = master.retries if scenario.retries is None else scenario.retries
    polls = master.polls if scenario.polls is None else scenario.polls
    length = master.ob1_cycle if scenario.wild else scenario.scan
    once = FRAME_MS * 9600 // master.baud + FRAME_CALLS * length
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


def _waited(master: PlannedMaster, job: PpiJob, scenario: PpiScenario) -> PpiScenario:
    """The same scenario; an answer that it makes later than the master waits for it need not be heard."""
    in_front = {FaultKind.FOREIGN: FOREIGN_BYTES, FaultKind.NOISE: OTHER_BYTES, FaultKind.TOKEN: OTHER_BYTES}
    extra = max((in_front.get(each.kind, 0) for each in scenario.faults), default=0)
    extra = extra or OTHER_BYTES * (scenario.bend is not None)
    pieces = 1 + (scenario.broken != 0) + (scenario.again != 0)
    late = {"any": 0, "request": 0, "poll": 0}
    late |= {each.at: each.milliseconds for each in scenario.faults if each.kind is FaultKind.LATE}
    if not extra and pieces == 1 and not any(late.values()):
        return scenario
    data = max((t.response.size for t in job.telegrams if t.response is not None), default=0)
    length = master.ob1_cycle if scenario.wild else min(scenario.scan, master.ob1_cycle)

    def heard(octets: int) -> int:
        """Milliseconds that one message of so many bytes takes: its characters, the gap behind them, calls."""
        return octets * CHARACTER_BITS * 1000 // master.baud + GAP_MS + (FRAME_CALLS // 2 + octets // 32) * length

    e5 = heard(1 + extra) + max(late["any"], late["request"])
    reply = heard(REPLY_FRAME + data + extra) + max(late["any"], late["poll"])
    reply += (pieces - 1) * (scenario.rest + heard(0))
    if e5 < master.ack_timeout and reply < master.reply_timeout:
        return scenario
    ends = dict.fromkeys((*scenario.status, WORDS["NO_ANSWER"], WORDS["NOT_READY"]))
    return replace(scenario, status=tuple(ends), retries=None, polls=None, ignored=None, damaged=None, pace=None)
