"""DriveJobs as it is delivered: a structure for each job, started are those with a cycle, inputs with the values of the
spec.

Signals and their types as docs/generated-code.md has them; values are compared as bytes, which are the same in the
telegram and in the CPU.
"""

from __future__ import annotations

from collections.abc import Iterator

from plcgen.base.diagnostics import Diagnostic, DiagnosticError
from plcgen.base.diagnostics.counting import quantity
from plcgen.ds47.plan.nouns import DriveJob, DrivePlan, PlannedRecipe
from plcgen.ds47.proof import asked, clock_input, message_lists
from plcgen.ds47.proof.cycles import AGE, cycle_signals
from plcgen.ds47.proof.records import NUMBER, recipe_signals
from plcgen.ds47.proof.restoration import CAUSE
from plcgen.ds47.proof.step_facts import FAILED
from plcgen.ds47.proof.wording.grounds import service_numbers, stated_of
from plcgen.proof.checks import Check, Outcome
from plcgen.proof.folder import Folder
from plcgen.proof.rig import Spot
from plcgen.s7.layout.image import image
from plcgen.s7.layout.layout import Layout, layout_block, locate
from plcgen.s7.types.data_types import Elementary
from plcgen.s7.types.literals import LiteralError

SIGNALS = {"execute": "BOOL", "busy": "BOOL", "done": "BOOL", "error": "BOOL", "status": "WORD"}
REPEATED = {**SIGNALS, **dict(zip(AGE, ("BOOL", "TIME"), strict=True))}
"""Those of a job with a cycle."""


def check_commands(plan: DrivePlan, folder: Folder) -> Iterator[Check]:
    """One check of each control DB, in the text source; its document is held against it elsewhere."""
    for caller in plan.callers if plan.jobs else ():
        yield from _check_control(caller.control.name, [job for job in plan.jobs if job.caller is caller], folder)

    for recipe in plan.recipes:
        yield from _check_records(recipe, folder)
    for job in plan.shapes:
        if job.permitted is not None:
            yield from _check_numbers(plan, job, job.permitted.db.name, folder)


def _check_numbers(plan: DrivePlan, job: DriveJob, name: str, folder: Folder) -> Iterator[Check]:
    """What a service may write is what spec and table of effects say, range by range."""
    block = folder.text.get(name.upper())
    if block is None:
        return  # what is missing is told elsewhere
    problems = []
    try:
        start = bytes(image(block, folder.text))
        edges = [int.from_bytes(start[at : at + 4], signed=True) for at in range(0, len(start), 4)]
        if edges != sorted(edges):
            problems.append("the ranges do not ascend")
        pairs = zip(edges[::2], edges[1::2], strict=True)
        found = {number for first, last in pairs for number in range(max(first, 0), min(last, 0xFFFF) + 1)}
        wanted, _ = service_numbers(plan, stated_of(plan), job)
        problems += [
            f"{number} {'may not' if number in found else 'may'} be written" for number in sorted(found ^ wanted)
        ]
    except (DiagnosticError, LiteralError, ValueError, KeyError) as problem:
        problems = [str(problem)]
    yield _verdict(name, f"{len(wanted)} numbers", problems, "every number that may be written", folder)


def _check_records(recipe: PlannedRecipe, folder: Folder) -> Iterator[Check]:
    """Every record as delivered: the values of the spec."""
    block = folder.text.get(recipe.db.name.upper())
    if block is None:
        return  # what is missing is told elsewhere
    problems = []
    try:
        layout, start = layout_block(block, folder.text), bytes(image(block, folder.text))
        for number, values in enumerate(recipe.values, 1):
            for use in recipe.uses:
                path = f"records[{number}].{use.member}"
                found = Spot.of(layout, path).bytes(bytearray(start), len(values[use.member]))
                if found != values[use.member]:
                    said = f"the spec says {values[use.member].hex(' ').upper()}"
                    problems.append(f"{path} starts with {found.hex(' ').upper()}, {said}")
    except (DiagnosticError, LiteralError, KeyError) as problem:
        problems = [str(problem)]
    yield _verdict(recipe.db.name, f"{recipe.count} records", problems, "every record as in the spec", folder)


