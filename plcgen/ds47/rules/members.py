"""Rules about names that meet: blocks, interface members, buffer members and their overrides."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from plcgen.base.diagnostics import Diagnostic, Note, Span
from plcgen.base.diagnostics.counting import shortlist
from plcgen.base.diagnostics.suggest import Vocabulary, did_you_mean
from plcgen.ds47.plan.fields import request_fields, response_fields
from plcgen.ds47.references import parse_reference
from plcgen.ds47.rules.places import member_span, parameter_span
from plcgen.ds47.views.parts import all_parts, parts_of

if TYPE_CHECKING:
    from collections.abc import Iterator

    from plcgen.ds47.plan.access import Use
    from plcgen.ds47.plan.nouns import DriveField, DriveJob, DrivePlan, DriveTelegram, PlannedDrive

_OWN = frozenset(
    {
        "execute", "busy", "done", "error", "status", "diagnosis", "hardwareid", "driveaddress",
        "driveobject", "slot", "unit", "requestdb", "responsedb",
    }
)  # fmt: skip
"""Members of every job block, in lower case."""

_PREFIXED = re.compile(r"(?:[Ss]tat|[Tt]emp|[Ii]nst)[A-Z0-9]|(?i:state_|status_)")
_SHOWN = 8


def control_members(plan: DrivePlan) -> Iterator[Diagnostic]:
    """PG406: two jobs would get the same member in the control DB."""
    first: dict[str, DriveJob] = {}
    for job in plan.jobs:
        earlier = first.setdefault(job.member.lower(), job)
        if earlier is not job and job.block.name.lower() != earlier.block.name.lower():
            yield Diagnostic(
                "PG406",
                f'jobs "{earlier.key}" and "{job.key}" are both called {job.member} in the control DB',
                plan.loaded.key_span(job.path),
                help="rename one of the jobs",
                notes=(Note("first use", plan.loaded.key_span(earlier.path)),),
            )


def interface_members(plan: DrivePlan) -> Iterator[Diagnostic]:
    """PG406: a value of a job has the name of another value or of a member the block needs itself."""
    always = _OWN.union(*(part.reserved for part in all_parts()))
    for job in plan.shapes:
        own = always.union(*(part.members for part in parts_of(job)))
        first: dict[str, Use] = {}
        uses = (one for use in job.uses for one in (*(use.bits or (use,)), *use.shown))
        for use in uses:
            span = member_span(plan, use)
            if use.member.lower() in own or _PREFIXED.match(use.member):
                yield Diagnostic(
                    "PG406",
                    f'{use.label}: the block itself has a member or constant called "{use.member}"',
                    span,
                    help="give the value another name with as:",
                )
                continue
            earlier = first.setdefault(use.member.lower(), use)
            if earlier is not use:
                yield Diagnostic(
                    "PG406",
                    f'{earlier.label} and {use.label} are both called "{use.member}"',
                    span,
                    help="give one of them another name with as:",
                    notes=(Note("first use", member_span(plan, earlier)),),
                )


def parameter_names(plan: DrivePlan) -> Iterator[Diagnostic]:
    """PG406: two parameters of a drive have the same name, so that the name says neither."""
    for drive in plan.drives:
        own = _own_names(plan, drive)
        numbers = {pnu for pnu, _, _ in own}
        first: dict[str, tuple[int, Span | None]] = {
            parameter.name: (pnu, None)
            for pnu, parameter in drive.device.parameters.items()
            if parameter.name and pnu not in numbers
        }
        for pnu, name, span in own:
            other, place = first.setdefault(name, (pnu, span))
            if place is span:
                continue
            where = f"P{other}" if place else f"P{other} of the catalogue"
            yield Diagnostic(
                "PG406",
                f'P{pnu} and {where} are both called "{name}"',
                span,
                help="give the parameter another name",
                notes=(Note("first use", place),) if place else (),
            )


def _own_names(plan: DrivePlan, drive: PlannedDrive) -> list[tuple[int, str, Span]]:
    """Number, name and place of the name of every parameter that the spec defines and names."""
    found = []
    for text, definition in plan.settings(drive).parameters.items():
        reference = parse_reference(text)
        if reference is not None and reference.pnu is not None and definition.name:
            span = plan.loaded.span((*drive.path, "parameters", text, "name"))
            found.append((reference.pnu, definition.name, span))
    return found


def buffer_members(plan: DrivePlan) -> Iterator[Diagnostic]:
    """PG406: two members of a buffer DB have the same name."""
    for job in plan.shapes:
        reported: set[tuple[str, Span]] = set()
        twice = {name for name, count in _counts(use.member for use in job.uses).items() if count > 1}
        for telegram in job.telegrams:
            for which, fields in (
                ("request", telegram.request.fields),
                ("response", telegram.response.fields),
            ):
                first: dict[str, DriveField] = {}
                for field in fields:
                    earlier = first.setdefault(field.name.lower(), field)
                    if earlier is field or field.name.lower() in twice:
                        continue
                    span = _field_span(plan, job, which, earlier, field)
                    if (field.name, span) in reported:
                        continue
                    reported.add((field.name, span))
                    yield Diagnostic(
                        "PG406",
                        f'two members of the {which} DB are called "{field.name}"',
                        span,
                        help="rename one of them: under members, or with as: at the parameter",
                    )


def _counts(words: Iterator[str]) -> dict[str, int]:
    found: dict[str, int] = {}
    for word in words:
        found[word.lower()] = found.get(word.lower(), 0) + 1
    return found


def _field_span(plan: DrivePlan, job: DriveJob, which: str, first: DriveField, second: DriveField) -> Span:
    """Find the place a person can change: an override, the value's name, else the parameter."""
    buffer = getattr(plan.entry(job), which)
    for old, new in buffer.members.items():
        if new.lower() == second.name.lower():
            return plan.loaded.span((*job.path, which, "members", old))
    for field in (first, second):
        if field.role == "value" and field.part is not None:
            return member_span(plan, field.part.use)
    part = second.part or first.part
    return parameter_span(plan, part.use) if part is not None else plan.loaded.key_span(job.path)


def overrides(plan: DrivePlan) -> Iterator[Diagnostic]:
    """PG408: ``members`` renames something that the buffer DB does not have."""
    for job in plan.shapes:
        spec = plan.entry(job)
        for which, buffer in (("request", spec.request), ("response", spec.response)):
            if not buffer.members:
                continue
            known = dict.fromkeys(name for t in job.telegrams for name in _generated(plan, job, t, which))
            generated = Vocabulary(known)
            some = shortlist([*known], _SHOWN, ", ...")
            for old in buffer.members:
                if old in known:
                    continue
                yield Diagnostic(
                    "PG408",
                    f'the {which} DB has no member "{old}"',
                    plan.loaded.key_span((*job.path, which, "members", old)),
                    help=f"{did_you_mean(old, generated)} members: {some}".strip(),
                )


def _generated(plan: DrivePlan, job: DriveJob, telegram: DriveTelegram, which: str) -> list[str]:
    """Names of a buffer's members before the spec's own names replace them."""
    where = plan.target
    if which == "request":
        fields = request_fields(telegram.parts, (0, 0, 0), where, {}, write=telegram.writes, faq=job.faq_names)
    else:
        size = telegram.response.size
        fields = response_fields(telegram.parts, size, where, {}, write=telegram.writes, faq=job.faq_names)
    return [field.name for field in fields]
