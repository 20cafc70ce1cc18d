"""The CPU of a simulated S7-200: S7 PDUs in, S7 PDUs out, over its memory, mode, switch and protection."""

from __future__ import annotations

import enum
from collections.abc import Mapping
from dataclasses import dataclass, field

from plcgen.ppi.sim.memory import KnownReads, StationMemory
from plcgen.ppi.wire.areas import JOB_HEADER, PDU_LIMIT, Area, Function, ReturnCode, Rosctr
from plcgen.ppi.wire.errors import Kind, Violation
from plcgen.ppi.wire.model import (
    AckReply,
    ErrorReply,
    ForceRequest,
    ItemResult,
    Pdu,
    ReadReply,
    ReadRequest,
    Reply,
    RunRequest,
    SetupReply,
    SetupRequest,
    StopRequest,
    WriteReply,
    WriteRequest,
)
from plcgen.ppi.wire.pdu import PROTOCOL, encode_pdu, examine_pdu, reply_size

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
