"""Arguments of the functions that must be one of a few words: a type checker sees a typing mistake, Python does not."""

from __future__ import annotations

from collections.abc import Iterable

from plcgen.base.diagnostics import ArgumentError


def expect(name: str, value: str | None, words: Iterable[str]) -> None:
    """Raise ArgumentError unless an argument is None or one of its words: nothing less is done instead."""
    known = tuple(words)
    if value is not None and value not in known:
        raise ArgumentError(f"{name} is {value!r}; allowed: {', '.join(known)}")
