"""A simulated drive behind two record services, with a virtual clock: what a CPU's WRREC and RDREC talk to.

State machine: IDLE -- WRREC --> PROCESSING -- time --> AVAILABLE -- RDREC --> IDLE. WRREC while PROCESSING
and RDREC while IDLE or PROCESSING end with B5h; WRREC while AVAILABLE discards the unread response. A refused
call changes nothing.
"""

from __future__ import annotations

import enum
from dataclasses import dataclass
from typing import TYPE_CHECKING

from plcgen.ds47.sim.behaviour import Behaviour
from plcgen.ds47.sim.faults import CALL_FAULTS, RESPONSE_FAULTS, Fault, FaultKind, damage
from plcgen.ds47.sim.server import WHOLE, Server
from plcgen.ds47.wire.codec import encode_response
from plcgen.ds47.wire.model import ADDRESS_SIZE, HEADER_SIZE, ErrorBlock, RequestId
from plcgen.ds47.wire.status import status_of

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from plcgen.ds47.sim.parameters import DriveObject, SimulatedParameter
    from plcgen.ds47.wire.status import Direction

INVALID_INDEX, LENGTH_ERROR, STATE_CONFLICT, HEADER_ERROR = 0xB0, 0xB1, 0xB5, 0xB7


class ChannelState(enum.Enum):
    """State of the parameter channel."""

    IDLE = "idle"
    PROCESSING = "processing"
    AVAILABLE = "available"


@dataclass(frozen=True, slots=True)
class RecordExchange:
    """One call as the drive saw it: when, which service, its STATUS, the request or response bytes."""

    time: int
    direction: Direction
    index: int
    status: int
    data: bytes


