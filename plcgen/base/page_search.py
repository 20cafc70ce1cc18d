"""Which pages of the documentation say most about some words.

What a page is about counts first: its title, the words of ``docs/words.toml``, headings, what its tables define;
then what it says. The search of the site has the same words (``docs/site.py``).
"""

from __future__ import annotations

import math
import re
import tomllib
from functools import cache
from typing import Any

from plcgen.base.resources import docs_dir, documented

MOST = 3
ENDINGS = r"(?<=\w{3})(?:ations?|ungen|ung|ing|ers?|en|es|ed|e|n|s)$"
"""Endings of words of more than four letters, removed until none is left."""
SPELLED = ((r"\b16#|\b0x(?=[0-9a-f])", ""), (r"\b([0-9a-f]{2,8})h\b", "$1"), (r"\b([pr])0+(?=[1-9])", "$1"))
"""Spellings of numbers: ``16#8104``, ``0x8104`` and ``8104h`` are one, as are ``P0971`` and ``P971``."""
_WORD = re.compile(r"\w+")
_LATER = ("codes/", "adr/")
"""Reference for somebody who comes from a message or from the source: no answer to a question."""
_ABOUT = frozenset({"CONTRIBUTING", "SECURITY", "architecture", "evidence", "releasing", "testing", "migration"})
"""About the project itself."""
_SUBJECT, _HEADING = 30, 8
_FEW = 4
"""A word of fewer pages says no more than one of these: it may be there by chance."""
_TASK = 1.3
"""A page that does one task answers sooner than the reference of everything."""
_WHOLE = 0.5
"""The least share of the words, by their weight, that a page has to have."""
_LONGER, _PART = 0.7, 0.5
"""What a word counts that begins with the one looked for, and a first part of a compound (``Rampen|zeiten``)."""


def title(text: str) -> str:
    """The first heading of a page."""
    return next((line.removeprefix("# ") for line in text.splitlines() if line.startswith("# ")), "")


def best_pages(words: str) -> list[tuple[str, str]]:
    """Name and title of the pages that say most about some words, the best first; none if none of them occurs."""
    wanted = set(stems(words[:200]))
    known = documented()
    if codes := [f"codes/{stem.upper()}" for stem in stems(words[:200]) if f"codes/{stem.upper()}" in known]:
        return [(name, title(known[name].read_text("utf-8"))) for name in codes[:MOST]]
    pages = {name: path.read_text("utf-8") for name, path in known.items() if not name.startswith(_LATER)}
    found = {name: {stem: _value(stem, bag) for stem in wanted} for name, bag in _bags(pages).items()}
    weights = {
        stem: math.log(1 + len(pages) / max(number, _FEW))
        for stem in wanted
        if (number := sum(values[stem] > 0 for values in found.values()))
    }
    scores: dict[str, float] = {}
    for name, values in found.items():
        has = sum(weight for stem, weight in weights.items() if values[stem])
        if has and has >= _WHOLE * sum(weights.values()):
            score = sum(weight * values[stem] for stem, weight in weights.items())
            scores[name] = score * (_TASK if name.startswith("tasks/") else 0.3 if name in _ABOUT else 1)
    return [(name, title(pages[name])) for name in sorted(scores, key=lambda name: -scores[name])[:MOST]]


def stems(text: str) -> list[str]:
    """Words without their endings, common ones left out: ``save``, ``saves`` and ``saving`` are one."""
    text = text.lower()
    for spelled, instead in SPELLED:
        text = re.sub(spelled, instead.replace("$", "\\"), text)
    return [_stem(word) for word in _WORD.findall(text) if word not in common_words()]


def _stem(word: str) -> str:
    shorter = re.sub(ENDINGS, "", word) if len(word) > 4 else word
    return word if shorter == word else _stem(shorter)


def subjects(name: str, text: str) -> dict[str, float]:
    """What a page is about: stems of its title, of words that people use, of headings and first cells."""
    about: dict[str, float] = {}
    for line in text.splitlines():
        if line.startswith("##") or (line.startswith("| ") and not line.startswith("| |")):
            for stem in stems(line.split(" | ")[0]):
                about[stem] = _HEADING
    for stem in stems(f"{name.replace('-', ' ')} {title(text)} {_words()['pages'].get(name, '')}"):
        about[stem] = _SUBJECT
    return about


@cache
def _words() -> dict[str, Any]:
    return tomllib.loads((docs_dir() / "words.toml").read_text("utf-8"))


@cache
def common_words() -> frozenset[str]:
    """Words that say nothing about a page."""
    return frozenset(_words()["common"].split())


def _bags(pages: dict[str, str]) -> dict[str, dict[str, float]]:
    """What every word of a page counts: often in a long page is worth less than often in a short one."""
    bags = {}
    for name, text in pages.items():
        counts: dict[str, float] = {}
        for stem in stems(text):
            counts[stem] = counts.get(stem, 0) + 1
        length = math.sqrt(1 + len(text) / 20_000)
        bag = {stem: 8 * count / (count + 3) * 8 / length for stem, count in counts.items()}
        for stem, value in subjects(name, text).items():
            bag[stem] = bag.get(stem, 0) + value
        bags[name] = bag
    return bags


def _value(wanted: str, bag: dict[str, float]) -> float:
    if wanted in bag:
        return bag[wanted]
    longer = [value for stem, value in bag.items() if len(wanted) > 3 and stem.startswith(wanted)]
    parts = [value for stem, value in bag.items() if len(stem) > 4 and wanted.startswith(stem)]
    return max([_LONGER * max(longer, default=0.0), _PART * max(parts, default=0.0)])
