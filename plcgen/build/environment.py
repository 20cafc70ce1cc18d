"""The Jinja environments, one a spelling; the only importer of jinja2.

Output depends on the view alone: undefined names are errors, and no clock, user, path or locale is within reach.
Templates are TIA SCL. For an older compiler a template is rewritten once, when it is loaded: rendering costs the same
on every target, and what a view puts into the text is never touched.
"""

from __future__ import annotations

import functools
import re
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from importlib import resources
from typing import Any

import jinja2
import jinja2.ext
import markupsafe

from plcgen.base.diagnostics import DiagnosticError
from plcgen.base.display import markdown
from plcgen.base.resources import templates_dir
from plcgen.build.document import Document
from plcgen.build.holes import FILTERS, StrayTextError, guard, stand_ins
from plcgen.build.own_hash import with_own_hash
from plcgen.build.reread import Reading, not_meant
from plcgen.s7.scl.classic import Spelling, respell


@dataclass(frozen=True, slots=True)
class RenderedFile:
    """A finished file: path with forward slashes, exact bytes, why it is experimental, the group of its document."""

    path: str
    data: bytes
    experimental: str = ""
    group: int = 0


_MARKUP = (".xml.j2", ".html.j2", ".svg.j2")


_SOURCES = (".scl.j2", ".udt.j2", ".db.j2")
_MARKDOWN = ".md.j2"
_PRINTED = re.compile(r"\{\{(-?)(.*?)(-?)\}\}", re.DOTALL)
_JINJA = re.compile(r"\{\{.*?\}\}|\{%.*?%\}|\{#.*?#\}", re.DOTALL)
_LETTER = "\ua4d0"
"""A letter that no template contains: it makes a word of what Jinja will replace."""
_PLACE = re.compile(rf"\(\*{_LETTER}(\d+){_LETTER}\*\)|{_LETTER}(\d+){_LETTER}")


def respell_template(source: str, spelling: Spelling) -> str:
    """Rewrite the SCL of a template; a ``{{ }}`` counts as a word or part of one, other tags as comments."""
    tags: list[str] = []

    def hide(match: re.Match[str]) -> str:
        tags.append(match[0])
        word = f"{_LETTER}{len(tags) - 1}{_LETTER}"
        return word if match[0].startswith("{{") else f"(*{word}*)"

    return _PLACE.sub(lambda place: tags[int(place[1] or place[2])], respell(_JINJA.sub(hide, source), spelling))


_INDENTED = re.compile(r"^( +)(\{% include .*?%\})$", re.MULTILINE)
_PART = re.compile(r'\{% part (".*?") %\}')
_ONE_PART = re.compile(r'\{% part (".*?") from (\S+) %\}')
_TERM = re.compile(r'\{% term (".*?") %\}')


def expand_marks(source: str) -> str:
    """Replace what Jinja does not know; no line is added, so that it names the right one in an error.

    An indented ``include`` moves what it brings to the right by as much. ``{% part "start" %}`` is the place where each
    of the view's ``parts``, names of templates, is included with this ``part``; ``{% part "result" from job.result %}``
    of one of them alone; ``{% term "unless" %}`` is the same as ``part`` within a line.
    """
    each = r"{% set part = \1 %}{% for each_part in parts %}{% include each_part %}{% endfor %}"
    source = _PART.sub(each, _TERM.sub("{% filter joined %}" + each + "{% endfilter %}", source))
    source = _ONE_PART.sub(r"{% set part = \1 %}{% include \2 %}", source)
    return _INDENTED.sub(r'{% filter moved("\1") %}\2{% endfilter %}', source)


def _moved(text: str, space: str) -> str:
    return text and space + re.sub(r"\n(?=.)", "\n" + space, text)


def _joined(text: str) -> str:
    return text.replace("\n", "")


class _Environment(jinja2.Environment):
    def join_path(self, template: str, parent: str) -> str:
        """A template that lies beside the code includes another one there by its mere name."""
        package, colon, _ = parent.partition(":")
        return f"{package}:{template}" if colon and "/" not in template and ":" not in template else template


class _Respelled(jinja2.ext.Extension):
    """Prepares the sources among the templates before Jinja compiles them."""

    def preprocess(self, source: str, name: str | None, filename: str | None = None) -> str:  # noqa: ARG002 - Jinja's
        spelling = Spelling(self.environment.globals["spelling"])
        if (name or "").endswith(_MARKDOWN):
            return _PRINTED.sub(r"{{\1 (\2) | shown \3}}", source)
        return expand_marks(guard(respell_template(source, spelling))) if (name or "").endswith(_SOURCES) else source


