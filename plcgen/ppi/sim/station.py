"""One simulated S7-200 on the line: FDL frames in and out, frame count bits, acknowledgements and polls.

A request is acknowledged with E5 and executed; its answer waits for a poll. With FCV = 1 and the frame count bit of
the frame before, a frame is a repetition (EN 50170): it is answered again and not executed twice. FCV = 0 (6Ch) starts
a new sequence.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from copy import copy
from dataclasses import dataclass, field
from typing import Any, Literal

from plcgen.ppi.sim.cpu import BY_LEVEL, Mode, Service, Session, StationCpu, Switch
from plcgen.ppi.sim.memory import StationMemory, decode_value, encode_value
from plcgen.ppi.wire.address import parse_item
from plcgen.ppi.wire.areas import PDU_LIMIT, ReturnCode
from plcgen.ppi.wire.model import FCB, FCV, REQUEST, Acknowledgement, FixedFrame, Frame, Item, VariableFrame
from plcgen.ppi.wire.profiles import profile
from plcgen.ppi.wire.telegram import DATA_FUNCTION

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
