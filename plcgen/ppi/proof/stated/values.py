"""Every value of every job at its address and nowhere else: as delivered, with values of its own, and refused."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from plcgen.oracles.spec.ppi.statement import PpiStatement, StatedAddress
from plcgen.oracles.spec.ppi.stations import (
    AREAS,
    FIRST,
    POLLS,
    READ,
    SERVICES,
    WRITE,
    AskedItem,
    Extent,
    HeardRequest,
    Number,
    UndescribedError,
    heard_frame_of,
)
from plcgen.ppi.proof.stated.rig import StatedBed, folded, numbers_of
from plcgen.ppi.proof.words import DONE, WORDS
from plcgen.proof.scenario import ScenarioError
from plcgen.s7.types.blocks import BlockKind

SYNC = Extent(AREAS["SM"], 0, 8)
"""SMB0: its reading changes nothing (docs/ppi-master.md, frame count bit)."""
ONE_BY_ONE = 8
"""So many bits of a job are set one at a time; of more, each gets a number of its own, and a turn for each digit."""
LONGEST_ITEM = 212
"""Bytes that certainly go into one telegram, whether they are read or written."""

Given = Mapping[str, Sequence[Number]]
"""Numbers of the inputs of a job, by the address as the spec writes it."""


def hold_values(bed: StatedBed) -> None:
    """Everything that travels: jobs as delivered, then each with values that occur nowhere else, then refused."""
    conduct = _Conduct(bed)
    for job in bed.jobs:
        conduct.delivered(job)
    conduct.tables()
    for job in bed.jobs:
        for turn in range(_turns(job)):
            conduct.exchange(job, turn)
        if job.values:
            conduct.refused(job)


def _codes(job: PpiStatement) -> dict[str, int]:
    """A number for each bit that is read or supplied, by its address."""
    bits = [value for value in (*job.inputs, *job.outputs) if value.kind == "BOOL"]
    return {value.text: 1 << n if len(bits) <= ONE_BY_ONE else n + 1 for n, value in enumerate(bits)}


def _turns(job: PpiStatement) -> int:
    """How often a job runs: at least twice if it has values of its own."""
    most = max(_codes(job).values(), default=0).bit_length()
    return max(2, most) if job.inputs or job.outputs else 0


class _Conduct:
    """The jobs of one master, run by run: which function code and reference come next.

    ``several`` says that the last good run took several telegrams.
    """

    def __init__(self, bed: StatedBed) -> None:
        self.bed = bed
        self.last: dict[int, int] = {}
        self.reference = 0
        self.sent: dict[bytes, PpiStatement] = {}
        self.several = False
        self.power_up()

    def power_up(self) -> None:
        """Frame counts and references begin again."""
        self.bed.power_up()
        self.last.clear()
        self.reference = 0

    # --- as delivered ------------------------------------------------------------------------------------------

    def delivered(self, job: PpiStatement) -> None:
        """The start values of signals and inputs, and the run that they make."""
        bed, members = self.bed, self.bed.members[job.key]
        pins = bed.pins()
        bed.cpu.restart("cold")
        if "execute" not in job.flags and bool(bed.signal(job, "execute")) != bool(job.cycle):
            raise bed.wrong(job.path, f"start value of execute of {job.key}", bool(job.cycle), not job.cycle)
        given = {}
        for value, path in zip(job.inputs, members.values, strict=True) if job.inputs else ():
            wanted = [value.start] * len(value.places)
            given[value.text] = wanted
            at_block = pins.get(folded(job.key) + folded(path.rpartition(".")[2]), path)
            for place in (path, at_block):
                found = bed.shown(place)
                if value.octets(found) != value.octets(wanted):
                    raise bed.wrong(value.path, f"start value of {place}", _said(wanted), _said(found))
        self.power_up()
        self._good(job, given)
        for heard in bed.line.requests():
            frame = bytearray(heard.frame)
            frame[6], frame[11:13] = FIRST, b"\0\0"
            frame[-2] = sum(frame[4:-2]) & 0xFF
            self.sent[bytes(frame)] = job

    def tables(self) -> None:
        """Every request that the jobs send as delivered lies in a data block: 6Ch, reference 0, FCS right."""
        bed = self.bed
        bed.cpu.restart("cold")
        found = set()
        for entry in bed.program.link.blocks.values():
            if entry.block.kind is BlockKind.DB and entry.index in bed.cpu.blocks:
                data = bytes(bed.cpu.blocks[entry.index])
                if len(data) > 1 and data[1] == 0x68:
                    found.add(data[1 : 1 + data[0]])
        for frame, job in self.sent.items():
            if frame not in found:
                close = min(
                    found, key=lambda table: sum(a != b for a, b in zip(table, frame, strict=False)), default=b""
                )
                raise bed.wrong(job.path, f"telegram table of {job.key}", frame.hex(" ").upper(), _decoded(close))
        self.power_up()

    # --- values that occur nowhere else ------------------------------------------------------------------------

    def exchange(self, job: PpiStatement, turn: int) -> None:
        """Run a job with other values in the station and at the inputs."""
        bed, codes = self.bed, _codes(job)
        memory = bed.line.stations[job.station]
        memory.octets.clear()
        memory.elements.clear()
        memory.rest = 0xFF if turn % 2 else 0
        # bits and reals last: where addresses overlap, a real stays a number and a bit what its turn makes it
        for value in sorted(job.outputs, key=lambda value: (value.kind == "BOOL", value.kind == "REAL")):
            data = bed.fresh(value, codes.get(value.text, 0), turn)
            size = len(data) // len(value.places)
            for number, place in enumerate(value.places):
                memory.put(place, data[number * size : (number + 1) * size])
        given: dict[str, Sequence[Number]] = {}
        if job.inputs:
            for value, path in zip(job.inputs, bed.members[job.key].values, strict=True):
                given[value.text] = numbers_of(value, bed.fresh(value, codes.get(value.text, 0), turn))
                bed.supply(path, value, given[value.text])
        self._good(job, given)

    def _good(self, job: PpiStatement, given: Given) -> None:
        """A run that must end well, with the right frames and values, and change nothing of another job."""
        bed, members = self.bed, self.bed.members[job.key]
        before = self._others(job)
        status = bed.run(job)
        self._check_ways(job)
        if status != DONE:
            raise bed.wrong(job.path, f"status of {job.key}", "16#0000", f"16#{status:04X}")
        self.check_frames(job, given)
        for value, path in zip(job.outputs, members.values, strict=True) if job.outputs else ():
            found, wanted = bed.shown(path), bed.held(job, value)
            if any(a != b and (a == a or b == b) for a, b in zip(found, wanted, strict=True)):  # noqa: PLR0124 - NaN
                said = f"{value.text} of station {job.station} as {value.kind}"
                raise bed.wrong(value.path, f"{path} shows {said}", _said(wanted), _said(found))
        bed.rest(job)
        if self._others(job) != before:
            raise bed.wrong(job.path, f'"{bed.control}"', f"changes of {job.key} only", "another job has changed")

    def _others(self, job: PpiStatement) -> bytes:
        first, end = self.bed.members[job.key].span
        try:
            data = bytes(self.bed.cpu.db(self.bed.control))
        except KeyError:
            return b""
        return data[:first] + data[end:]

    # --- on the line -------------------------------------------------------------------------------------------

    def _check_ways(self, job: PpiStatement) -> None:
        """Frames as the documents describe them, between the master and the station of the job."""
        bed, line = self.bed, self.bed.line
        if line.wrong:
            raise bed.wrong(job.path, f"frames of {job.key}", "those of the documents", line.wrong[0])
        for heard in line.heard:
            if heard.meaning.station != job.station:
                raise bed.wrong(job.path, f"station of {job.key}", job.station, heard.meaning.station)
            if heard.meaning.source != bed.port.own_address:
                raise bed.wrong(bed.port.path, "address of the master", bed.port.own_address, heard.meaning.source)

    def check_frames(self, job: PpiStatement, given: Given) -> None:
        """Function codes, references and order of the frames, then what the requests ask for."""
        bed, line = self.bed, self.bed.line
        began = job.station not in self.last
        for heard in line.heard:
            meaning = heard.meaning
            last = self.last.get(job.station)
            wanted = FIRST if last is None else POLLS[0] if last & 0x20 else POLLS[1]
            if meaning.function_code != wanted:
                raise bed.wrong(
                    job.path, f"function code of {job.key}", f"{wanted:02X}h", f"{meaning.function_code:02X}h"
                )
            self.last[job.station] = meaning.function_code
            if isinstance(meaning, HeardRequest):
                if meaning.reference in {0, self.reference}:
                    raise bed.wrong(job.path, f"PDU reference of {job.key}", "a new one", meaning.reference)
                self.reference = meaning.reference
        requests = [heard.meaning for heard in line.heard if isinstance(heard.meaning, HeardRequest)]
        if len(line.heard) != 2 * len(requests):
            raise bed.wrong(job.path, f"polls of {job.key}", len(requests), len(line.heard) - len(requests))
        if began and job.service != READ:
            harmless = requests.pop(0) if requests else None
            if harmless is None or harmless.service != READ or [item.place for item in harmless.items] != [SYNC]:
                raise bed.wrong(job.path, f"first request of {job.key} after power-up", "a read of SMB0", harmless)
        self._check_requests(job, requests, given)

    def _check_requests(self, job: PpiStatement, requests: Sequence[HeardRequest], given: Given) -> None:
        bed = self.bed
        services = {request.service for request in requests}
        self.several = len(requests) > 1
        if services != {job.service}:
            said = [f"{service:02X}h" for service in sorted(services)]
            raise bed.wrong(job.path, f"service of {job.key}", f"{job.service:02X}h", ", ".join(said) or "none")
        if job.service in SERVICES:
            if len(requests) != 1:
                raise bed.wrong(job.path, f"requests of {job.key}", 1, len(requests))
            return
        items = [item for request in requests for item in request.items]
        for value in job.values:
            for extent in (value.whole,) if _octets(value.whole) <= LONGEST_ITEM else value.places:
                if not any(_inside(extent, item.place) for item in items):
                    found = ", ".join(str(item.place) for item in items)
                    raise bed.wrong(value.path, f"{job.key} asks for {value.text}", f"{extent} in one item", found)
        if not job.merged:
            apart = sorted(str(v.whole) for v in job.values if _octets(v.whole) <= LONGEST_ITEM)
            asked = sorted(str(item.place) for item in items if _octets(item.place) <= LONGEST_ITEM)
            if len(items) < len(job.values) or (len(apart) == len(job.values) and asked != apart):
                raise bed.wrong(job.path, f"items of {job.key}", ", ".join(apart), ", ".join(asked))
        if job.service == WRITE:
            self._check_written(job, items, given)
            return
        cells = {(value.whole.area, cell) for value in job.values for cell in value.whole.cells}
        for item in items:
            place = item.place
            unit = 1 if place.counted or place.length == 1 else 8
            for end in (place.cells[:unit], place.cells[-unit:]):
                if not any((place.area, cell) in cells for cell in end):
                    raise bed.wrong(job.path, f"what {job.key} reads", _texts(job), place)

    def _check_written(self, job: PpiStatement, items: Sequence[AskedItem], given: Given) -> None:
        """Every bit that is written, as the spec says, and no other one."""
        bed = self.bed
        wanted: dict[tuple[int, int], tuple[int, StatedAddress]] = {}
        for value in job.values:
            data = value.octets(given.get(value.text) or _constants(value))
            for area, cell, state in AskedItem(value.whole, data).bits():
                wanted[area, cell] = state, value
        found = {(area, cell): state for item in items for area, cell, state in item.bits()}
        for place, (state, value) in wanted.items():
            if found.get(place) != state:
                written = next(item for item in items if _inside(Extent(*place, 1), item.place))
                at = (value.whole.first - written.place.first) // 8
                octets = max(1, value.whole.length // 8)
                data = value.octets(given.get(value.text) or _constants(value))
                said = f"{job.key} writes to {value.text} of station {job.station}"
                raise bed.wrong(value.path, said, data.hex(" "), written.data[at : at + octets].hex(" "))
        for place in found.keys() - wanted.keys():
            raise bed.wrong(job.path, f"what {job.key} writes", _texts(job), f"also {Extent(*place, 1)}")
        if len(found) != sum(item.place.length for item in items):
            raise bed.wrong(job.path, f"{job.key} writes every address", "once", "twice")

    # --- refused -----------------------------------------------------------------------------------------------

    def refused(self, job: PpiStatement) -> None:
        """Every item gets a return code of its own: each address shows that of its item, and no output changes."""
        bed, members = self.bed, self.bed.members[job.key]
        before = [bed.shown(path) for path in members.values]
        bed.line.refuse = True
        status = bed.run(job)
        bed.line.refuse = False
        if status != WORDS["ITEM_ERROR"] or not bed.signal(job, "error") or bed.signal(job, "done"):
            raise bed.wrong(job.path, f"status of {job.key} if the station refuses", "16#8401", f"16#{status:04X}")
        shown = bed.shown(members.errors)
        for value, found in zip(job.values, shown, strict=True):
            codes = bed.line.codes
            whole = [0x8000 | code for place, code in codes if _inside(value.whole, place)]
            parts = [0x8000 | code for place, code in codes if _meet(value.whole, place)]
            wanted = (whole or parts or [0]) + [0] * self.several  # it ends with its first telegram that is refused
            if found not in wanted:
                said = f"error of {value.text} of {job.key} if the station refuses it"
                raise bed.wrong(value.path, said, f"16#{wanted[0]:04X}", f"16#{int(found):04X}")
        if job.outputs and [bed.shown(path) for path in members.values] != before:
            raise bed.wrong(job.path, f"outputs of {job.key} if the station refuses", "unchanged", "changed")
        if not bed.line.codes:
            raise ScenarioError(f"{job.key}: nothing was refused")
        bed.rest(job)
        self.power_up()


def _constants(value: StatedAddress) -> list[Number]:
    """The constant of an address; a single one fills an array."""
    return [value.constant if value.constant is not None else value.start] * len(value.places)


def _octets(extent: Extent) -> int:
    return 5 * extent.length if extent.counted else max(1, extent.length // 8)


def _inside(inner: Extent, outer: Extent) -> bool:
    first, end = outer.cells.start, outer.cells.stop
    return inner.area == outer.area and first <= inner.cells.start and inner.cells.stop <= end


def _meet(one: Extent, other: Extent) -> bool:
    return one.area == other.area and one.cells.start < other.cells.stop and other.cells.start < one.cells.stop


def _texts(job: PpiStatement) -> str:
    return ", ".join(value.text for value in job.values)


def _said(numbers: Sequence[Number]) -> str:
    return ", ".join(map(str, numbers[:4])) + (", .." if len(numbers) > 4 else "")


def _decoded(frame: bytes) -> str:
    try:
        heard_frame_of(frame)
    except UndescribedError as problem:
        return str(problem)
    return frame.hex(" ").upper()
