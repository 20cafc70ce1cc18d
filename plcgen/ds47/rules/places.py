"""Where drives, uses and parameters stand in the spec: the spans rules point at."""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeVar

from plcgen.project.rules.places import node_at

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from plcgen.base.diagnostics import Span
    from plcgen.ds47.plan.access import Use
    from plcgen.ds47.plan.nouns import DriveJob, DrivePlan

Found = TypeVar("Found")


def on_any_drive(
    plan: DrivePlan, find: Callable[[DriveJob, Use], Found | None]
) -> Iterator[tuple[DriveJob, Use, Found]]:
    """Every use of which a rule finds something, with the first drive of the job of which it does: told once for all.

    A rule about parameters looks at them as every drive of a job knows them, never at those of the first drive alone.
    """
    for shape in plan.shapes:
        told: set[int] = set()
        for job in plan.drive_kinds(shape):
            for use in job.own:
                found = None if use.position in told else find(job, use)
                if found:
                    told.add(use.position)
                    yield job, use, found


def of_drive(plan: DrivePlan, job: DriveJob) -> str:
    """Names the drive of an instance, unless it is the first of its job."""
    return "" if job is plan.instances(job)[0] else f" of {job.drive.key}"


def parameter_span(plan: DrivePlan, use: Use) -> Span:
    """Where a use's parameter is written: the key of a short form, else the value of ``parameter``."""
    return plan.loaded.span((*use.path, "parameter"))


def value_span(plan: DrivePlan, use: Use) -> Span:
    """Where a use is written as a whole."""
    return plan.loaded.span(use.path)


def member_span(plan: DrivePlan, use: Use) -> Span:
    """Where a use's member name comes from: ``as``, else the parameter."""
    given = node_at(plan, (*use.path, "as"))
    return parameter_span(plan, use) if given is None else given.span


def given_start(use: Use) -> bool:
    """Whether the spec gives an input its start value."""
    return getattr(use.item, "start", None) is not None
