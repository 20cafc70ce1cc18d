"""Rules about single parameters: access, repetition, dangerous writes, types without a counterpart."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

from plcgen.base.diagnostics import Diagnostic, Note, Severity
from plcgen.ds47 import guards
from plcgen.ds47.plan.access import Compare, Remember, Use, Verify, Write
from plcgen.ds47.plan.types import element_type
from plcgen.ds47.plan.untyped import of_siblings
from plcgen.ds47.references import number_of
from plcgen.ds47.rules.places import of_drive, on_any_drive, parameter_span

if TYPE_CHECKING:
    from collections.abc import Iterator

    from plcgen.ds47.device import Parameter
    from plcgen.ds47.plan.access import Use
    from plcgen.ds47.plan.nouns import DriveJob, DrivePlan

_KINDS = {105: "activate: true", 971: "save: drive_object", 977: "save: unit"}
"""The kind of job for what a write of a number starts."""
_OPAQUE = frozenset({"BinaryDate", "TimeOfDay", "TimeDifferenceWithDate"})


def access(plan: DrivePlan) -> Iterator[Diagnostic]:
    """PG207: a job writes what can only be read, or reads what can only be written."""
    for job, use, (what, help_) in on_any_drive(plan, partial(_no_access, plan)):
        title = _title(use.parameter)
        yield Diagnostic("PG207", f"{title}{of_drive(plan, job)} {what}", parameter_span(plan, use), help=help_)


def _no_access(plan: DrivePlan, job: DriveJob, use: Use) -> tuple[str, str] | None:
    """What is wrong, and what helps."""
    doubt = use.parameter.doubt("access")
    if use.writes and use.parameter.access == "r":
        help_ = "the drive would answer error 01h: remove it from write, or read it in another job"
        return f"can only be read{doubt}", help_
    if use.writes and not use.parameter.source and use.item.parameter.strip()[:1] in {"r", "R"}:
        if use.parameter.pnu in plan.own_numbers(job.drive):
            return None
        what = "is written with r, which marks a read-only parameter"
        return what, f"write P{use.parameter.pnu} if the drive accepts values for it"
    if not use.writes and use.parameter.access == "w" and not isinstance(use.role, Verify | Remember):
        return f"can only be written{doubt}", f"remove it from {job.kind}"
    return None


def repeated(plan: DrivePlan) -> Iterator[Diagnostic]:
    """PG213: a job, or a step of it, writes or compares the same value of a parameter twice; the last one would win."""
    for job in plan.shapes:
        bynumber_of: dict[tuple[int, int], list[Use]] = {}
        for use in job.uses:
            if not isinstance(use.role, Write | Compare):
                continue
            bynumber_of.setdefault((use.parameter.pnu, use.step), []).append(use)
        for uses in bynumber_of.values():
            yield from _overlaps(plan, uses)


_LAST_WINS = "a drive takes the values in order, so the last one wins: remove one of them"


def _overlaps(plan: DrivePlan, uses: list[Use]) -> Iterator[Diagnostic]:
    furthest: Use | None = None
    for use in sorted(uses, key=lambda item: (item.subindex, item.position)):
        if furthest is not None and use.subindex <= _last(furthest):
            first, second = sorted((furthest, use), key=lambda item: item.position)
            does = "written" if use.writes else "compared"
            yield Diagnostic(
                "PG213",
                f"{second.label} is {does} twice in this {'step' if second.step else 'job'}",
                parameter_span(plan, second),
                help=_LAST_WINS if use.writes else "remove one of them",
                notes=(Note(f"first {does} as {first.label}", parameter_span(plan, first)),),
            )
        if furthest is None or _last(use) > _last(furthest):
            furthest = use


def _last(use: Use) -> int:
    return use.subindex + (1 if use.format.is_string else use.count) - 1


def dangerous(plan: DrivePlan) -> Iterator[Diagnostic]:
    """PG219: a write that can do harm is not signed off, or a sign-off names nothing."""
    for job, use, reason in on_any_drive(plan, partial(_danger, plan)):
        pnu = use.parameter.pnu
        key = "allow_safety" if pnu in guards.SAFETY else "allow"
        yield Diagnostic(
            "PG219",
            f"writing {_title(use.parameter)}{of_drive(plan, job)} needs a sign-off: {reason}",
            parameter_span(plan, use),
            help=f"if this is intended, add {key}: {{{use.parameter.label}: why}} to the job{_job_of(pnu)}",
        )
    for job in plan.shapes:
        spec = plan.entry(job)
        written = {use.parameter.pnu for use in job.uses if use.writes}
        if job.permitted is not None:
            written |= job.permitted.named
            yield from _service(plan, job)
        for key in ("allow", "allow_safety"):
            for text in getattr(spec, key):
                if number_of(text) not in written:
                    yield Diagnostic(
                        "PG219",
                        f'{key} names "{text}", which this job does not write',
                        plan.loaded.key_span((*job.path, key, text)),
                        Severity.WARNING,
                        help=f"remove it from {key}",
                    )


def _job_of(pnu: int) -> str:
    return f"; or let a job of its own kind do it, which needs no sign-off: {_KINDS[pnu]}" if pnu in _KINDS else ""


def _service(plan: DrivePlan, job: DriveJob) -> Iterator[Diagnostic]:
    """What a service cannot be permitted to write, and one that may not write anything."""
    assert job.permitted is not None  # of such jobs only
    keys = [(key, text) for key in ("allow", "allow_safety") for text in getattr(plan.entry(job), key)]
    for key, text in keys:
        if number_of(text) in guards.NOT_SERVED:
            yield Diagnostic(
                "PG219",
                f"a service does not write {text}: it starts something, is a number of Safety, or can only be read",
                plan.loaded.key_span((*job.path, key, text)),
                help="write it in a job of its own: save, acknowledge, activate or write",
            )
    if not job.permitted.ranges:
        device = job.drive.device.key
        yield Diagnostic(
            "PG219",
            f"no number is known to be harmless in {device}, and none is named: the service could not write anything",
            plan.loaded.key_span((*job.path, "service")),
            help="name what it may write in the job, with the reason: allow: {P1120: set by the operator}",
        )


def _danger(plan: DrivePlan, job: DriveJob, use: Use) -> str:
    """Why a write needs the sign-off that the job does not give."""
    reason = plan.danger(job, use)
    return reason if reason and plan.sign_off(job, use.parameter.pnu) is None else ""


def unclassified(plan: DrivePlan) -> Iterator[Diagnostic]:
    """PG261: nobody has said what a write of this number does, and the job does not sign it off."""
    told = set()
    for job, use, _ in on_any_drive(plan, partial(_unclassified, plan)):
        known = (job.shape, job.drive.device.key, use.parameter.pnu)
        if known not in told:
            told.add(known)
            yield Diagnostic(
                "PG261",
                f"nobody has classified what writing {_title(use.parameter)}{of_drive(plan, job)} does",
                parameter_span(plan, use),
                Severity.WARNING,
                help="look it up in the list manual; if it may be written, add "
                f"allow: {{{use.parameter.label}: why}} to the job",
            )


def _unclassified(plan: DrivePlan, job: DriveJob, use: Use) -> bool:
    read_only = _no_access(plan, job, use) is not None  # which has its own message
    return not read_only and plan.unclassified(job, use) and plan.sign_off(job, use.parameter.pnu) is None


def only_bytes(plan: DrivePlan) -> Iterator[Diagnostic]:
    """PG220: the CPU has no data type for the value, so the block hands over its bytes."""
    family = plan.target.family.upper()
    for job in plan.shapes:
        for use in job.uses:
            if use.untyped or element_type(use.format, plan.target) is not None:
                continue
            size = use.count * use.format.size
            if use.format.name in _OPAQUE:
                help_ = "no S7 CPU has this type: decode the bytes in your own program"
            else:
                help_ = "an S7-1500 has a type for it; on this CPU, decode the bytes in your own program"
            yield Diagnostic(
                "PG220",
                f"{use.label} is {use.type_text}: an {family} holds it only as {size} bytes",
                parameter_span(plan, use),
                Severity.WARNING,
                help=help_,
            )


def unknown_types(plan: DrivePlan) -> Iterator[Diagnostic]:
    """PG228: nobody has looked up of which type a parameter is; a wrong one is refused, or read as another value."""
    told = set()
    for job, use, how in on_any_drive(plan, partial(_not_looked_up, plan)):
        known = (job.drive.device.key, use.parameter.pnu)
        if known not in told:
            told.add(known)
            what = f"{use.label}{of_drive(plan, job)} is {use.format.name}"
            yield Diagnostic(
                "PG228",
                f"{what} {how}: nobody has looked it up",
                parameter_span(plan, use),
                Severity.WARNING,
                help=f"look it up, then define it in the drive: "
                f"parameters: {{{use.parameter.label}: {{type: {use.parameter.type}}}}}",
            )


def _not_looked_up(plan: DrivePlan, job: DriveJob, use: Use) -> str:
    """Where a type comes from that is from memory, or that of other devices; empty if somebody has looked it up."""
    drive, known = job.drive, use.parameter
    if known.pnu in plan.own_numbers(drive):
        return ""
    if known.grades.get("type") == "recalled":
        return "from general knowledge"
    listed = drive.device.find(known.pnu, drive.object_type)
    lent = known.grades.get("type") == "inferred" and (listed is None or not listed.type)
    return f"as in {known.source}" if lent else ""


def untyped(plan: DrivePlan) -> Iterator[Diagnostic]:
    """PG267: a parameter is read whose type nobody knows: outputs of their own say what the drive answers."""
    for job in plan.shapes:
        for use in job.uses:
            if not use.untyped or job.serves:
                continue
            device = job.drive.device
            said = of_siblings(device, use.parameter.pnu)
            others = "; ".join(f"{type_} in {rows[0].source}" for type_, rows in said.items())
            shown = ", ".join(one.member for one in use.shown)
            yield Diagnostic(
                "PG267",
                f"nobody knows the type of {use.label} of {device.key}: the answer tells it, in {shown}",
                parameter_span(plan, use),
                Severity.NOTE,
                help=f"a type gives one output instead: {{parameter: {use.item.parameter}, type: ..}}"
                f"{f' ({others})' if others else ''}",
            )


def definitions(plan: DrivePlan) -> Iterator[Diagnostic]:
    """PG107: a parameter of the spec has limits that no value can keep."""
    for drive in plan.drives:
        for text, own in plan.settings(drive).parameters.items():
            if own.min is None or own.max is None or own.min <= own.max:
                continue
            path = (*drive.path, "parameters", text)
            yield Diagnostic(
                "PG107",
                f"{text}: min {own.min:g} is larger than max {own.max:g}",
                plan.loaded.span((*path, "min")),
                help="swap the two",
                notes=(Note("max", plan.loaded.span((*path, "max"))),),
            )


def _title(parameter: Parameter) -> str:
    return f"{parameter.label} ({parameter.title})" if parameter.title else parameter.label
