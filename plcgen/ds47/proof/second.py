"""A second drive answers too: one that was written from documents alone and shares nothing with the first.

Both get the requests that the files on disk define, and requests that are wrong in one byte. What documents say about a
shipped device, its drive object and its parameters' types, is looked up apart from its profile.
"""

from __future__ import annotations

import struct
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial

from plcgen.base.diagnostics import Diagnostic, DiagnosticError, Severity, Span, has_errors
from plcgen.base.diagnostics.counting import quantity
from plcgen.ds47.plan.access import Use
from plcgen.ds47.plan.nouns import DriveJob, DrivePlan, DriveTelegram, PlannedDrive
from plcgen.ds47.plan.types import element_type
from plcgen.ds47.proof.exchanges import ExchangeError, sound_image, talk, telegram_name
from plcgen.ds47.sim.bench import build_drive
from plcgen.ds47.sim.drive import Drive
from plcgen.ds47.wire.codec import TelegramError
from plcgen.oracles import profidrive
from plcgen.oracles.documents import (
    DocumentedDevice,
    DocumentedLimits,
    DocumentedType,
    device,
    documented_limits,
    documented_types,
    s7_types,
)
from plcgen.proof.checks import Check, Outcome
from plcgen.proof.folder import Folder
from plcgen.proof.making import Pending

LOCAL = 0xB02E
"""The record that addresses one drive object whatever the request says."""
ANOTHER_TYPE = {0x08: 0x04, 0x07: 0x04, 0x04: 0x07, 0x06: 0x03, 0x03: 0x06, 0x05: 0x02, 0x02: 0x05}
"""A format of the same size that is not that of the parameter."""


_SHOWN = 8


class _DifferenceError(Exception):
    """The two do not agree."""


def fact_checks(plan: DrivePlan) -> Iterator[Check]:
    """What the plan takes for granted of its devices, against what documents say: addresses, then types."""
    asked: dict[str, list[tuple[PlannedDrive, Use]]] = {}
    for drive in plan.drives:
        uses = {use.parameter.pnu: use for job in plan.jobs if job.drive is drive for use in job.uses}
        if not uses:
            continue
        asked.setdefault(drive.device.key, []).extend((drive, use) for use in uses.values())
        id_, subject = f"facts.{drive.key}", f"{drive.key}: {drive.device.key}"
        said = device(drive.device.key)
        if said is None:
            yield Check(id_, subject, "", Outcome.NOT_RUN, "not run: no second source is known for this device")
        else:
            text = f"drive object, record: {said.source}"
            yield _agreement(id_, subject, text, "a second source agrees", list(_address(plan, drive, said)))
    for key, pairs in asked.items():
        yield _type_check(plan, key, pairs)
    if asked:
        yield _s7_check(plan, [use for pairs in asked.values() for _, use in pairs])


def _type_check(plan: DrivePlan, key: str, pairs: Sequence[tuple[PlannedDrive, Use]]) -> Check:
    """The types of a device against every document, and which of them only the profile's own document states."""
    documented = documented_types(key)
    second: dict[int, DocumentedType] = {}
    for _, use in pairs:
        others = (one for one in documented.get(use.parameter.pnu, ()) if one.another(use.parameter.source))
        found = next(others, None)
        if found is not None:
            second[use.parameter.pnu] = found
    single = {use.parameter.pnu: use.label.partition("[")[0] for _, use in pairs if use.parameter.pnu not in second}
    id_, subject = f"types.{key}", f"types: {key}"
    wrong = [*_types(plan, pairs, documented), *_limits(plan, pairs, documented_limits(key))]
    if not second and not wrong:
        verdict = f"not run: no second source was found for the type of {quantity(len(single), 'parameter')}"
        return Check(id_, subject, "", Outcome.NOT_RUN, verdict)
    verdict = f"{len(second)} of {quantity(len(second) + len(single), 'type')}: a second source agrees"
    if single:
        shown = [single[number] for number in sorted(single)]
        verdict += f"; one source: {', '.join(shown[:_SHOWN])}{', ..' if len(shown) > _SHOWN else ''}"
    doubted: dict[str, dict[int, str]] = {}
    for _, use in pairs:
        if doubt := use.parameter.type_note:
            doubted.setdefault(doubt, {})[use.parameter.pnu] = use.label.partition("[")[0]
    for doubt, labels in sorted(doubted.items()):
        shown = [labels[number] for number in sorted(labels)]
        verdict += f"; {doubt}: {', '.join(shown[:_SHOWN])}{', ..' if shown[_SHOWN:] else ''}"
    text = "; ".join(dict.fromkeys(one.source for one in second.values()))
    return _agreement(id_, subject, text, verdict, wrong)


