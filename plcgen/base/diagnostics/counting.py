"""How messages count and list."""

from __future__ import annotations

from collections.abc import Sequence


def quantity(number: int, noun: str, plural: str = "") -> str:
    """``1 byte``, ``2 bytes``; with a plural of its own ``2 retries``."""
    return f"{number} {noun if number == 1 else plural or f'{noun}s'}"


def shortlist(items: Sequence[str], most: int, more: str = ", ..") -> str:
    """``a, b, ..``: the first ones, and ``more`` if there are others."""
    return ", ".join(items[:most]) + (more if len(items) > most else "")
