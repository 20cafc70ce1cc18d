"""Where the files that ship with the tool lie (beside the package, or inside it in a wheel), and the collector."""

from __future__ import annotations

import gc
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

_PACKAGE = Path(__file__).resolve().parent


def _locate(installed: str, checkout: str) -> Path:
    inside = _PACKAGE / installed
    return inside if inside.is_dir() else _PACKAGE.parent / checkout


def templates_dir() -> Path:
    """Directory of the Jinja2 templates."""
    return _locate("_templates", "templates")


def specs_dir() -> Path:
    """Directory of the shipped job specs, device profiles and parameter catalogues."""
    return _locate("_specs", "specs")


@contextmanager
def collector_paused() -> Iterator[None]:
    """No garbage collection meanwhile: trees and views hold no cycles, walking them again and again costs a third."""
    running = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if running:
            gc.enable()
