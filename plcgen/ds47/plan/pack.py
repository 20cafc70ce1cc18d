"""Packing: the fewest telegrams that keep the order and the record limit in both directions.

The response is sized for the worst mixture of positive and negative blocks: a block never answers with more than
max(positive, 6) bytes, because an error block is ``44 02`` and two words.
"""

from __future__ import annotations

from collections.abc import Sequence

from plcgen.ds47.plan.access import Part, Use
from plcgen.ds47.wire.formats import padded
from plcgen.ds47.wire.model import ADDRESS_SIZE, HEADER_SIZE, MAX_ELEMENTS, negative_size

MAX_TELEGRAMS = 255
"""Telegrams of one job: each has a request reference of its own, 1 to 255."""
BLOCK_HEADER = 2
ERROR_BLOCK = 6


def request_length(parts: Sequence[Part], *, write: bool) -> int:
    """Exact length of the request in bytes."""
    values = sum(BLOCK_HEADER + padded(part.size) for part in parts) if write else 0
    return HEADER_SIZE + ADDRESS_SIZE * len(parts) + values


def positive_length(parts: Sequence[Part], *, write: bool) -> int:
    """Exact length of the fully positive response in bytes."""
    return HEADER_SIZE if write else HEADER_SIZE + sum(BLOCK_HEADER + padded(part.size) for part in parts)


def negative_length(parts: Sequence[Part]) -> int:
    """Length of the response in which every parameter failed with two error words."""
    return negative_size(len(parts))


def longest_response(parts: Sequence[Part], *, write: bool) -> int:
    """Longest possible response: every block as long as its worst answer."""
    return HEADER_SIZE + sum(_answer(part.size, write=write) for part in parts)


def _answer(size: int, *, write: bool) -> int:
    return ERROR_BLOCK if write else max(BLOCK_HEADER + padded(size), ERROR_BLOCK)


class _Open:
    """The telegram being filled."""

    def __init__(self, limit: int, most: int, elements: int, *, write: bool) -> None:
        self.limit, self.most, self.elements, self.write = limit, most, elements, write
        self.parts: list[Part] = []
        self.request = self.response = HEADER_SIZE

    def room(self, use: Use) -> int:
        """How many values of a use still fit."""
        if len(self.parts) >= self.most or self.request + ADDRESS_SIZE > self.limit:
            return 0
        if self.response + ERROR_BLOCK > self.limit:
            return 0
        if self.parts and self.parts[-1].use is use:
            return 0  # two slices of an array in one telegram would be two members of one name
        used = self.request + ADDRESS_SIZE if self.write else self.response
        free = self.limit - used - BLOCK_HEADER
        return max(0, min((free - free % 2) // use.format.size, self.elements))

    def add(self, part: Part) -> None:
        """Take a part in."""
        self.parts.append(part)
        self.request = request_length(self.parts, write=self.write)
        self.response = longest_response(self.parts, write=self.write)


def _fill(
    uses: Sequence[Use], limit: int, most: int, elements: int, *, write: bool, eager: bool
) -> list[tuple[Part, ...]] | None:
    """Fill telegrams front to back; ``eager`` splits arrays to use the room left. None: one value is too long."""
    done: list[tuple[Part, ...]] = []
    current = _Open(limit, most, elements, write=write)
    for use in uses:
        start = 0
        while start < use.count:
            left = use.count - start
            room = current.room(use)
            fits_alone = _Open(limit, most, elements, write=write).room(use)
            take = left if room >= left else 0
            if not take and use.divisible and (eager or left > fits_alone):
                take = min(room, left)
            if take:
                current.add(Part(use, start, take))
                start += take
            elif current.parts:
                done.append(tuple(current.parts))
                current = _Open(limit, most, elements, write=write)
            else:
                return None
    if current.parts:
        done.append(tuple(current.parts))
    return done


def pack(
    uses: Sequence[Use], limit: int, most: int, elements: int = MAX_ELEMENTS, *, write: bool
) -> list[tuple[Part, ...]] | None:
    """Distribute uses over telegrams of at most ``limit`` bytes and ``most`` parameters, order kept.

    A parameter has at most ``elements`` elements in one telegram.

    Filling front to back and splitting arrays wherever a telegram ends is optimal: it is never behind any other
    distribution after the same number of telegrams. Arrays stay whole if that costs no telegram.

    Returns:
        The parts of each telegram, or None if a single value does not fit.
    """
    eager = _fill(uses, limit, most, elements, write=write, eager=True)
    if eager is None or len(eager) == 1:
        return eager
    whole = _fill(uses, limit, most, elements, write=write, eager=False)
    return whole if whole is not None and len(whole) == len(eager) else eager
