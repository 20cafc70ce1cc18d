"""Jobs of a PPI master -> planned jobs: values, telegrams with a member for every byte, blocks.

A table is the length of the telegram in one byte, then the telegram: so every word of the frame and every value lies at
an even offset. The last value of a write is padded to even length too, as STEP 7-Micro/WIN sends it. A response DB
holds the data part of the reply as it is when every item is good.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from plcgen.base.diagnostics import Diagnostic, Report
from plcgen.base.diagnostics.counting import shortlist
from plcgen.base.diagnostics.suggest import Vocabulary, did_you_mean
from plcgen.ppi.plan.nouns import LEAD, Kind, Placed, PlannedStation, PpiField, PpiJob, PpiTelegram, PpiValue, WireItem
from plcgen.ppi.plan.values import ValueResolver
from plcgen.ppi.schema import VERBS, MasterJob, PpiBuffer, PpiMaster, PpiReadItem, PpiSection, PpiWriteItem
from plcgen.ppi.symbols import SymbolTable
from plcgen.ppi.wire.areas import JOB_HEADER, Area, Function, SizeCode
from plcgen.ppi.wire.errors import PpiError
from plcgen.ppi.wire.fdl import encode_frame
from plcgen.ppi.wire.model import (
    FIRST,
    Item,
    ItemWrite,
    Pdu,
    ReadRequest,
    RunRequest,
    StopRequest,
    VariableFrame,
    WriteRequest,
)
from plcgen.ppi.wire.pack import PlannedItem, Telegrams, pack_read, pack_write
from plcgen.ppi.wire.pdu import encode_pdu
from plcgen.project.nouns import BlockRef, Buffer
from plcgen.project.numbering import Numbering
from plcgen.project.spec import LoadedSpec, SpecPath
from plcgen.project.triggers import plan_trigger
from plcgen.s7.types.data_types import ELEMENTARY, ArrayType, DataType
from plcgen.s7.types.names import TIA_LIMIT, V5_LIMIT, camel_case, first_upper, pascal_case, shorten

BYTE, WORD, DWORD = ELEMENTARY["BYTE"], ELEMENTARY["WORD"], ELEMENTARY["DWORD"]
FRAME_HEADER = 7
_HEADER = (
    ("telegramLength", "length", BYTE), ("startDelimiter", "start", BYTE), ("frameLength", "frame_length", BYTE),
    ("frameLengthRepeated", "frame_length_2", BYTE), ("startDelimiterRepeated", "start_2", BYTE),
    ("destination", "destination", BYTE), ("source", "source", BYTE), ("functionCode", "function_code", BYTE),
    ("protocolId", "protocol", BYTE), ("messageType", "rosctr", BYTE), ("reserved", "reserved", WORD),
    ("pduReference", "reference", WORD), ("parameterLength", "parameter_length", WORD),
    ("dataLength", "data_length", WORD), ("service", "service", BYTE),
)  # fmt: skip
_ITEM = (
    ("specification", "specification", BYTE), ("addressLength", "address_length", BYTE),
    ("syntaxId", "syntax", BYTE), ("transportSize", "transport_size", BYTE), ("elementCount", "count", WORD),
    ("dbNumber", "db", WORD), ("area", "area", BYTE), ("bitAddressHigh", "address_high", BYTE),
    ("bitAddress", "address", WORD),
)  # fmt: skip
_RUN = (
    ("reservedByte", "reserved", BYTE), ("reservedDword", "reserved", DWORD), ("reservedLast", "reserved", BYTE),
    ("serviceMark", "service_mark", BYTE), ("argumentLength", "argument_length", WORD),
)  # fmt: skip
_STOP = (("reservedByte", "reserved", BYTE), ("reservedDword", "reserved", DWORD))
_PROGRAM = ArrayType(((0, 9),), BYTE)


@dataclass(slots=True)
class _Layout:
    image: bytes
    single: bool
    fields: list[PpiField] = field(default_factory=list)
    offset: int = 0

    def add(
        self, name: str, role: str, type_: DataType, size: int = 0, item: int = 0, placed: tuple[Placed, ...] = ()
    ) -> None:
        size = size or type_.bits // 8  # type: ignore[union-attr]
        if item and not self.single and role != "value":
            name += str(item)
        data = self.image[self.offset : self.offset + size].ljust(size, b"\0")
        self.fields.append(PpiField(name, role, type_, self.offset, size, data, item, placed))
        self.offset += size

    def rows(self, rows: tuple[tuple[str, str, DataType], ...], item: int = 0) -> None:
        for name, role, type_ in rows:
            self.add(name, role, type_, 0, item)

    def value(self, wire: WireItem, item: int, *, last: bool) -> None:
        """A value and the pad behind it; with several values in one item, their bytes."""
        octets = wire.item.octets
        name, type_ = f"data{'' if self.single else item}", None
        single = wire.single
        if single is not None:
            name = single.member
            type_ = single.type if not single.bit else BYTE
            if isinstance(type_, ArrayType) and octets % 2:
                type_ = None
        if type_ is None:
            type_ = BYTE if octets == 1 else ArrayType(((0, octets + octets % 2 - 1),), BYTE)
        array = isinstance(type_, ArrayType)
        size = octets + octets % 2 if array else octets
        self.add(name, "value", type_, size, item, wire.values)
        if not array and octets % 2 and not last:
            self.add("padding", "pad", BYTE, 0, item)


def request_fields(request: bytes, items: tuple[WireItem, ...]) -> tuple[PpiField, ...]:
    """Members of the telegram table of one frame."""
    layout = _Layout(bytes((len(request),)) + request, len(items) == 1)
    layout.rows(_HEADER)
    service = request[FRAME_HEADER + JOB_HEADER]
    if service in {Function.READ, Function.WRITE}:
        layout.rows((("itemCount", "item_count", BYTE),))
        for number in range(1, len(items) + 1):
            layout.rows(_ITEM, number)
        if service == Function.WRITE:
            for number, wire in enumerate(items, 1):
                layout.rows((("returnCode", "return_code", BYTE), ("sizeCode", "size_code", BYTE)), number)
                layout.rows((("valueLength", "value_length", WORD),), number)
                layout.value(wire, number, last=False)
    else:
        layout.rows(_RUN if service == Function.PI_SERVICE else _STOP)
        layout.add("programName", "program", _PROGRAM, 10)
    layout.rows((("frameCheck", "fcs", BYTE), ("endDelimiter", "end", BYTE)))
    return tuple(layout.fields)


def response_fields(items: tuple[WireItem, ...], *, write: bool) -> tuple[PpiField, ...]:
    """Members of the response DB: the data part of the reply when every item is good."""
    layout = _Layout(b"", len(items) == 1)
    for number, wire in enumerate(items, 1):
        layout.rows((("returnCode", "return_code", BYTE),), number)
        if write:
            continue
        layout.rows((("sizeCode", "size_code", BYTE), ("valueLength", "value_length", WORD)), number)
        layout.value(wire, number, last=number == len(items))
    return tuple(layout.fields)


def value_length(wire: WireItem) -> int:
    """Length of a value as its item's length field says it: in bits, or in bytes for size code 09."""
    octets = wire.item.octets
    code = wire.item.size_code
    return 1 if code == SizeCode.BIT else octets if code == SizeCode.OCTETS else 8 * octets


