"""Rules about PPI masters: addresses on the line, ports, names that meet, times; names and texts for other rules."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import TYPE_CHECKING

from plcgen.base.diagnostics import Diagnostic, Note, Severity, Span
from plcgen.ppi.plan.nouns import (
    ACK_STATION,
    CHARACTER_BITS,
    E5,
    REPLY_STATION,
    characters,
    heard_ms,
    job_ms,
    line_ms,
    longest_reply,
)
from plcgen.project.rules.places import key_or_value, node_at
from plcgen.s7.types.durations import spelled

if TYPE_CHECKING:
    from plcgen.ppi.plan.nouns import PlannedMaster, PpiJob, PpiPlan, PpiValue
    from plcgen.project.spec import SpecPath
from functools import partial
from typing import TYPE_CHECKING

from plcgen.project.part import Named, Rules

if TYPE_CHECKING:
    from plcgen.base.diagnostics import Span
    from plcgen.ppi.plan.nouns import PpiPlan
    from plcgen.project.spec import SpecPath


_SIGNALS = ("execute", "busy", "done", "error", "status", "errors")
_OWN = frozenset({"port", "moduleaddress", "diagnostics"})
_PREFIXED = re.compile(r"(?:[Ss]tat|[Tt]emp|[Ii]nst)[A-Z0-9]")


def checks(plan: PpiPlan) -> Iterator[Diagnostic]:
    """Every rule about the masters of a plan."""
    yield from _ports(plan)
    yield from _control_members(plan)
    for master in plan.masters:
        # PG235: two stations, or a station and the master, have one address
        first: dict[int, tuple[str, Span]] = {}
        own = key_or_value(plan, (*master.path, "own_address"))
        first[master.own_address] = ("the master itself", own)
        for station in master.stations:
            span = plan.loaded.span((*station.path, "address"))
            earlier = first.setdefault(station.address, (f'station "{station.key}"', span))
            if earlier[1] is not span:
                yield Diagnostic(
                    "PG235",
                    f'station "{station.key}" has the address {station.address}, which is also that of {earlier[0]}',
                    span,
                    help="every station and master on a line needs an address of its own",
                    notes=(Note("first use", earlier[1]),),
                )
        yield from _pins(plan, master)
        yield from _waits(plan, master)
        yield from _times(plan, master)
        for job in master.jobs:
            yield from _members(plan, job)


def _ports(plan: PpiPlan) -> Iterator[Diagnostic]:
    first: dict[int, PlannedMaster] = {}
    key = "address" if plan.target.classic else "port"
    for master in plan.masters:
        if not master.port:
            continue
        earlier = first.setdefault(master.port, master)
        if earlier is not master:
            yield Diagnostic(
                "PG242",
                f'masters "{earlier.key}" and "{master.key}" use the same port {master.port}',
                key_or_value(plan, (*master.path, key)),
                help="put all stations of a line under one master",
                notes=(Note("first use", key_or_value(plan, (*earlier.path, key))),),
            )


def _control_members(plan: PpiPlan) -> Iterator[Diagnostic]:
    """PG406: two jobs would get the same member in the control DB."""
    first: dict[str, SpecPath] = {}
    for master in plan.masters:
        for job in master.jobs:
            earlier = first.setdefault(job.member.lower(), job.path)
            if earlier is not job.path:
                yield Diagnostic(
                    "PG406",
                    f'jobs "{earlier[-1]}" and "{job.key}" get the same name in the control DB',
                    plan.loaded.key_span(job.path),
                    help="rename one of the jobs",
                    notes=(Note("first use", plan.loaded.key_span(earlier)),),
                )


def _pins(plan: PpiPlan, master: PlannedMaster) -> Iterator[Diagnostic]:
    """PG406: two signals or values get the same name at the block."""
    first: dict[str, Span | None] = dict.fromkeys(_OWN)
    for job in master.jobs:
        place = plan.loaded.key_span(job.path)
        names = [(signal, place) for signal in _SIGNALS]
        names += [(value.member, member_span(plan, value)) for value in job.values]
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


def _members(plan: PpiPlan, job: PpiJob) -> Iterator[Diagnostic]:
    """PG406: a value has the name of another value, of a signal or of a field of its telegram."""
    fixed = {
        field.name.lower()
        for telegram in job.telegrams
        for buffer in telegram.buffers
        for field in buffer.fields
        if field.role != "value"
    }
    fixed |= set(_SIGNALS)
    first: dict[str, PpiValue] = {}
    for value in job.values:
        name = value.member.lower()
        if name in fixed:
            message = f'{value.label}: its job has a member called "{value.member}" already'
            yield Diagnostic("PG406", message, member_span(plan, value), help="give the value another name with as:")
            continue
        earlier = first.setdefault(name, value)
        if earlier is not value:
            yield Diagnostic(
                "PG406",
                f'{earlier.label} and {value.label} are both called "{value.member}"',
                member_span(plan, value),
                help="give one of them another name with as:",
                notes=(Note("first use", member_span(plan, earlier)),),
            )


def _times(plan: PpiPlan, master: PlannedMaster) -> Iterator[Diagnostic]:
    """PG311: a job takes longer than its timeout or its cycle, or waits longer until the jobs before it have ended."""
    within = f"at {master.baud} bit/s with cycles of OB1 of up to {spelled(master.ob1_cycle)}"
    took = [job_ms(job, master.baud, master.ob1_cycle, classic=plan.target.classic) for job in master.jobs]
    for job, least in zip(master.jobs, took, strict=True):
        line = line_ms(CHARACTER_BITS * sum(map(characters, job.telegrams)), master.baud)
        if job.cycle and job.cycle < line:
            yield Diagnostic(
                "PG311",
                f"the telegrams take {spelled(line)} on the line; the cycle is {spelled(job.cycle)}",
                key_or_value(plan, (*job.path, "cycle")),
                Severity.WARNING,
                help=f"at {master.baud} bit/s: allow more time, or read less",
            )
        given = f"; the timeout is {spelled(job.timeout)}"
        if job.timeout < least:
            yield Diagnostic(
                "PG311",
                f"the job takes {spelled(least)}{given}",
                key_or_value(plan, (*job.path, "timeout")),
                help=f"{within}: allow more time, or read less",
            )
        elif job.timeout < sum(took) and node_at(plan, (*job.path, "timeout")) is not None:
            yield Diagnostic(
                "PG311",
                f"the jobs of the master take {spelled(sum(took))} one after the other{given}",
                key_or_value(plan, (*job.path, "timeout")),
                Severity.WARNING,
                help=f"{within}: started together with the others it may end with 16#8104 before its turn",
            )


def _waits(plan: PpiPlan, master: PlannedMaster) -> Iterator[Diagnostic]:
    """PG311: a timeout is over before an answer that comes at once can have been received, or hardly later."""
    longest = longest_reply(master.jobs)
    for key, value, octets, what, station in (
        ("ack_timeout", master.ack_timeout, E5, "E5", ACK_STATION),
        ("reply_timeout", master.reply_timeout, longest, f"a reply of {longest} bytes", REPLY_STATION),
    ):
        least = heard_ms(octets, master.baud, master.ob1_cycle, classic=plan.target.classic)
        if value >= least + station:
            continue
        message, severity = f"{key} ends after {spelled(value)}, before {what} can have been received", Severity.ERROR
        if value >= least:
            message, severity = (
                f"{key} leaves {spelled(value - least)} to the station, of {spelled(value)}",
                Severity.WARNING,
            )
        yield Diagnostic(
            "PG311",
            message,
            key_or_value(plan, (*master.path, key)),
            severity,
            help=f"at least {spelled(least)} at {master.baud} bit/s with cycles of OB1 of up to "
            f"{spelled(master.ob1_cycle)}, and {spelled(station)} for the station; without the key it is computed",
        )


def member_span(plan: PpiPlan, value: PpiValue) -> Span:
    """Where the name of a value comes from: ``as``, else its address."""
    given = node_at(plan, (*value.path, "as"))
    return given.span if given is not None else plan.loaded.span((*value.path, "item"))


def names(plan: PpiPlan) -> Iterator[Named]:
    """Keys of masters, stations and jobs, names of values."""
    key_of = plan.loaded.key_span
    for key, master in plan.spec.ppi.items():
        yield Named("master key", key, "key", partial(key_of, ("ppi", key)))
        for which in ("stations", "jobs"):
            for name in getattr(master, which):
                yield Named(f"{which[:-1]} key", name, "key", partial(key_of, ("ppi", key, which, name)))
    for job in plan.jobs:
        for value in job.values:
            yield Named("member", value.member, "identifier", partial(member_span, plan, value))


def texts(plan: PpiPlan) -> Iterator[tuple[SpecPath, dict[str, str]]]:
    """Comments of masters, stations, jobs and values."""
    for master in plan.masters:
        yield (*master.path, "comment"), master.comment
        for station in master.stations:
            yield (*station.path, "comment"), station.comment
        for job in master.jobs:
            yield (*job.path, "comment"), job.comment
            for value in job.values:
                yield (*value.path, "comment"), value.comment


def untranslated(plan: PpiPlan) -> Iterator[tuple[SpecPath, str]]:  # noqa: ARG001 - every text has its languages
    """No text without a language."""
    return iter(())


def taken(plan: PpiPlan) -> Iterator[tuple[str, str, Span | None]]:
    """Names of the tables."""
    yield f"{plan.prefix}PpiJobTags", "the tag table of the PPI jobs", None
    for master in plan.masters:
        yield f"Watch_{master.block.name}", f'the watch table of master "{master.key}"', None


def partners(plan: PpiPlan) -> Iterator[tuple[str, str, Span]]:
    """Serial ports: a line has one master."""
    for master in plan.masters:
        yield f"{master.module} {master.port}", f"the port {master.port}", plan.loaded.span(master.path)


RULES = Rules(checks=(checks,), names=names, texts=texts, untranslated=untranslated, taken=taken, partners=partners)
