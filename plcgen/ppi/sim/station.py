"""One simulated S7-200 on the line: frames in and out, frame count bits, polls, and the CPU that answers PDUs.

A request is acknowledged with E5 and executed; its answer waits for a poll. With FCV = 1 and the frame count bit of
the frame before, a frame is a repetition (EN 50170): it is answered again and not executed twice. FCV = 0 (6Ch) starts
a new sequence.
"""

from __future__ import annotations

import enum
from collections.abc import Callable, Mapping
from copy import copy
from dataclasses import dataclass, field
from typing import Any, Literal

from plcgen.ppi.sim.memory import KnownReads, StationMemory, decode_value, encode_value
from plcgen.ppi.wire.address import parse_item
from plcgen.ppi.wire.areas import JOB_HEADER, PDU_LIMIT, Area, Function, ReturnCode, Rosctr
from plcgen.ppi.wire.errors import Kind, Violation
from plcgen.ppi.wire.model import (
    FCB,
    FCV,
    REQUEST,
    Acknowledgement,
    AckReply,
    ErrorReply,
    FixedFrame,
    ForceRequest,
    Frame,
    Item,
    ItemResult,
    Pdu,
    ReadReply,
    ReadRequest,
    Reply,
    RunRequest,
    SetupReply,
    SetupRequest,
    StopRequest,
    VariableFrame,
    WriteReply,
    WriteRequest,
)
from plcgen.ppi.wire.pdu import PROTOCOL, encode_pdu, examine_pdu, reply_size
from plcgen.ppi.wire.profiles import profile
from plcgen.ppi.wire.telegram import DATA_FUNCTION

WRONG_SWITCH, NOT_SUPPORTED, BUSY, LENGTH_ERROR, PASSWORD = 0x8001, 0x8104, 0x8404, 0x8500, 0xD602
"""Errors in the header of an answer. Of D6xx, "password", the last two digits were not checked with a CPU."""

LEAST_PDU = 32
"""A smaller PDU would hold no answer; no S7-200 negotiates one."""

_LENGTHS = frozenset({
    Kind.SHORT, Kind.PARAMETER_LENGTH, Kind.DATA_LENGTH, Kind.ITEM_COUNT, Kind.LIMIT,
})  # fmt: skip
_UNKNOWN = frozenset({Kind.ITEM_HEADER, Kind.SERVICE})
_OUTPUTS = frozenset({Area.Q, Area.AQ})


class Mode(enum.Enum):
    """Operating mode."""

    RUN = "run"
    STOP = "stop"


class Switch(enum.Enum):
    """Position of the mode switch; in STOP the CPU cannot be started from outside."""

    RUN = "run"
    TERM = "term"
    STOP = "stop"


class Service(enum.Enum):
    """What a password can protect."""

    READ = "read"
    WRITE = "write"
    RUN = "run"
    STOP = "stop"
    FORCE = "force"
    OUTPUTS = "outputs"  # writing outputs while in STOP


BY_LEVEL: Mapping[int, frozenset[Service]] = {
    1: frozenset(),
    **dict.fromkeys((2, 3, 4), frozenset({Service.FORCE, Service.OUTPUTS})),
}
"""Services that need the password at each protection level. Source: S7-200 system manual, "Restricting access to the
CPU": user data, RUN and STOP stay allowed at every level, forcing and writing outputs in STOP do not."""


@dataclass(slots=True)
class Session:
    """What a CPU remembers of one master: the PDU size they negotiated, None before that."""

    limit: int | None = None


