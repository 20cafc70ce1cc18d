"""Near-name search for "did you mean": one rule for keys, names, parameters and codes."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterable, Iterator
from functools import cached_property

_LEAST = 3
"""Letters of a part that is worth a suggestion."""
_MANY = 40
"""Of so many candidates at most each is compared; of more, those that share the most pairs of letters."""
_PLACES = 30
"""So many candidates are kept for a pair of letters, and compared in the end."""


class Vocabulary:
    """Candidates for many words: however many there are, a word is compared with a few of them.

    What a file has a thousand of may be misspelt a thousand times.
    """

    def __init__(self, candidates: Iterable[str]) -> None:
        self._words = tuple(candidates)

    def __iter__(self) -> Iterator[str]:
        return iter(self._words)

    def __len__(self) -> int:
        return len(self._words)

    def first(self, most: int) -> tuple[str, ...]:
        """The first candidates."""
        return self._words[:most]

    @cached_property
    def by_lower(self) -> dict[str, str]:
        """The candidates by what they are in lower case."""
        return {word.lower(): word for word in self._words}

    @cached_property
    def _by_pair(self) -> dict[str, list[str]]:
        found: dict[str, list[str]] = {}
        for word in self.by_lower:
            for pair in _pairs(word):
                kept = found.setdefault(pair, [])
                if len(kept) < _PLACES:
                    kept.append(word)
        return found

    def like(self, word: str) -> Iterable[str]:
        """Those in lower case that are worth a comparison with a word in lower case."""
        if len(self.by_lower) <= _MANY:
            return self.by_lower
        shared = Counter(each for pair in _pairs(word) for each in self._by_pair.get(pair, ()))
        return [each for each, _ in shared.most_common(_PLACES)]


def _pairs(word: str) -> set[str]:
    """Neighbouring letters; at both ends there is a blank."""
    return {f" {word} "[at : at + 2] for at in range(len(word) + 1)}


def near(word: str, candidates: Iterable[str]) -> list[str]:
    """The candidate that looks most like ``word``, if one does; letter case is ignored.

    Without any, the only one of which ``word`` is a whole part: ``g120`` means ``sinamics-g120``. Who asks for many
    words makes a :class:`Vocabulary` of the candidates first.
    """
    from difflib import get_close_matches

    known = candidates if isinstance(candidates, Vocabulary) else Vocabulary(candidates)
    wanted = word.lower()
    pool = known.like(wanted)
    hits = [
        hit
        for hit in get_close_matches(wanted, pool, n=3, cutoff=0.6)
        if one_letter_wrong(wanted, hit) or _few_changes(wanted, hit)
    ][:1]
    if not hits and len(word) >= _LEAST:
        parts = [one for one in pool if wanted in one.replace("_", "-").split("-")]
        hits = parts if len(parts) == 1 else []
    return [known.by_lower[hit] for hit in hits]


def _few_changes(word: str, meant: str) -> bool:
    """Whether a third of the letters at most is wrong: ``every`` shares most of its letters with ``verify``.

    One that begins the same for half of its length is near, too: ``read_them`` and ``read_it``.
    """
    half = (max(len(word), len(meant)) + 1) // 2
    if word[:half] == meant[:half] and half <= min(len(word), len(meant)):
        return True
    row = list(range(len(meant) + 1))
    for at, letter in enumerate(word, 1):
        last, row[0] = row[0], at
        for place, other in enumerate(meant, 1):
            last, row[place] = row[place], min(row[place] + 1, row[place - 1] + 1, last + (letter != other))
    return 3 * row[-1] <= max(len(word), len(meant)) + 1


def did_you_mean(word: str, candidates: Iterable[str]) -> str:
    """``did you mean "x"?`` or an empty string."""
    hits = near(word, candidates)
    return f'did you mean "{hits[0]}"?' if hits else ""


def one_letter_wrong(word: str, meant: str) -> bool:
    """Whether one letter of a word is wrong, missing, too many or changed places with its neighbour."""
    if len(word) < len(meant):
        word, meant = meant, word
    at = next((n for n, (one, other) in enumerate(zip(word, meant, strict=False)) if one != other), len(meant))
    if len(word) > len(meant):
        return word[at + 1 :] == meant[at:]
    swapped = word[at : at + 2] == meant[at : at + 2][::-1] and word[at + 2 :] == meant[at + 2 :]
    return word != meant and (word[at + 1 :] == meant[at + 1 :] or swapped)


def job_hint(name: str, known: Collection[str]) -> str:
    """Which jobs there are where ``name`` is none: those of that name on several drives, else near ones, and all."""
    of_drives = [key for key in known if key.startswith(f"{name}.")]
    if of_drives:
        return f"it is on several drives: {', '.join(of_drives)}"
    return f"{did_you_mean(name, known)} jobs of this spec: {', '.join(known)}".strip()
