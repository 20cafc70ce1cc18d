"""What one telegram holds while a plan is made: pieces of memory, joined where that makes it shorter.

A piece is atomic: the value of one asked item must come in one telegram, or its bytes might be of different scans.
"""

from __future__ import annotations

import itertools
from bisect import bisect_left
from dataclasses import dataclass

from plcgen.ppi.wire.areas import ITEM_LIMIT, ITEM_SIZE, JOB_HEADER, PDU_LIMIT, REPLY_HEADER, VALUE_HEADER

Span = tuple[int, int]
"""Bytes of an area: first and behind the last."""


@dataclass(frozen=True, slots=True)
class PackingRules:
    """What a telegram may hold: bytes of its header, of an item besides the value, both limits, the bridged gap.

    A gap of up to ``bridge`` bytes between two spans is included in one item if that makes no telegram longer. Bytes
    between two writes are never included.
    """

    header: int
    item: int
    bridge: int
    limit: int = PDU_LIMIT
    most: int = ITEM_LIMIT

    @property
    def room(self) -> int:
        """Longest value of a telegram with one item."""
        return self.limit - self.header - self.item


READING = PackingRules(REPLY_HEADER + 2, VALUE_HEADER, bridge=4)
"""The answer is the longer telegram: 12 + 2, then 4 and the value for each item."""

WRITING = PackingRules(JOB_HEADER + 2, ITEM_SIZE + VALUE_HEADER, bridge=0)
"""The request is the longer telegram: 10 + 2, then 12 + 4 and the value for each item."""

WORTH_BRIDGING = ITEM_SIZE + VALUE_HEADER
"""A gap of fewer bytes costs less on the line than another item in request and answer."""


@dataclass(frozen=True, slots=True)
class MemoryPiece:
    """One value or part of it: area, bytes, and the asked items (with the offset of the part) that it serves.

    ``joins`` is False for what must stay an item of its own: timers, counters, and bits that are written.
    """

    area: int
    span: Span
    serves: tuple[tuple[int, int], ...]
    joins: bool = True

    @property
    def size(self) -> int:
        """Bytes of the piece."""
        return self.span[1] - self.span[0]


@dataclass(frozen=True, slots=True)
class Load:
    """Pieces of one telegram, the spans they make (by area, in order) and the sizes of those that stay alone."""

    rules: PackingRules
    pieces: tuple[MemoryPiece, ...] = ()
    spans: tuple[tuple[int, tuple[Span, ...]], ...] = ()
    single: tuple[int, ...] = ()

    def sizes(self) -> list[int]:
        """Lengths of the values, without pads."""
        return [end - start for _, spans in self.spans for start, end in spans] + list(self.single)

    def adding(self, piece: MemoryPiece) -> Load | None:
        """Return the load with one more piece, None if that is too much for a telegram."""
        pieces = (*self.pieces, piece)
        if not piece.joins:
            return Load(self.rules, pieces, self.spans, (*self.single, piece.size)).fitting()
        before = dict(self.spans)
        before[piece.area] = _insert(before.get(piece.area, ()), piece.span, self.rules.bridge)
        return Load(self.rules, pieces, tuple(before.items()), self.single).fitting()

    def fitting(self) -> Load | None:
        """Return the load, with more spans joined if there are too many items; None if it is too long."""
        load: Load | None = self
        while load is not None and len(load.sizes()) > self.rules.most:
            load = load.joined(None)
        return load if load is not None and load.length() <= self.rules.limit else None

    def length(self) -> int:
        """Length of the PDU: values are padded, except one odd one that comes last."""
        sizes = self.sizes()
        padded = sum(self.rules.item + size + size % 2 for size in sizes)
        return self.rules.header + padded - any(size % 2 for size in sizes)

    def joined(self, widest: int | None) -> Load | None:
        """Return the load with the two nearest spans joined; None for writes and gaps of ``widest`` or more."""
        gaps = [
            (right[0] - left[1], area, index)
            for area, spans in self.spans
            for index, (left, right) in enumerate(itertools.pairwise(spans))
        ]
        if not gaps or not self.rules.bridge:
            return None
        gap, area, index = min(gaps)
        if widest is not None and gap >= widest:
            return None
        spans = dict(self.spans)
        row = spans[area]
        spans[area] = (*row[:index], (row[index][0], row[index + 1][1]), *row[index + 2 :])
        return Load(self.rules, self.pieces, tuple(spans.items()), self.single)

    def settled(self) -> Load:
        """Return the load with further spans joined as long as that saves bytes on the line and fits."""
        load = self
        while True:
            wider = load.joined(WORTH_BRIDGING)
            if wider is None or wider.length() > self.rules.limit:
                return load
            load = wider


