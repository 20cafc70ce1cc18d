"""What generated programs say to their user, in German and Chinese: a phrase book beside the templates.

``phrases.toml`` of each folder of templates has English phrases with their translations; ``{..}`` stands for anything,
``{title}`` for the title of a parameter, which ``titles.toml`` translates, ``{parameter}`` for a parameter with its
title or without one, ``{phrase}`` for another phrase. A title that is not in ``titles.toml`` stays as it is, and what
stands around it is translated.
"""

from __future__ import annotations

import re
import tomllib
from collections.abc import Mapping
from functools import cache, lru_cache
from typing import NamedTuple

from plcgen.base.resources import templates_dir

LANGUAGES = ("de", "zh")
"""Languages of the phrase book besides English, in the order of its columns."""
_PLACE = re.compile(r"\\\{(\w+)\\\}")
_ROLE = re.compile(r"(?:BI|CI|BO|CO|CO/BO): ")
_LABEL = r"[rP][0-9]+(?:\[[0-9.]+\])?(?:\.[0-9]+(?:, \.[0-9]+)*)?"
"""``P2155[1..2]``, ``P1030.0, .2``"""
_PARAMETER = re.compile(rf"({_LABEL}) (.+)")
_WORDS = {
    "label": _LABEL,
    "parameter": rf"{_LABEL}(?: .+?)?",
    "number": "[0-9]+",
    "signal": r"\w+",
    "unit": r"[^\[\]]+",
}
"""What a place may hold, by its name; others hold anything."""


class _Phrase(NamedTuple):
    pattern: re.Pattern[str]
    translations: tuple[str, ...]


@cache
def _exact() -> Mapping[str, tuple[str, ...]]:
    return {text: tuple(found) for text, found in _rows("phrases") if "{" not in text}


@cache
def _patterns() -> tuple[_Phrase, ...]:
    """Phrases with places, as patterns of the whole text."""
    found = []
    for text, translations in _rows("phrases"):
        if "{" in text:
            pattern = _PLACE.sub(lambda place: f"(?P<{place[1]}>{_WORDS.get(place[1], '.+?')})", re.escape(text))
            found.append(_Phrase(re.compile(pattern), tuple(translations)))
    return tuple(found)


@cache
def _titles() -> Mapping[str, tuple[str, ...]]:
    return {text: tuple(found) for text, found in _rows("titles")}


def _rows(name: str) -> list[tuple[str, list[str]]]:
    wide = ("ppi", "ds47", "shared")  # "Read {what}" of drives is wider than "Read {what} of {station}"
    paths = sorted(templates_dir().glob(f"*/{name}.toml"), key=lambda path: wide.index(path.parent.name))
    return [row for path in paths for row in tomllib.loads(path.read_text("utf-8")).items()]


@lru_cache(maxsize=65536)
def translated(text: str) -> Mapping[str, str]:
    """A text of one or more lines by language, ``de`` and ``zh``; without those in which a line has no translation."""
    lines = [_line(line, own=False) or _line(line, own=True) for line in text.split("\n")]
    return {name: "\n".join(line[name] for line in lines) for name in LANGUAGES if all(name in line for line in lines)}


def _line(text: str, *, own: bool) -> Mapping[str, str]:
    """A line by language; ``own``: whether it may have titles that nobody has translated."""
    found = _exact().get(text)
    if found is not None:
        return dict(zip(LANGUAGES, found, strict=True))
    for phrase in _patterns():
        match = phrase.pattern.fullmatch(text)
        filled = _filled(phrase, match.groupdict(), own=own) if match else {}
        if filled:
            return filled
    return {}


def _filled(phrase: _Phrase, places: Mapping[str, str], *, own: bool) -> Mapping[str, str]:
    inner = {name: _inside(name, text, own=own) for name, text in places.items()}
    return {
        language: form.format(**{name: texts[language] for name, texts in inner.items()})
        for language, form in zip(LANGUAGES, phrase.translations, strict=True)
        if all(language in texts for texts in inner.values())
    }


def _inside(name: str, text: str, *, own: bool) -> Mapping[str, str]:
    """What stands in a place, by language."""
    same = dict.fromkeys(LANGUAGES, text)
    if name in {"phrase", "condition"}:
        return _line(text, own=own) or (same if name == "condition" else {})
    if name == "title":
        return title_in(text) or (same if own else {})
    match = _PARAMETER.fullmatch(text) if name == "parameter" else None
    if match is None:
        return same
    title = _inside("title", match[2], own=own)
    return {language: f"{match[1]} {one}" for language, one in title.items()}


def title_in(text: str) -> Mapping[str, str]:
    """The title of a parameter by language, with what it is in a connection; empty if nobody has translated it."""
    role = _ROLE.match(text)
    head = role[0] if role else ""
    found = _titles().get(text[len(head) :], ())
    return {language: head + one for language, one in zip(LANGUAGES, found, strict=False)}
