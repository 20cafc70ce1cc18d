"""Good files in which one value or one key after the other is something else than belongs there."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from typing import Any

Path = tuple[str | int, ...]
HERE = "\N{EMPTY SET}"
"""Stands where something is put in; no file has it."""
VALUES = {
    "null": "null", "a list": "[1, a]", "an empty list": "[]", "a list of nothing": "[null]", "lists": "[[[1]]]",
    "mappings": "[{}, {a: 1}]", "a mapping": "{a: {b: c}}", "an empty mapping": "{}", "a null key": "{null: null}",
    "zero": "0", "negative": "-1", "a fraction": "1.5", "huge": "1e308", "39 digits": "9" * 39,
    "2**63": str(2**63), "5,000 digits": "9" * 5000, "true": "true", "false": "false", "a date": "2026-11-01",
    "empty": '""', "a blank": '" "', "a long text": '"' + "x" * 5000 + '"', "a long word": "x" * 5000, "a word": "zq",
    "hexadecimal": "16#FF", "10,000 lists": "[" * 10_000 + "]" * 10_000, "10,000 mappings": "{a: " * 10_000,
    "35 lists": "[" * 35 + "]" * 35, "no anchor": "*none", "itself": "&s [*s]", "twice the same": "[&t {a: 1}, *t]",
    "merged": "{<<: {a: 1}}", "merged with text": "{<<: a}", "a tag": "!!set {a}", "a list as key": "{[1]: 2}",
}  # fmt: skip
KEYS = {
    "null": "null", "true": "true", "a number": "1", "negative": "-1", "a fraction": "1.5", "a date": "2026-11-01",
    "empty": '""', "a blank": '" "', "a long text": '"' + "x" * 5000 + '"', "a list": "[1]", "a mapping": "{a: 1}",
    "merged": "<<", "an expression": '"a b.c[1]: {}"', "10,000 lists": "[" * 10_000 + "]" * 10_000,
    "no anchor": "*none",
}  # fmt: skip


def places(data: Any, path: Path = ()) -> Iterator[Path]:
    """The way to every value of a file, that of the whole first."""
    yield path
    pairs = data.items() if isinstance(data, dict) else enumerate(data) if isinstance(data, list) else ()
    for key, value in pairs:
        yield from places(value, (*path, key))


def at(data: Any, path: Path) -> Any:
    """The value at a place."""
    for step in path:
        data = data[step]
    return data


def wrong_files(data: Any, path: Path) -> Iterator[tuple[str, str]]:
    """The file with something else at a place, as YAML, each with what it is."""
    text = json.dumps(_changed(data, path, HERE), indent=1, ensure_ascii=False)
    yield from ((what, text.replace(f'"{HERE}"', shape)) for what, shape in VALUES.items())
    if path and isinstance(path[-1], str):
        twice = json.dumps({path[-1]: at(data, path)}, ensure_ascii=False)[1:-1]
        yield "there twice", text.replace(f'"{HERE}"', f"1, {twice}")
        text = json.dumps(_changed(data, path, HERE, key=True), indent=1, ensure_ascii=False)
        yield from ((f"{what} as key", text.replace(f'"{HERE}"', shape)) for what, shape in KEYS.items())


def _changed(data: Any, path: Sequence[str | int], new: str, *, key: bool = False) -> Any:
    """The data with something new at a place, or with a new name of it."""
    if not path:
        return new
    first, *rest = path
    last = key and not rest
    if isinstance(data, dict):
        pairs = ((new if last and name == first else name, name, value) for name, value in data.items())
        return {
            shown: value if name != first or last else _changed(value, rest, new, key=key)
            for shown, name, value in pairs
        }
    return [_changed(value, rest, new, key=key) if number == first else value for number, value in enumerate(data)]
