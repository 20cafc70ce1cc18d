"""Rules about PPI masters: addresses on the line, ports, names that meet, times."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import TYPE_CHECKING

from plcgen.diagnostics import Diagnostic, Note, Severity, Span
from plcgen.project.rules.places import key_or_value, node_at
from plcgen.protocols.ds47.rules.telegrams import spelled

if TYPE_CHECKING:
    from plcgen.project.loading import SpecPath
    from plcgen.project.model import Project
    from plcgen.protocols.ppi.plan.model import PlannedMaster, PlannedPpiJob, PpiValue
    from plcgen.s7.address import Address

_SIGNALS = ("execute", "busy", "done", "error", "status", "errors")
_OWN = frozenset({"port", "moduleaddress", "diagnostics"})
_PREFIXED = re.compile(r"(?:[Ss]tat|[Tt]emp|[Ii]nst)[A-Z0-9]")
_CHARACTER_BITS = 11
_POLL = 6


def rules(project: Project) -> Iterator[Diagnostic]:
    """Every rule about the masters of a project."""
    masters = project.ppi.masters if project.ppi is not None else ()
    yield from _ports(project, masters)
    yield from _control_members(project, masters)
    for master in masters:
        yield from _addresses(project, master)
        yield from _pins(project, master)
        for job in master.jobs:
            yield from _members(project, job)
            yield from _times(project, master, job)


def _addresses(project: Project, master: PlannedMaster) -> Iterator[Diagnostic]:
    """PG235: two stations, or a station and the master, have one address."""
    first: dict[int, tuple[str, Span]] = {}
    own = key_or_value(project, (*master.path, "own_address"))
    first[master.own_address] = ("the master itself", own)
    for station in master.stations:
        span = project.loaded.span((*station.path, "address"))
        earlier = first.setdefault(station.address, (f'station "{station.key}"', span))
        if earlier[1] is not span:
            yield Diagnostic(
                "PG235",
                f'station "{station.key}" has the address {station.address}, and so has {earlier[0]}',
                span,
                help="every participant of a line has an address of its own",
                notes=(Note("first use", earlier[1]),),
            )


def _ports(project: Project, masters: tuple[PlannedMaster, ...]) -> Iterator[Diagnostic]:
    """PG242: two masters on one port."""
    first: dict[int, PlannedMaster] = {}
    key = "address" if project.target.classic else "port"
    for master in masters:
        if not master.port:
            continue
        earlier = first.setdefault(master.port, master)
        if earlier is not master:
            yield Diagnostic(
                "PG242",
                f'masters "{earlier.key}" and "{master.key}" use the same port {master.port}',
                key_or_value(project, (*master.path, key)),
                help="put all stations of a line under one master",
                notes=(Note("first use", key_or_value(project, (*earlier.path, key))),),
            )


def _control_members(project: Project, masters: tuple[PlannedMaster, ...]) -> Iterator[Diagnostic]:
    """PG406: two jobs would get the same member in the control DB."""
    first: dict[str, SpecPath] = {}
    for master in masters:
        for job in master.jobs:
            name = f"{master.member if len(masters) > 1 else ''}{job.member}".lower()
            earlier = first.setdefault(name, job.path)
            if earlier is not job.path:
                yield Diagnostic(
                    "PG406",
                    f'jobs "{earlier[-1]}" and "{job.key}" get the same name in the control DB',
                    project.loaded.key_span(job.path),
                    help="rename one of the jobs",
                    notes=(Note("first use", project.loaded.key_span(earlier)),),
                )


def _pins(project: Project, master: PlannedMaster) -> Iterator[Diagnostic]:
    """PG406: two signals or values get the same name at the block."""
    first: dict[str, Span | None] = dict.fromkeys(_OWN)
    for job in master.jobs:
        place = project.loaded.key_span(job.path)
        names = [(signal, place) for signal in _SIGNALS]
        names += [(value.member, member_span(project, value)) for value in job.values]
        for name, span in names:
            pin = job.pin(name)
            if _PREFIXED.match(pin):
                message = f'the block itself may have a member called "{pin}"'
                yield Diagnostic("PG406", message, span, help="rename the job")
            if first.setdefault(pin.lower(), span) is span:
                continue
            earlier = first[pin.lower()]
            yield Diagnostic(
                "PG406",
                f'two members of the block are called "{pin}"',
                span,
                help="give the value another name with as:, or rename the job",
                notes=(Note("first use", earlier),) if earlier else (),
            )


def _members(project: Project, job: PlannedPpiJob) -> Iterator[Diagnostic]:
    """PG406: a value has the name of another value, of a signal or of a field of its telegram."""
    fixed = {
        field.name.lower()
        for telegram in job.telegrams
        for field in (*telegram.request_fields, *telegram.response_fields)
        if field.role != "value"
    }
    fixed |= set(_SIGNALS)
    first: dict[str, PpiValue] = {}
    for value in job.values:
        name = value.member.lower()
        if name in fixed:
            message = f'{value.label}: its job has a member called "{value.member}" already'
            yield Diagnostic("PG406", message, member_span(project, value), help="give the value another name with as:")
            continue
        earlier = first.setdefault(name, value)
        if earlier is not value:
            yield Diagnostic(
                "PG406",
                f'{earlier.label} and {value.label} are both called "{value.member}"',
                member_span(project, value),
                help="give one of them another name with as:",
                notes=(Note("first use", member_span(project, earlier)),),
            )


def _times(project: Project, master: PlannedMaster, job: PlannedPpiJob) -> Iterator[Diagnostic]:
    """PG311: the line is slower than timeout or cycle."""
    characters = 0
    for telegram in job.telegrams:
        reply = telegram.response_fields[-1] if telegram.response_fields else None
        data = reply.offset + reply.size if reply is not None else 0
        characters += len(telegram.request) + 1 + _POLL + 23 + data
    line = -(-characters * _CHARACTER_BITS * 1000 // master.baud)
    shown = spelled(line)
    for key, value, severity in (("timeout", job.timeout, Severity.ERROR), ("cycle", job.cycle, Severity.WARNING)):
        if value and value < line:
            yield Diagnostic(
                "PG311",
                f"the telegrams take {shown} on the line; the {key} is {spelled(value)}",
                key_or_value(project, (*job.path, key)),
                severity,
                help=f"at {master.baud} bit/s: allow more time, or read less",
            )


def member_span(project: Project, value: PpiValue) -> Span:
    """Where the name of a value comes from: ``as``, else its address."""
    given = node_at(project, (*value.path, "as"))
    return given.span if given is not None else project.loaded.span((*value.path, "item"))


def flags(project: Project) -> Iterator[tuple[str, SpecPath, Address]]:
    """Absolute flags of the PPI jobs: what they are for, where they stand, address."""
    for master in project.ppi.masters if project.ppi is not None else ():
        for job in master.jobs:
            for signal, address in job.trigger.items():
                yield f"{signal} of {job.key}", (*job.path, "trigger", signal), address
