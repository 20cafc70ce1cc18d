"""The outline of a text that may be broken says the same as the reader where the text is sound."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from plcgen.base.diagnostics import Report
from plcgen.base.files.yaml import YamlNode, parse_yaml
from plcgen.workbench.service.positions import from_units, split_lines, to_units, width
from plcgen.workbench.service.specs.sketch import sketch
from tests.projects import ROOT

SHIPPED = sorted((ROOT / "specs").rglob("*.yaml"))


def _read(node: YamlNode, path: tuple[str | int, ...] = ()) -> Iterator[tuple[object, ...]]:
    for key, (place, value) in node.pairs.items():
        if place.value is not None and not str(place.value).startswith("\0"):
            yield (*path, key), place.span.line, place.span.column
        if value.span.line >= place.span.line:  # an alias stands elsewhere
            yield from _read(value, (*path, key))
    for n, value in enumerate(node.items):
        yield from _read(value, (*path, n))


@pytest.mark.parametrize("path", SHIPPED, ids=lambda path: path.stem)
def test_keys_are_those_of_the_reader(path: Path) -> None:
    """Every key of every shipped spec, profile and CPU table at its line and column, and none that is not there."""
    text = path.read_text("utf-8-sig")
    root = parse_yaml(text, "f", Report())
    assert root is not None
    found = {
        (one.path, one.key.line, one.key.column) for one in sketch(text, "f").entries if isinstance(one.path[-1], str)
    }
    assert set(_read(root)) - found == set()
    if "*" not in text and "<<" not in text:
        assert found - set(_read(root)) == set()


@pytest.mark.parametrize("path", SHIPPED[:6], ids=lambda path: path.stem)
def test_no_prefix_of_a_text_fails(path: Path) -> None:
    """A text that is cut anywhere, as while it is typed, has an outline and a spot at its end."""
    text = path.read_text("utf-8-sig")[:3000]
    for end in range(0, len(text), 7):
        lines = split_lines(text[:end])
        sketch(text[:end], "f").at(len(lines), len(lines[-1]) + 1)


BROKEN = [
    ("plc: {name: A, fam\ndrives:\n  one: {device: x}\n", ("drives", "one", "device")),
    ('plc: {name: "A\ndrives:\n  one: {device: x}\n', ("drives", "one", "device")),
    ("jobs:\n  a: {write: {P1: [1,\n  b:\n    drive: x\n", ("jobs", "b", "drive")),
    ('plc:\n  name: "A\ndrives:\n  one: {device: x}\n', ("drives", "one", "device")),
    ("plc:\n  name: >\n    A: [\n\ndrives:\n  one: {device: x}\n", ("drives", "one", "device")),
    ("jobs:\n  a:\n    wri\n  b:\n    drive: x\n", ("jobs", "b", "drive")),
    ("a: }\nb: ]\njobs:\n  b:\n    drive: x\n", ("jobs", "b", "drive")),
]


@pytest.mark.parametrize(("text", "path"), BROKEN)
def test_what_follows_a_break_is_found(text: str, path: tuple[str, ...]) -> None:
    """A bracket or a quote that is left open ends where a line begins no deeper than its key."""
    assert sketch(text, "f").value(*path) == "x"


def test_columns_in_utf16() -> None:
    """U+1F527 has two units (RFC 2781, 2.1: D83D DD27); a position inside it is its beginning; ß and 泵 have one."""
    lines = ["a: ß泵\U0001f527 b"]
    assert width("\U0001f527") == 2
    assert to_units(lines, 1, 7) == (0, 7)  # a, colon, blank, ß, 泵 before the sixth character, which takes two
    assert from_units(lines, 0, 7) == (1, 7)
    assert from_units(lines, 0, 6) == (1, 6)
    assert from_units(lines, 0, 99) == (1, 9)
    assert from_units(lines, 7, 0) == (1, 9)
    assert to_units(lines, 0, 0) == (0, 0)
    assert to_units(lines, 1, 7, "utf-8") == (0, 12)  # 3 + 2 + 3 + 4 bytes
    assert from_units(lines, 0, 12, "utf-8") == (1, 7)
    assert from_units(lines, 0, 6, "utf-32") == (1, 7)
