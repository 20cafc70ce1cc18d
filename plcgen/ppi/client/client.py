"""PPI client: read and write an S7-200 by address or symbol.

    from plcgen.client import Client

    with Client.open("/dev/ttyUSB0") as plc:              # or socket://192.168.1.50:4000
        print(plc.info().text)
        for reading in plc.read("VB100", "VD200:REAL", "M0.0"):
            print(reading.name, reading.value)
        plc.write({"VW100": 1234})

Reads and writes are distributed over as few telegrams as possible. An item that the station refuses has no value but
a return code; everything that concerns a whole job raises ClientError, a lost line LineError.
"""

from __future__ import annotations

import re
import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Self

from plcgen.base.diagnostics import Diagnostic, DiagnosticError, Span
from plcgen.base.line import Line
from plcgen.ppi.client.exchange import NO_ANSWER, REFUSED, ClientError, Exchange, Settings
from plcgen.ppi.client.values import Place, PlaceError, Value, parse_place, text_of
from plcgen.ppi.wire.areas import PDU_LIMIT, Area, ReturnCode
from plcgen.ppi.wire.codes import return_code
from plcgen.ppi.wire.errors import PpiError
from plcgen.ppi.wire.model import (
    AckReply,
    Item,
    ItemResult,
    ItemWrite,
    ReadReply,
    RunRequest,
    SetupReply,
    SetupRequest,
    StopRequest,
    WriteReply,
)
from plcgen.ppi.wire.pack import READING, WRITING, ReadPlan, pack_read, pack_write
from plcgen.ppi.wire.pdu import encode_pdu

if TYPE_CHECKING:
    from types import TracebackType

    from plcgen.ppi.symbols import SymbolTable

CPU_TYPE = Item.memory(Area.SYS, 0, 20)
_TYPE = re.compile(r"\s*(.*?)\s*([0-9]{4})?\s*")
_LEAST_PDU = 60
_MOST_PLANS = 100
"""Different sets of items whose plans are kept: a panel or a logger reads a few again and again."""


@dataclass(frozen=True, slots=True)
class Written:
    """One value that was written, or why not: ``code`` is FFh, or another one."""

    place: Place
    code: int

    @property
    def ok(self) -> bool:
        """Whether the station has accepted the item."""
        return self.code == ReturnCode.OK

    @property
    def error(self) -> str:
        """``03h access denied``; empty if all is well."""
        return "" if self.ok else f"{self.code:02X}h {return_code(self.code).text}"


@dataclass(frozen=True, slots=True)
class Reading(Written):
    """One value that was read, or why not; ``data`` are the bytes as they came, big-endian."""

    data: bytes = b""
    value: Value | None = None

    @property
    def name(self) -> str:
        """What was asked for, as it was written."""
        return self.place.name

    @property
    def text(self) -> str:
        """Value as people read it, or the error."""
        return self.error if self.value is None else text_of(self.value, self.place.type)


@dataclass(frozen=True, slots=True)
class CpuInfo:
    """What SYS says: 20 characters with the CPU type and, at their end, the firmware (``0201`` is V2.01)."""

    text: str

    @property
    def type(self) -> str:
        """``CPU 226``."""
        found = _TYPE.fullmatch(self.text)
        return found[1] if found else self.text.strip()

    @property
    def firmware(self) -> str:
        """``02.01``, or empty if the text does not end with four digits."""
        found = _TYPE.fullmatch(self.text)
        return f"{found[2][:2]}.{found[2][2:]}" if found and found[2] else ""


@dataclass(frozen=True, slots=True)
class _Prepared:
    """A plan and its PDUs, in which only the reference changes from read to read.

    ``plain`` are the bytes of each item if every telegram carries just what was asked for, in its order.
    """

    plan: ReadPlan
    pdus: tuple[bytes, ...]
    plain: tuple[int, ...] = ()

    def results(self, replies: Sequence[ReadReply]) -> tuple[ItemResult, ...]:
        """One result per asked item. Raises PpiError if the replies are not those to this plan."""
        if self.plain:
            found = tuple([result for reply in replies for result in reply.results])
            if self.plain == tuple([len(result.data) for result in found if result.ok]):
                return found
        return self.plan.collect(replies)


