"""The one Jinja environment; the only importer of jinja2.

Output depends on the view alone: undefined names are errors, and no clock, user, path or locale is within reach.
"""

from __future__ import annotations

import functools
import zlib
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any

import jinja2

from plcgen.documents.document import Document
from plcgen.resources import templates_dir

MAX_PLAIN = 256 * 1024 * 1024
"""Bytes of a project that are kept as they are; what goes beyond is kept compressed until it is written."""

_WORTH_PACKING = 16 * 1024


@dataclass(frozen=True, slots=True)
class RenderedFile:
    """A finished file: relative path with forward slashes, exact bytes, why it is experimental ("" if not)."""

    path: str
    content: bytes
    experimental: str = ""
    packed: bool = False

    @property
    def data(self) -> bytes:
        """The exact bytes of the file."""
        return zlib.decompress(self.content) if self.packed else self.content

    def pack(self) -> RenderedFile:
        """The same file in less memory: the documents of ten thousand jobs are gigabytes."""
        if self.packed or len(self.content) < _WORTH_PACKING:
            return self
        return RenderedFile(self.path, zlib.compress(self.content, 1), self.experimental, packed=True)


_MARKUP = (".xml.j2", ".html.j2", ".svg.j2")


@functools.cache
def environment() -> jinja2.Environment:
    """Environment for the shipped templates: no user templates, templates of markup escape by default."""
    return jinja2.Environment(
        loader=jinja2.FileSystemLoader(templates_dir()),
        undefined=jinja2.StrictUndefined,
        autoescape=lambda name: name is not None and name.endswith(_MARKUP),  # noqa: S701 - SCL is no markup
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
        auto_reload=False,
        cache_size=-1,
    )


@functools.cache
def _template(name: str) -> jinja2.Template:
    return environment().get_template(name)


def render_text(template: str, view: dict[str, Any]) -> str:
    """Render one template."""
    return _template(template).render(view)


def render(document: Document) -> RenderedFile:
    """Render one document to bytes; characters were checked before, what is left over becomes ``?``."""
    return _finished(document, render_text(document.template, document.view))


def _finished(document: Document, text: str) -> RenderedFile:
    if document.newline != "\n":
        text = text.replace("\n", document.newline)
    return RenderedFile(document.path, text.encode(document.encoding, "replace"), document.experimental)


def render_all(
    documents: Iterable[Document], progress: Callable[[str, int, int], None] | None = None
) -> list[RenderedFile]:
    """Render documents in order, twins behind their original.

    ``progress(what, done, 0)``: how many there will be is not known before.
    """
    files: list[RenderedFile] = []
    plain = 0
    for number, document in enumerate(documents, 1):
        text = render_text(document.template, document.view)
        made = [_finished(document, text)]
        if document.twins is not None:
            made += [render(twin) for twin in document.twins(text)]
        plain += sum(len(file.content) for file in made)
        files += made if plain <= MAX_PLAIN else [file.pack() for file in made]
        if progress is not None and number % 50 == 0:
            progress("render", number, 0)
    return files
