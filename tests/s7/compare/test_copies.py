"""A copy of a folder elsewhere is the same, to diff and to a lock: whatever its shape, its names and its values."""

from __future__ import annotations

import shutil
import tempfile
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import plcgen
from tests.s7.xml.reading.documents import document, function_block, sections

PLACES = ("", "Program blocks", "Program blocks/Line", "PLC_1/Program blocks", "PLC_2/Program blocks", "lib")
PLACES += ("Sub/PLC_1/Program blocks", "PLC data types", "PLC_1/Software units/U/Program blocks", "ä b/c,d")
ELSEWHERE = ("copy", "deeper/than/before", "Program blocks/x", "PLC_2/PLC tags/copy", "ä (1)")
MARKS = "aB1_ .,:;#%&'()[]{}=+-*/!?|<>@`~^äß中"
names = st.text(MARKS, min_size=1, max_size=8).filter(lambda name: name == name.strip())
values = st.text(MARKS + '"$', max_size=8)
types = st.sampled_from(["Int", "Bool", "Real", "String[20]", "WString[9]", "Array[0..2] of Int", "DTL"])


@st.composite
def member_lists(draw, depth=2):
    """Declarations of members with any names, attributes and start values."""
    lines = []
    for name in draw(st.lists(names, min_size=1, max_size=4, unique_by=str.upper)):
        kind = draw(types)
        attribute = ""
        if draw(st.booleans()):
            text = draw(values).replace("$", "").replace("'", "").replace('"', "")
            attribute = f" {{S7_m_c := '{text}'}}"
        if depth and draw(st.booleans()):
            inner = draw(member_lists(depth=depth - 1))
            array = draw(st.sampled_from(["", "Array[1..2] of "]))
            lines.append(f'"{name}"{attribute} : {array}Struct\n{inner}END_STRUCT;\n')
            continue
        start = ""
        if "String" in kind:
            text = draw(values).replace("$", "$$").replace("'", "$'")
            start = f" := {'WSTRING#' if kind[0] == 'W' else ''}'{text}'"
        elif kind in {"Int", "Bool"}:
            start = f" := {draw(st.integers(0, 1))}"
        lines.append(f'"{name}"{attribute} : {kind}{start};\n')
    return "".join(lines)


@st.composite
def folders(draw):
    """Files by path: data blocks, some with the same names in several PLCs, and instances of a type."""
    found = {}
    for number, place in enumerate(draw(st.lists(st.sampled_from(PLACES), min_size=1, max_size=4, unique=True))):
        body = draw(member_lists())
        name = draw(names)
        udt = f'TYPE "t{number}{name}"\nSTRUCT\n{body}END_STRUCT;\nEND_TYPE\n'
        db = f'DATA_BLOCK "d{number}{name}"\nSTRUCT\n{body}"of {name}" : "t{number}{name}";\nEND_STRUCT;\nBEGIN\n'
        db += "END_DATA_BLOCK\n"
        fb = f'FUNCTION_BLOCK "f{number}{name}"\nVAR_INPUT\n{body}END_VAR\nBEGIN\n;\nEND_FUNCTION_BLOCK\n'
        instance = f'DATA_BLOCK "i{number}{name}"\n"f{number}{name}"\nBEGIN\nEND_DATA_BLOCK\n'
        found[f"{place}/x{number}.scl".lstrip("/")] = udt + db + fb + instance
        if place in {"Program blocks", "PLC_1/Program blocks", "PLC_2/Program blocks"}:
            found[f"{place}/same.db"] = 'DATA_BLOCK "Same"\nSTRUCT\na : Int;\nEND_STRUCT;\nBEGIN\nEND_DATA_BLOCK\n'
    return found


def write(root: Path, files: dict[str, str]) -> Path:
    for path, text in files.items():
        (root / path).parent.mkdir(parents=True, exist_ok=True)
        (root / path).write_text(text, encoding="utf-8-sig")
    return root


@settings(max_examples=40, deadline=None)
@given(folders(), st.sampled_from(ELSEWHERE))
def test_a_copy_is_the_same(files, elsewhere):
    """Nothing differs, and a lock of one is green with the other."""
    with tempfile.TemporaryDirectory() as place:
        root = Path(place)
        old = write(root / "before", files)
        new = root / elsewhere
        shutil.copytree(old, new)
        result = plcgen.diff(old, new)
        assert [d for d in result.diagnostics if d.severity.label == "error"] == []
        assert result.changes == ()
        assert result.compared >= 4 * len([path for path in files if not path.endswith("same.db")])
        lock = root / "x.lock.json"
        written = plcgen.lock(old, out=lock)
        assert written.ok, written.diagnostics
        for checked in (plcgen.check_lock(lock=lock), plcgen.check_lock(new, lock=lock)):
            assert (checked.changes, checked.readable) == ((), True)


