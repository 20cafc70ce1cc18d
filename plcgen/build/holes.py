"""What a template of a source prints stays where it stands: in a comment, in a title, in quotes, in code.

Every ``{{ }}`` of a template gets a filter, chosen once by what surrounds it there. A text that would leave its place
(a line end in a comment, a quote in quotes, a semicolon or a comment in code) is refused, wherever it comes from.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping

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
    text = str(value)
    if unprintable(text):
        raise StrayTextError(text)
    return value


def _without(quote: str) -> Callable[[object], object]:
    def held(value: object) -> object:
        text = str(value)
        if quote in text or unprintable(text):
            raise StrayTextError(text)
        return value

    return held


def _in_name(value: object) -> object:
    if not _NAME.fullmatch(str(value)):
        raise StrayTextError(str(value))
    return value


def _in_code(value: object) -> object:
    if isinstance(value, int):
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