class Drive:
    """A drive with its objects, behaviour and pending faults; ``journal`` keeps every call.

    ``write_record`` and ``read_record`` answer at once with the STATUS of the finished call, 0 is success;
    the calls in between (7001h, 7002h) belong to the CPU. ``asked`` is told that a request to read has come: whoever
    waits for a value can let it come then.
    """

    def __init__(
        self, behaviour: Behaviour | None = None, objects: Iterable[DriveObject] = (), faults: Iterable[Fault] = ()
    ) -> None:
        self.behaviour = behaviour or Behaviour()
        self.objects = {item.number: item for item in objects}
        self.faults = list(faults)
        self.time = 0
        self.journal: list[RecordExchange] = []
        self._server = Server(self.behaviour, self.objects)
        self._request: tuple[int, bytes] | None = None
        self._due = 0
        self._response: bytes | None = None
        self._previous: bytes | None = None
        self._clearing: list[tuple[int, int, SimulatedParameter]] = []
        self.asked: Callable[[], None] | None = None

    @property
    def state(self) -> ChannelState:
        """State of the parameter channel now."""
        if self._request is not None:
            return ChannelState.PROCESSING
        return ChannelState.IDLE if self._response is None else ChannelState.AVAILABLE

    @property
    def saving(self) -> bool:
        """Whether values are being saved, so that nothing may be written."""
        return any(parameter.saves for _, _, parameter in self._clearing)

    def advance(self, milliseconds: int) -> None:
        """Let time pass: requests finish and self-clearing parameters return to 0 in order."""
        if milliseconds < 0:
            raise ValueError(f"time does not run backwards: {milliseconds} ms")
        end = self.time + milliseconds
        while True:
            due = [at for at, _, _ in self._clearing]
            if self._request is not None:
                due.append(self._due)
            if not due or min(due) > end:
                break
            self.time = max(self.time, min(due))
            self._clear()
            self._finish()
        self.time = end

    def write_record(self, index: int, data: bytes) -> int:
        """Take a parameter request; STATUS 0, or DF80xx00h."""
        data = bytes(data)
        status = self._struck("write") or self._check_write(index & 0xFFFF, data)
        self.journal.append(RecordExchange(self.time, "write", index, status, data))
        if status:
            return status
        self._response = None
        if self.asked is not None and data[1] == RequestId.READ:
            self.asked()
        if self._use(FaultKind.SILENCE):
            return 0
        late = self._use(FaultKind.LATE)
        self._request = (index & 0xFFFF, data)
        self._due = self.time + self.behaviour.processing + (late.milliseconds if late else 0)
        self._finish()
        return 0

    def read_record(self, index: int, max_length: int) -> tuple[int, bytes]:
        """Hand out the response once: STATUS 0 and its bytes, or DE80xx00h and none."""
        status = self._struck("read") or self._check_read(index & 0xFFFF, max_length)
        delivered = b""
        if not status and self._response is not None:
            delivered, self._previous, self._response = self._response, self._response, None
        self.journal.append(RecordExchange(self.time, "read", index, status, delivered))
        return status, delivered

    def power_cycle(self) -> None:
        """Switch off and on: unsaved values, the pending request and the unread response are lost."""
        self._request = self._response = self._previous = None
        self._clearing.clear()
        for item in self.objects.values():
            for parameter in item.parameters.values():
                parameter.values = list(parameter.saved)

    def _check_write(self, index: int, data: bytes) -> int:
        if index not in self.behaviour.record_indexes:
            return status_of("write", INVALID_INDEX)
        if not HEADER_SIZE <= len(data) <= self.behaviour.record_limit:
            return status_of("write", LENGTH_ERROR)
        if self.state is ChannelState.PROCESSING:
            return status_of("write", STATE_CONFLICT)
        reference, identifier, _, count = data[:HEADER_SIZE]
        if reference == 0 or count == 0:
            return status_of("write", HEADER_ERROR)
        if identifier in set(RequestId) and len(data) < HEADER_SIZE + ADDRESS_SIZE * count:
            return status_of("write", LENGTH_ERROR)
        return 0

    def _check_read(self, index: int, max_length: int) -> int:
        if index not in self.behaviour.record_indexes:
            return status_of("read", INVALID_INDEX)
        if self._response is None:
            return status_of("read", STATE_CONFLICT)
        if max_length < len(self._response):
            return status_of("read", LENGTH_ERROR)
        return 0

    def _finish(self) -> None:
        """Execute the pending request when its time has come."""
        if self._request is None or self._due > self.time:
            return
        (index, data), self._request = self._request, None
        self._server.frozen = self.saving
        response = encode_response(self._server.answer(index, data, self._injected(data[3])), strict=False)
        for written in self._server.written:
            self._start_clearing(written.drive_object, written.pnu)
        self._server.written.clear()
        for fault in [item for item in self.faults if item.kind in RESPONSE_FAULTS]:
            if fault.use():
                response = damage(fault, response, self._previous)
        self._drop_spent()
        self._response = response

    def _injected(self, count: int) -> dict[int, ErrorBlock]:
        found: dict[int, ErrorBlock] = {}
        for fault in self.faults:
            reachable = fault.kind is FaultKind.ERROR and WHOLE <= fault.position <= count
            if reachable and fault.use():
                found[fault.position] = fault.error_block()
        return found

    def _struck(self, direction: Direction) -> int:
        """STATUS of the first fault that strikes this call, 0 if none does."""
        status = 0
        for fault in self.faults:
            if fault.kind in CALL_FAULTS and fault.call == direction and fault.use():
                status = fault.call_status()
                break
        self._drop_spent()
        return status

    def _use(self, kind: FaultKind) -> Fault | None:
        struck = next((fault for fault in self.faults if fault.kind is kind and fault.use()), None)
        self._drop_spent()
        return struck

    def _drop_spent(self) -> None:
        self.faults = [fault for fault in self.faults if not fault.spent]

    def _start_clearing(self, number: int, pnu: int) -> None:
        parameter = self.objects[number].parameters[pnu]
        if parameter.clears_after is not None and any(parameter.values):
            self._clearing.append((self.time + parameter.clears_after, number, parameter))

    def _clear(self) -> None:
        for entry in [item for item in self._clearing if item[0] <= self.time]:
            self._clearing.remove(entry)
            _, number, parameter = entry
            parameter.values = [0] * len(parameter.values)
            if parameter.acknowledges:
                _acknowledge(self.objects[number], parameter.remaining)
            if parameter.saves:
                self._save(self.objects.values() if parameter.saves == "unit" else [self.objects[number]])

    def _save(self, objects: Iterable[DriveObject]) -> None:
        for item in objects:
            for parameter in item.parameters.values():
                parameter.saved = tuple(parameter.values)


FAULT_BUFFER = (945, 947, 948, 949, 2109, 2130, 2133, 2136, 3115, 3120, 3122)
"""Columns of the fault buffer: a fault case has eight places (S120: r0945)."""
CASE = 8


def _acknowledge(item: DriveObject, remaining: int) -> None:
    """Each fault case becomes that of the one before it; the first ``remaining`` faults are present again."""
    for pnu in FAULT_BUFFER:
        if pnu in item.parameters:
            values = item.parameters[pnu].values
            present = values[:CASE]
            values[:] = [*present[:remaining], *[0] * (CASE - remaining), *values][: len(values)]
    if 944 in item.parameters:
        changes = item.parameters[944].values
        changes[:] = [(int(value) + 1) % 0x10000 for value in changes]
