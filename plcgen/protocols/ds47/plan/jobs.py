"""One job of the spec -> a planned job: uses, telegrams, buffers, blocks."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from itertools import groupby

from plcgen.diagnostics import Diagnostic, Report
from plcgen.project.nouns import BlockRef, Buffer, PlannedTrigger
from plcgen.project.numbering import Numbering
from plcgen.project.spec import LoadedSpec, SpecPath
from plcgen.project.triggers import plan_trigger
from plcgen.protocols.ds47 import guards
from plcgen.protocols.ds47.kinds import (
    ACKNOWLEDGES,
    ACTIVATES,
    ACTIVE,
    ALARM_COUNTER,
    FAULT_COUNTER,
    SAVES,
    UTC,
    JobKind,
    Messages,
    ReadItem,
    WriteItem,
    kind_called,
    kinds,
)
from plcgen.protocols.ds47.plan import pack
from plcgen.protocols.ds47.plan.callers import Callers, footprint
from plcgen.protocols.ds47.plan.fields import request_fields, response_fields
from plcgen.protocols.ds47.plan.nouns import (
    DeviationList,
    DriveJob,
    DriveTelegram,
    MessageList,
    Part,
    PlannedDrive,
    PlannedUnit,
    Use,
)
from plcgen.protocols.ds47.plan.readback import read_back, transaction
from plcgen.protocols.ds47.plan.recipes import Recipes
from plcgen.protocols.ds47.plan.references import number_of
from plcgen.protocols.ds47.plan.steps import divided, resolved_steps
from plcgen.protocols.ds47.plan.uses import UseResolver
from plcgen.protocols.ds47.schema import BufferSettings as BufferSpec
from plcgen.protocols.ds47.schema import DriveSections, JobEntry
from plcgen.protocols.ds47.wire.codec import encode_request
from plcgen.protocols.ds47.wire.model import ParameterAddress, Request, RequestId, ValueBlock
from plcgen.s7.names import TIA_LIMIT, V5_LIMIT, camel_case, pascal_case, shorten
from plcgen.s7.types import ELEMENTARY, Elementary


def plan_jobs(
    key: str,
    loaded: LoadedSpec,
    drives: tuple[PlannedDrive, ...],
    slots: Slots,
    resolvers: Mapping[str, UseResolver],
    callers: Callers,
    recipes: Recipes,
    numbering: Numbering,
    report: Report,
) -> tuple[DriveJob, ...]:
    """Plan one job of the spec: an instance for each of its drives; none if it has no usable parameter."""
    job = loaded.sections(DriveSections).jobs[key]
    path = ("jobs", key)
    kind = _kind(job, key, loaded, report)
    first = drives[0]
    uses = _uses(job, kind, path, loaded, recipes, resolvers[first.key], report) if kind is not None else ()
    if kind is None or not uses:
        return ()
    packed = _packed(uses, first, loaded, report)
    if packed is None:
        return ()
    for other in drives[1:]:
        _same_telegrams(kind, packed, first, other, loaded, path, recipes, resolvers[other.key], report)
    if len(packed) > len(_directions(uses)) and job.split == "never":
        _report_unsplittable(kind, path, uses, first, loaded, report)
    reference = job.reference if job.reference is not None else 1
    name = pascal_case(key)
    faq = (job.names or loaded.spec.plc.names) == "faq"
    own = _own_blocks(job, kind, len(packed), len(drives), loaded, path, report)
    context = _Context(key, first, reference, numbering, faq=faq, many=len(packed) > 1, own=own)
    telegrams = tuple(_telegram(index, parts, job, name, context) for index, parts in enumerate(packed, 1))
    given = job.block.name
    block = numbering.block("FB", given or name, (*path, "block"), job.block.number, given=bool(given))
    if job.trigger is not None and len(drives) > 1:
        _report_shared_flags(key, len(drives), loaded, path, report)
    timeout = _timeout(job, uses)
    listed = _listed(job, kind, uses, name, numbering, path)
    recorded = tuple(use for use in uses if use.recorded)
    recipe = recipes.of(getattr(job, kind.key), key, recorded, resolvers[first.key]) if kind.recorded else None
    size = footprint(uses, telegrams, listed)
    return tuple(
        DriveJob(
            key=key if len(drives) == 1 else f"{key}.{drive.key}",
            member=_member(key if len(drives) == 1 else f"{key}_{drive.key}", job, numbering),
            kind=kind.key,
            once=any(use.writes and use.parameter.pnu in guards.TRIGGERS for use in uses),
            shape=key,
            slot=slots.next(drive.unit),
            link=drive,
            caller=callers.caller(drive.unit, size),
            uses=uses,
            telegrams=telegrams,
            block=block,
            trigger=plan_trigger(job.trigger, path, loaded, report) if drive is first else PlannedTrigger(),
            reference=reference,
            timeout=timeout,
            retry_pause=job.retry_pause,
            retries=_retries(job, job.timeout if uses[0].remembers is not None else timeout),
            faq_names=faq,
            listed=listed,
            clock=_clock(kind, numbering),
            recipe=recipe,
            comment=job.comment or {},
            path=path,
        )
        for drive in drives
    )


def _clock(kind: JobKind, numbering: Numbering) -> Elementary | None:
    """Type of the time at the input of a job that sets a clock."""
    return ELEMENTARY["DTL" if numbering.where.t15 else "DATE_AND_TIME"] if kind.key == "clock" else None


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


def _report_shared_flags(key: str, drives: int, loaded: LoadedSpec, path: SpecPath, report: Report) -> None:
    message = f'flags cannot belong to {drives} drives: "{key}" would start on all of them at once'
    help_ = "leave trigger out: every instance has its execute in DriveJobs"
    report.add(Diagnostic("PG404", message, loaded.key_span((*path, "trigger")), help=help_))


class Slots:
    """Hands out the places of each unit, from 1."""

    def __init__(self) -> None:
        self._used: dict[str, int] = {}

    def next(self, unit: PlannedUnit) -> int:
        """The next free place."""
        self._used[unit.key] = self._used.get(unit.key, 0) + 1
        return self._used[unit.key]


def _same_telegrams(
    kind: JobKind,
    packed: list[tuple[Part, ...]],
    first: PlannedDrive,
    other: PlannedDrive,
    loaded: LoadedSpec,
    path: SpecPath,
    recipes: Recipes,
    resolver: UseResolver,
    report: Report,
) -> None:
    """PG222: the parameters of a job are not the same on another of its drives, so that one block cannot serve both."""
    job = loaded.sections(DriveSections).jobs[str(path[-1])]
    quiet = Report()
    uses = _uses(job, kind, path, loaded, recipes, resolver.reporting(quiet), quiet)
    own = _packed(uses, other, loaded, quiet) if uses else None
    if own is not None and _meanings(packed) == _meanings(own):
        return
    why = (
        f"{first.key} is a {first.device.key}, {other.key} a {other.device.key}"
        if first.device is not other.device
        else ("their parameters are defined differently")
    )
    message = f'"{path[-1]}" cannot be one block for {first.key} and {other.key}: {why}'
    report.add(Diagnostic("PG222", message, loaded.span((*path, "drive")), help="make a job for each kind of drive"))


def _meanings(packed: list[tuple[Part, ...]]) -> list[tuple[bytes, list[tuple[object, ...]]]]:
    """Every telegram with the types of what it accesses, what that should be if it is compared, limits of records."""
    return [(_request_bytes(parts, 1, 0), [_meaning(part.use, part.data) for part in parts]) for parts in packed]


def _meaning(use: Use, data: bytes) -> tuple[object, ...]:
    limits = (use.parameter.minimum, use.parameter.maximum) if use.recorded else ()
    return use.format.code, data if use.compared else b"", *limits


def _own_blocks(
    job: JobEntry, kind: JobKind, telegrams: int, drives: int, loaded: LoadedSpec, path: SpecPath, report: Report
) -> bool:
    """Whether the telegrams have data blocks of their own; PG223 where that cannot be."""
    buffers = {"request": job.request, "response": job.response}
    keys = [which for which, given in buffers.items() if given.db is not None or given.name is not None]
    keys += ["buffers"] if job.buffers == "db" else []
    sized = any(given.size is not None for given in buffers.values())
    works = {"compare": "compares", "clock": "sets a clock"}.get(kind.key, "has a recipe" if kind.recorded else "")
    if telegrams == 1 and drives == 1 and not works:
        return bool(keys) or sized
    if keys:
        why = f"has {telegrams} telegrams" if telegrams > 1 else f"has {drives} drives"
        why = works or why
        message = f'"{path[-1]}" {why}: data blocks of its own are for one telegram of one drive that reads or writes'
        help_ = "leave the data blocks out, or make several jobs of it"
        report.add(Diagnostic("PG223", message, loaded.key_span((*path, keys[0])), help=help_))
    return False


_MOST_RETRIES = 30_000
"""They are counted in an INT."""


def _timeout(job: JobEntry, uses: tuple[Use, ...]) -> int:
    """Time-out of the channel in ms: what the spec says, twice that to restore, and the time that a drive takes."""
    poll = next((use.poll for use in uses if use.poll is not None), None)
    if uses[0].remembers is not None:
        return 2 * job.timeout
    return job.timeout + (poll.limit + poll.interval if poll is not None else 0)


def _retries(job: JobEntry, timeout: int) -> int:
    """Bound on retries of one telegram; by default their pauses take 80 % of the time-out, so that it is reached."""
    if job.retries is not None:
        return job.retries
    return min(max(1, timeout * 4 // (5 * job.retry_pause)), _MOST_RETRIES)


def _member(key: str, job: JobEntry, numbering: Numbering) -> str:
    """Name of the instance in the control DB; with flags, their tags (``..Execute``) have to fit the limit too."""
    limit = V5_LIMIT if numbering.where.v5 else TIA_LIMIT
    return shorten(camel_case(key), limit if job.trigger is None else limit - len("Execute"))


def _directions(uses: tuple[Use, ...]) -> list[tuple[Use, ...]]:
    """The uses of a job, divided where writing and reading change: a telegram does one of them.

    What asks again is behind everything else, in a telegram of its own; so is every step of a sequence.
    """
    return [tuple(group) for _, group in groupby(uses, key=lambda use: (use.writes, use.again is not None, use.step))]


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
    if packed and len(packed) <= pack.MAX_TELEGRAMS:
        return None if divided(packed, loaded, report) else packed
    if packed is not None:
        message = f"the job needs more than {pack.MAX_TELEGRAMS} telegrams"
        report.add(Diagnostic("PG307", message, loaded.key_span(uses[0].path[:2]), help="make several jobs of it"))
        return None
    long = max(uses, key=lambda use: use.count * use.format.size)
    message = f"{long.label} does not fit one record of {device.record_limit} bytes"
    if long.writes and long.count > device.max_elements:
        message = f"{long.label} has {long.count} elements; {device.key} takes {device.max_elements} in one telegram"
    report.add(Diagnostic("PG301", message, loaded.span(long.path), help="shorten the string"))
    return None


def _kind(job: JobEntry, key: str, loaded: LoadedSpec, report: Report) -> JobKind | None:
    """The one kind that a job says it is; None after a diagnostic. What is read back may be saved in the same job."""
    given = [kind for kind in kinds() if getattr(job, kind.key) is not None]
    if len(given) == 1:
        return given[0]
    saved = [kind for kind in given if kind.writes and kind.poll is None]
    if len(given) == 2 and len(saved) == 1 and _then(job, saved[0]) is not None:
        if job.verify is not None:
            return saved[0]
        message = f'job "{key}" saves what it has not read back'
        help_ = "add verify: readback, or make two jobs of it"
        report.add(Diagnostic("PG218", message, loaded.key_span(("jobs", key)), help=help_))
        return None
    names = " or ".join(kind.key for kind in given)
    what = f"either {names}, not both" if given else "what to read, what to write or what to save"
    help_ = "make two jobs of it" if given else f"add {' or '.join(kind.example for kind in kinds())}"
    report.add(Diagnostic("PG218", f'job "{key}" needs {what}', loaded.key_span(("jobs", key)), help=help_))
    return None


def _uses(
    job: JobEntry,
    kind: JobKind,
    path: SpecPath,
    loaded: LoadedSpec,
    recipes: Recipes,
    resolver: UseResolver,
    report: Report,
) -> tuple[Use, ...]:
    first = _own_uses(job, kind, 0, path, loaded, recipes, resolver, report)
    then = _then(job, kind)
    if then is None or not first:
        return first
    return first + _own_uses(job, then, len(first), path, loaded, recipes, resolver, report)


def _then(job: JobEntry, kind: JobKind) -> JobKind | None:
    """The kind of what a job does behind its own: it saves."""
    saves = kind_called("save")
    return saves if kind is not saves and getattr(job, saves.key) is not None else None


def _own_uses(
    job: JobEntry,
    kind: JobKind,
    before: int,
    path: SpecPath,
    loaded: LoadedSpec,
    recipes: Recipes,
    resolver: UseResolver,
    report: Report,
) -> tuple[Use, ...]:
    """The uses of one kind, with ``before`` others in front of them."""
    place: SpecPath | None = (*path, kind.key)
    if kind.recorded:
        place = recipes.place(getattr(job, kind.key), (*path, kind.key))
    if place is None:
        return ()
    items = loaded.sections(DriveSections).items(job, kind)
    if not items:
        report.add(Diagnostic("PG218", f'job "{path[-1]}" names no parameter', loaded.span((*path, kind.key))))
    if kind.key == "save" and not _savable(items[0], place, loaded, resolver, report):
        return ()
    if (kind.messages is not None or kind.key in {"acknowledge", "activate", "clock"}) and not _listable(
        items, place, loaded, resolver, report
    ):
        return ()
    if kind.steps is not None:
        return resolved_steps(tuple(kind.steps(getattr(job, kind.key))), place, loaded, resolver)
    whole = kind.poll is not None or kind.messages is not None or kind.key == "clock"
    found = [
        resolver.resolve(
            item,
            before + position,
            place if whole else (*place, position - 1),
            write=kind.writes and isinstance(item, WriteItem),
        )
        for position, item in enumerate(items, 1)
    ]
    uses = tuple(use for use in found if use is not None)
    if kind.recorded:
        uses = tuple(replace(use, recorded=True) for use in recipes.recorded(uses, resolver))
    if job.verify is not None and kind.poll is None and len(uses) == len(items):
        restores = job.on_error if kind.key in {"write", "write_recipe"} and _then(job, kind) is None else None
        if restores is not None:
            uses = transaction(uses, items, restores, path, resolver)
        else:
            uses = (*uses, *read_back(uses, items, resolver))
    if kind.poll is not None and len(uses) == len(items):
        uses = (uses[0], replace(uses[1], poll=kind.poll(getattr(job, kind.key))), *uses[2:])
    if kind.compares:
        uses = tuple(replace(use, compared=True) for use in uses if _comparable(use, loaded, report))
    if kind.messages is not None:
        uses = tuple(_columns(uses, kind.messages(getattr(job, kind.key)))) if len(uses) == len(items) else ()
    return uses


_LARGEST = 4
"""Bytes of a value that a list of deviations has room for."""


def _comparable(use: Use, loaded: LoadedSpec, report: Report) -> bool:
    """Whether a value fits the list of deviations; PG249 if not."""
    if not use.format.is_string and use.format.size <= _LARGEST:
        return True
    message = f"{use.label} is {use.format.name}: the list of deviations has numbers of 1, 2 or 4 bytes"
    report.add(Diagnostic("PG249", message, loaded.span((*use.path, "parameter")), help="read it in another job"))
    return False


def _columns(uses: tuple[Use, ...], settings: Messages) -> Iterator[Use]:
    """The accesses to a buffer of messages: the counter, columns of groups, the counter again."""
    first, *middle, last = uses
    yield first
    for number, use in enumerate(middle):
        group, column = divmod(number, len(settings.columns))
        yield replace(use, column=settings.columns[column], group=group)
    yield replace(last, again=first)


def _savable(
    item: ReadItem | WriteItem, path: SpecPath, loaded: LoadedSpec, resolver: UseResolver, report: Report
) -> bool:
    """Whether the parameter that saves is known with its type, and with its range where it shall save as a setting.

    PG243 if not: no other is taken in its place.
    """
    known = resolver.known.get(number_of(item.parameter) or 0)
    setting = item.value if isinstance(item, WriteItem) and item.value != 1 else None
    device, name = resolver.device.key, item.parameter
    if known is not None and known.type and setting is not None and known.maximum is None:
        message = f"nobody has looked up whether {name} of {device} takes {setting}"
        help_ = f"if your drive does, say so in it: parameters: {{{name}: {{type: {known.type}, max: 12}}}}"
        report.add(Diagnostic("PG243", message, loaded.span((*path, "setting")), help=help_))
        return False
    if known is not None and known.type:
        return True
    others = [f"save: {word}" for word, pnu in SAVES.items() if pnu in resolver.known and f"P{pnu}" != name]
    message = f"{name} is not in the catalogue of {device}: it is not known whether writing it saves anything"
    define = f"if your drive has it, define it there: parameters: {{{name}: {{type: Unsigned16}}}}"
    report.add(Diagnostic("PG243", message, loaded.span(path), help="; ".join((*others, define))))
    return False


_SCALARS = {f"r{FAULT_COUNTER}": "Unsigned16", f"r{ALARM_COUNTER}": "Unsigned16", f"P{ACKNOWLEDGES}": "Unsigned8",
            f"P{ACTIVATES}": "Integer16", f"r{ACTIVE}": "Integer16", f"P{UTC[0]}": "Unsigned16"}  # fmt: skip
"""Parameters of such jobs that have no index, with their type in an S120."""


def _listable(
    items: tuple[ReadItem | WriteItem, ...], path: SpecPath, loaded: LoadedSpec, resolver: UseResolver, report: Report
) -> bool:
    """Whether every parameter that the job does not name itself is known, with a type that does not come from memory.

    PG248 for those that are not: a job that reads something else than it says is worse than none.
    """
    wanted = dict.fromkeys(item.parameter.partition("[")[0] for item in items)
    missing = []
    for name in wanted:
        known = resolver.known.get(number_of(name) or 0)
        if known is None or not known.type or known.grades.get("type", "read") == "recalled":
            missing.append(name)
    if not missing:
        return True
    names, them = ", ".join(missing), "it" if len(missing) == 1 else "them"
    message = f"{names} of {resolver.device.key}: nobody has looked up whether the device has {them}"
    definition = f"{missing[0]}: {{type: {_SCALARS.get(missing[0], '.., array: 64')}}}"
    help_ = f"look it up in the list manual and define it in the drive: parameters: {{{definition}}}"
    if not set(missing) <= set(_SCALARS) and isinstance(items[0], ReadItem):
        help_ += "; or leave its column out"
    report.add(Diagnostic("PG248", message, loaded.span(path), help=help_))
    return False


def _report_unsplittable(
    kind: JobKind, path: SpecPath, uses: tuple[Use, ...], drive: PlannedDrive, loaded: LoadedSpec, report: Report
) -> None:
    """Why a job that must not be split does not fit one telegram."""
    device = drive.device
    parts = [Part(use, 0, use.count) for use in uses]
    write = uses[0].writes
    place = loaded.span((*path, kind.key))
    help_ = "allow several telegrams (split: auto) or make two jobs of it"
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
        return db, self.numbering.block("UDT", f"type{_upper(db.name if db else name)}", path)

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


def _upper(name: str) -> str:
    return name[:1].upper() + name[1:]


def _request_bytes(parts: tuple[Part, ...], reference: int, drive_object: int) -> bytes:
    write = parts[0].use.writes
    header = (reference, int(RequestId.CHANGE if write else RequestId.READ), drive_object)
    addresses = tuple(ParameterAddress(part.use.parameter.pnu, part.subindex, part.elements) for part in parts)
    values = tuple(ValueBlock(part.use.format.code, part.count, part.data) for part in parts) if write else ()
    return encode_request(Request(*header, addresses, values))
