"""Names and texts of drives and their jobs, for the rules about names and comments."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from typing import TYPE_CHECKING

from plcgen.ds47.rules.places import member_span
from plcgen.project.part import Named

if TYPE_CHECKING:
    from plcgen.base.diagnostics import Span
    from plcgen.ds47.plan.nouns import DrivePlan
    from plcgen.project.spec import SpecPath


def names(plan: DrivePlan) -> Iterator[Named]:
    """Keys of drives, recipes and jobs, names of records, parameters, values and members."""
    value, key_of = plan.loaded.span, plan.loaded.key_span
    for key in plan.spec.units:
        yield Named("unit key", key, "key", partial(key_of, ("units", key)))
    for placed in plan.spec.placed():
        yield Named("drive key", placed.key, "key", partial(key_of, placed.path))
        for text, parameter in placed.drive.parameters.items():
            if parameter.name is not None:
                place = partial(value, (*placed.path, "parameters", text, "name"))
                yield Named("parameter name", parameter.name, "parameter", place)
    for key, recipe in plan.spec.recipes.items():
        yield Named("recipe key", key, "key", partial(key_of, ("recipes", key)))
        for record in recipe.records if isinstance(recipe.records, dict) else ():
            yield Named("record", record, "text", partial(key_of, ("recipes", key, "records", record)))
    for key in plan.spec.jobs:
        yield Named("job key", key, "key", partial(key_of, ("jobs", key)))
    for job in plan.shapes:
        for use in (each for one in job.uses for each in (one, *one.bits)):
            yield Named("member", use.member, "identifier", partial(member_span, plan, use))
        spec = plan.entry(job)
        for which, buffer in (("request", spec.request), ("response", spec.response)):
            for old, new in buffer.members.items():
                yield Named("member", new, "identifier", partial(value, (*job.path, which, "members", old)))


def texts(plan: DrivePlan) -> Iterator[tuple[SpecPath, dict[str, str]]]:
    """Comments of drives, jobs, values and recipes."""
    for drive in plan.drives:
        yield (*drive.path, "comment"), drive.comment
    for job in plan.shapes:
        yield (*job.path, "comment"), job.comment
        for use in (each for one in job.uses for each in (one, *one.bits)):
            yield (*use.path, "comment"), use.comment
    for recipe in plan.recipes:
        yield ("recipes", recipe.key, "comment"), recipe.comment


def untranslated(plan: DrivePlan) -> Iterator[tuple[SpecPath, str]]:
    """Titles and units of the parameters that the spec defines."""
    for drive in plan.drives:
        for text, parameter in plan.settings(drive).parameters.items():
            for key, value in (("title", parameter.title), ("unit", parameter.unit)):
                yield (*drive.path, "parameters", text, key), value or ""


def taken(plan: DrivePlan) -> Iterator[tuple[str, str, Span | None]]:
    """Names of the tables."""
    yield f"{plan.prefix}DriveJobTags", "the tag table", None
    for job in plan.shapes:
        yield f"Watch_{job.block.name}", f'the watch table of job "{job.key}"', None


def partners(plan: DrivePlan) -> Iterator[tuple[str, str, Span]]:
    """Devices by their identifiers: a parameter server takes one request at a time, and one channel sees to that."""
    for drive in plan.drives:
        what = drive.id_name or str(drive.id_value)
        yield what, f"the device at {what}", plan.loaded.span(drive.path)