@dataclass(slots=True)
class StationCpu:
    """One CPU. ``protected`` names the services that it refuses with D6xx, as nobody has given the password.

    ``jobs`` counts the PDUs that it was given.
    """

    memory: StationMemory
    mode: Mode = Mode.RUN
    switch: Switch = Switch.TERM
    pdu_limit: int = PDU_LIMIT
    protected: frozenset[Service] = frozenset()
    jobs: int = 0
    _reads: KnownReads = field(init=False)

    def __post_init__(self) -> None:
        self._reads = KnownReads(self.memory)

    def answer(
        self, data: bytes, session: Session, *, refuse: int | None = None, items: Mapping[int, int] | None = None
    ) -> bytes | None:
        """Execute the PDU in ``data`` and return the PDU of the answer; None if it is thrown away.

        ``refuse`` is a header error that ends the job at once, ``items`` return codes that item numbers (from 1) get
        instead of being executed: both are faults.
        """
        self.jobs += 1
        if len(data) < JOB_HEADER or data[0] != PROTOCOL or data[1] not in {Rosctr.JOB, Rosctr.USERDATA}:
            return None
        limit = session.limit or self.pdu_limit
        plain = not refuse and not items and len(data) <= limit and Service.READ not in self.protected
        known = self._reads.find(data) if plain else None
        if known is not None and known.size <= limit:
            return known.answer(data[4:6])
        reference = data[4] << 8 | data[5]
        pdu, found = examine_pdu(data)
        if plain and not found and isinstance(pdu, ReadRequest):
            self._reads.keep(data, pdu)
        code = refuse or _header_error(found) or (LENGTH_ERROR if len(data) > limit else 0)
        if code or pdu is None:
            return encode_pdu(_error(reference, code or LENGTH_ERROR))
        return encode_pdu(self._execute(pdu, session, limit, items or {}))

    def _execute(self, pdu: Pdu, session: Session, limit: int, items: Mapping[int, int]) -> Reply:
        reference = pdu.reference
        if isinstance(pdu, ReadRequest):
            return self._read(pdu, limit, items)
        if isinstance(pdu, WriteRequest):
            return self._write(pdu, items)
        if isinstance(pdu, SetupRequest):
            session.limit = max(LEAST_PDU, min(pdu.pdu_size, self.pdu_limit))
            return SetupReply(reference, session.limit, 1, 1)
        if isinstance(pdu, RunRequest):
            return self._switch(reference, Function.PI_SERVICE, Service.RUN, Mode.RUN)
        if isinstance(pdu, StopRequest):
            return self._switch(reference, Function.STOP, Service.STOP, Mode.STOP)
        if isinstance(pdu, ForceRequest):
            if Service.FORCE in self.protected:
                return _error(reference, PASSWORD)
            code = self.memory.force(pdu.item, pdu.data)
            return AckReply(reference) if code == ReturnCode.OK else _error(reference, NOT_SUPPORTED)
        return _error(reference, NOT_SUPPORTED)

    def _read(self, pdu: ReadRequest, limit: int, items: Mapping[int, int]) -> Reply:
        if Service.READ in self.protected:
            return _error(pdu.reference, PASSWORD)
        good = tuple(item for item in pdu.items if self.memory.check(item) == ReturnCode.OK)
        if reply_size(good) > limit:
            return _error(pdu.reference, LENGTH_ERROR)
        results = (
            ItemResult(items[number]) if number in items else self.memory.read(item)
            for number, item in enumerate(pdu.items, 1)
        )
        return ReadReply(pdu.reference, tuple(results))

    def _write(self, pdu: WriteRequest, items: Mapping[int, int]) -> Reply:
        outputs = Service.OUTPUTS in self.protected and self.mode is Mode.STOP
        if Service.WRITE in self.protected or (outputs and any(entry.item.area in _OUTPUTS for entry in pdu.items)):
            return _error(pdu.reference, PASSWORD)
        codes = (
            items[number] if number in items else self.memory.write(entry.item, entry.data)
            for number, entry in enumerate(pdu.items, 1)
        )
        return WriteReply(pdu.reference, tuple(codes))

    def _switch(self, reference: int, function: Function, service: Service, mode: Mode) -> Reply:
        if service in self.protected:
            return _error(reference, PASSWORD)
        if mode is Mode.RUN and self.switch is Switch.STOP:
            return _error(reference, WRONG_SWITCH)
        self.mode = mode
        return AckReply(reference, function)


def _error(reference: int, code: int) -> ErrorReply:
    return ErrorReply(reference, code >> 8, code & 0xFF)


def _header_error(found: list[Violation]) -> int:
    """Header error of a PDU that is wrong as a whole, 0 if each item can be judged on its own."""
    kinds = {violation.kind for violation in found}
    if kinds & _LENGTHS:
        return LENGTH_ERROR
    return NOT_SUPPORTED if kinds & _UNKNOWN else 0


FrameCountRule = Literal["standard", "strict", "ignore"]
"""``standard``: a repeated poll that got E5 before is a new poll, for masters that poll with 5Ch only. ``strict``: it
gets E5 again, to the letter of EN 50170. ``ignore``: every frame is new, for masters that never alternate."""

_STATUS, _SRD_LOW, _SRD_HIGH = 0x9, 0xC, 0xD
_WITHOUT_ANSWER = frozenset({0x4, 0x6})
_SLAVE, _NOT_ACTIVATED = 0x00, 0x03
_ACK = Acknowledgement()


@dataclass(slots=True)
class _Link:
    """What a station remembers of one master: last frame count bit, last answer, the answer that waits for a poll."""

    session: Session = field(default_factory=Session)
    bit: int | None = None
    last: Frame | None = None
    waiting: bytes | None = None
    polls: int = 0


