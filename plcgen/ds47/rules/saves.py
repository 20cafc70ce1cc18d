"""Rules about jobs that save: who counts the wear, and who waits meanwhile."""

from __future__ import annotations

from typing import TYPE_CHECKING

from plcgen.base.diagnostics import Diagnostic, Note, Severity
from plcgen.ds47.rules.places import parameter_span
from plcgen.project.rules.places import node_at
from plcgen.s7.types.durations import spelled

if TYPE_CHECKING:
    from collections.abc import Iterator

    from plcgen.ds47.plan.nouns import DriveJob, DrivePlan
    from plcgen.project.spec import SpecPath


def counted_apart(plan: DrivePlan) -> Iterator[Diagnostic]:
    """PG244: the same is saved by two jobs, each of which knows of its own saves only."""
    first: dict[tuple[str, int, int, bytes], DriveJob] = {}
    for job in plan.jobs:
        if not job.guarded:
            continue
        number = job.saving[-1].parameter.pnu
        place = job.drive.unit.key, number, job.drive.drive_object, job.saving[0].data
        earlier = first.setdefault(place, job)
        if earlier is job:
            continue
        what = f"P{number} of {job.drive.key}"
        yield Diagnostic(
            "PG244",
            f'"{earlier.key}" and "{job.key}" both save {what}: neither knows when the other one saved',
            parameter_span(plan, job.uses[-1]),
            help="start one job from both places: that job then counts all saves",
            notes=(Note("first use", parameter_span(plan, earlier.uses[-1])),),
        )


def short_wait(plan: DrivePlan) -> Iterator[Diagnostic]:
    """PG245: other jobs of the unit give up before a save ends."""
    told = set()
    for job in plan.jobs:
        unit = job.drive.unit
        if job.poll is None or unit.wait >= job.timeout or plan.slots(unit) < 2 or (job.shape, unit.key) in told:
            continue
        told.add((job.shape, unit.key))
        yield Diagnostic(
            "PG245",
            f'"{job.shape}" may hold {unit.key} for {spelled(job.timeout)}, its other jobs wait for '
            f"{spelled(unit.wait)}: they may end with 16#8104",
            parameter_span(plan, job.uses[-1]),
            Severity.WARNING,
            help=f"give {unit.key} a longer wait, or the job a shorter limit",
            notes=tuple(_given(plan, (*unit.path, "wait"), (*job.path, "timeout"))),
        )


def _given(plan: DrivePlan, *paths: SpecPath) -> Iterator[Note]:
    """Where the times stand that the spec gives."""
    for path in paths:
        node = node_at(plan, path)
        if node is not None:
            yield Note(f"the {path[-1]}", node.span)