def _check_control(name: str, jobs: list[DriveJob], folder: Folder) -> Iterator[Check]:
    block = folder.text.get(name.upper())
    if block is None:
        return  # what is missing is told elsewhere
    try:
        layout, start = layout_block(block, folder.text), bytes(image(block, folder.text))
        members = _members(layout)
        problems = [p for job in jobs for p in _job(job, layout, start, members.get(job.member, set()))]
        expected = {f"{job.member}.{use.member}" for job in jobs for use in job.inputs}
        expected |= {f"{job.member}.{NUMBER}" for job in jobs if job.recipe is not None}
        expected |= {f"{job.member}.execute" for job in jobs if job.cycle}
        expected |= {f"{job.member}.{name}" for job in jobs if job.serves for name in asked.TYPES}
        problems += [
            f"{entry.path} has the start value {entry.member.start}"
            for entry in layout.entries
            if entry.member.start is not None and entry.path.replace('"', "").partition("[")[0] not in expected
        ]
    except (DiagnosticError, LiteralError) as problem:
        problems = [str(problem)]
    started = "only jobs with a cycle" if any(job.cycle for job in jobs) else "no job"
    yield _verdict(name, quantity(len(jobs), "job"), problems, f"inputs as in the spec, {started} started", folder)


def _verdict(name: str, figures: str, problems: list[str], good: str, folder: Folder) -> Check:
    if problems:
        found = Diagnostic("PG614", f'"{name}": {problems[0]}', folder.place(name))
        return Check("commands", f'"{name}"', "", Outcome.ERROR, problems[0], found)
    return Check("commands", f'"{name}"', figures, Outcome.OK, good)


def _members(layout: Layout) -> dict[str, set[str]]:
    """Members of every structure."""
    found: dict[str, set[str]] = {}
    for entry in layout.entries:
        if entry.depth == 1:
            above, _, name = entry.path.replace('"', "").partition(".")
            found.setdefault(above, set()).add(name)
    return found


def _job(job: DriveJob, layout: Layout, start: bytes, found: set[str]) -> Iterator[str]:
    """What is wrong with the structure of a job."""
    flags = {name for name, _ in job.trigger.items()}
    values = {*clock_input.inputs(job), *(use.member for use in job.outputs)}
    values |= {*(FAILED if job.in_steps else ()), *recipe_signals(job)}
    values |= {"diagnosis"}
    values |= {CAUSE} if job.restores else set()
    values |= {*cycle_signals(job), *(one.member for _, one in job.shown), *asked.names(job)}
    values |= {path.partition("[")[0] for path in message_lists.paths(job)}
    wanted = {name for name in SIGNALS if name not in flags} | values
    prefix = f"{job.member}."
    for name in sorted(wanted ^ found):
        yield f"{prefix}{name} {'is missing' if name in wanted else 'is not a member of the job'}"
    types = REPEATED if job.cycle else SIGNALS
    types = types if job.clock is None else {**types, clock_input.TIME: job.clock.name}
    if "execute" in wanted & found:
        entry = locate(layout, f"{prefix}execute")
        if start[entry.byte] >> entry.bit & 1 != bool(job.cycle):
            yield f"{prefix}execute starts with {'FALSE' if job.cycle else 'TRUE'}"
    for name in sorted(wanted & found & set(types) - {use.member for use in (*job.inputs, *job.outputs)}):
        entry = locate(layout, f"{prefix}{name}")
        if not isinstance(entry.type, Elementary) or entry.type.name != types[name]:
            yield f"{prefix}{name} is not of type {types[name]}"
    for name, number in asked.Asked().inputs().items() if job.serves else ():
        if (
            name in found
            and int.from_bytes(Spot.of(layout, f"{prefix}{name}").bytes(bytearray(start)), signed=True) != number
        ):
            yield f"{prefix}{name} does not start with {number}"
    for use in job.inputs:
        if use.member in found:
            entry = locate(layout, f"{prefix}{use.member}")
            held = start[entry.byte : entry.byte + len(use.data)]
            if entry.size == 1:
                held = bytes((held[0] >> entry.bit & 1,))
            if held != use.data:
                said = f"the spec says {use.data.hex(' ').upper()}"
                yield f"{prefix}{use.member} starts with {held.hex(' ').upper()}, {said}"
