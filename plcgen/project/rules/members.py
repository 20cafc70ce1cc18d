"""Rules about names that meet: blocks, interface members, buffer members and their overrides."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from plcgen.diagnostics import Diagnostic, Note, Span
from plcgen.diagnostics.suggest import did_you_mean
from plcgen.project.rules.places import by_importance, key_or_value, member_span, name_span, parameter_span
from plcgen.protocols.ds47.plan.fields import request_fields, response_fields
from plcgen.protocols.ds47.plan.references import parse_reference

if TYPE_CHECKING:
    from collections.abc import Iterator

    from plcgen.project.model import Field, PlannedDrive, PlannedJob, Project, Telegram, Use

_OWN = frozenset(
    {
        "execute", "busy", "done", "error", "status", "errors", "errorinfos", "diagnostics", "hardwareid",
        "driveaddress", "own_number", "record_index", "response_size", "max_retries", "timeout", "drain_limit",
        "retry_pause", "lease", "clock_end", "clock_mask",
    }
)  # fmt: skip
"""Members and constants of every job block, in lower case."""

_PREFIXED = re.compile(r"(?:[Ss]tat|[Tt]emp|[Ii]nst)[A-Z0-9]|(?i:state_|status_)")
_FIXED = ("plc",)
_SHOWN = 8


def block_names(project: Project) -> Iterator[Diagnostic]:
    """PG406: a block has the name of another block, table or tag; letter case does not matter."""
    first = {name.lower(): (f'"{name}"', what, span) for name, what, span in _taken(project)}
    reported: set[tuple[Span, Span | None]] = set()
    for block in by_importance(project):
        if block.path == _FIXED:
            continue
        span = name_span(project, block)
        mine = (f'"{block.name}"', "", span)
        earlier = first.setdefault(block.name.lower(), mine)
        name, what, place = earlier
        if earlier is mine or (span, place) in reported:
            continue
        reported.add((span, place))
        yield Diagnostic(
            "PG406",
            f'block name "{block.name}" is {f"also the name of {what}" if what else "used twice"}',
            span,
            help="rename one of them: letter case makes no difference",
            notes=(Note(f"first use: {name}", place),) if place else (),
        )


def _taken(project: Project) -> Iterator[tuple[str, str, Span | None]]:
    """Names that blocks of a spec must not have: of what every project gets, and of tables and tags."""
    yield "Main", "the example OB1", None
    yield "DriveJobTags", "the tag table", None
    for block in project.blocks:
        if block.path == _FIXED:
            yield block.name, "a block of every project", None
    if project.ppi is not None:
        from plcgen.protocols.ppi.rules.names import ppi_taken

        yield from ppi_taken(project)
    for job in project.jobs:
        yield f"Watch_{job.block.name}", f'the watch table of job "{job.key}"', None
        for flag in job.trigger.items():
            signal = flag[0]
            span = key_or_value(project, (*job.path, "trigger", signal))
            yield f"{job.member}{signal.capitalize()}", f'the {signal} flag of job "{job.key}"', span


def control_members(project: Project) -> Iterator[Diagnostic]:
    """PG406: two jobs would get the same member in the control DB."""
    first: dict[str, PlannedJob] = {}
    for job in project.jobs:
        earlier = first.setdefault(job.member.lower(), job)
        if earlier is not job and job.block.name.lower() != earlier.block.name.lower():
            yield Diagnostic(
                "PG406",
                f'jobs "{earlier.key}" and "{job.key}" are both called {job.member} in the control DB',
                project.loaded.key_span(job.path),
                help="rename one of the jobs",
                notes=(Note("first use", project.loaded.key_span(earlier.path)),),
            )


def interface_members(project: Project) -> Iterator[Diagnostic]:
    """PG406: a value of a job has the name of another value or of a member the block needs itself."""
    for job in project.jobs:
        first: dict[str, Use] = {}
        for use in job.uses:
            span = member_span(project, use)
            if use.member.lower() in _OWN or _PREFIXED.match(use.member):
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
                    notes=(Note("first use", member_span(project, earlier)),),
                )


def parameter_names(project: Project) -> Iterator[Diagnostic]:
    """PG406: two parameters of a drive have the same name, so that the name says neither."""
    for drive in project.drives:
        own = _own_names(project, drive)
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


def _own_names(project: Project, drive: PlannedDrive) -> list[tuple[int, str, Span]]:
    """Number, name and place of the name of every parameter that the spec defines and names."""
    found = []
    for text, definition in project.loaded.spec.drives[drive.key].parameters.items():
        reference = parse_reference(text)
        if reference is not None and reference.pnu is not None and definition.name:
            span = project.loaded.span((*drive.path, "parameters", text, "name"))
            found.append((reference.pnu, definition.name, span))
    return found


def buffer_members(project: Project) -> Iterator[Diagnostic]:
    """PG406: two members of a buffer DB have the same name."""
    for job in project.jobs:
        reported: set[tuple[str, Span]] = set()
        twice = {name for name, count in _counts(use.member for use in job.uses).items() if count > 1}
        for telegram in job.telegrams:
            for which, fields in (
                ("request", telegram.request_fields),
                ("response", telegram.response_fields),
            ):
                first: dict[str, Field] = {}
                for field in fields:
                    earlier = first.setdefault(field.name.lower(), field)
                    if earlier is field or field.name.lower() in twice:
                        continue
                    span = _field_span(project, job, which, earlier, field)
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


def _field_span(project: Project, job: PlannedJob, which: str, first: Field, second: Field) -> Span:
    """Find the place a person can change: an override, the value's name, else the parameter."""
    buffer = getattr(project.loaded.spec.jobs[job.key], which)
    for old, new in buffer.members.items():
        if new.lower() == second.name.lower():
            return project.loaded.span((*job.path, which, "members", old))
    for field in (first, second):
        if field.role == "value" and field.part is not None:
            return member_span(project, field.part.use)
    part = second.part or first.part
    return parameter_span(project, part.use) if part is not None else project.loaded.key_span(job.path)


def overrides(project: Project) -> Iterator[Diagnostic]:
    """PG408: ``members`` renames something that the buffer DB does not have."""
    for job in project.jobs:
        spec = project.loaded.spec.jobs[job.key]
        for which, buffer in (("request", spec.request), ("response", spec.response)):
            if not buffer.members:
                continue
            generated = list(dict.fromkeys(name for t in job.telegrams for name in _generated(project, job, t, which)))
            known = set(generated)
            for old in buffer.members:
                if old in known:
                    continue
                some = ", ".join(generated[:_SHOWN]) + (", ..." if len(generated) > _SHOWN else "")
                yield Diagnostic(
                    "PG408",
                    f'the {which} DB has no member "{old}"',
                    project.loaded.key_span((*job.path, which, "members", old)),
                    help=f"{did_you_mean(old, generated)} members: {some}".strip(),
                )


def _generated(project: Project, job: PlannedJob, telegram: Telegram, which: str) -> list[str]:
    """Names of a buffer's members before the spec's own names replace them."""
    where = project.target
    if which == "request":
        fields = request_fields(telegram.parts, (0, 0, 0), where, {}, write=job.write, faq=job.faq_names)
    else:
        size = telegram.response_size
        fields = response_fields(telegram.parts, size, where, {}, write=job.write, faq=job.faq_names)
    return [field.name for field in fields]
