"""A whole project rendered: every document of the emitters, then the manifest over them."""

from __future__ import annotations

import gc
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from plcgen.emit import emit
from plcgen.plan.model import Project
from plcgen.render.environment import RenderedFile, render_all
from plcgen.render.manifest import manifest


def render_project(project: Project, progress: Callable[[str, int, int], None] | None = None) -> list[RenderedFile]:
    """Every file of a project, in memory."""
    with collector_paused():
        files = render_all(emit(project), progress)
        files.append(manifest(project, files))
    return files


@contextmanager
def collector_paused() -> Iterator[None]:
    """No garbage collection meanwhile: views hold no cycles, and walking them again and again costs a third."""
    running = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if running:
            gc.enable()
