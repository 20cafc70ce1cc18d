"""What an emitter hands to the renderer: a template and its view, or a finished text, and the file it becomes."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from plcgen.s7.scl.classic import Spelling

if TYPE_CHECKING:
    from plcgen.build.reread import Promise
    from plcgen.s7.types.blocks import Block


@dataclass(frozen=True, slots=True)
class Document:
    """One file to be rendered.

    ``path`` is relative to the output folder, with forward slashes; without a ``template`` the ``text`` is finished;
    ``encoding`` a Python codec name; ``newline`` the line ending; ``experimental`` why the file
    was never seen in a real import ("" if it was); ``spelling`` says for which compiler the template is rewritten,
    ``voice`` says the finished text in the project's languages; ``promise`` is what a source must say when it is read
    again, ``twins`` makes further documents from the block that is read then; ``data`` is a file that is no text.
    """

    path: str
    template: str = ""
    view: Mapping[str, Any] = field(default_factory=dict)
    text: str = ""
    encoding: str = "utf-8"
    newline: str = "\n"
    experimental: str = ""
    twins: Callable[[Block], Iterator[Document]] | None = field(default=None, repr=False)
    spelling: Spelling = Spelling.TIA
    voice: Callable[[str], str] | None = field(default=None, repr=False)
    data: bytes = b""
    promise: Promise | None = field(default=None, repr=False)
    group: int = 0
    """Place of a source among the others: types 1, data blocks 2, function blocks 3, instances 4; else 0."""
