"""What documents are held against, held itself against the spec: drives, accesses, values, names, units.

The wording takes from the plan which accesses a job has and what they are called. Here every one of them is looked up
among those that the spec demands, as the second reader of the spec states it, and the other way round.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from itertools import chain
from weakref import WeakKeyDictionary

from plcgen.base.diagnostics import Diagnostic, Span
from plcgen.ds47.plan.access import Use, Verify
from plcgen.ds47.plan.nouns import DriveJob, DrivePlan, PlannedDrive
from plcgen.ds47.proof.stated.source import effects, kinds_of_others, spec_source
from plcgen.ds47.proof.wording.naming import line
from plcgen.oracles.spec.ds47.course import value_bytes
from plcgen.oracles.spec.ds47.drives import KnownDrive, known_drives
from plcgen.oracles.spec.ds47.kinds.service import written_numbers
from plcgen.oracles.spec.ds47.signing import SAFETY, sign_off, values_written
from plcgen.oracles.spec.ds47.state import shipped_statements, state_jobs
from plcgen.oracles.spec.ds47.statement import FromInput, Number, Source, StatedAccess, StatedDrive, StatedJob
from plcgen.oracles.spec.place import NotStatedError, SpecPlace
from plcgen.proof.wording.model import unlike

OUTPUT = 0x8000
CODE = "PG614"
Place = tuple[int, bool, int, int]
"""Step of a sequence (else 0), whether it is written, number, index."""


@dataclass(frozen=True, slots=True)
class Stated:
    """The spec, read a second time: drives by key, jobs by their key and that of the drive."""

    drives: Mapping[str, KnownDrive]
    jobs: Mapping[tuple[str, str], StatedJob]
    unstated: frozenset[str]

    def danger(self, plan: DrivePlan, job: DriveJob, number: int) -> Iterator[str]:
        """Why a write of a job asks for a sign-off, and who gave it; nothing if it does not ask.

        What a kind of another distribution signs off, only that kind knows.
        """
        drive, stated = self.drives.get(job.drive.key), self.jobs.get((job.shape, job.drive.key))
        if drive is None:
            return
        steps = stated.steps if stated is not None else ()
        written = [one for step in steps for one in step.accesses if one.write and one.number == number]
        known = [values_written(one, restores=stated is None or bool(stated.restore)) for one in written]
        whole = bool(known) and None not in known
        values = frozenset().union(*(one for one in known if one is not None)) if whole else None
        if why := effects().danger(drive, number, values):
            signed = sign_off(plan.loaded.root.data()["jobs"][job.shape], drive, number)
            if not signed and (stated is None or stated.kind not in shipped_statements()):
                signed = plan.sign_off(job, number) or ""
            yield f"{why}; signed off: {signed or 'no'}"


def service_numbers(plan: DrivePlan, stated: Stated, job: DriveJob) -> tuple[frozenset[int], dict[int, str]]:
    """What a service may write on all of its drives, by the spec alone, and what of that the spec names, and why."""
    drives = [stated.drives[one.drive.key] for one in plan.jobs if one.shape == job.shape]
    entry = plan.loaded.root.data()["jobs"][job.shape]
    return written_numbers(entry, [effects().harmless(drive) for drive in drives], SAFETY)


_STATED: WeakKeyDictionary[DrivePlan, Stated] = WeakKeyDictionary()


def stated_of(plan: DrivePlan) -> Stated:
    """What the spec of a plan demands; nothing if that cannot be stated, which the group Spec reports."""
    if plan not in _STATED:
        _STATED[plan] = _stated(plan)
    return _STATED[plan]


def _stated(plan: DrivePlan) -> Stated:
    source = spec_source(plan.loaded)
    try:
        drives = known_drives(source)
        statement = state_jobs(source, kinds_of_others(), drives)
    except (NotStatedError, LookupError, TypeError, ValueError):
        return Stated({}, {}, frozenset(source.data.get("jobs") or ()))
    jobs = {(job.key, job.drive.key): job for job in statement.jobs}
    return Stated(drives, jobs, frozenset(job.key for job in statement.unstated))


def groundless(plan: DrivePlan, stated: Stated) -> Iterator[Diagnostic]:
    """Every difference between the plan and the spec that documents would repeat."""
    for drive in plan.drives:
        known = stated.drives.get(drive.key)
        if known is not None:
            yield from _problems(drive.key, known.stated.place, _of_drive(drive, known.stated))
    planned = {(job.shape, job.drive.key): job for job in plan.jobs}
    for key, demanded in stated.jobs.items():
        job = planned.get(key)
        found = ["no document has it"] if job is None else chain(_of_job(job, demanded), _pinned(plan, job))
        yield from _problems(demanded.key, demanded.place, found)
    for key in planned:
        if key not in stated.jobs and key[0] not in stated.unstated:
            yield from _problems(key[0], SpecPlace(plan.loaded.file, 1), [f"documents have it for drive {key[1]}"])


def _pinned(plan: DrivePlan, job: DriveJob) -> Iterator[str]:
    """What the spec says of blocks, numbers and sizes."""
    entry, telegram = plan.entry(job), job.telegrams[0]
    yield from unlike("function block", entry.block.name, entry.block.number, job.block)
    numbers = [("reference of the first request", entry.reference, telegram.request.data[0])]
    for what, given, buffer in (
        ("request", entry.request, telegram.request),
        ("answer", entry.response, telegram.response),
    ):
        yield from unlike(f"data block of the {what}", given.name, given.db, buffer.db)
        numbers.append((f"size of the {what}", given.size, buffer.size))
    yield from (
        f"the {what} is {found}, the spec says {said}" for what, said, found in numbers if said not in {None, found}
    )


def _problems(key: str, place: SpecPlace, found: Iterator[str] | list[str]) -> Iterator[Diagnostic]:
    span = Span(place.file, place.line, place.column)
    yield from (Diagnostic(CODE, f"{key}: {what}", span) for what in found)


def _of_drive(drive: PlannedDrive, stated: StatedDrive) -> Iterator[str]:
    if isinstance(stated.identifier, str):
        found, wanted = drive.id_name, stated.identifier
    else:
        found, wanted = str(drive.id_value), str(stated.identifier | OUTPUT * stated.output)
    for what, one, two in (
        ("identifier", found, wanted),
        ("drive object", drive.drive_object, stated.drive_object),
        ("record", drive.record_index, stated.record),
        ("comment", _lines(drive.comment.values()), _lines(stated.comments)),
    ):
        if one != two:
            yield f"documents name the {what} {one}, the spec says {two}"


def _of_job(job: DriveJob, stated: StatedJob) -> Iterator[str]:
    if (said := _lines(job.comment.values())) != (wanted := _lines(stated.comments)):
        yield f"documents say {said}, the spec says {wanted}"
    demanded: dict[Place, StatedAccess] = {}
    for step in stated.steps:
        for access in step.accesses:
            demanded.update(((step.number, access.write, access.number, i), access) for i in _indexes(access))
    seen: Counter[Place] = Counter()
    for use in job.own:
        count = 1 if use.format.is_string else use.count
        places = [(use.step, use.writes, use.parameter.pnu, use.subindex + at) for at in range(count)]
        seen.update(places)
        accesses = [demanded.get(place) for place in places]
        if None in accesses:
            yield f"documents say that it {'writes' if use.writes else 'reads'} {use.label}, the spec does not"
        elif accesses[0] is not None:
            yield from _of_access(job, use, accesses[0])
    for place, access in demanded.items():
        _, write, number, index = place
        if not seen[place]:
            what = f"{access.letter}{number}" + (f"[{index}]" if access.indexed else "")
            yield f"documents do not say that it {'writes' if write else 'reads'} {what}"
        elif write and seen[place] > 1:
            yield f"documents say that it writes {access.written} twice"


def _indexes(access: StatedAccess) -> range:
    return range(access.index, access.index + (1 if access.string else access.count))


def _of_access(job: DriveJob, use: Use, stated: StatedAccess) -> Iterator[str]:
    known = use.parameter
    for what, found, wanted in (
        ("can be written", known.access != "r", stated.letter != "r"),
        ("title", line(known.title), line(stated.title)),
        ("unit", known.unit, stated.unit),
        ("bytes of a value", use.format.size, stated.size),
        ("has an index", use.first is not None, stated.indexed),
        ("bits", sorted(one.bit or 0 for one in use.bits), sorted(bit for bit, _ in stated.bits) if use.writes else []),
    ):
        if found != wanted:
            yield f'of {stated.written} documents say "{what}: {found}", spec and profile "{what}: {wanted}"'
    own = not use.as_(Verify) and not use.precedes and not use.bits  # else it says what it is there for
    if stated.comments is not None and own and _lines(use.comment.values()) != _lines(stated.comments):
        texts = _lines(use.comment.values()), _lines(stated.comments)
        yield "of {} documents say {}, the spec says {}".format(stated.written, *texts)
    if use.writes and not use.bits and job.clock is None and not use.recorded:
        yield from _of_values(use, stated)


def _lines(texts: Iterable[str]) -> list[str]:
    return sorted({line(text) for text in texts} - {""})


def _of_values(use: Use, stated: StatedAccess) -> Iterator[str]:
    inputs = [one for one in stated.values if isinstance(one, FromInput)]
    if use.constant == bool(inputs):
        yield f"documents say that {stated.written} {'is a constant' if use.constant else 'has an input'}"
        return
    if stated.string:
        return  # nobody states what a text is filled up with
    starts: dict[Source, Number | bytes] = {one: one.start for one in inputs if not isinstance(one.start, str)}
    wanted = b"".join(value_bytes(stated, at, starts) for at in range(len(stated.values)))
    if use.data != wanted:
        yield f"documents say that {stated.written} gets {use.data.hex(' ')}, the spec says {wanted.hex(' ')}"
