"""Nothing that a file says ends a line, hides or turns the direction of reading, wherever it stands.

The places are those of the JSON schemas, so that a new key cannot be forgotten. ``make hostile`` tries every character
at every place, ``make test`` one of them after the other.
"""

from __future__ import annotations

import os
import unicodedata
from collections.abc import Iterator
from itertools import cycle

from tests.doors import DOORS, schema_of
from tests.schema_walk import Place, Walk

HOSTILE = "PLCGEN_HOSTILE" in os.environ
CHARACTERS = [
    *map(chr, (*range(0x20), *range(0x7F, 0xA0))),  # controls
    *"\u2028\u2029",  # line and paragraph separator
    *"\u200e\u200f\u061c\u202a\u202b\u202c\u202d\u202e\u2066\u2067\u2068\u2069",  # direction of reading
    *"\u00ad\u180e\u200b\u200c\u200d\u2060\u2061\u2062\u2063\u2064\ufeff\ufff9\ufffa\ufffb",  # nothing to see
    *"\U000e0001\U000e0041",  # tags
    *"\u034f\u115f\u1160\u17b4\u17b5\u2800\u3164\uffa0",  # letters and marks that show nothing
    *"\ue000\ufffe\uffff\u0378",  # no characters, or nobody's
]
LEAST_HOSTILE, LEAST = 15_000, 1_000


WALKS = {kind: Walk(schema_of(kind)) for kind in DOORS}
"""What reads each kind of file, and the places in it."""
PLACES = [(kind, place) for kind, walk in WALKS.items() for place in walk.places]


def injections() -> Iterator[tuple[str, Place, str]]:
    """Kind of file, place and character; without ``make hostile`` as many of them that every place has two or more."""
    if HOSTILE:
        return ((kind, place, char) for kind, place in PLACES for char in CHARACTERS)
    rounds = -(-LEAST // len(PLACES)) + 1
    return ((kind, place, char) for (kind, place), char in zip(PLACES * rounds, cycle(CHARACTERS), strict=False))


def test_the_walk_comes_to_every_text() -> None:
    """No text of a schema is left out, and there are enough of them."""
    assert {kind: walk.missed() for kind, walk in WALKS.items()} == {kind: [] for kind in WALKS}
    assert len(PLACES) * len(CHARACTERS) >= LEAST_HOSTILE
    assert sum(1 for _ in injections()) >= (LEAST_HOSTILE if HOSTILE else LEAST)
    assert not [char for char in CHARACTERS if unicodedata.category(char)[0] not in "CZLMS"]


def test_no_place_takes_a_character_that_is_none_of_a_text() -> None:
    """An error stands in its line; where any other text would do, it names the character."""
    free = {each for each in PLACES if not _wrong(*each, "zq7x")}
    wrong = []
    for kind, place, char in injections():
        told = _wrong(kind, place, f"zq7{char}x")
        spelled = (f"U+{ord(char):04X}", f"\\u{ord(char):04X}", char)
        if not told or ((kind, place) in free and not any(each in one for one in told for each in spelled)):
            wrong.append(f"{kind} {place}: U+{ord(char):04X}: {told}")
    assert wrong == []
    assert len(free) > 100


def test_every_text_has_a_length() -> None:
    """A text of more than 2,000 characters is refused wherever one may stand."""
    assert [f"{kind} {place}" for kind, place in PLACES if not _wrong(kind, place, "z" * 2001)] == []


def _wrong(kind: str, place: Place, text: str) -> list[str]:
    """Messages of the errors in the line of a text at a place."""
    file, line = place.file(text)
    return [f"{found.message} {found.help}" for found in DOORS[kind](file) if found.span.line == line]
