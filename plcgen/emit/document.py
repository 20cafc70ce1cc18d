"""What an emitter hands to the renderer: a template, its view, and the file it becomes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True, slots=True)
class Document:
    """One file to be rendered.

    ``path`` is relative to the output folder, with forward slashes; ``encoding`` a Python codec name;
    ``newline`` the line ending; ``experimental`` why the file was never seen in a real import ("" if it was).
    """

    path: str
    template: str
    view: dict[str, Any]
    encoding: str = "utf-8"
    newline: str = "\n"
    experimental: str = ""
