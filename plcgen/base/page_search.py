"""Which pages of the documentation say most about some words: titles first, then headings, then what they say."""

from __future__ import annotations

import math
import re

from plcgen.base.resources import documented

MOST = 3
_WORD = re.compile(r"[a-z0-9_]{2,}")
_COMMON = re.compile(
    r"(?:an|and|any|are|as|at|be|by|can|do|does|for|from|have|how|in|into|is|it|my|of|on|or|that|the|there|to|what|where"
    r"|which|who|why|with|you|your)\Z"
)
_ENDINGS = re.compile(r"(?:ations?|ing|ers?|es|ed|e|s)\Z")
_LATER = ("codes/", "adr/")
"""Reference for somebody who comes from a message or from the source: no answer to a question."""
_ABOUT = frozenset({"CONTRIBUTING", "SECURITY", "architecture", "evidence", "releasing", "testing", "migration"})
"""About the project itself."""
_NAME, _HEADING = 12, 5
_TASK = 1.3
"""A page that does one task answers sooner than the reference of everything."""
_WHOLE = 0.5
"""The least share of the words, by their weight, that a page has to have."""


def title(text: str) -> str:
    """The first heading of a page."""
    return next((line.removeprefix("# ") for line in text.splitlines() if line.startswith("# ")), "")


def best_pages(words: str) -> list[tuple[str, str]]:
    """Name and title of the pages that say most about some words, the best first; none if none of them occurs."""
    wanted = set(_stems(words[:200]))
    pages = {name: path.read_text("utf-8") for name, path in documented().items() if not name.startswith(_LATER)}
    bags = {name: _bag(name, text) for name, text in pages.items()}
    weights = {
        stem: math.log(1 + len(bags) / found) for stem in wanted if (found := sum(stem in bag for bag in bags.values()))
    }
    scores: dict[str, float] = {}
    for name, bag in bags.items():
        has = sum(weight for stem, weight in weights.items() if stem in bag)
        if has and has >= _WHOLE * sum(weights.values()):
            score = sum(weight * bag.get(stem, 0.0) for stem, weight in weights.items())
            scores[name] = score * (_TASK if name.startswith("tasks/") else 0.3 if name in _ABOUT else 1)
    return [(name, title(pages[name])) for name in sorted(scores, key=lambda name: -scores[name])[:MOST]]


def _bag(name: str, text: str) -> dict[str, float]:
    """What every word of a page counts: often in a long page is worth less than often in a short one."""
    counts: dict[str, float] = {}
    length = math.sqrt(1 + len(text) / 20_000)
    for stem in _stems(text):
        counts[stem] = counts.get(stem, 0) + 1
    bag = {stem: 8 * count / (count + 3) * 8 / length for stem, count in counts.items()}
    for line in text.splitlines():
        if line.startswith("##"):
            for stem in set(_stems(line)):
                bag[stem] += _HEADING / length
    for stem in {*_stems(name.replace("-", " ").replace("/", " ")), *_stems(title(text))}:
        bag[stem] = bag.get(stem, 0) + _NAME
    return bag


def _stems(text: str) -> list[str]:
    """Words without their endings, common ones left out: ``save``, ``saves`` and ``saving`` are one."""
    words = (word for word in _WORD.findall(text.lower()) if not _COMMON.match(word))
    return [_ENDINGS.sub("", word) if len(word) > 4 else word for word in words]
