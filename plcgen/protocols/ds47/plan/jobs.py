"""One job of the spec -> a planned job: uses, telegrams, buffers, blocks."""

from __future__ import annotations

from plcgen.diagnostics import Diagnostic, Report
from plcgen.project.nouns import BlockRef, Buffer
from plcgen.project.numbering import Numbering
from plcgen.project.spec import LoadedSpec, SpecPath
from plcgen.project.triggers import plan_trigger
from plcgen.protocols.ds47.kinds import JobKind, kinds
from plcgen.protocols.ds47.plan import pack
from plcgen.protocols.ds47.plan.fields import request_fields, response_fields
from plcgen.protocols.ds47.plan.nouns import DriveJob, DriveTelegram, Part, PlannedDrive, Use
from plcgen.protocols.ds47.plan.uses import UseResolver
from plcgen.protocols.ds47.schema import BufferSettings as BufferSpec
from plcgen.protocols.ds47.schema import DriveSections, JobEntry
from plcgen.protocols.ds47.wire.codec import encode_request
from plcgen.protocols.ds47.wire.model import ParameterAddress, Request, RequestId, ValueBlock
from plcgen.s7.names import TIA_LIMIT, V5_LIMIT, camel_case, pascal_case, shorten


def plan_job(
    key: str,
    loaded: LoadedSpec,
    drive: PlannedDrive,
    owner: int,
    resolver: UseResolver,
    numbering: Numbering,
    report: Report,
) -> DriveJob | None:
    """Plan one job; None if it has no usable parameter."""
    job = loaded.sections(DriveSections).jobs[key]
    path = ("jobs", key)
    kind = _kind(job, key, loaded, report)
    uses = _uses(job, kind, path, loaded, resolver, report) if kind is not None else ()
    if kind is None or not uses:
        return None
    write = kind.writes
    packed = _packed(uses, drive, loaded, report, write=write)
    if packed is None:
        return None
    reference = job.reference if job.reference is not None else (owner - 1) % 255 + 1
    name = pascal_case(key)
    faq = (job.names or loaded.spec.plc.names) == "faq"
    if len(packed) > 1 and job.split == "never":
        _report_unsplittable(kind, path, uses, drive, loaded, report)
    context = _Context(key, drive, reference, numbering, write=write, faq=faq, many=len(packed) > 1)
    telegrams = tuple(_telegram(index, parts, job, name, context) for index, parts in enumerate(packed, 1))
    block, instance, records = _blocks(job, name, path, numbering)
    return DriveJob(
        key=key,
        member=_member(key, job, numbering),
        kind=kind.key,
        writes=write,
        link=drive,
        owner=owner,
        uses=uses,
        telegrams=telegrams,
        block=block,
        instance=instance,
        record_instances=records,
        trigger=plan_trigger(job.trigger, path, loaded, report),
        reference=reference,
        timeout=job.timeout,
        retry_pause=job.retry_pause,
        retries=_retries(job),
        faq_names=faq,
        comment=job.comment or {},
        path=path,
    )


