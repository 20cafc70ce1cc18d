"""A whole project rendered: every document of the emitters, then the manifest over them."""

from __future__ import annotations

from collections.abc import Callable

from plcgen.documents import emit
from plcgen.documents.environment import RenderedFile, render_all
from plcgen.documents.manifest import manifest
from plcgen.project.nouns import Project
from plcgen.resources import collector_paused


def render_project(project: Project, progress: Callable[[str, int, int], None] | None = None) -> list[RenderedFile]:
    """Every file of a project, in memory."""
    with collector_paused():
        files = render_all(emit(project), progress)
        files.append(manifest(project, files))
    return files