def _insert(spans: tuple[Span, ...], new: Span, bridge: int) -> tuple[Span, ...]:
    """Insert a span in order and join it with those that overlap it or are at most ``bridge`` bytes away."""
    at = bisect_left(spans, new)
    start, end = new
    first = at
    while first > 0 and spans[first - 1][1] + bridge >= start:
        first -= 1
        start, end = min(start, spans[first][0]), max(end, spans[first][1])
    last = at
    while last < len(spans) and spans[last][0] <= end + bridge:
        end = max(end, spans[last][1])
        last += 1
    return (*spans[:first], (start, end), *spans[last:])


def distribute(pieces: list[MemoryPiece], rules: PackingRules) -> list[Load]:
    """Distribute pieces over the fewest loads.

    Simple ways of filling come first. If they need more than the number of bytes demands, all distributions with one
    load fewer are tried, up to ``_BUDGET`` steps: small sets are solved exactly. Every piece must fit a load alone.
    """
    if not pieces:
        return []
    ordered = sorted(pieces, key=lambda piece: (piece.area, piece.span))
    best = _next_fit(ordered, rules)
    if len(best) > 1 and len(pieces) <= _MANY:
        largest = sorted(pieces, key=lambda piece: -piece.size)
        best = min(best, _first_fit(ordered, rules), _first_fit(largest, rules), key=len)
        least = least_loads(pieces, rules)
        while len(best) > least:
            fewer = _Search(largest, rules, len(best) - 1, _BUDGET).run()
            if fewer is None:
                break
            best = fewer
    return best


_BUDGET = 4000
_MANY = 400
"""Pieces up to which more than one way of filling is tried."""


def least_loads(pieces: list[MemoryPiece], rules: PackingRules) -> int:
    """Return a number of loads that no distribution can be under: every byte is sent at least once."""
    spans: dict[int, tuple[Span, ...]] = {}
    total = 0
    for piece in pieces:
        if piece.joins:
            spans[piece.area] = _insert(spans.get(piece.area, ()), piece.span, 0)
        else:
            total += piece.size
    total += sum(end - start for row in spans.values() for start, end in row)
    return max(1, -(-total // rules.room))


def _next_fit(pieces: list[MemoryPiece], rules: PackingRules) -> list[Load]:
    done: list[Load] = []
    current = Load(rules)
    for piece in pieces:
        more = current.adding(piece)
        if more is None:
            done.append(current)
            more = _alone(rules, piece)
        current = more
    return [*done, current]


def _first_fit(pieces: list[MemoryPiece], rules: PackingRules) -> list[Load]:
    loads: list[Load] = []
    for piece in pieces:
        for index, load in enumerate(loads):
            more = load.adding(piece)
            if more is not None:
                loads[index] = more
                break
        else:
            loads.append(_alone(rules, piece))
    return loads


def _alone(rules: PackingRules, piece: MemoryPiece) -> Load:
    load = Load(rules).adding(piece)
    if load is None:
        raise ValueError(f"a piece of {piece.size} bytes does not fit a telegram")
    return load


@dataclass(slots=True)
class _Search:
    """Depth-first search for a distribution over at most ``loads`` loads, the largest pieces first."""

    pieces: list[MemoryPiece]
    rules: PackingRules
    loads: int
    budget: int

    def run(self) -> list[Load] | None:
        """Return a distribution, None if there is none or the budget is used up."""
        return self._place(0, [])

    def _place(self, at: int, loads: list[Load]) -> list[Load] | None:
        if at == len(self.pieces):
            return loads
        piece = self.pieces[at]
        choices = range(min(len(loads) + 1, self.loads))
        for index in choices:
            self.budget -= 1
            if self.budget < 0:
                return None
            before = loads[index] if index < len(loads) else Load(self.rules)
            more = before.adding(piece)
            if more is None:
                continue
            found = self._place(at + 1, [*loads[:index], more, *loads[index + 1 :]])
            if found is not None:
                return found
        return None
