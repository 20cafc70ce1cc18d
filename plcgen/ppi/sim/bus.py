"""A PPI line in memory with its stations, faults and journal; the time belongs to the caller."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterable
from collections.abc import Set as AbstractSet
from typing import Literal, NamedTuple

from plcgen.ppi.sim.faults import BEFORE, DAMAGING, Fault, FaultKind, before, can_damage, damage
from plcgen.ppi.sim.station import BUSY, Interference, Station
from plcgen.ppi.wire.fdl import encode_frame, found_frame
from plcgen.ppi.wire.model import Acknowledgement, FixedFrame, Frame, VariableFrame
from plcgen.ppi.wire.stream import Splitter

GAP = 200
"""Milliseconds of silence after which the rest of a frame is not waited for any more."""

_JOURNAL = 10_000
_ACKNOWLEDGED = b"\xe5"
_REFUSED_ITEM, _NO_RESOURCE = 0x05, 0x02
_REFUSALS = frozenset({0x01, 0x02, 0x03})


def _fault(text: str) -> Fault:
    """Read a fault; only texts need the reader and its libraries."""
    from plcgen.ppi.sim.faults import parse_fault

    return parse_fault(text)


class Traffic(NamedTuple):
    """Bytes on the line: when (ms), ``>`` from the masters or ``<`` from the stations, and the fault behind it.

    ``frame`` is None for bytes that are no frame, and for everything that a fault changed.
    """

    time: int
    direction: Literal[">", "<"]
    data: bytes
    frame: Frame | None = None
    note: str = ""


class Bus:
    """Stations on one line. It is an ``Endpoint``: ``receive``, ``transmit`` and ``due`` are all that a line needs.

    ``journal`` keeps what was on the line (the last 10,000 entries), ``listener`` is told of every entry. Frames may
    arrive in pieces; a gap of more than 200 ms inside one ends it. Answers of different stations cannot collide:
    addresses are unique.
    """

    def __init__(
        self,
        stations: Iterable[Station] = (),
        faults: Iterable[Fault | str] = (),
        listener: Callable[[Traffic], None] | None = None,
    ) -> None:
        self.stations: dict[int, Station] = {}
        for station in stations:
            self.add(station)
        self.faults = [_fault(fault) if isinstance(fault, str) else fault for fault in faults]
        self.journal: deque[Traffic] = deque(maxlen=_JOURNAL)
        self.listener = listener
        self._splitter = Splitter()
        self._heard = 0
        self._queue: list[Traffic] = []
        self._previous: dict[int, bytes] = {}

    def add(self, station: Station) -> None:
        """Put a station on the line. ValueError if its address is taken."""
        if station.address in self.stations:
            raise ValueError(f"address {station.address} is taken")
        self.stations[station.address] = station

    def receive(self, data: bytes, now: int) -> None:
        """Take bytes from the line that arrive at ``now`` milliseconds; answers wait for ``transmit``."""
        if self._splitter.pending and now - self._heard > GAP:
            for chunk in self._splitter.finish():
                self._note(Traffic(now, ">", chunk.data, note="unfinished"))
        self._heard = now
        chunks = self._splitter.feed(data)
        if not self._splitter.pending:
            chunks += self._splitter.finish()  # what is no frame is told at once, not with the next frame
        for chunk in chunks:
            frame = found_frame(chunk.data) if chunk.frame else None
            self._note(Traffic(now, ">", chunk.data, frame, "" if frame else "no frame"))
            station = self._addressed(frame)
            if frame is not None and station is not None:
                self._deliver(station, chunk.data, frame, now)

    def transmit(self, now: int) -> bytes:
        """Hand out the bytes that have been sent up to ``now`` milliseconds."""
        if not self._queue:
            return b""
        ready = [entry for entry in self._queue if entry.time <= now]
        if not ready:
            return b""
        self._queue = [entry for entry in self._queue if entry.time > now]
        for entry in ready:
            self._note(entry)
        return b"".join(entry.data for entry in ready)

    def due(self) -> int | None:
        """When the next bytes will be sent, None if nothing is under way."""
        return min(entry.time for entry in self._queue) if self._queue else None

    def exchange(self, data: bytes, now: int = 0) -> bytes:
        """Receive and transmit at once: the answer to bytes, without anything that comes late."""
        self.receive(data, now)
        return self.transmit(now)

    def branch(self) -> Bus:
        """Another line to the same CPUs, with masters of its own; faults, journal and listener are shared."""
        other = Bus((station.twin() for station in self.stations.values()), (), self._tell)
        other.faults, other.journal = self.faults, self.journal
        return other

    def _addressed(self, frame: Frame | None) -> Station | None:
        return self.stations.get(frame.destination) if isinstance(frame, FixedFrame | VariableFrame) else None

    def _deliver(self, station: Station, raw: bytes, frame: Frame, now: int) -> None:
        if not self.faults:
            answer = station.receive(frame)
            if answer is not None:
                sent = _ACKNOWLEDGED if isinstance(answer, Acknowledgement) else encode_frame(answer)
                if sent is not _ACKNOWLEDGED:
                    self._previous[station.address] = sent
                self._queue.append(Traffic(now, "<", sent, answer))
            return
        if self._strike(FaultKind.DEAF, station, frame):
            return
        answer = self._refusal(station, frame) or station.receive(frame, lambda: self._interference(station, frame))
        if answer is None:
            return
        late = self._strike(FaultKind.LATE, station, frame)
        due = now + (late.milliseconds if late else 0)
        for fault in self._struck(BEFORE, station, frame, answer):
            self._queue.append(Traffic(now, "<", before(fault, raw), note=fault.kind.value))
        if self._strike(FaultKind.SILENCE, station, frame):
            return
        clean = encode_frame(answer)
        sent, notes = clean, ["late"] if late else []
        for fault in self._struck(DAMAGING, station, frame, answer):
            sent = damage(fault, sent, self._previous.get(station.address))
            notes.append(fault.kind.value)
        if not isinstance(answer, Acknowledgement):
            self._previous[station.address] = clean
        if sent:
            self._queue.append(Traffic(due, "<", sent, answer if sent == clean else None, ", ".join(notes)))

    def _refusal(self, station: Station, frame: Frame) -> FixedFrame | None:
        fault = self._strike(FaultKind.NACK, station, frame)
        if fault is None or not isinstance(frame, FixedFrame | VariableFrame):
            return None
        return FixedFrame(frame.source, station.address, fault.value if fault.value in _REFUSALS else _NO_RESOURCE)

    def _interference(self, station: Station, frame: Frame) -> Interference:
        if isinstance(frame, FixedFrame):
            return Interference(not_ready=self._strike(FaultKind.NOT_READY, station, frame) is not None)
        header = self._strike(FaultKind.HEADER, station, frame)
        items = {
            fault.item: _REFUSED_ITEM if fault.code is None else fault.code
            for fault in self._struck({FaultKind.ITEM}, station, frame, None)
        }
        refuse = None if header is None else BUSY if header.code is None else header.code
        return Interference(refuse, items)

    def _strike(self, kind: FaultKind, station: Station, frame: Frame) -> Fault | None:
        return next(iter(self._struck({kind}, station, frame, None)), None)

    def _struck(
        self, kinds: AbstractSet[FaultKind], station: Station, frame: Frame, answer: Frame | None
    ) -> list[Fault]:
        """Faults of some kinds that strike a frame; each counts the occasion, and those that damage need an answer
        that can be damaged.
        """
        if not self.faults:
            return []
        found = [
            fault
            for fault in self.faults
            if fault.kind in kinds
            and fault.meets(station.address, frame)
            and (answer is None or fault.kind not in DAMAGING or can_damage(fault, answer))
            and fault.use()
        ]
        self.faults[:] = [fault for fault in self.faults if not fault.spent]
        return found

    def _note(self, entry: Traffic) -> None:
        self.journal.append(entry)
        self._tell(entry)

    def _tell(self, entry: Traffic) -> None:
        if self.listener is not None:
            self.listener(entry)
