"""What a spec says, held against what is in a drive or in the data blocks of a CPU."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from plcgen.ds47 import guards
from plcgen.ds47.live.connection import Reader, ReadRefusedError
from plcgen.ds47.live.parameters import ElementReading, ParameterReader, element_value
from plcgen.ds47.plan.access import Use
from plcgen.ds47.plan.nouns import DriveField, DriveJob, DrivePlan
from plcgen.ds47.wire.formats import FormatKind
from plcgen.project.nouns import Buffer

EQUAL, DEVIATES, INPUT, UNREAD, TOLD = "equal", "deviates", "input", "not read", "as it is now"


@dataclass(frozen=True, slots=True)
class LiveRow:
    """One comparison: of what, where, what is wanted, what was found, the verdict and why; of a parameter its title and
    unit, too.
    """

    subject: str
    place: str
    wanted: str
    found: str
    verdict: str
    why: str = ""
    title: str = ""
    unit: str = ""

    @property
    def sentence(self) -> str:
        """What a row that deviates says to people."""
        unit = f" {self.unit}" if self.unit else ""
        called = f"{self.title}: " if self.title else ""
        return f"{called}{self.found}{unit}, not {self.wanted}{unit} ({self.place})" if self.found else self.why


def compare_drives(plan: DrivePlan, readers: Mapping[str, ParameterReader]) -> Iterator[LiveRow]:
    """Every value that a job writes or compares, against the drive; only drives with a reader are asked.

    A constant has to be in the drive. The value of an input is told, without a verdict; what starts something or is
    set back by the drive is left alone.
    """
    for job in plan.jobs:
        reader = readers.get(job.drive.key)
        if reader is None:
            continue
        for use in job.own:
            if use.supplied and use.parameter.pnu not in guards.SET_BACK and not use.format.is_string:
                yield from _use(job, use, reader)


def _use(job: DriveJob, use: Use, reader: ParameterReader) -> Iterator[LiveRow]:
    step = use.format.size
    indexes = range(use.subindex, use.subindex + use.count)
    about = (use.parameter.title, use.parameter.unit)
    for at, found in enumerate(reader.read([(use.parameter, indexes)], job.drive.drive_object)):
        data = use.data[at * step : (at + 1) * step]
        if use.bits:
            yield from _bits(job, use, found)
            continue
        wanted = element_value(use.parameter, found.index, data).text or data.hex(" ").upper()
        label = use.label.partition("[")[0] + (f"[{found.index}]" if use.first is not None else "")
        verdict = _verdict(use, data, found)
        shown = found.text or found.data.hex(" ").upper()
        yield LiveRow(f"{job.drive.key} {label}", job.key, wanted, shown, verdict, found.doubt, *about)


def _bits(job: DriveJob, use: Use, found: ElementReading) -> Iterator[LiveRow]:
    """A row for each bit that is written: the others are nobody's business."""
    for one in use.bits:
        wanted, there = any(one.data), bool(int.from_bytes(found.data) >> (one.bit or 0) & 1)
        verdict = UNREAD if found.doubt else INPUT if not one.constant else EQUAL if wanted == there else DEVIATES
        shown = str(int(there)) if not found.doubt else found.text or found.data.hex(" ").upper()
        title = use.parameter.title
        yield LiveRow(f"{job.drive.key} {one.label}", job.key, str(int(wanted)), shown, verdict, found.doubt, title)


def _verdict(use: Use, wanted: bytes, found: ElementReading) -> str:
    if found.doubt:
        return UNREAD
    if not use.constant:
        return INPUT
    return EQUAL if wanted == found.data or _next_to(use, wanted, found.data) else DEVIATES


def _next_to(use: Use, wanted: bytes, found: bytes) -> bool:
    """Whether two REALs differ in their last place alone: a drive keeps some values in other units."""
    if use.format.kind is not FormatKind.FLOAT or wanted[0] >> 7 != found[0] >> 7:
        return False
    return abs(int.from_bytes(wanted) - int.from_bytes(found)) <= 1


def compare_buffers(plan: DrivePlan, reader: Reader) -> Iterator[LiveRow]:
    """The data blocks of telegrams that have a number, against those in a CPU: length, constants, start values."""
    seen: set[int] = set()
    for job in plan.jobs:
        for telegram in job.telegrams:
            for buffer in (telegram.request, telegram.response):
                if buffer.db is not None and buffer.db.number not in seen:
                    seen.add(buffer.db.number)
                    yield from _block(buffer, buffer.db.number, reader)


def _block(buffer: Buffer[DriveField], number: int, reader: Reader) -> Iterator[LiveRow]:
    name = f'DB{number} "{buffer.home.name}"'
    length, data = read_stored(name, number, buffer.size, reader)
    yield length
    if data and buffer.data:
        yield from (_field(name, buffer, field, data) for field in buffer.fields)


def read_stored(name: str, number: int, size: int, reader: Reader) -> tuple[LiveRow, bytes]:
    """Whether a data block has this length, and its bytes; none if it is missing or shorter."""
    try:
        data = reader.read(number, 0, size)
    except ReadRefusedError as problem:
        why = f"missing, shorter, or not readable: {problem}"
        return LiveRow(name, "length", f"{size} bytes", "", DEVIATES, why), b""
    longer = _longer(reader, number, size + size % 2)
    found = f"more than {size} bytes" if longer else f"{size} bytes"
    return LiveRow(name, "length", f"{size} bytes", found, DEVIATES if longer else EQUAL), data


def _longer(reader: Reader, number: int, size: int) -> bool:
    try:
        reader.read(number, size, 1)
    except ReadRefusedError:
        return False
    return True


def _field(name: str, buffer: Buffer[DriveField], field: DriveField, data: bytes) -> LiveRow:
    found = data[field.offset : field.offset + field.size]
    wanted = buffer.image[field.offset : field.offset + field.size]
    changes = field.role == "reference" or (
        field.role == "value" and field.part is not None and not field.part.use.constant
    )
    verdict = TOLD if changes else EQUAL if found == wanted else DEVIATES
    return LiveRow(name, f"+{field.offset} {field.name}", wanted.hex(" ").upper(), found.hex(" ").upper(), verdict)
