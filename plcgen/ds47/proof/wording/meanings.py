"""What each byte of a telegram means, stated a second time by its place in data set 47.

Sources: SINAMICS S120 Function Manual Communication, 12/2018, section 3.4 (header, address, values, word alignment,
format 44h of errors). The numbers of the parameters come from the bytes of the request.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

HEADER, ADDRESS, REFUSED = 4, 6, 6
"""Bytes of a header, of an address, and of a parameter that is refused with two error words."""
CHANGE = 0x02
_ASKED = ("request reference 1..255", "01h = read, 02h = write", "drive object (axis)", "number of parameters")
_ANSWERED = (
    "mirrored request reference", "01h/02h = good, 81h/82h = error", "mirrored drive object", "number of parameters",
)  # fmt: skip
_PLACE = ((0, "10h = value"), (1, "number of elements"), (2, "parameter number"), (4, "subindex"))
_REFUSED = ((0, "44h = error"), (1, "number of error words"), (2, "error number"), (4, "second error word"))
_SPARE = frozenset({"room for the longest error answer", "pad byte"})


@dataclass(frozen=True, slots=True)
class AskedValue:
    """The values of one parameter in a telegram: their bytes, what documents call it, what they may say of it."""

    size: int
    label: str
    texts: frozenset[str]


def numbers(request: bytes) -> list[int]:
    """Numbers of the parameters that a request names, as its bytes have them."""
    places = range(HEADER + 2, HEADER + ADDRESS * request[3], ADDRESS)
    return [int.from_bytes(request[at : at + 2]) for at in places]


def subindices(request: bytes) -> list[int]:
    """First subindex of each of them."""
    places = range(HEADER + 4, HEADER + ADDRESS * request[3], ADDRESS)
    return [int.from_bytes(request[at : at + 2]) for at in places]


class Meanings(dict[int, frozenset[str]]):
    """Texts that a member may have, by its byte; behind the end of what is known lies what is spare."""

    def __missing__(self, offset: int) -> frozenset[str]:
        return _SPARE


def of_request(request: bytes, values: Sequence[AskedValue]) -> Meanings:
    """Every byte of a request."""
    found = Meanings((at, frozenset({text})) for at, text in enumerate(_ASKED))
    for number, value in enumerate(values):
        found.update(_at(HEADER + ADDRESS * number, value.label, _PLACE))
    if request[1] == CHANGE:
        found.update(_values(HEADER + ADDRESS * len(values), values))
    return found


def of_answer(request: bytes, values: Sequence[AskedValue]) -> Meanings:
    """Every byte of the answer to a request; a change of one parameter has its error words by name."""
    found = Meanings((at, frozenset({text})) for at, text in enumerate(_ANSWERED))
    if request[1] != CHANGE:
        found.update(_values(HEADER, values))
    elif len(values) == 1:
        found.update((at, texts | _SPARE) for at, texts in _at(HEADER, "", _REFUSED))
    return found


def lengths(request: bytes, values: Sequence[AskedValue]) -> tuple[int, int]:
    """Bytes of the good answer and of the longest one: each parameter may be refused with two error words."""
    if request[1] == CHANGE:
        return HEADER, HEADER + REFUSED * len(values)
    blocks = [2 + value.size + value.size % 2 for value in values]
    return HEADER + sum(blocks), HEADER + sum(max(block, REFUSED) for block in blocks)


def _at(offset: int, label: str, rows: Sequence[tuple[int, str]]) -> Iterator[tuple[int, frozenset[str]]]:
    return ((offset + at, frozenset({f"{label} {text}".strip()})) for at, text in rows)


def _values(at: int, values: Sequence[AskedValue]) -> Iterator[tuple[int, frozenset[str]]]:
    for value in values:
        yield from _at(at, value.label, ((0, "data format"), (1, "number of values")))
        yield at + 2, value.texts
        if value.size % 2:
            yield at + 2 + value.size, frozenset({f"{value.label} pad byte"})
        at += 2 + value.size + value.size % 2