def _beside_protocol(name: str) -> str | None:
    """Source of ``package:path``: a template that a protocol of another distribution keeps beside its code."""
    package, _, path = name.partition(":")
    return resources.files(package).joinpath(path).read_text("utf-8") if path else None


@functools.cache
def environment(spelling: Spelling = Spelling.TIA) -> jinja2.Environment:
    """Environment for the templates of this package, and ``package:path``; markup and Markdown are escaped."""
    made = _Environment(
        loader=jinja2.ChoiceLoader(
            [jinja2.FunctionLoader(_beside_protocol), jinja2.FileSystemLoader(templates_dir())],
        ),
        undefined=jinja2.StrictUndefined,
        autoescape=lambda name: name is not None and name.endswith(_MARKUP),
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
        auto_reload=False,
        cache_size=-1,
        extensions=[_Respelled],
    )
    made.globals["spelling"] = spelling
    made.filters |= FILTERS
    made.filters |= {
        "joined": _joined,
        "code": _code,
        "with_bytes": _with_bytes,
        "shown": _shown,
        "breakable": _breakable,
        "moved": _moved,
    }
    return made


class _Marked(str):
    """Markdown that is meant as such."""

    __slots__ = ()


def _code(text: str) -> _Marked:
    return _Marked(markdown.code_span(text))


_BYTES = re.compile(r"(`[0-9A-F ]+`)")


def _with_bytes(text: str) -> _Marked:
    """A text in which bytes between backticks are code."""
    parts = _BYTES.split(text)
    return _Marked("".join(part if number % 2 else markdown.escape(part) for number, part in enumerate(parts)))


def _shown(value: object) -> str:
    """What a template of Markdown prints: whatever it is, a viewer shows just that."""
    text = str(value)
    return text if text.isalnum() or isinstance(value, _Marked) else markdown.escape(text)


_JOINTS = re.compile(r"(?<=[._\]/,:-])(?=[^._\]/,:\s-])|(?<=[a-z0-9])(?=[A-Z])")

_TOO_LONG = re.compile(r"[^\s._\]/,:-]{24}(?=[^\s._\]/,:-])")


def _breakable(text: str) -> markupsafe.Markup:
    """A name that a page may break where its parts meet, behind ``.`` ``_`` ``]`` and before a capital.

    A part that is too long for any column breaks anywhere.
    """
    text = _TOO_LONG.sub(lambda run: f"{run[0]}\u200b", text)
    pieces = (piece for part in _JOINTS.split(text) for piece in part.split("\u200b"))
    return markupsafe.Markup("<wbr>").join(pieces)


@functools.cache
def _template(name: str, spelling: Spelling) -> jinja2.Template:
    return environment(spelling).get_template(name)


def render_text(template: str, view: Mapping[str, Any], spelling: Spelling = Spelling.TIA) -> str:
    """Render one template."""
    return _template(template, spelling).render(view)


def render(document: Document) -> RenderedFile:
    """Render one document to bytes; characters were checked before, what is left over becomes ``?``."""
    return _finished(document, _text(document))


def _text(document: Document) -> str:
    if not document.template:
        return document.text
    try:
        text = render_text(document.template, document.view, document.spelling)
    except StrayTextError as stray:
        raise DiagnosticError([not_meant(document.path, f'"{stray}" would not stay at its place')]) from stray
    return text if document.voice is None else document.voice(text)


def _harmless(document: Document) -> str:
    with stand_ins():
        return render_text(document.template, document.view, document.spelling)


def _finished(document: Document, text: str) -> RenderedFile:
    if document.data:
        return RenderedFile(document.path, document.data, document.experimental)
    if document.newline != "\n":
        text = text.replace("\n", document.newline)
    data = text.encode(document.encoding, "replace")
    return RenderedFile(document.path, data, document.experimental, document.group)


def render_all(
    documents: Iterable[Document], progress: Callable[[str, int, int], None] | None = None
) -> Iterator[RenderedFile]:
    """Render documents in order, twins behind their original, one at a time: ten thousand jobs are gigabytes.

    ``progress(what, done, 0)``: how many there will be is not known before.
    """
    reading = Reading()
    for number, document in enumerate(documents, 1):
        text = _text(document)
        block, promise = None, document.promise
        if promise is not None:
            read = reading.alike if document.twins is None else reading.alone
            block = read(text, document.path, promise, partial(_harmless, document))
            text, block = with_own_hash(text, block)
        elif document.template.endswith(_SOURCES):
            raise DiagnosticError([not_meant(document.path, "nothing is promised of it")])
        yield _finished(document, text)
        if document.twins is not None and block is not None:
            yield from map(render, document.twins(block))
        if progress is not None and number % 50 == 0:
            progress("render", number, 0)
