"""Near-name search for "did you mean": one rule for keys, names, parameters and codes."""

from __future__ import annotations

from collections.abc import Iterable


def near(word: str, candidates: Iterable[str], limit: int = 1) -> list[str]:
    """Up to ``limit`` candidates that look like ``word``, best first; letter case is ignored."""
    from difflib import get_close_matches

    by_lower = {candidate.lower(): candidate for candidate in candidates}
    hits = get_close_matches(word.lower(), by_lower, n=limit, cutoff=0.6)
    return [by_lower[hit] for hit in hits]


def did_you_mean(word: str, candidates: Iterable[str]) -> str:
    """``did you mean "x"?`` or an empty string."""
    hits = near(word, candidates)
    return f'did you mean "{hits[0]}"?' if hits else ""
