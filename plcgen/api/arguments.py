"""Arguments of the functions that must be one of a few words: a type checker sees a typing mistake, Python does not."""

from __future__ import annotations

from collections.abc import Iterable


def expect(name: str, value: str | None, words: Iterable[str]) -> None:
    """Raise ValueError unless an argument is None or one of its words: nothing is done less thoroughly than asked."""
    known = tuple(words)
    if value is not None and value not in known:
        raise ValueError(f"{name} is {value!r}; there are {', '.join(known)}")