HARMLESS = Item.memory(Area.SM, 0)
"""SMB0: every S7-200 has it, and reading it changes nothing."""


_SHOWN = 20


@dataclass(slots=True)
class JobPlanner:
    """Plans the jobs of one master; counts telegrams, items and values."""

    loaded: LoadedSpec
    numbering: Numbering
    report: Report
    key: str
    name: str
    master: PpiMaster
    stations: Mapping[str, PlannedStation]
    symbols: Mapping[str, SymbolTable]
    telegrams: int = 0
    items: int = 0
    values: int = 0
    found: list[PpiJob] = field(default_factory=list)
    words: Vocabulary = field(init=False)

    def __post_init__(self) -> None:
        self.words = Vocabulary(self.stations)

    def jobs(self) -> tuple[PpiJob, ...]:
        """Every job that can be planned."""
        for key, job in self.master.jobs.items():
            planned = self._job(key, job)
            if planned is not None:
                self.found.append(planned)
        return tuple(self.found)

    def syncs(self, jobs: Sequence[PpiJob]) -> tuple[PpiTelegram, ...]:
        """One harmless read for each station that something is executed on."""
        wanted = dict.fromkeys(job.station.key for job in jobs if job.kind != "read")
        found = []
        for name in wanted:
            station = self.stations[name]
            base = f"{self.name}{pascal_case(name)}Sync"
            items = self._items([PlannedItem(HARMLESS, ())], ())
            found.append(self._telegram("sync", station, items, base, PpiBuffer(), PpiBuffer(), station.path))
        return tuple(found)

    # --- one job --------------------------------------------------------------------------------------

    def _job(self, key: str, job: MasterJob) -> PpiJob | None:
        path: SpecPath = ("ppi", self.key, "jobs", key)
        station = self.stations.get(job.station)
        if station is None:
            hint = (
                did_you_mean(job.station, self.words)
                or f"stations here: {shortlist(self.words.first(_SHOWN + 1), _SHOWN)}"
            )
            message = f'unknown station "{job.station}"'
            self.report.add(Diagnostic("PG238", message, self.loaded.span((*path, "station")), help=hint))
            return None
        kind = self._kind(key, job, path)
        if kind is None:
            return None
        values = self._values(kind, job, station, path)
        if kind in {"read", "write"} and not values:
            return None
        packed = self._packed(kind, values, path, merge=job.merge)
        if packed is None:
            return None
        if len(packed) > 1 and job.split == "never":
            self._unsplittable(key, values, len(packed), path, kind)
        base = self.name + pascal_case(key)
        others = {(self.name + pascal_case(other)).upper() for other in self.master.jobs}
        apart = "_" if any(f"{base}{index}".upper() in others for index in range(1, len(packed) + 1)) else ""
        telegrams = []
        for index, group in enumerate(packed, 1):
            name = f"{base}{apart}{index}" if len(packed) > 1 else base
            request = job.request if index == 1 else PpiBuffer()
            response = job.response if index == 1 else PpiBuffer()
            telegrams.append(self._telegram(kind, station, self._items(group, values), name, request, response, path))
        limit = V5_LIMIT if self.numbering.where.v5 else TIA_LIMIT
        limit -= 0 if job.trigger is None else len(f"{self.numbering.prefix}Execute")
        return PpiJob(
            key=key,
            number=len(self.found) + 1,
            stem=camel_case(key),
            member=shorten(self._member(key), limit),
            kind=kind,
            link=station,
            values=values,
            telegrams=tuple(telegrams),
            trigger=plan_trigger(job.trigger, path, self.loaded, self.report),
            cycle=job.cycle or 0,
            timeout=job.timeout,
            longest_name=limit,
            comment=job.comment or {},
            path=path,
        )

    def _member(self, key: str) -> str:
        """What all masters share knows a job by this name: with several masters it begins with its own."""
        several = len(self.loaded.sections(PpiSection).ppi) > 1
        return f"{camel_case(self.key)}{pascal_case(key)}" if several else camel_case(key)

    def _kind(self, key: str, job: MasterJob, path: SpecPath) -> Kind | None:
        given = [verb for verb in VERBS if getattr(job, verb) is not None]
        if len(given) == 1:
            kind: dict[str, Kind] = {"read": "read", "write": "write", "run": "run", "stop": "stop"}
            return kind[given[0]]
        what = f"one of read, write, run, stop, not {' and '.join(given)}" if given else "read, write, run or stop"
        help_ = (
            "make a job for each of them" if given else "add read: [VB100], write: {VB100: 16}, run: true or stop: true"
        )
        message = f'job "{key}" needs {what}'
        self.report.add(Diagnostic("PG218", message, self.loaded.key_span(path), help=help_))
        return None

    def _values(self, kind: Kind, job: MasterJob, station: PlannedStation, path: SpecPath) -> tuple[PpiValue, ...]:
        entries: tuple[PpiReadItem | PpiWriteItem, ...] = (job.read if kind == "read" else job.write) or ()
        if kind not in {"read", "write"}:
            return ()
        if not entries:
            message = f'job "{path[-1]}" names no address'
            self.report.add(Diagnostic("PG218", message, self.loaded.span((*path, kind))))
        symbols = self.symbols[station.key]
        resolver = ValueResolver(self.loaded, self.numbering.where, station, symbols, self.report)
        found = []
        for position, entry in enumerate(entries, 1):
            self.values += 1
            value = resolver.resolve(entry, position, self.values, (*path, kind, position - 1))
            if value is not None:
                found.append(value)
        return tuple(found)

    def _packed(self, kind: Kind, values: tuple[PpiValue, ...], path: SpecPath, *, merge: bool) -> Telegrams | None:
        """Telegrams of a job; None after a diagnostic if values that are written overlap."""
        if not values:
            return ((),)
        try:
            if kind == "read":
                return pack_read([value.item for value in values], merge=merge).telegrams
            return pack_write([ItemWrite(value.item, value.data) for value in values], merge=merge).telegrams
        except PpiError as problem:
            text = "; ".join(violation.message for violation in problem.violations)
            help_ = "write every byte once, or make two jobs"
            self.report.add(Diagnostic("PG239", text, self.loaded.span((*path, kind)), help=help_))
            return None

    def _unsplittable(self, key: str, values: Sequence[PpiValue], count: int, path: SpecPath, kind: Kind) -> None:
        octets = sum(value.item.octets for value in values)
        message = f'job "{key}" needs {count} telegrams: {len(values)} addresses, {octets} bytes'
        help_ = "one telegram takes 19 items, 222 bytes to read or 212 to write: allow split: auto or make two jobs"
        self.report.add(Diagnostic("PG310", message, self.loaded.span((*path, kind)), help=help_))

    # --- telegrams ------------------------------------------------------------------------------------

    def _items(self, planned: Sequence[PlannedItem], values: Sequence[PpiValue]) -> tuple[WireItem, ...]:
        found = []
        for one in planned:
            self.items += 1
            placed = tuple(Placed(values[p.asked], p.at, p.start, p.length, p.bit) for p in one.parts)
            found.append(WireItem(self.items, one.item, placed, one.data))
        return tuple(found)

    def _telegram(
        self,
        kind: Kind,
        station: PlannedStation,
        items: tuple[WireItem, ...],
        name: str,
        request: PpiBuffer,
        response: PpiBuffer,
        path: SpecPath,
    ) -> PpiTelegram:
        self.telegrams += 1
        frame = _frame(kind, station.address, self.master.own_address, items)
        table = self._block(f"{name}_Request", request, (*path, "request"))
        request_id = frame[FRAME_HEADER + JOB_HEADER]
        asked = request_fields(frame, items)
        sent = Buffer(table, self._type(table, path), asked, LEAD + len(frame), frame, bytes((len(frame),)))
        answer = None
        if kind in {"read", "write"}:
            db = self._block(f"{name}_Response", response, (*path, "response"))
            fields = response_fields(items, write=kind == "write")
            answer = Buffer(db, self._type(db, path), fields, fields[-1].offset + fields[-1].size)
        return PpiTelegram(
            number=self.telegrams,
            request_id=request_id,
            response_id=request_id,
            request=sent,
            response=answer,
            kind=kind,
            station=station,
            items=items,
        )

    def _type(self, block: BlockRef, path: SpecPath) -> BlockRef:
        return self.numbering.block("UDT", f"type{first_upper(block.name)}", path, derived=True)

    def _block(self, name: str, given: PpiBuffer, path: SpecPath) -> BlockRef:
        return self.numbering.block("DB", given.name or name, path, given.db, given=bool(given.name))


def _frame(kind: Kind, station: int, own: int, items: tuple[WireItem, ...]) -> bytes:
    if kind == "write":
        pairs = tuple(ItemWrite(wire.item, wire.data) for wire in items)
        pdu: Pdu = WriteRequest.padded(0, pairs)
    elif kind in {"run", "stop"}:
        pdu = RunRequest(0) if kind == "run" else StopRequest(0)
    else:
        pdu = ReadRequest(0, tuple(wire.item for wire in items))
    source = own if own != station else (own + 1) % 127  # the same address twice is a finding of the rules
    return encode_frame(VariableFrame(station, source, FIRST, encode_pdu(pdu)))