class Client:
    """A client for one station over one line; close it, or use it in a ``with`` block."""

    def __init__(
        self,
        line: Line,
        settings: Settings | None = None,
        *,
        symbols: SymbolTable | None = None,
        now: Callable[[], float] = time.monotonic,
    ) -> None:
        self.exchange = Exchange(line, settings, now)
        self.symbols = symbols
        self.pdu_limit = PDU_LIMIT
        self._reference = 0
        self._places: dict[str, Place] = {}
        self._prepared: dict[tuple[Item, ...], _Prepared] = {}
        self._latest: _Prepared | None = None
        """The plan of the read before: most programs read the same again and again."""

    @classmethod
    def open(
        cls, port: str, *, rate: int = 9600, settings: Settings | None = None, symbols: SymbolTable | None = None
    ) -> Client:
        """Open a serial port, a pseudo terminal or ``socket://HOST:PORT``. Raises LineError."""
        from plcgen.base.line.opening import open_line

        return cls(open_line(port, rate), settings, symbols=symbols)

    def close(self) -> None:
        """Give the line back."""
        self.exchange.line.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, problem: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    # ---- Reading ----------------------------------------------------------------------------------------------

    def place(self, text: str | Place) -> Place:
        """Return the place of an address or symbol. Raises DiagnosticError if it is none."""
        if isinstance(text, Place):
            return text
        found = self._places.get(text)
        if found is None:
            try:
                found = self._places.setdefault(text, parse_place(text, self.symbols))
            except PlaceError as problem:
                diagnostic = Diagnostic(problem.code, problem.message, Span(text), help=problem.help)
                raise DiagnosticError([diagnostic]) from problem
        return found

    def read(self, *places: str | Place) -> tuple[Reading, ...]:
        """Read addresses or symbols, in as few telegrams as possible; one reading each, in the order asked.

        Raises DiagnosticError (an address that is none), ClientError (no answer, the job refused) and LineError.
        """
        asked = [self.place(place) for place in places]
        results = self.read_items([place.item for place in asked])
        return tuple(
            [
                Reading(place, result.code, result.data, place.value(result.data) if result.ok else None)
                for place, result in zip(asked, results, strict=True)
            ]
        )

    def read_items(self, items: Sequence[Item]) -> tuple[ItemResult, ...]:
        """Read items; one result each. What failed together with others is read again by itself."""
        if not items:
            return ()
        key = tuple(items)
        prepared = self._latest if self._latest is not None and self._latest.plan.asked == key else self._planned(key)
        results = self._collect(prepared)
        if prepared.plain:
            return results
        alone = [n for n, result in enumerate(results) if not result.ok and prepared.plan.shared(n)]
        if not alone:
            return results
        again = self._collect(self._prepare([items[number] for number in alone], merge=False))
        corrected = dict(zip(alone, again, strict=True))
        return tuple(corrected.get(number, result) for number, result in enumerate(results))

    def _planned(self, key: tuple[Item, ...]) -> _Prepared:
        found = self._prepared.get(key)
        if found is None:
            if len(self._prepared) >= _MOST_PLANS:
                self._prepared.clear()
            found = self._prepared.setdefault(key, self._prepare(key, merge=True))
        self._latest = found
        return found

    def _prepare(self, items: Sequence[Item], *, merge: bool) -> _Prepared:
        plan = pack_read(items, merge=merge, rules=replace(READING, limit=self.pdu_limit))
        requests = plan.requests()
        sent = tuple(item for request in requests for item in request.items)
        plain = tuple(item.octets for item in items) if sent == tuple(items) else ()
        return _Prepared(plan, tuple(encode_pdu(request) for request in requests), plain)

    def _collect(self, prepared: _Prepared) -> tuple[ItemResult, ...]:
        replies = []
        for pdu in prepared.pdus:
            reference = self._following()
            reply = self.exchange.run_encoded(pdu[:4] + reference.to_bytes(2) + pdu[6:], reference)
            if not isinstance(reply, ReadReply):
                raise self._unexpected("a read is answered with something else")
            replies.append(reply)
        try:
            return prepared.results(replies)
        except PpiError as problem:
            raise self._unexpected("; ".join(violation.message for violation in problem.violations)) from problem

    # ---- Writing ----------------------------------------------------------------------------------------------

    def write(self, values: Mapping[str, Value | Sequence[bool | int | float]]) -> tuple[Written, ...]:
        """Write values to addresses or symbols; one result each, in the order given.

        Raises DiagnosticError (an address or a value that does not fit), ClientError and LineError.
        """
        asked = [(self.place(name), value) for name, value in values.items()]
        try:
            entries = [(place, place.write(value)) for place, value in asked]
        except PlaceError as problem:
            diagnostic = Diagnostic(problem.code, problem.message, Span("<values>"), help=problem.help)
            raise DiagnosticError([diagnostic]) from problem
        return self.write_items(entries)

    def write_items(self, entries: Iterable[tuple[Place, ItemWrite]]) -> tuple[Written, ...]:
        """Write items with their bytes; everything is checked before the first telegram is sent.

        Raises DiagnosticError (two overlap), ClientError and LineError.
        """
        pairs = tuple(entries)
        try:
            plan = pack_write([entry for _, entry in pairs], rules=replace(WRITING, limit=self.pdu_limit))
            for request in plan.requests():
                encode_pdu(request)
        except PpiError as problem:
            found = [Diagnostic("PG716", violation.message, Span("<values>")) for violation in problem.violations]
            raise DiagnosticError(found) from problem
        replies = []
        for request in plan.requests():
            reply = self.exchange.run(replace(request, reference=self._following()))
            if not isinstance(reply, WriteReply):
                raise self._unexpected("a write is answered with something else")
            replies.append(reply)
        try:
            codes = plan.collect(replies)
        except PpiError as problem:
            raise self._unexpected("; ".join(violation.message for violation in problem.violations)) from problem
        return tuple(Written(place, code) for (place, _), code in zip(pairs, codes, strict=True))

    # ---- The CPU ----------------------------------------------------------------------------------------------

    def run(self) -> None:
        """Put the CPU into RUN. Raises RefusedError if its mode selector forbids that."""
        self._acknowledged(RunRequest(self._following()))

    def stop(self) -> None:
        """Put the CPU into STOP."""
        self._acknowledged(StopRequest(self._following()))

    def info(self) -> CpuInfo:
        """Return the CPU type from the system area."""
        (result,) = self.read_items([CPU_TYPE])
        if not result.ok:
            meaning = return_code(result.code)
            raise ClientError(
                REFUSED, self.exchange.line.name, f"SYS0[20]: {result.code:02X}h {meaning.text}", meaning.help
            )
        return CpuInfo(result.data.decode("ascii", "replace").rstrip("\x00 "))

    def negotiate(self, pdu_size: int = PDU_LIMIT) -> SetupReply:
        """Negotiate the PDU size, optional for an S7-200; a smaller one than 240 is kept to from then on."""
        reply = self.exchange.run(SetupRequest(self._following(), pdu_size))
        if not isinstance(reply, SetupReply) or reply.pdu_size < _LEAST_PDU:
            raise self._unexpected("the negotiation is answered with something else")
        self.pdu_limit = min(reply.pdu_size, PDU_LIMIT)
        self._prepared.clear()
        self._latest = None
        return reply

    # ---- Jobs -------------------------------------------------------------------------------------------------

    def _following(self) -> int:
        self._reference = self._reference % 0xFFFF + 1
        return self._reference

    def _acknowledged(self, request: RunRequest | StopRequest) -> None:
        reply = self.exchange.run(request)
        if not isinstance(reply, AckReply):
            raise self._unexpected("RUN or STOP is answered with something else")

    def _unexpected(self, message: str) -> ClientError:
        return ClientError(NO_ANSWER, self.exchange.line.name, message)
