"""Random data blocks: nothing differs from itself, and what is reported as moved is what a second calculation says."""

from __future__ import annotations

import re
import tempfile
from pathlib import Path

from hypothesis import given, settings
from hypothesis import strategies as st

import plcgen

TYPES = {"Byte": (8, 8), "Bool": (1, 1), "Word": (16, 16), "Real": (32, 16), "String[5]": (56, 16), "DTL": (96, 16)}
"""Size and alignment in bits, as the rules of standard access say."""

members = st.lists(st.sampled_from(sorted(TYPES)), min_size=1, max_size=12)


def offsets(types: list[tuple[str, str]]) -> dict[str, int]:
    """Offsets in bits by name, by hand: next free bit, byte or word."""
    found, free = {}, 0
    for name, type_ in types:
        size, align = TYPES[type_]
        free = -(-free // align) * align
        found[name] = free
        free += size
    return found


def source(types: list[tuple[str, str]]) -> str:
    body = "".join(f"  {name} : {type_};\n" for name, type_ in types)
    return f'DATA_BLOCK "B"\nSTRUCT\n{body}END_STRUCT;\nBEGIN\nEND_DATA_BLOCK\n'


def write(folder: Path, types: list[tuple[str, str]]) -> Path:
    folder.mkdir()
    (folder / "b.db").write_text(source(types), encoding="utf-8")
    return folder


def place(bits: int) -> str:
    return f"{bits // 8}.{bits % 8}"


@settings(max_examples=60)
@given(members, st.data())
def test_moves_are_those_of_a_second_calculation(kinds, data):
    """Insert one member anywhere: exactly the members whose offset differs are named, each with both offsets."""
    old = [(f"m{n}", kind) for n, kind in enumerate(kinds)]
    at = data.draw(st.integers(0, len(old)))
    new = [*old[:at], ("added", data.draw(st.sampled_from(sorted(TYPES)))), *old[at:]]
    before, after = offsets(old), offsets(new)
    expected = {
        f"{name} {place(before[name])} -> {place(after[name])}" for name in before if before[name] != after[name]
    }
    with tempfile.TemporaryDirectory() as folder:
        root = Path(folder)
        result = plcgen.diff(write(root / "old", old), write(root / "new", new))
        plcgen.lock(root / "old", out=root / "x.lock.json")
        locked = plcgen.check_lock(root / "new", lock=root / "x.lock.json")
        assert plcgen.check_lock(root / "old", lock=root / "x.lock.json").changes == ()
    for found in (result, locked):
        moved = set()
        for change in found.changes:
            if change.kind == "member-moved":
                moved |= set(change.details) or {f"{change.path} {change.old} -> {change.new}"}
        assert moved == expected
        assert [c.path for c in found.changes if c.kind == "member-added"] == ["added"]
        assert {c.kind for c in found.changes} <= {"member-moved", "member-added", "block-grown"}


@settings(max_examples=30)
@given(members)
def test_spelling_is_no_difference(kinds):
    """Blanks, letter case of types, comments of the file: nothing others notice."""
    old = [(f"m{n}", kind) for n, kind in enumerate(kinds)]
    with tempfile.TemporaryDirectory() as folder:
        first = write(Path(folder) / "old", old)
        second = write(Path(folder) / "new", old)
        path = second / "b.db"
        text = re.sub(r": (\w+)", lambda m: f"  :\n {m[1].upper()}", path.read_text("utf-8"))
        path.write_text(f"(* note *)\n{text}", encoding="utf-8")
        assert plcgen.diff(first, second).changes == ()