@dataclass(frozen=True, slots=True)
class Interference:
    """What faults do to one frame on its way: a header error, return codes of items by number, "not ready"."""

    refuse: int | None = None
    items: Mapping[int, int] | None = None
    not_ready: bool = False


class Station:
    """An S7-200 with an address. ``station["VB100"]`` reads and sets its memory as the process would.

    not_ready: how many polls of every request get E5 before the answer.
    """

    def __init__(
        self,
        cpu: str = "224",
        address: int = 2,
        *,
        values: Mapping[str, Any] | None = None,
        symbols: Mapping[str, str] | None = None,
        mode: Mode = Mode.RUN,
        switch: Switch = Switch.TERM,
        type_: str | None = None,
        pdu_limit: int = PDU_LIMIT,
        not_ready: int = 0,
        frame_count: FrameCountRule = "standard",
        protected: frozenset[Service] = BY_LEVEL[1],
        write_inputs: bool = True,
    ) -> None:
        if not 0 <= address <= 126:
            raise ValueError(f"a station address is 0 to 126, not {address}")
        memory = StationMemory(profile(cpu), type_, write_inputs=write_inputs)
        self.cpu = StationCpu(memory, mode, switch, pdu_limit, protected)
        self.address = address
        self.symbols = dict(symbols or {})
        self.not_ready = not_ready
        self.frame_count = frame_count
        self._links: dict[int, _Link] = {}
        for name, value in (values or {}).items():
            self[name] = value

    @property
    def mode(self) -> Mode:
        """RUN or STOP."""
        return self.cpu.mode

    @property
    def executed(self) -> int:
        """How many requests have been executed."""
        return self.cpu.jobs

    def item(self, name: str) -> Item:
        """Return the item of an address or symbol. Raises AddressError, IndexError if this CPU does not have it."""
        item = parse_item(self.symbols.get(name, name))
        code = self.cpu.memory.check(item)
        if code != ReturnCode.OK:
            raise IndexError(f"{name} is beyond the memory of a {self.cpu.memory.profile.title}")
        return item

    def __getitem__(self, name: str) -> Any:
        item = self.item(name)
        return decode_value(item, self.cpu.memory.read(item).data)

    def __setitem__(self, name: str, value: Any) -> None:
        item = self.item(name)
        self.cpu.memory.put(item, encode_value(item, value))

    def twin(self) -> Station:
        """The same CPU on another line: memory and mode are shared, masters are not."""
        other = copy(self)
        other._links = {}  # noqa: SLF001 - its own class
        return other

    def receive(self, frame: Frame, interfere: Callable[[], Interference] = Interference) -> Frame | None:
        """Take a frame from the line and return the answer, None if it is not for this station or gets none.

        ``interfere`` is asked once, if the frame is a new request or a poll for an answer that is there.
        """
        if not isinstance(frame, FixedFrame | VariableFrame) or frame.destination != self.address:
            return None
        kind = frame.function & 0x0F
        if not frame.function & REQUEST or kind in _WITHOUT_ANSWER:
            return None
        if kind == _STATUS:
            return FixedFrame(frame.source, self.address, _SLAVE)
        if kind not in {_SRD_LOW, _SRD_HIGH}:
            return FixedFrame(frame.source, self.address, _NOT_ACTIVATED)
        link = self._links.setdefault(frame.source, _Link())
        repeated = self._repeats(link, frame)
        link.bit = frame.function & FCB
        if not repeated or link.last is None:
            link.last = self._new(link, frame, interfere)
        return link.last

    def _repeats(self, link: _Link, frame: FixedFrame | VariableFrame) -> bool:
        if self.frame_count == "ignore" or not frame.function & FCV or link.bit != frame.function & FCB:
            return False
        poll_again = isinstance(frame, FixedFrame) and isinstance(link.last, Acknowledgement)
        return not poll_again or self.frame_count == "strict"

    def _new(self, link: _Link, frame: FixedFrame | VariableFrame, interfere: Callable[[], Interference]) -> Frame:
        if isinstance(frame, VariableFrame):
            found = interfere()
            link.waiting = self.cpu.answer(frame.pdu, link.session, refuse=found.refuse, items=found.items)
            link.polls = 0
            return _ACK
        if link.waiting is None:
            return _ACK
        link.polls += 1
        if link.polls <= self.not_ready or interfere().not_ready:
            return _ACK
        data, link.waiting = link.waiting, None
        return VariableFrame(frame.source, self.address, DATA_FUNCTION, data)
