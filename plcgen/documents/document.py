"""What an emitter hands to the renderer: a template, its view, and the file it becomes."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Any

from plcgen.scl.classic import Spelling

RAW = "text/raw.j2"
"""The template of a text that is finished: its view has it as ``text``."""


@dataclass(frozen=True, slots=True)
class Document:
    """One file to be rendered.

    ``path`` is relative to the output folder, with forward slashes; ``encoding`` a Python codec name;
    ``newline`` the line ending; ``experimental`` why the file was never seen in a real import ("" if it was);
    ``twins`` makes further documents from the finished text of this one; ``spelling`` says for which compiler the
    template is rewritten.
    """

    path: str
    template: str
    view: dict[str, Any]
    encoding: str = "utf-8"
    newline: str = "\n"
    experimental: str = ""
    twins: Callable[[str], Iterator[Document]] | None = field(default=None, repr=False)
    spelling: Spelling = Spelling.TIA