def _retries(job: JobEntry) -> int:
    """Bound on retries of one telegram; by default their pauses take 80 % of the time-out, so that it is reached."""
    return max(1, job.timeout * 4 // (5 * job.retry_pause)) if job.retries is None else job.retries


def _member(key: str, job: JobEntry, numbering: Numbering) -> str:
    """Name of the job in the control DB; with flags, their tags (``..Execute``) have to fit the limit too."""
    limit = V5_LIMIT if numbering.where.v5 else TIA_LIMIT
    return shorten(camel_case(key), limit if job.trigger is None else limit - len("Execute"))


def _blocks(
    job: JobEntry, name: str, path: SpecPath, numbering: Numbering
) -> tuple[BlockRef, BlockRef, tuple[BlockRef, BlockRef] | None]:
    """The function block, its instance DB and, for STEP 7 V5, the instance DBs of WRREC and RDREC."""
    own = job.block.name
    block = numbering.block("FB", own or name, (*path, "block"), job.block.number, given=bool(own))
    own = job.instance.name
    instance = numbering.block("DB", own or f"{name}_DB", (*path, "instance"), job.instance.number, given=bool(own))
    if not numbering.where.v5:
        return block, instance, None
    records = (numbering.block("DB", f"{name}_WrRec", path), numbering.block("DB", f"{name}_RdRec", path))
    return block, instance, records


def _packed(
    uses: tuple[Use, ...], drive: PlannedDrive, loaded: LoadedSpec, report: Report, *, write: bool
) -> list[tuple[Part, ...]] | None:
    """Telegrams of a job; None after a diagnostic if they are too many, or if a single value does not fit a record."""
    device = drive.device
    octets = sum(use.count * use.format.size for use in uses)
    packed: list[tuple[Part, ...]] | None = []
    if octets <= pack.MAX_TELEGRAMS * device.record_limit:
        packed = pack.pack(uses, device.record_limit, device.max_parameters, device.max_elements, write=write)
    if packed and len(packed) <= pack.MAX_TELEGRAMS:
        return packed
    if packed is not None:
        message = f"the job needs more than {pack.MAX_TELEGRAMS} telegrams"
        report.add(Diagnostic("PG307", message, loaded.key_span(uses[0].path[:2]), help="make several jobs of it"))
        return None
    long = max(uses, key=lambda use: use.count * use.format.size)
    message = f"{long.label} does not fit one record of {device.record_limit} bytes"
    if write and long.count > device.max_elements:
        message = f"{long.label} has {long.count} elements; {device.key} takes {device.max_elements} in one telegram"
    report.add(Diagnostic("PG301", message, loaded.span(long.path), help="shorten the string"))
    return None


def _kind(job: JobEntry, key: str, loaded: LoadedSpec, report: Report) -> JobKind | None:
    """The one kind that a job says it is; None after a diagnostic."""
    given = [kind for kind in kinds() if getattr(job, kind.key) is not None]
    if len(given) == 1:
        return given[0]
    names = " or ".join(kind.key for kind in given)
    what = f"either {names}, not both" if given else "what to read or what to write"
    help_ = "make two jobs of it" if given else f"add {' or '.join(kind.example for kind in kinds())}"
    report.add(Diagnostic("PG218", f'job "{key}" needs {what}', loaded.key_span(("jobs", key)), help=help_))
    return None


def _uses(
    job: JobEntry, kind: JobKind, path: SpecPath, loaded: LoadedSpec, resolver: UseResolver, report: Report
) -> tuple[Use, ...]:
    items = kind.items(getattr(job, kind.key))
    if not items:
        report.add(Diagnostic("PG218", f'job "{path[-1]}" names no parameter', loaded.span((*path, kind.key))))
    found = [
        resolver.resolve(item, position, (*path, kind.key, position - 1), write=kind.writes)
        for position, item in enumerate(items, 1)
    ]
    return tuple(use for use in found if use is not None)


def _report_unsplittable(
    kind: JobKind, path: SpecPath, uses: tuple[Use, ...], drive: PlannedDrive, loaded: LoadedSpec, report: Report
) -> None:
    """Why a job that must not be split does not fit one telegram."""
    device = drive.device
    parts = [Part(use, 0, use.count) for use in uses]
    write = kind.writes
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
        write: bool,
        faq: bool,
        many: bool,
    ) -> None:
        self.key, self.drive, self.reference, self.numbering = key, drive, reference, numbering
        self.write, self.faq, self.many = write, faq, many

    def reference_of(self, index: int) -> int:
        return (self.reference - 1 + index - 1) % 255 + 1

    def type_of(self, block: BlockRef) -> BlockRef:
        return self.numbering.block("UDT", f"type{_upper(block.name)}", block.path)

    def name(self, base: str, index: int) -> str:
        return f"{base}{index}" if self.many else base


def _telegram(number: int, parts: tuple[Part, ...], job: JobEntry, name: str, context: _Context) -> DriveTelegram:
    where, write, faq = context.numbering.where, context.write, context.faq
    request_id = RequestId.CHANGE if write else RequestId.READ
    header = (context.reference_of(number) & 0xFF, int(request_id), context.drive.drive_object)
    data = _request_bytes(parts, header, write=write)
    pinned = job.response.size
    size = pack.longest_response(parts, write=write) if pinned is None else pinned
    request_db = _buffer(job.request, "request", f"{name}_Request", number, context)
    response_db = _buffer(job.response, "response", f"{name}_Response", number, context)
    asked = request_fields(parts, header, where, job.request.members, write=write, faq=faq)
    answered = response_fields(parts, size, where, job.response.members, write=write, faq=faq)
    return DriveTelegram(
        number=number,
        request_id=request_id,
        response_id=request_id,
        request=Buffer(request_db, context.type_of(request_db), asked, len(data), data),
        response=Buffer(response_db, context.type_of(response_db), answered, size),
        parts=parts,
        positive_length=pack.positive_length(parts, write=write),
        negative_length=pack.negative_length(parts),
        pinned=pinned,
    )


def _upper(name: str) -> str:
    return name[:1].upper() + name[1:]


def _buffer(given: BufferSpec, which: str, default: str, index: int, context: _Context) -> BlockRef:
    path = ("jobs", context.key, which)
    name = context.name(given.name or default, index)
    number = given.db if index == 1 else None
    return context.numbering.block("DB", name, path, number, given=bool(given.name))


def _request_bytes(parts: tuple[Part, ...], header: tuple[int, int, int], *, write: bool) -> bytes:
    addresses = tuple(ParameterAddress(part.use.parameter.pnu, part.subindex, part.elements) for part in parts)
    values = tuple(ValueBlock(part.use.format.code, part.count, part.data) for part in parts) if write else ()
    return encode_request(Request(*header, addresses, values))
