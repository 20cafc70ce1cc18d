"""One job of the spec -> a planned job: uses, telegrams, buffers, blocks."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from itertools import chain, groupby

from plcgen.base.diagnostics import Diagnostic, Note, Report
from plcgen.ds47 import guards
from plcgen.ds47.kind import JobKind, Poll
from plcgen.ds47.plan import pack
from plcgen.ds47.plan.access import Compare, Part, Recount, Remember, Use
from plcgen.ds47.plan.accesses import Accesses, job_kind, kind_behind
from plcgen.ds47.plan.callers import Callers, footprint
from plcgen.ds47.plan.fields import request_fields, response_fields
from plcgen.ds47.plan.nouns import (
    DeviationList,
    DriveJob,
    DriveTelegram,
    MessageList,
    Permitted,
    PlannedDrive,
    PlannedRecipe,
    PlannedUnit,
)
from plcgen.ds47.plan.recipes import Recipes
from plcgen.ds47.plan.steps import divided
from plcgen.ds47.plan.types import element_type
from plcgen.ds47.plan.uses import UseResolver
from plcgen.ds47.references import number_of
from plcgen.ds47.schema import BufferSettings as BufferSpec
from plcgen.ds47.schema import DriveSections, JobEntry
from plcgen.ds47.wire.codec import encode_request
from plcgen.ds47.wire.model import ParameterAddress, Request, RequestId, ValueBlock
from plcgen.project.nouns import BlockRef, Buffer, PlannedTrigger
from plcgen.project.numbering import Numbering
from plcgen.project.spec import LoadedSpec, SpecPath
from plcgen.project.target import Target
from plcgen.project.triggers import plan_trigger
from plcgen.s7.types.data_types import ELEMENTARY, Elementary
from plcgen.s7.types.names import TIA_LIMIT, V5_LIMIT, camel_case, first_upper, pascal_case, shorten


class Slots:
    """Hands out the places of each unit, from 1."""

    def __init__(self) -> None:
        self._used: dict[str, int] = {}

    def next(self, unit: PlannedUnit) -> int:
        """The next free place."""
        self._used[unit.key] = self._used.get(unit.key, 0) + 1
        return self._used[unit.key]


@dataclass(slots=True)
class DriveJobPlanner:
    """Plans the jobs of a spec one after the other: an instance for each drive of a job."""

    loaded: LoadedSpec
    resolvers: Mapping[str, UseResolver]
    callers: Callers
    recipes: Recipes
    numbering: Numbering
    report: Report
    slots: Slots = field(default_factory=Slots)

    def job(self, key: str, drives: tuple[PlannedDrive, ...]) -> tuple[DriveJob, ...]:
        """One job of the spec on its drives; none if it has no usable parameter."""
        job, path, first = self.loaded.sections(DriveSections).jobs[key], ("jobs", key), drives[0]
        kind = job_kind(job, key, drives[0].device, self.loaded, self.report)
        resolver = self.resolvers[first.key]
        accesses = Accesses(job, path, self.loaded, self.recipes, resolver, self.report)
        uses = accesses.uses(kind) if kind is not None else ()
        if kind is None or not uses:
            return ()
        packed = _packed(uses, first, self.loaded, self.report)
        if packed is None:
            return ()
        own = self._own_uses(kind, uses, packed, drives, path)
        if len(packed) > len(_directions(uses)) and job.split == "never":
            _report_unsplittable(kind, path, uses, first, self.loaded, self.report)
        if job.trigger is not None and len(drives) > 1:
            _report_shared_flags(key, len(drives), self.loaded, path, self.report)
        return self._instances(key, kind, own, packed, drives)

    def _instances(
        self,
        key: str,
        kind: JobKind,
        uses_of: Mapping[str, tuple[Use, ...]],
        packed: list[tuple[Part, ...]],
        drives: tuple[PlannedDrive, ...],
    ) -> tuple[DriveJob, ...]:
        """What all instances share, and an instance for each drive, with its own uses."""
        job, first, numbering = self.loaded.sections(DriveSections).jobs[key], drives[0], self.numbering
        uses = uses_of[first.key]
        path, name, given, many = ("jobs", key), pascal_case(key), job.block.name, len(drives) > 1
        reference = job.reference if job.reference is not None else 1
        faq = (job.names or self.loaded.spec.plc.names) == "faq"
        works = _more_than_data_blocks(kind, uses, numbering.where)
        own = _own_blocks(job, works, len(packed), len(drives), self.loaded, path, self.report)
        context = _Context(key, first, reference, numbering, faq=faq, many=len(packed) > 1, own=own)
        telegrams = tuple(_telegram(index, parts, job, name, context) for index, parts in enumerate(packed, 1))
        block = numbering.block("FB", given or name, (*path, "block"), job.block.number, given=bool(given))
        timeout = _timeout(job, uses)
        diagnosis = numbering.block("UDT", f"type{name}_Diagnosis", path)
        listed = _listed(job, kind, uses, name, numbering, path)
        size = footprint(uses, telegrams, listed)
        recipe = self._recipe(job, kind, key, uses, first)
        then = kind_behind(job, kind)
        permitted = _permitted(job, name, drives, numbering, path) if kind.changes(getattr(job, kind.key)) else None
        return tuple(
            DriveJob(
                key=f"{key}.{drive.key}" if many else key,
                member=_member(f"{key}_{drive.key}" if many else key, job, numbering),
                kind=kind.key,
                once=any(use.writes and use.parameter.pnu in guards.TRIGGERS for use in uses),
                shape=key,
                slot=self.slots.next(drive.unit),
                link=drive,
                caller=self.callers.caller(drive.unit, size),
                uses=uses,
                own=uses_of[drive.key],
                telegrams=telegrams,
                block=block,
                diagnosis=diagnosis,
                trigger=self._trigger(job, path) if drive is first else PlannedTrigger(),
                reference=reference,
                timeout=timeout,
                retry_pause=job.retry_pause,
                retries=_retries(job, job.timeout if uses[0].as_(Remember) else timeout),
                faq_names=faq,
                listed=listed,
                clock=_clock(kind, numbering),
                recipe=recipe,
                then="" if then is None else then.key,
                cycle=job.cycle or 0,
                permitted=permitted,
                comment=job.comment or {},
                path=path,
            )
            for drive in drives
        )

    def _trigger(self, job: JobEntry, path: SpecPath) -> PlannedTrigger:
        return plan_trigger(job.trigger, path, self.loaded, self.report)

    def _recipe(
        self, job: JobEntry, kind: JobKind, key: str, uses: tuple[Use, ...], drive: PlannedDrive
    ) -> PlannedRecipe | None:
        if not kind.recorded:
            return None
        recorded = tuple(use for use in uses if use.recorded)
        return self.recipes.of(getattr(job, kind.key), key, recorded, self.resolvers[drive.key])

    def _own_uses(
        self,
        kind: JobKind,
        uses: tuple[Use, ...],
        packed: list[tuple[Part, ...]],
        drives: tuple[PlannedDrive, ...],
        path: tuple[str, str],
    ) -> dict[str, tuple[Use, ...]]:
        """The uses as each drive knows its parameters; those of drives that know them alike are found once.

        PG222 where the telegrams would not be the same or would not mean the same: one block cannot serve both.
        """
        first = drives[0]
        seen = [(self.resolvers[first.key], uses)]
        found = {first.key: uses}
        for drive in drives[1:]:
            resolver = self.resolvers[drive.key]
            known = next((own for other, own in seen if other.alike(resolver)), None)
            if known is None:
                known = self._same_telegrams(kind, packed, first, drive, path) or uses
                seen.append((resolver, known))
            found[drive.key] = known
        return found

    def _same_telegrams(
        self,
        kind: JobKind,
        packed: list[tuple[Part, ...]],
        first: PlannedDrive,
        other: PlannedDrive,
        path: tuple[str, str],
    ) -> tuple[Use, ...] | None:
        """The uses of another drive, after PG222 too, so that the rules see them; None if not all can be resolved."""
        job = self.loaded.sections(DriveSections).jobs[path[1]]
        quiet = Report()
        resolver = self.resolvers[other.key].reporting(quiet)
        uses = Accesses(job, path, self.loaded, self.recipes, resolver, quiet).uses(kind)
        own = _packed(uses, other, self.loaded, quiet) if uses else None
        same = own is not None and _meanings(packed) == _meanings(own)
        units = _units(packed, own) if own is not None and same else ""
        if same and not units:
            return uses
        why = (
            f"{first.key} is a {first.device.key}, {other.key} a {other.device.key}"
            if first.device is not other.device
            else "their parameters are defined differently"
        )
        message = f'"{path[1]}" cannot be one block for {first.key} and {other.key}: {units or why}'
        notes = tuple(Note(f"{other.key}: {one.message}", one.span) for one in quiet)
        place = self.loaded.span((*path, "drive"))
        self.report.add(Diagnostic("PG222", message, place, help="make a job for each kind of drive", notes=notes))
        return uses if uses and len(uses) == sum(map(len, packed)) else None


def _clock(kind: JobKind, numbering: Numbering) -> Elementary | None:
    """Type of the time at the input of a job that sets a clock."""
    return ELEMENTARY["DTL" if numbering.where.t15 else "DATE_AND_TIME"] if kind.sets_clock else None


_PLACES = 32
"""Deviations that are listed at most; all of them are counted."""


def _listed(
    job: JobEntry, kind: JobKind, uses: tuple[Use, ...], name: str, numbering: Numbering, path: SpecPath
) -> MessageList | DeviationList | None:
    """The list that the block delivers: of messages, or of deviations with a place for each value, up to a limit."""
    if kind.messages is None and not kind.compares:
        return None
    type_ = numbering.block("UDT", f"type{name}Entry", path)
    if kind.messages is None:
        return DeviationList(type_, min(sum(use.count for use in uses), _PLACES))
    return MessageList(kind.key, f"{kind.key.removesuffix('s')}Count", type_, kind.messages(getattr(job, kind.key)))


def _permitted(
    job: JobEntry, name: str, drives: Sequence[PlannedDrive], numbering: Numbering, path: SpecPath
) -> Permitted:
    """What is harmless in every drive of a service, and what the job signs."""
    known = (drive.device.harmless(drive.object_type) for drive in drives)
    named = frozenset(pnu for text in job.allow if (pnu := number_of(text)) is not None) - guards.NOT_SERVED
    ranges: list[tuple[int, int]] = []
    for pnu in sorted(set.intersection(*known) | named):
        if ranges and ranges[-1][1] == pnu - 1:
            ranges[-1] = (ranges[-1][0], pnu)
        else:
            ranges.append((pnu, pnu))
    return Permitted(numbering.block("DB", f"{name}_Numbers", path), tuple(ranges), named)


def _report_shared_flags(key: str, drives: int, loaded: LoadedSpec, path: SpecPath, report: Report) -> None:
    message = f'flags cannot belong to {drives} drives: "{key}" would start on all of them at once'
    help_ = "leave trigger out: every instance has its execute in DriveJobs"
    report.add(Diagnostic("PG404", message, loaded.key_span((*path, "trigger")), help=help_))


def _meanings(packed: list[tuple[Part, ...]]) -> list[tuple[bytes, list[tuple[object, ...]]]]:
    """Every telegram with the types of what it accesses, what that should be if it is compared, limits of records."""
    return [(_request_bytes(parts, 1, 0), [_meaning(part.use, part.data) for part in parts]) for parts in packed]


def _meaning(use: Use, data: bytes) -> tuple[object, ...]:
    limits = (use.parameter.minimum, use.parameter.maximum) if use.recorded else ()
    return use.format.code, data if use.as_(Compare) else b"", *limits


def _units(packed: list[tuple[Part, ...]], other: list[tuple[Part, ...]]) -> str:
    """Which parameter has another unit on the other drive; empty if none has."""
    for one, its in zip(chain.from_iterable(packed), chain.from_iterable(other), strict=True):
        here, there = one.use.parameter.unit, its.use.parameter.unit
        if here and there and here.lower() != there.lower():
            doubts = [part.use.parameter.doubt("unit") for part in (one, its)]
            return f"{one.use.label} is in {here}{doubts[0]} and in {there}{doubts[1]}"
    return ""


def _more_than_data_blocks(kind: JobKind, uses: Sequence[Use], where: Target) -> str:
    """Why a job cannot have its telegrams in data blocks of its own, whatever their number; empty if it can.

    Their values are written by absolute addresses, and there is none of more than 4 bytes.
    """
    types = (element_type(use.format, where) for use in uses if use.writes and not use.constant)
    if any(type_ is not None and type_.bits > 32 for type_ in types):
        return "has an input of 8 bytes"
    works = {
        "has a recipe": kind.recorded,
        "compares": kind.compares,
        "sets a clock": kind.sets_clock,
        "serves": kind.serves,
    }
    works["reads without a type"] = any(use.untyped for use in uses)
    return next((work for work, does in works.items() if does), "")


def _own_blocks(
    job: JobEntry, works: str, telegrams: int, drives: int, loaded: LoadedSpec, path: SpecPath, report: Report
) -> bool:
    """Whether the telegrams have data blocks of their own; PG223 where that cannot be, for what the job ``works``."""
    buffers = {"request": job.request, "response": job.response}
    keys = [which for which, given in buffers.items() if given.db is not None or given.name is not None]
    keys += ["buffers"] if job.buffers == "db" else []
    sized = any(given.size is not None for given in buffers.values())
    if telegrams == 1 and drives == 1 and not works:
        return bool(keys) or sized
    if keys:
        why = f"has {telegrams} telegrams" if telegrams > 1 else f"has {drives} drives"
        why = works or why
        message = (
            f'"{path[-1]}" {why}: only one telegram of one drive that reads or writes can have data blocks of its own'
        )
        help_ = "leave the data blocks out, or split the job"
        report.add(Diagnostic("PG223", message, loaded.key_span((*path, keys[0])), help=help_))
    return False


_MOST_RETRIES = 30_000
"""They are counted in an INT."""


def _timeout(job: JobEntry, uses: tuple[Use, ...]) -> int:
    """Time-out of the channel in ms: what the spec says, twice that to restore, and the time that a drive takes."""
    poll = next((poll for use in uses if (poll := use.as_(Poll))), None)
    own = 2 * job.timeout if uses[0].as_(Remember) else job.timeout
    return own + (poll.limit + poll.interval if poll is not None else 0)


def _retries(job: JobEntry, timeout: int) -> int:
    """Bound on retries of one telegram; by default their pauses take 80 % of the time-out, so that it is reached."""
    if job.retries is not None:
        return job.retries
    return min(max(1, timeout * 4 // (5 * job.retry_pause)), _MOST_RETRIES)


def _member(key: str, job: JobEntry, numbering: Numbering) -> str:
    """Name of the instance in the control DB; with flags, their tags (``..Execute``) have to fit the limit too."""
    limit = V5_LIMIT if numbering.where.v5 else TIA_LIMIT
    return shorten(camel_case(key), limit if job.trigger is None else limit - len(f"{numbering.prefix}Execute"))


def _directions(uses: tuple[Use, ...]) -> list[tuple[Use, ...]]:
    """The uses of a job, divided where writing and reading change: a telegram does one of them.

    What asks again is behind everything else, in a telegram of its own; so is every step of a sequence.
    """
    return [
        tuple(group) for _, group in groupby(uses, key=lambda use: (use.writes, use.as_(Recount) is not None, use.step))
    ]


def _packed(
    uses: tuple[Use, ...], drive: PlannedDrive, loaded: LoadedSpec, report: Report
) -> list[tuple[Part, ...]] | None:
    """Telegrams of a job; None after a diagnostic if they are too many, or if a single value does not fit a record."""
    device = drive.device
    octets = sum(use.count * use.format.size for use in uses)
    packed: list[tuple[Part, ...]] | None = []
    if octets <= pack.MAX_TELEGRAMS * device.record_limit:
        limits = device.record_limit, device.max_parameters, device.max_elements
        found = [pack.pack(group, *limits, write=group[0].writes) for group in _directions(uses)]
        packed = None if None in found else [parts for telegrams in found for parts in telegrams or ()]
    if packed and sum(parts[0].use.as_(Recount) is not None for parts in packed) > 1:
        message = f"the codes that are read again need more than one telegram of {device.record_limit} bytes"
        report.add(Diagnostic("PG307", message, loaded.span(uses[0].path), help="read fewer groups: history"))
        return None
    if packed and len(packed) <= pack.MAX_TELEGRAMS:
        return None if divided(packed, loaded, report) else packed
    if packed is not None:
        message = f"the job needs more than {pack.MAX_TELEGRAMS} telegrams"
        report.add(Diagnostic("PG307", message, loaded.key_span(uses[0].path[:2]), help="split it into several jobs"))
        return None
    long = max(uses, key=lambda use: use.count * use.format.size)
    message = f"{long.label} does not fit one record of {device.record_limit} bytes"
    if long.writes and long.count > device.max_elements:
        message = f"{long.label} has {long.count} elements; {device.key} takes {device.max_elements} in one telegram"
    report.add(Diagnostic("PG301", message, loaded.span(long.path), help="shorten the string"))
    return None


def _report_unsplittable(
    kind: JobKind, path: SpecPath, uses: tuple[Use, ...], drive: PlannedDrive, loaded: LoadedSpec, report: Report
) -> None:
    """Why a job that must not be split does not fit one telegram."""
    device = drive.device
    parts = [Part(use, 0, use.count) for use in uses]
    write = uses[0].writes
    place = loaded.span((*path, kind.key))
    help_ = "allow several telegrams (split: auto) or split it into two jobs"
    if len(parts) > device.max_parameters:
        message = f"{len(parts)} parameters in one telegram; {device.key} takes {device.max_parameters}"
        report.add(Diagnostic("PG302", message, place, help=help_))
    elif any(use.divisible and use.count > device.max_elements for use in uses):
        long = max(uses, key=lambda use: use.count)
        message = f"{long.label} has {long.count} elements; {device.key} takes {device.max_elements} in one telegram"
        report.add(Diagnostic("PG301", message, place, help=help_))
    else:
        request, response = pack.request_length(parts, write=write), pack.longest_response(parts, write=write)
        message = f"request {request} bytes, response up to {response}: the record holds {device.record_limit}"
        report.add(Diagnostic("PG301", message, place, help=help_))


class _Context:
    """What all telegrams of a job share."""

    def __init__(
        self,
        key: str,
        drive: PlannedDrive,
        reference: int,
        numbering: Numbering,
        *,
        faq: bool,
        many: bool,
        own: bool,
    ) -> None:
        self.key, self.drive, self.reference, self.numbering = key, drive, reference, numbering
        self.faq, self.many, self.own = faq, many, own

    def reference_of(self, index: int) -> int:
        return (self.reference - 1 + index - 1) % 255 + 1

    def buffer(self, given: BufferSpec, which: str, default: str, index: int) -> tuple[BlockRef | None, BlockRef]:
        """The data block of a telegram, if it has one, and its type."""
        path = ("jobs", self.key, which)
        name = self.name(given.name or default, index)
        db = self.numbering.block("DB", name, path, given.db, given=bool(given.name)) if self.own else None
        derived = bool(db or given.name)
        return db, self.numbering.block("UDT", f"type{first_upper(db.name if db else name)}", path, derived=derived)

    def name(self, base: str, index: int) -> str:
        return f"{base}{index}" if self.many else base


def _telegram(number: int, parts: tuple[Part, ...], job: JobEntry, name: str, context: _Context) -> DriveTelegram:
    where, write, faq = context.numbering.where, parts[0].use.writes, context.faq
    request_id = RequestId.CHANGE if write else RequestId.READ
    header = (context.reference_of(number) & 0xFF, int(request_id), context.drive.drive_object)
    data = _request_bytes(parts, header[0], header[2])
    pinned = job.response.size
    size = pack.longest_response(parts, write=write) if pinned is None else pinned
    asking = context.buffer(job.request, "request", f"{name}_Request", number)
    answering = context.buffer(job.response, "response", f"{name}_Response", number)
    asked = request_fields(parts, header, where, job.request.members, write=write, faq=faq)
    answered = response_fields(parts, size, where, job.response.members, write=write, faq=faq)
    return DriveTelegram(
        number=number,
        request_id=request_id,
        response_id=request_id,
        request=Buffer(*asking, asked, len(data), data),
        response=Buffer(*answering, answered, size),
        parts=parts,
        positive_length=pack.positive_length(parts, write=write),
        negative_length=pack.negative_length(parts),
        pinned=pinned,
    )


def _request_bytes(parts: tuple[Part, ...], reference: int, drive_object: int) -> bytes:
    write = parts[0].use.writes
    header = (reference, int(RequestId.CHANGE if write else RequestId.READ), drive_object)
    addresses = tuple(ParameterAddress(part.use.parameter.pnu, part.subindex, part.elements) for part in parts)
    values = tuple(ValueBlock(part.use.format.code, part.count, part.data) for part in parts) if write else ()
    return encode_request(Request(*header, addresses, values))
