"""Names and texts of PPI masters, for the rules about names and comments."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from typing import TYPE_CHECKING

from plcgen.ppi.rules.line import member_span
from plcgen.project.part import Named

if TYPE_CHECKING:
    from plcgen.base.diagnostics import Span
    from plcgen.ppi.plan.nouns import PpiPlan
    from plcgen.project.spec import SpecPath


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
    yield "PpiJobTags", "the tag table of the PPI jobs", None
    for master in plan.masters:
        yield f"Watch_{master.block.name}", f'the watch table of master "{master.key}"', None
