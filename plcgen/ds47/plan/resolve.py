"""The sections ``drives`` and ``jobs`` of a spec -> planned drives and jobs."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING

from plcgen.base.diagnostics import Diagnostic, Note, Report, Severity
from plcgen.base.diagnostics.counting import shortlist
from plcgen.base.diagnostics.suggest import Vocabulary, did_you_mean
from plcgen.ds47 import guards
from plcgen.ds47.device import Parameter, ParameterDef, parameter_from
from plcgen.ds47.plan.callers import Callers
from plcgen.ds47.plan.jobs import DriveJobPlanner
from plcgen.ds47.plan.nouns import DriveJob, DrivePlan, PlannedDrive
from plcgen.ds47.plan.recipes import Recipes
from plcgen.ds47.plan.redefinition import merged, widened
from plcgen.ds47.plan.room import Room
from plcgen.ds47.plan.units import plan_engine, plan_units
from plcgen.ds47.plan.uses import UseResolver
from plcgen.ds47.references import parse_reference
from plcgen.ds47.schema import DriveSections
from plcgen.project.numbering import Numbering
from plcgen.project.spec import LoadedSpec

if TYPE_CHECKING:
    from plcgen.protocol.base import Protocol


_SHOWN = 20


def plan_drives(protocol: Protocol, loaded: LoadedSpec, numbering: Numbering, report: Report) -> DrivePlan:
    """Plan the units and drives of a spec and their jobs."""
    spec = loaded.sections(DriveSections)
    # without jobs these blocks are not made: they take no numbers then
    common = numbering if spec.jobs else numbering.apart()
    engine = plan_engine(common)
    callers = Callers(common)
    units, drives = plan_units(loaded, common, report)
    resolvers = _resolvers(loaded, drives, report)
    recipes = Recipes(loaded, numbering, report)
    jobs = _jobs(loaded, drives, resolvers, callers, recipes, numbering, report)
    if loaded.whole and len(drives) == len([*spec.placed()]):  # a drive that cannot be read may have its parameters
        recipes.unused(resolvers.values())
    used = {job.drive.unit.key for job in jobs}
    first, *others = callers.found
    blocks = [*engine.blocks(), first.block, first.instance, *(unit.db for unit in units if unit.key in used)]
    blocks += {job.shape: job.permitted.db for job in jobs if job.permitted is not None}.values()
    blocks += [ref for recipe in recipes.found.values() for ref in (recipe.type, recipe.db)]
    seen: set[str] = set()
    for one in jobs:
        if one.shape not in seen:
            seen.add(one.shape)
            buffers = [buffer for telegram in one.telegrams for buffer in (telegram.request, telegram.response)]
            blocks += [block for buffer in buffers for block in (buffer.type, buffer.db) if block is not None]
            blocks += [one.diagnosis, one.block] if one.listed is None else [one.diagnosis, one.listed.type, one.block]
    return DrivePlan(
        protocol=protocol,
        loaded=loaded,
        name=loaded.spec.plc.name,
        target=numbering.where,
        languages=loaded.spec.plc.languages,
        jobs=jobs,
        blocks=(*blocks, first.control, *(ref for one in others for ref in one.blocks())) if spec.jobs else (),
        drives=drives,
        units=tuple(unit for unit in units if unit.key in used or not jobs),
        engine=engine,
        callers=tuple(callers.found),
    )


def _resolvers(loaded: LoadedSpec, drives: tuple[PlannedDrive, ...], report: Report) -> dict[str, UseResolver]:
    """What knows the parameters of each drive; what a spec defines wrongly is reported once."""
    found = {}
    placed = {one.key: one for one in loaded.sections(DriveSections).placed()}
    for drive in drives:
        definitions = placed[drive.key].drive.parameters
        own = _own_parameters(loaded, drive, definitions, report)
        resolver = found[drive.key] = UseResolver(loaded, drive, own, report)
        for text in definitions:
            reference = parse_reference(text)
            known = own.get(reference.pnu) if reference and reference.pnu is not None else None
            if known is not None:
                resolver.check_definition(known, (*drive.path, "parameters", text))
    return found


def _jobs(
    loaded: LoadedSpec,
    drives: tuple[PlannedDrive, ...],
    resolvers: dict[str, UseResolver],
    callers: Callers,
    recipes: Recipes,
    numbering: Numbering,
    report: Report,
) -> tuple[DriveJob, ...]:
    """Every job on every drive; a drive that does not exist is a diagnostic."""
    spec = loaded.sections(DriveSections)
    known = {one.key for one in spec.placed()}
    words = Vocabulary(known)
    those = f"drives of this spec: {shortlist(sorted(known), _SHOWN)}" if known else ""
    by_key = {drive.key: drive for drive in drives}
    jobs: list[DriveJob] = []
    planner = DriveJobPlanner(loaded, resolvers, callers, recipes, numbering, report)
    room = Room(loaded)
    for key, job in spec.jobs.items():
        for index, name in enumerate(job.drive):
            place = loaded.span(("jobs", key, "drive") if len(job.drive) == 1 else ("jobs", key, "drive", index))
            if name not in known:
                hint = did_you_mean(name, words) or those or "the spec has no drive that can be read"
                report.add(Diagnostic("PG202", f'unknown drive "{name}"', place, help=hint))
            elif name in job.drive[:index]:
                report.add(Diagnostic("PG202", f'drive "{name}" is named twice', place, help="name every drive once"))
        chosen = tuple(by_key[name] for name in dict.fromkeys(job.drive) if name in by_key)
        if not chosen:
            continue
        found = planner.job(key, chosen)
        jobs += found
        if problem := room.problem(found):
            message, help_ = problem
            report.add(Diagnostic("PG307", message, loaded.key_span(("jobs", key)), help=help_))
            break
    return tuple(jobs)


def pinned(spec: DriveSections) -> Iterator[tuple[str, int]]:
    """Block numbers that the jobs of a spec fix."""
    for job in spec.jobs.values():
        for kind, number in (
            ("DB", job.request.db),
            ("DB", job.response.db),
            ("FB", job.block.number),
        ):
            if number is not None:
                yield kind, number


def _own_parameters(
    loaded: LoadedSpec, drive: PlannedDrive, definitions: Mapping[str, ParameterDef], report: Report
) -> dict[int, Parameter]:
    """Parameters that the spec defines for a drive, by number."""
    own: dict[int, Parameter] = {}
    device = drive.device
    for text, definition in definitions.items():
        path = (*drive.path, "parameters", text)
        reference = parse_reference(text)
        if reference is None or reference.pnu is None or reference.first is not None or not 1 <= reference.pnu <= 65535:
            report.add(
                Diagnostic(
                    "PG203",
                    f'"{text}" is not a parameter number',
                    loaded.key_span(path),
                    help=f"write its number, for example {device.example()}",
                )
            )
            continue
        known = device.find(reference.pnu, drive.object_type)
        sure = known is not None and (known.read("access") or known.pnu in device.parameters)
        reason = guards.why_read_only(
            text, reference.pnu, catalogued=known.access if known is not None and sure else ""
        )
        if reason and definition.access not in {None, "r"}:
            source = f": {known.source}" if known is not None and known.access == "r" else ""
            message, help_ = f"{text} cannot be written: {reason}{source}", "remove access, or write access: r"
            report.add(Diagnostic("PG207", message, loaded.span((*path, "access")), help=help_))
            continue
        if reference.pnu in own:
            first = next(key for key in definitions if (other := parse_reference(key)) and other.pnu == reference.pnu)
            report.add(
                Diagnostic(
                    "PG103",
                    f'parameter {reference.pnu} is defined twice: "{first}" and "{text}"',
                    loaded.key_span(path),
                    help="remove one of them; letter case and leading zeros make no difference",
                    notes=(Note("first definition", loaded.key_span((*path[:-1], first))),),
                )
            )
            continue
        scale = definition.scale or (known.scale if known is not None else 0.0)
        found = parameter_from(reference.pnu, {**definition.model_dump(), "scale": scale}, "r" if reason else text[:1])
        own[reference.pnu] = found if known is None else merged(known, found)
        for key, told in widened(known, definition, found) if known is not None else ():
            message = f"{found.label} {told}: {known.source}" if known is not None else ""
            narrow = "" if key == "unit" else ", or narrow it"
            help_ = f"remove {key}{narrow}; a device that differs gets a profile of its own (docs/devices.md)"
            report.add(Diagnostic("PG229", message, loaded.span((*path, key)), help=help_))
        inferred = known is not None and known.pnu in device.parameters and known.grades.get("type") == "inferred"
        if known is not None and inferred and found.type.lower() != known.type.lower():
            message = (
                f"{found.label} is {known.type} in the catalogue (inferred), not {definition.type}: {known.source}"
            )
            help_ = "remove the definition if its type is a guess; if your list manual has it, say so in this line: "
            help_ += "# plcgen: allow PG212 list manual p. .."
            report.add(Diagnostic("PG212", message, loaded.span((*path, "type")), Severity.WARNING, help=help_))
    return own
