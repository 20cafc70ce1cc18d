"""A whole project rendered: every document of the engine, then the manifest over them."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from plcgen.build.engine import emit
from plcgen.build.environment import RenderedFile, render_all
from plcgen.build.manifest import entry, manifest
from plcgen.build.one_source import joined
from plcgen.project.nouns import Project


def render_project(project: Project, progress: Callable[[str, int, int], None] | None = None) -> Iterator[RenderedFile]:
    """Every file of a project, one at a time; of those already handed out only hash and length are kept."""
    entries = []
    files = render_all(emit(project), progress)
    for file in joined(project, files) if project.loaded.spec.plc.sources == "one" else files:
        entries.append(entry(file))
        yield file
    yield manifest(project, entries)