def _s7_check(plan: DrivePlan, uses: Sequence[Use]) -> Check:
    """The S7 types that hold the values."""
    known = s7_types(plan.target.family)
    here = {use.format.name: element_type(use.format, plan.target) for use in uses}
    wrong = []
    for name, held in here.items():
        found, said = held.name if held is not None else "bytes", known.get(name, "bytes")
        if found != said:
            wrong.append(
                Diagnostic("PG640", f"{name} is held as {found} here, as {said} by its size and sign", Span(""))
            )
    return _agreement("types.s7", "types of the S7", "", f"{quantity(len(here), 'type')} by size and sign", wrong)


def _agreement(id_: str, subject: str, text: str, verdict: str, wrong: Sequence[Diagnostic]) -> Check:
    """A good check with its verdict, or the worst of what documents contradict."""
    if not wrong:
        return Check(id_, subject, text, Outcome.OK, verdict)
    worst = max(wrong, key=lambda one: one.severity is Severity.ERROR)
    outcome = Outcome.ERROR if has_errors(wrong) else Outcome.WARNING
    return Check(id_, subject, text, outcome, worst.message, worst)


def _address(plan: DrivePlan, drive: PlannedDrive, said: DocumentedDevice) -> Iterator[Diagnostic]:
    place = plan.loaded.key_span(drive.path)
    number = _drive_object(plan, drive)
    if drive.drive_object != number:
        yield Diagnostic("PG640", f"drive object {drive.drive_object} is addressed, {number} is meant", place)
    elif said.drive_objects and number not in said.drive_objects:
        numbers = ", ".join(map(str, said.drive_objects))
        yield Diagnostic("PG640", f"drive object {number}: {said.source} says {numbers}", place)
    if said.without_index and drive.device.scalar_elements != said.without_index:
        here, there = (
            "{} to read, {} to write".format(*both) for both in (drive.device.scalar_elements, said.without_index)
        )
        yield Diagnostic("PG640", f"elements without an index: {here}; {said.source} prints {there}", place)
    if said.elements and drive.device.max_elements != said.elements:
        message = f"{drive.device.max_elements} elements of one parameter: {said.source} says {said.elements}"
        yield Diagnostic("PG640", message, place)
    if said.sources and drive.device.bico != said.sources:
        message = f"sources of {drive.device.key} are {drive.device.bico} here, {said.sources} in printed values"
        yield Diagnostic("PG640", message, place)
    if drive.record_index not in profidrive.RECORDS:
        message = f"record {drive.record_index:04X}h is not a parameter record: use 002Fh, B02Eh or B02Fh"
        yield Diagnostic("PG640", message, place)


def _types(
    plan: DrivePlan, uses: Sequence[tuple[PlannedDrive, Use]], documented: Mapping[int, Sequence[DocumentedType]]
) -> Iterator[Diagnostic]:
    """A type of the profile that documents contradict is an error, one of the user's own a warning."""
    for drive, use in uses:
        said = () if use.untyped else documented.get(use.parameter.pnu, ())
        against = (one for one in said if one.type != use.format.name)
        found = next(against, None)
        if found is not None:
            severity = Severity.ERROR if _of_profile(drive, use) else Severity.WARNING
            message = f"{use.label} is {use.format.name} here, {found.type} in: {found.source}"
            yield Diagnostic("PG640", message, plan.loaded.span(use.path), severity)


