"""A covering array: rows in which every pair of values occurs that is possible, and every triple of some dimensions."""

from __future__ import annotations

import random
from collections.abc import Callable, Mapping, Sequence
from itertools import combinations, product

Row = dict[str, str]
ATTEMPTS = 30
"""So often a row is begun again that has no way to its end."""
Possible = Callable[[Mapping[str, str]], bool]
"""Whether values of some dimensions go together."""


def cover(
    dimensions: Mapping[str, Sequence[str]], possible: Possible, triples: Sequence[tuple[str, str, str]] = ()
) -> list[Row]:
    """Rows that cover every possible pair and the given triples; always the same ones.

    Each begins with something that is not covered yet, and takes dimension by dimension the value that covers most.
    """
    sets = [*combinations(dimensions, 2), *triples]
    every = ((names, values) for names in sets for values in product(*(dimensions[name] for name in names)))
    missing = {one: None for one in every if possible(dict(zip(*one, strict=True)))}
    of: dict[str, list[tuple[str, ...]]] = {name: [one for one in sets if name in one] for name in dimensions}
    draw, rows = random.Random("cover"), []  # which of equal ones
    while missing:
        begin = next(iter(missing))
        for _ in range(ATTEMPTS):
            row = _row(dict(zip(*begin, strict=True)), dimensions, possible, of, missing, draw)
            if row is not None:
                rows.append(row)
                break
        missing.pop(begin)
        for one in sets if row is not None else ():
            missing.pop((one, tuple(row[name] for name in one)), None)
    return rows


def _row(
    row: Row,
    dimensions: Mapping[str, Sequence[str]],
    possible: Possible,
    of: Mapping[str, Sequence[tuple[str, ...]]],
    missing: Mapping[object, None],
    draw: random.Random,
) -> Row | None:
    left = [name for name in dimensions if name not in row]
    for name in draw.sample(left, len(left)):
        values = [value for value in dimensions[name] if possible({**row, name: value})]
        if not values:
            return None
        gains = {value: _gain({**row, name: value}, of[name], missing) for value in values}
        row[name] = max(draw.sample(values, len(values)), key=gains.__getitem__)
    return {name: row[name] for name in dimensions}


def _gain(row: Row, sets: Sequence[tuple[str, ...]], missing: Mapping[object, None]) -> int:
    return sum([(one, tuple(map(row.get, one))) in missing for one in sets])


def sample(rows: Sequence[Row]) -> list[Row]:
    """A few of the rows in which every value of every dimension occurs."""
    left = {item for row in rows for item in row.items()}
    found = []
    while left:
        best = max(rows, key=lambda row: len(left & row.items()))
        left -= best.items()
        found.append(best)
    return found
