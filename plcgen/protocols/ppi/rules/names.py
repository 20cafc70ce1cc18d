"""Names and texts of PPI masters for the rules about names: keys, members, flags, comments."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial
from typing import TYPE_CHECKING

from plcgen.project.rules.places import key_or_value
from plcgen.protocols.ppi.rules.line import member_span

if TYPE_CHECKING:
    from plcgen.diagnostics import Span
    from plcgen.project.loading import SpecPath
    from plcgen.project.model import Project
    from plcgen.protocols.ppi.plan.model import PlannedMaster

Row = tuple[str, str, str, "Callable[[], Span]"]


def _masters(project: Project) -> tuple[PlannedMaster, ...]:
    return project.ppi.masters if project.ppi is not None else ()


def ppi_names(project: Project) -> Iterator[Row]:
    """What is named, the name, its role, where it stands: for every name of the masters that reaches a source."""
    key_of = project.loaded.key_span
    for key, master in project.loaded.spec.masters.items():
        yield "master key", key, "key", partial(key_of, ("ppi", key))
        for which in ("stations", "jobs"):
            for name in getattr(master, which):
                yield f"{which[:-1]} key", name, "key", partial(key_of, ("ppi", key, which, name))
    for master in _masters(project):
        for job in master.jobs:
            yield "member", job.member, "identifier", partial(key_of, job.path)
            for value in job.values:
                yield "member", value.member, "identifier", partial(member_span, project, value)


def ppi_comments(project: Project) -> Iterator[tuple[SpecPath, dict[str, str]]]:
    """Texts of the masters that become comments."""
    for master in _masters(project):
        yield (*master.path, "comment"), master.comment
        for station in master.stations:
            yield (*station.path, "comment"), station.comment
        for job in master.jobs:
            yield (*job.path, "comment"), job.comment
            for value in job.values:
                yield (*value.path, "comment"), value.comment


def ppi_taken(project: Project) -> Iterator[tuple[str, str, Span | None]]:
    """Names that blocks must not have: of the masters' watch and tag tables and flags."""
    yield "PpiJobTags", "the tag table of the PPI jobs", None
    for master in _masters(project):
        yield f"Watch_{master.block.name}", f'the watch table of master "{master.key}"', None
        for job in master.jobs:
            for flag in job.trigger.items():
                signal = flag[0]
                span = key_or_value(project, (*job.path, "trigger", signal))
                yield f"{job.member}{signal.capitalize()}", f'the {signal} flag of job "{job.key}"', span