def _limits(
    plan: DrivePlan, uses: Sequence[tuple[PlannedDrive, Use]], documented: Mapping[int, Sequence[DocumentedLimits]]
) -> Iterator[Diagnostic]:
    """Limits of the profile that the list which they were read in does not print."""
    for drive, use in uses:
        known = drive.device.find(use.parameter.pnu, drive.object_type)
        if known is None or not (known.read("min") and known.read("max")):
            continue
        for said in documented.get(known.pnu, ()):
            if said.package in known.source and (known.minimum, known.maximum) != (said.low, said.high):
                here = f"{known.minimum:g} to {known.maximum:g}"
                message = f"{use.label} is {here} here, {said.low:g} to {said.high:g} in: {said.source}"
                yield Diagnostic("PG640", message, plan.loaded.span(use.path))


def second_checks(plan: DrivePlan, folder: Folder) -> Iterator[Pending]:
    """Both drives answer every request of the files, good and wrong ones."""
    for job in plan.shapes:
        for telegram in job.telegrams:
            id_, subject = f"second.{telegram.request.home.name}", telegram_name(job, telegram)
            place = partial(folder.place, (telegram.request.db or job.block).name)
            yield Pending(id_, subject, place, partial(_both, plan, folder, job, telegram))


def _both(plan: DrivePlan, folder: Folder, job: DriveJob, telegram: DriveTelegram) -> Iterator[Check]:
    id_, subject = f"second.{telegram.request.home.name}", telegram_name(job, telegram)
    request = sound_image(plan, folder, job, telegram)
    if request is None:
        return
    strange = {part.use.format.name for part in telegram.parts} - set(profidrive.TYPES)
    if strange:
        verdict = f"not run: documents leave open how {', '.join(sorted(strange))} is answered"
        yield Check(id_, subject, "", Outcome.NOT_RUN, verdict)
        return
    try:
        count = TwoDrives(plan, job, request).run()
    except (_DifferenceError, ExchangeError, profidrive.UnansweredError, TelegramError) as found:
        message = str(found)
    except DiagnosticError as found:
        message = found.diagnostics[0].message
    else:
        yield Check(id_, subject, "", Outcome.OK, f"both drives give the same {count} answers")
        return
    problem = Diagnostic("PG640", message, folder.place((telegram.request.db or job.block).name))
    yield Check(id_, subject, "", Outcome.ERROR, message, problem)


@dataclass(frozen=True)
class TwoDrives:
    """One request of the files, sent to both drives."""

    plan: DrivePlan
    job: DriveJob
    request: bytes

    @property
    def writes(self) -> bool:
        """Whether it is a change."""
        return self.request[1] == profidrive.CHANGE

    def run(self) -> int:
        """Compare all answers and return their number."""
        request = self.request
        first, second = self.drives()
        self._same("", request, first, second)
        if self.writes:
            self._same("what was written, ", reading(request), first, second)
        wrong = dict(mistakes(request, self.job))
        for what, data in wrong.items():
            self._both_refuse(what, data, *self.drives())
        return 1 + self.writes + len(wrong)

    def drives(self) -> tuple[Drive, profidrive.DocumentedDrive]:
        """The simulated drive of the profile, and the one of the documents with the same values."""
        first = build_drive(self.plan, self.job.drive, distinct=True)
        return first, second_drive(self.plan, self.job.drive, first)

    def _same(self, what: str, request: bytes, first: Drive, second: profidrive.DocumentedDrive) -> None:
        expected = second.answer(self.job.drive.record_index, request)
        answer = talk(self.job, request, first)
        if answer != expected:
            said = f"documents say {expected.hex(' ').upper()}, the simulated drive {answer.hex(' ').upper()}"
            raise _DifferenceError(f"{what}{request.hex(' ').upper()}: {said}")
        if answer[1] & profidrive.NEGATIVE:
            raise _DifferenceError(f"{what}{request.hex(' ').upper()} is refused: {answer.hex(' ').upper()}")

    def _both_refuse(self, what: str, request: bytes, first: Drive, second: profidrive.DocumentedDrive) -> None:
        """The number of the first error must be the same; how much is said besides differs between devices."""
        expected = second.answer(self.job.drive.record_index, request)
        answer = talk(self.job, request, first)
        if _error(answer) != _error(expected):
            said = f"documents say {expected.hex(' ').upper()}, the simulated drive {answer.hex(' ').upper()}"
            raise _DifferenceError(f"{what}: {said}")


