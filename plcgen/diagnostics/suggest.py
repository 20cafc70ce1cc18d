"""Near-name search for "did you mean": one rule for keys, names, parameters and codes."""

from __future__ import annotations

from collections.abc import Iterable

_LEAST = 3
"""Letters of a part that is worth a suggestion."""


def near(word: str, candidates: Iterable[str]) -> list[str]:
    """The candidate that looks most like ``word``, if one does; letter case is ignored.

    Without any, the only one of which ``word`` is a whole part: ``g120`` means ``sinamics-g120``.
    """
    from difflib import get_close_matches

    by_lower = {candidate.lower(): candidate for candidate in candidates}
    hits = get_close_matches(word.lower(), by_lower, n=1, cutoff=0.6)
    if not hits and len(word) >= _LEAST:
        parts = [one for one in by_lower if word.lower() in one.replace("_", "-").split("-")]
        hits = parts if len(parts) == 1 else []
    return [by_lower[hit] for hit in hits]


def did_you_mean(word: str, candidates: Iterable[str]) -> str:
    """``did you mean "x"?`` or an empty string."""
    hits = near(word, candidates)
    return f'did you mean "{hits[0]}"?' if hits else ""
