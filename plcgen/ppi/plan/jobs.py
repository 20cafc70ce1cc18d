"""Jobs of a PPI master -> planned jobs: values, telegrams with their tables, blocks."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from plcgen.base.diagnostics import Diagnostic, Report
from plcgen.base.diagnostics.counting import shortlist
from plcgen.base.diagnostics.suggest import Vocabulary, did_you_mean
from plcgen.ppi.plan.fields import FRAME_HEADER, request_fields, response_fields
from plcgen.ppi.plan.nouns import LEAD, Kind, Placed, PlannedStation, PpiJob, PpiTelegram, PpiValue, WireItem
from plcgen.ppi.plan.values import ValueResolver
from plcgen.ppi.schema import VERBS, MasterJob, PpiBuffer, PpiMaster, PpiReadItem, PpiSection, PpiWriteItem
from plcgen.ppi.symbols import SymbolTable
from plcgen.ppi.wire.areas import JOB_HEADER, Area
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
from plcgen.s7.types.names import TIA_LIMIT, V5_LIMIT, camel_case, first_upper, pascal_case, shorten

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
