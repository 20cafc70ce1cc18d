"""What a template of a source prints stays where it stands: in a comment, in a title, in quotes, in code.

Every ``{{ }}`` of a template gets a filter, chosen once by what surrounds it there. A text that would leave its place
(a line end in a comment, a quote in quotes, a semicolon or a comment in code) is refused, wherever it comes from. And
the finished source is held against the same one with the same harmless letter everywhere: both must be the same code.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar
from functools import lru_cache
from itertools import zip_longest

from plcgen.base.diagnostics import PlcgenError
from plcgen.base.files.printed import unprintable

_PLACE = re.compile(r"\{\{(.*?)\}\}")
_TAG = re.compile(r"\{%.*?%\}|\{#.*?#\}")
_QUOTED = re.compile(r"\"[^\"\n]*\"|'(?:[^'$\n]|\$[^\n])*'")
_FREE_LINE = re.compile(r"\s*(?:TITLE|REGION|AUTHOR|FAMILY|NAME)\b")
_ENDS = re.compile(r"//|\(\*|\*\)|/\*|\*/|[;'\"{}]")
_DECLARED = re.compile(r"\s*:(?!=)")
_NAME = re.compile(r"\w+")
_PLAIN = re.compile(r"[\w.#]+")


class StrayTextError(PlcgenError, ValueError):
    """A text that would become something else at its place in a source."""


_STAND_IN = "\ua4d1"
"""A letter that no template and no view contains."""
_standing_in = ContextVar("standing in", default=False)


@contextmanager
def stand_ins() -> Iterator[None]:
    """Meanwhile templates print one and the same letter wherever a comment, title, text, name or quotes are filled."""
    before = _standing_in.set(True)
    try:
        yield
    finally:
        _standing_in.reset(before)


_TOKEN = re.compile(
    r"(?P<quotes>\"[^\"\n]*\")|(?P<string>'(?:[^'$\n]|\$[^\n])*')|(?P<comment>//[^\n]*|\(\*.*?\*\)|/\*.*?\*/)"
    r"|(?P<line>^[ \t]*(?:TITLE|REGION)\b[^\n]*)|\w+|[^\w\s]",
    re.DOTALL | re.MULTILINE,
)


def left_its_place(text: str, with_stand_ins: str) -> str:
    """The first piece of a source that would not be there if its template had been filled with something harmless.

    Empty if both are the same code with as many comments: nothing that was filled in has become code, or hidden any.
    """
    lines, others = text.split("\n"), with_stand_ins.split("\n")
    if len(lines) != len(others) or "(*" in with_stand_ins or "/*" in with_stand_ins:
        return _difference(text, with_stand_ins)
    unlike = ((line, other) for line, other in zip(lines, others, strict=True) if line != other)
    return next(filter(None, (_difference(*pair) for pair in unlike)), "")


@lru_cache(maxsize=4096)  # jobs have most of their lines in common
def _difference(text: str, with_stand_ins: str) -> str:
    for real, harmless in zip_longest(_TOKEN.finditer(text), _TOKEN.finditer(with_stand_ins)):
        if real is None or harmless is None or real.lastgroup != harmless.lastgroup:
            return (real or harmless)[0]
        same = real[0] == harmless[0] or (_STAND_IN in harmless[0] and _NAME.fullmatch(real[0]))
        if real.lastgroup is None and not same:
            return str(real[0])
    return ""


def guard(template: str) -> str:
    """A template of SCL in which every ``{{ }}`` is held at its place."""
    return "".join(map(_guarded, template.splitlines(keepends=True)))


def _guarded(line: str) -> str:
    plain = _TAG.sub(lambda tag: " " * len(tag[0]), line)
    return _PLACE.sub(
        lambda place: f"{{{{ ({place[1]}) | {_kind(plain[: place.start()], plain[place.end() :])} }}}}", line
    )


def _kind(before: str, behind: str) -> str:
    """The filter of a place between these pieces of its line."""
    if not before.strip() and _DECLARED.match(behind):
        return "in_name"
    left = _QUOTED.sub("", _PLACE.sub("x", before))
    if "//" in left or (_FREE_LINE.match(left) and not left.count("'") % 2):
        return "in_line"
    return "in_quotes" if left.count('"') % 2 else "in_string" if left.count("'") % 2 else "in_code"


def _in_line(value: object) -> object:
    if _standing_in.get():
        return _STAND_IN
    text = str(value)
    if unprintable(text):
        raise StrayTextError(text)
    return value


def _without(quote: str) -> Callable[[object], object]:
    def held(value: object) -> object:
        if _standing_in.get():
            return _STAND_IN
        text = str(value)
        if quote in text or unprintable(text):
            raise StrayTextError(text)
        return value

    return held


def _in_name(value: object) -> object:
    if _standing_in.get():
        return _STAND_IN
    if not _NAME.fullmatch(str(value)):
        raise StrayTextError(str(value))
    return value


def _in_code(value: object) -> object:
    if isinstance(value, int) or _standing_in.get():
        return value
    text = str(value)
    if not _PLAIN.fullmatch(text) and (_ENDS.search(_QUOTED.sub("", text)) or unprintable(text.replace("\n", ""))):
        raise StrayTextError(text)
    return value


FILTERS: Mapping[str, Callable[[object], object]] = {
    "in_line": _in_line,
    "in_quotes": _without('"'),
    "in_string": _without("'"),
    "in_name": _in_name,
    "in_code": _in_code,
}
"""Filters by the name that :func:`guard` gives them; each raises StrayTextError."""