def _error(answer: bytes) -> tuple[bytes, bytes]:
    """Header without the number of parameters, number of the first error."""
    return answer[:3], answer[6:8] if answer[4:5] == bytes((profidrive.ERROR,)) else b""


def second_drive(plan: DrivePlan, drive: PlannedDrive, first: Drive) -> profidrive.DocumentedDrive:
    """The drive of the documents with the values of the simulated one."""
    said = device(drive.device.key)
    by_size = bool(said.by_size) if said is not None else drive.device.answer_format == "size"
    uses = [use for job in plan.jobs if job.drive is drive for use in job.own]
    parameters: dict[int, profidrive.HeldParameter] = {}
    for use in uses:
        held = first.objects[drive.drive_object].parameters[use.parameter.pnu]
        documented = documented_types(drive.device.key).get(use.parameter.pnu, ()) if _of_profile(drive, use) else ()
        name = documented[0].type if documented else use.format.name
        if name in profidrive.TYPES:
            values = _numbers(name, held.values, use)
            low, high, read_only = use.parameter.minimum, use.parameter.maximum, use.parameter.access == "r"
            array = held.array or use.format.is_string  # of octets
            parameters[use.parameter.pnu] = profidrive.HeldParameter(name, values, array, read_only, low, high)
    return profidrive.DocumentedDrive({_drive_object(plan, drive): parameters}, by_size)


def _numbers(name: str, values: Sequence[bool | float | str | bytes], use: Use) -> dict[int, int | float]:
    found: dict[int, int | float] = {}
    for index, value in enumerate(values):
        if isinstance(value, str | bytes):
            octets = value.encode("ascii", "replace") if isinstance(value, str) else value
            found |= dict(enumerate(octets, use.subindex))
        else:
            found[index] = value if profidrive.TYPES[name][1] in "fd" else int(value)
    return found


def _drive_object(plan: DrivePlan, drive: PlannedDrive) -> int:
    """The number that the spec says, else documents, else the profile."""
    said, asked = device(drive.device.key), plan.settings(drive).drive_object
    if asked is not None:
        return asked
    return said.drive_object if said is not None else drive.device.drive_object


def _of_profile(drive: PlannedDrive, use: Use) -> bool:
    return use.parameter == drive.device.find(use.parameter.pnu, drive.object_type)


def reading(change: bytes) -> bytes:
    """The request that reads what a change has written: its header and addresses."""
    return struct.pack("BBBB", change[0], profidrive.READ, change[2], change[3]) + change[4 : 4 + 6 * change[3]]


def mistakes(request: bytes, job: DriveJob) -> Iterator[tuple[str, bytes]]:
    """The request with one thing wrong, and what that is."""

    def changed(at: int, *octets: int) -> bytes:
        return request[:at] + bytes(octets) + request[at + len(octets) :]

    if job.drive.record_index != LOCAL:
        yield "a drive object that does not exist", changed(2, 0xFD)
    yield "a parameter that does not exist", changed(6, 0xFF, 0xFE)
    if request[5]:  # without elements a subindex may be looked at or not
        yield "a subindex that does not exist", changed(8, 0x7F, 0xF0)
    values = 4 + 6 * request[3]
    if request[1] == profidrive.CHANGE and request[values] in ANOTHER_TYPE:
        yield "a value of another type", changed(values, ANOTHER_TYPE[request[values]])
