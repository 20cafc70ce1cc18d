"""How messages count."""

from __future__ import annotations


def counted(number: int, noun: str, plural: str = "") -> str:
    """``1 byte``, ``2 bytes``; with a plural of its own ``2 retries``."""
    return f"{number} {noun if number == 1 else plural or f'{noun}s'}"
