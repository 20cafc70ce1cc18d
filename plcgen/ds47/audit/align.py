"""Two rows of names side by side: the alignment with the most equal neighbours, as ``difflib`` writes it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

Opcode = tuple[Literal["equal", "replace", "delete", "insert"], int, int, int, int]
"""What to do with ``wanted[i:j]`` and ``have[k:n]``."""

MAX_CELLS = 1_000_000
_PAD_SCORE, _SCORE = 1, 4
"""A pad or reserve looks like any other: it must not pull real members away from their fields."""


def align(wanted: Sequence[str], have: Sequence[str]) -> list[Opcode]:
    """Opcodes that turn ``wanted`` into ``have``; equal ones first wherever there is a choice.

    The longest common subsequence by weight, of at most ``MAX_CELLS`` comparisons: what is longer is cut.
    """
    have = have[: MAX_CELLS // max(len(wanted), 1)]
    best = [[0] * (len(have) + 1) for _ in range(len(wanted) + 1)]
    for i in range(len(wanted) - 1, -1, -1):
        row, below = best[i], best[i + 1]
        score = _PAD_SCORE if wanted[i] == "pad" else _SCORE
        for k in range(len(have) - 1, -1, -1):
            skipped = max(below[k], row[k + 1])
            row[k] = max(skipped, score + below[k + 1]) if wanted[i] == have[k] else skipped
    codes: list[Opcode] = []
    i = k = 0
    while i < len(wanted) or k < len(have):
        first, second = i, k
        while i < len(wanted) and k < len(have) and _together(best, wanted, have, i, k):
            i, k = i + 1, k + 1
        if i > first:
            codes.append(("equal", first, i, second, k))
            continue
        while (i < len(wanted) or k < len(have)) and not _together(best, wanted, have, i, k):
            if k == len(have) or (i < len(wanted) and best[i + 1][k] >= best[i][k + 1]):
                i += 1
            else:
                k += 1
        tag: Literal["replace", "delete", "insert"] = "replace"
        if i == first or k == second:
            tag = "insert" if i == first else "delete"
        codes.append((tag, first, i, second, k))
    return codes


def _together(best: list[list[int]], wanted: Sequence[str], have: Sequence[str], i: int, k: int) -> bool:
    """Whether the best alignment pairs these two."""
    if i >= len(wanted) or k >= len(have) or wanted[i] != have[k]:
        return False
    score = _PAD_SCORE if wanted[i] == "pad" else _SCORE
    return best[i][k] == score + best[i + 1][k + 1]