def test_a_plc_at_the_root_and_another_below(tmp_path):
    """The one at the root has the names of its blocks alone, the other its folder before them."""
    text = 'DATA_BLOCK "Same"\nSTRUCT\na : {};\nEND_STRUCT;\nBEGIN\nEND_DATA_BLOCK\n'
    files = {"Program blocks/s.db": text.format("Int"), "PLC_2/Program blocks/s.db": text.format("Real")}
    old = write(tmp_path / "old", files)
    new = write(tmp_path / "new", files | {"PLC_2/Program blocks/s.db": text.format("DInt")})
    changes = plcgen.diff(old, new).changes
    assert [(c.kind, c.subject) for c in changes] == [("type-changed", 'DB "PLC_2/Same"')]


@pytest.mark.parametrize("name", ["User1.Text", "a[1]", "a.b[2].c", "b}{c", "a := b"])
def test_names_that_look_like_paths(name, tmp_path):
    """A change inside is found in the member that has it, from a lock as well."""
    text = 'DATA_BLOCK "B"\nSTRUCT\na : Int;\ns : STRUCT\n"{}" : Int := {};\nEND_STRUCT;\nEND_STRUCT;\nBEGIN\n'
    text += "END_DATA_BLOCK\n"
    old = write(tmp_path / "old", {"b.db": text.format(name, 1)})
    new = write(tmp_path / "new", {"b.db": text.format(name, 2)})
    lock = tmp_path / "x.lock.json"
    assert plcgen.lock(old, out=lock).ok
    for result in (plcgen.diff(old, new), plcgen.check_lock(new, lock=lock)):
        (change,) = result.changes
        assert (change.kind, name in change.path) == ("start-value", True)


def test_a_broken_file_is_left_out_if_asked(tmp_path):
    """One unreadable document blocks diff and lock; with keep_going the rest is compared, and that is said."""
    text = 'DATA_BLOCK "B"\nSTRUCT\na : Int := {};\nEND_STRUCT;\nBEGIN\nEND_DATA_BLOCK\n'
    broken = {"c.xml": "<Document>", "d.scl": 'FUNCTION_BLOCK "F"\nVAR\na : Int;\nBEGIN\nEND_FUNCTION_BLOCK\n'}
    old = write(tmp_path / "old", {"b.db": text.format(1), **broken})
    new = write(tmp_path / "new", {"b.db": text.format(2), **broken})
    lock = tmp_path / "x.lock.json"
    assert not plcgen.diff(old, new).readable
    assert not plcgen.lock(old, out=lock).ok
    written = plcgen.lock(old, out=lock, keep_going=True)
    assert (written.ok, written.blocks) == (True, 1)
    for result in (plcgen.diff(old, new, keep_going=True), plcgen.check_lock(new, lock=lock, keep_going=True)):
        assert result.readable
        assert [change.kind for change in result.changes] == ["start-value"]
        left_out = {Path(d.span.file).name for d in result.diagnostics if d.message.startswith("left out: ")}
        assert left_out == {"c.xml", "d.scl"}


def test_blocks_with_graphical_networks_are_one_line(tmp_path):
    """Hundreds of blocks in LAD are one note, with how many they are."""
    for side in ("old", "new"):
        for number in range(3):
            block = function_block(sections(Input=""), '<FlgNet xmlns="urn:net" />').replace(
                "<Name>", f"<Name>B{number}"
            )
            write(tmp_path / side, {f"b{number}.xml": document(block).decode("utf-8-sig")})
    result = plcgen.diff(tmp_path / "old", tmp_path / "new")
    notes = [d.message for d in result.diagnostics if d.code == "PG814"]
    assert len(notes) == 2  # one for each side
    assert all(note.startswith("networks of 3 blocks, in LAD or FBD, are not read") for note in notes)


def test_a_tag_table_in_two_versions(tmp_path):
    """The first one counts, the other is told like a block that is declared twice; the lock agrees with itself."""
    table = (
        '<Document><Engineering version="V18" /><SW.Tags.PlcTagTable ID="0"><AttributeList><Name>Tags</Name>'
        '</AttributeList><ObjectList><SW.Tags.PlcTag ID="1" CompositionName="Tags"><AttributeList>'
        "<DataTypeName>Bool</DataTypeName><LogicalAddress>%M{}.0</LogicalAddress><Name>go</Name></AttributeList>"
        "</SW.Tags.PlcTag></ObjectList></SW.Tags.PlcTagTable></Document>"
    )
    old = write(tmp_path / "old", {"a/t.xml": table.format(5), "b/t.xml": table.format(6)})
    shutil.copytree(old, tmp_path / "new")
    lock = tmp_path / "x.lock.json"
    assert [d.code for d in plcgen.lock(old, out=lock).diagnostics] == ["PG805"]
    written = plcgen.lock(old, out=lock, keep_going=True)
    assert (written.ok, written.blocks) == (True, 1)
    checked = plcgen.check_lock(lock=lock, keep_going=True)
    compared = plcgen.diff(old, tmp_path / "new", keep_going=True)
    assert [(result.changes, result.readable) for result in (checked, compared)] == [((), True)] * 2
