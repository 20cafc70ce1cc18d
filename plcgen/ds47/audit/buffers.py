"""Telegrams to expected fields, and which buffer belongs to which telegram."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from plcgen.base.diagnostics import Diagnostic, Severity
from plcgen.ds47.audit.model import Expected, Match
from plcgen.ds47.plan.nouns import DriveField, DrivePlan, DriveTelegram
from plcgen.ds47.wire.codec import TelegramError, decode_request
from plcgen.ds47.wire.model import Request
from plcgen.s7.read.buffers import FoundBuffer, Slot
from plcgen.s7.types.data_types import ArrayType, Elementary

_LABELS = {
    "reference": "request reference", "request_id": "request ID", "drive_object": "axis (drive object)",
    "count": "number of parameters", "attribute": "attribute", "elements": "number of elements",
    "pnu": "parameter number", "subindex": "subindex", "format": "format", "value_count": "number of values",
    "value": "value", "pad": "pad byte",
}  # fmt: skip


def expected_fields(match: Match) -> list[Expected]:
    """Fields of the request, or those of the answer that its reader needs: arrays element by element."""
    fields = match.telegram.request.fields if match.role == "request" else match.telegram.response.fields
    return [expected for field in fields for expected in _expected(field, match.role == "request")]


def _expected(field: DriveField, request: bool) -> Iterator[Expected]:  # noqa: FBT001 - private
    if field.role not in _LABELS:
        return  # reserves and the room of an error: no member has to stand there
    label = _LABELS[field.role] if request or field.role != "request_id" else "response ID"
    if field.part is not None:
        label = f"{label} of {field.part.use.label}"
    part = field.part
    if field.role != "value" or part is None:
        yield Expected(field.role, label, field.offset, field.size, field.data if request else None, part)
        return
    constant = request and part.use.constant
    size = part.use.format.size
    if part.use.format.is_string or not isinstance(field.type, ArrayType):
        data = field.data if constant else None
        yield Expected("value", label, field.offset, field.size, data, part, part.use.format)
        return
    for number in range(part.count):
        at = number * size
        which = f"value {number + 1} of {part.use.label}" if part.count > 1 else label
        data = field.data[at : at + size] if constant else None
        yield Expected("value", which, field.offset + at, size, data, part, part.use.format)
    rest = field.size - part.count * size
    if rest:
        yield Expected("pad", f"pad byte of {part.use.label}", field.offset + field.size - rest, rest, None, part)


def match_buffers(plan: DrivePlan, found: Sequence[FoundBuffer]) -> list[Match]:
    """A match for every buffer of every job: by number, then by name, then by the start values of the request."""
    matches = [
        Match(job, telegram, role)
        for job in plan.jobs
        for telegram in job.telegrams
        for role in ("request", "response")
    ]  # type: list[Match]
    free = list(found)
    for how in (_by_number, _by_name, _by_content, _by_shape):
        for match in matches:
            if match.buffer is None:
                candidates = [buffer for buffer in free if how(match, buffer)]
                if len(candidates) == 1:
                    match.buffer, match.how = candidates[0], _HOW[how.__name__]
                    free.remove(candidates[0])
    for match in matches:
        _missing(plan, match, matches)
    return matches


_HOW = {"_by_number": "number", "_by_name": "name", "_by_content": "start values", "_by_shape": "members"}


def _by_number(match: Match, buffer: FoundBuffer) -> bool:
    return match.ref.pinned and buffer.block.number == match.ref.number


def _by_name(match: Match, buffer: FoundBuffer) -> bool:
    return buffer.block.name.upper() == match.ref.name.upper()


def _by_content(match: Match, buffer: FoundBuffer) -> bool:
    """Whether the start values are a request for the same parameters, in the same order."""
    if match.role != "request" or buffer.memory is None:
        return False
    request = _decoded(buffer.memory)
    if request is None:
        return False
    wanted = [(part.use.parameter.pnu, part.subindex) for part in match.telegram.parts]
    return [(a.pnu, a.subindex) for a in request.addresses] == wanted and match.telegram.writes == bool(request.values)


def _by_shape(match: Match, buffer: FoundBuffer) -> bool:
    """Whether a response has exactly the members of the answer, as names and offsets tell."""
    from plcgen.ds47.audit.names import CLASSES, class_of

    if match.role != "response" or buffer.block.number is not None:
        return False
    wanted = [(f.offset, f.size, CLASSES[f.role]) for f in expected_fields(match) if f.role != "pad"]
    have = [(s.offset, s.size, class_of(s.path)) for s in buffer.slots]
    return have[: len(wanted)] == wanted


def _decoded(memory: bytes) -> Request | None:
    """The request that start values form; None if they form none."""
    try:
        return decode_request(memory)
    except TelegramError:
        return None


def _missing(plan: DrivePlan, match: Match, matches: Sequence[Match]) -> None:
    """A DB that is not there is worth a word if the other one of its job is."""
    if match.buffer is not None or not any(m.buffer for m in matches if m.job is match.job):
        return
    ref = match.ref
    message = f'no DB for the {match.role} of {match.name}: neither DB{ref.number} nor "{ref.name}" is in the sources'
    help_ = "also name its file, or state in the spec which DB it is (request/response: {db, name})"
    span = plan.loaded.key_span(match.job.path)
    match.findings.report("PG650", message, span, help_, severity=Severity.WARNING)


def stray_requests(plan: DrivePlan, found: Sequence[FoundBuffer], matches: Sequence[Match]) -> list[Diagnostic]:
    """Data blocks whose start values are a good request that no job of the spec sends."""
    taken = {id(match.buffer) for match in matches}
    known: list[DriveTelegram] = [telegram for job in plan.jobs for telegram in job.telegrams]
    strays = []
    for buffer in found:
        request = None if id(buffer) in taken or buffer.memory is None else _decoded(buffer.memory)
        if request is None or any(t.request.data == buffer.memory for t in known):
            continue
        what = ", ".join(f"P{a.pnu}[{a.subindex}]" for a in request.addresses[:4])
        verb = "writes" if request.values else "reads"
        message = f"{buffer.title} is a request that {verb} {what}; no job of the spec does"
        help_ = "add the job to the spec, or the parameter to the job"
        strays.append(Diagnostic("PG650", message, buffer.span, Severity.WARNING, help=help_))
    return strays


def is_elementary(slot: Slot, names: frozenset[str]) -> bool:
    """Whether a slot has one of these elementary types."""
    return isinstance(slot.type, Elementary) and slot.type.name in names
