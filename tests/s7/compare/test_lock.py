"""The lock file: its text, drift, and what hostile or edited ones do."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import pytest

import plcgen
from tests.projects import FAQ, ROOT, generated_example

SOURCE = """\
DATA_BLOCK "Motor"
{ S7_Optimized_Access := 'FALSE' }
NON_RETAIN
STRUCT
  run : Bool;
  ready {ExternalWritable := 'False'} : Bool;
  speed : Real := 10.0;
  limits : STRUCT
    low : Int;
    high : Int := 100;
  END_STRUCT;
  name : String[8] := 'a: b #c';
  table : Array[0..3] of Byte := [1, 2(2)];
END_STRUCT;
BEGIN
END_DATA_BLOCK
"""
# Offsets by hand: BOOLs 0.0 and 0.1, REAL even 2.0, STRUCT 6.0 with two INTs, STRING[8] takes 10 bytes from 10.0,
# ARRAY even 20.0, length 24.
LOCKED = """\
{{"kind": "DB", "name": "Motor", "hash": "{hash}", "bytes": 24, "access": "standard", "retain": false, "members": [
  {{"path": "run", "type": "BOOL", "offset": "0.0", "bits": 1}},
  {{"path": "ready", "type": "BOOL", "offset": "0.1", "bits": 1, "attributes": {{"EXTERNALWRITABLE": "FALSE"}}}},
  {{"path": "speed", "type": "REAL", "offset": "2.0", "bits": 32, "start": "10.0"}},
  {{"path": "limits", "type": "STRUCT", "offset": "6.0", "bits": 32}},
  {{"path": "limits.low", "type": "INT", "offset": "6.0", "bits": 16}},
  {{"path": "limits.high", "type": "INT", "offset": "8.0", "bits": 16, "start": "100"}},
  {{"path": "name", "type": "STRING[8]", "offset": "10.0", "bits": 80, "start": "'a: b #c'"}},
  {{"path": "table", "type": "ARRAY[0..3] OF BYTE", "offset": "20.0", "bits": 32, "start": "{table}"}}]}}
]
}}
"""


@pytest.fixture
def project(tmp_path, monkeypatch):
    """A folder with one source and its lock."""
    monkeypatch.chdir(tmp_path)
    Path("plc").mkdir()
    Path("plc/Motor.db").write_text(SOURCE, encoding="utf-8")
    assert plcgen.lock("plc").ok
    return tmp_path


def lock_text() -> str:
    return Path("plcgen.lock.json").read_text("utf-8")


def edit(path: str, old: str, new: str) -> None:
    text = Path(path).read_text("utf-8")
    assert old in text
    Path(path).write_text(text.replace(old, new, 1), encoding="utf-8")


@pytest.mark.usefixtures("project")
def test_text():
    """One line a member with offset, bits, type, start value; sorted, no dates."""
    text = lock_text()
    data = json.loads(text)
    assert text.endswith(LOCKED.format(hash=data["blocks"][0]["hash"], table="[16#01, 2(16#02), 16#00]"))
    assert (data["format"], data["sources"]) == (2, ["plc"])


@pytest.mark.usefixtures("project")
def test_diff_reads_a_lock():
    """A lock on either side of diff is the state it keeps: the same changes as with the sources, at its lines."""
    shutil.copytree("plc", "old")
    edit("plc/Motor.db", "  limits :", "  x : Int;\n  limits :")
    wanted = {(c.kind, c.path, c.old, c.new) for c in plcgen.diff("old", "plc").changes}
    result = plcgen.diff("plcgen.lock.json", "plc")
    assert {(c.kind, c.path, c.old, c.new) for c in result.changes} == wanted
    (moved,) = [c for c in result.changes if c.kind == "member-moved"]
    assert moved.old_span is not None
    assert (moved.old_span.file, moved.old_span.line) == ("plcgen.lock.json", 10)  # limits: the fourth member
    assert plcgen.diff("old", "plcgen.lock.json").changes == ()
    Path("wrong.json").write_text('{"format": 2}', "utf-8")
    assert [d.code for d in plcgen.diff("wrong.json", "plc").diagnostics] == ["PG633"]


EARLIER = "# Layout lock of plcgen.\nformat: 1\nsources: [plc]\nblocks: {}\n"


@pytest.mark.usefixtures("project")
def test_a_lock_of_an_earlier_version():
    """It says what to do, whether it has the old name or is named; writing over it needs no force."""
    Path("plcgen.lock.json").unlink()
    Path("plcgen.lock.yaml").write_text(EARLIER, "utf-8")
    (found,) = plcgen.check_lock().diagnostics
    assert (found.code, "plcgen.lock.yaml is one of an earlier version" in found.help) == ("PG110", True)
    (found,) = plcgen.check_lock(lock="plcgen.lock.yaml").diagnostics
    assert (found.code, "write a new one, plcgen lock FOLDER" in found.help) == ("PG633", True)
    assert plcgen.lock("plc", out="plcgen.lock.yaml").ok


def test_no_drift(project):
    """The lock fits, from any folder, and writing it again changes nothing."""
    assert plcgen.check_lock().changes == ()
    assert not plcgen.lock().changed
    assert plcgen.check_lock(project / "plc", lock=project / "plcgen.lock.json").changes == ()


DRIFT = {
    "moved": ("  speed :", "  x : Int; speed :", {"member-added", "member-moved", "block-grown"}),
    "start value": ("10.0", "20.0", {"start-value"}),
    "nested start value": (":= 100", ":= 101", {"start-value"}),
    "type": ("low : Int", "low : Word", {"type-changed"}),
    "renamed": ("low :", "bottom :", {"member-renamed"}),
    "attribute": ("{ExternalWritable := 'False'} ", "", {"hmi-access-added"}),
    "access": ("'FALSE' }", "'TRUE' }", {"access-changed"}),
    "retain": ("NON_RETAIN\n", "", {"retain-changed"}),
    "array": ("2(2)", "2(3)", {"start-value"}),
}


@pytest.mark.parametrize("name", DRIFT)
@pytest.mark.usefixtures("project")
def test_drift(name):
    """Every change of memory is found, with its class, and accepted by writing the lock again."""
    old, new, kinds = DRIFT[name]
    edit("plc/Motor.db", old, new)
    result = plcgen.check_lock()
    assert {c.kind for c in result.changes} == kinds
    assert result.readable
    assert plcgen.lock().changed
    assert plcgen.check_lock().changes == ()


@pytest.mark.usefixtures("project")
def test_old_and_new_offsets():
    """The report shows where the member was and where it is, at its place in the source."""
    edit("plc/Motor.db", "  limits :", "  x : Int;\n  limits :")
    (moved,) = [c for c in plcgen.check_lock().changes if c.kind == "member-moved"]
    assert (moved.old, moved.new) == ("6.0", "8.0")
    assert "limits.high 8.0 -> 10.0" in moved.details
    assert moved.new_span is not None
    assert (Path(moved.new_span.file).as_posix(), moved.new_span.line) == ("plc/Motor.db", 9)
    assert moved.old_span is not None
    assert moved.old_span.file == "plcgen.lock.json"


@pytest.mark.usefixtures("project")
def test_comments_are_no_drift():
    """Comments, order of files and spelling do not touch memory."""
    edit("plc/Motor.db", "speed : Real := 10.0;", "speed:REAL := 1.0E1; // rpm")
    assert plcgen.check_lock().changes == ()


@pytest.mark.usefixtures("project")
def test_code_and_constants():
    """Code is locked by its hash, constants included; its comments are not."""
    head = 'FUNCTION "F" : Void VAR_INPUT a : Int; END_VAR VAR CONSTANT L : Int := 1; END_VAR'
    scl = f'{head}\nBEGIN "x" := #a; END_FUNCTION'
    path = Path("plc/F.scl")
    path.write_text(scl)
    plcgen.lock("plc")
    path.write_text(scl.replace('"x"', '// note\n"x"'))
    assert plcgen.check_lock().changes == ()
    for new in (scl.replace("#a;", "#a + 1;"), scl.replace(":= 1;", ":= 2;")):
        path.write_text(new)
        assert [c.kind for c in plcgen.check_lock().changes] == ["code-changed"]


@pytest.mark.slow
@pytest.mark.parametrize(
    "name", ["s7-300_mm440_dp", "s7-300_6ra80_dp_tia", "s7-1200_s7-200_ppi", "s7-1500_s120_messages"]
)
def test_round_trip_of_the_examples(name, tmp_path):
    """Specs and generated folders, one for each target: what was locked is what is read back."""
    lock = tmp_path / "x.lock.json"
    spec, folder = ROOT / "specs" / f"{name}.yaml", generated_example(name)
    for what in (spec, folder, folder / "xml"):
        if not what.exists():
            continue  # STEP 7 V5 has no SimaticML
        classic = "s7-300" in name
        assert plcgen.lock(what, out=lock, classic=classic).ok
        result = plcgen.check_lock(what, lock=lock, classic=classic)
        assert (result.changes, result.compared > 3) == ((), True)


def test_round_trip_of_foreign_sources(tmp_path):
    """Whatever the reader accepts can be locked and read back."""
    folder = ROOT / "tests" / "s7" / "scl" / "sources"
    for path in sorted(folder.rglob("*")):
        if path.suffix not in {".scl", ".db", ".udt", ".awl"}:
            continue
        lock = tmp_path / "x.lock.json"
        if plcgen.lock(path, out=lock).ok:
            assert plcgen.check_lock(path, lock=lock).changes == (), path


def test_a_spec_is_locked_with_its_telegrams(tmp_path):
    """A changed telegram is drift; its bytes are named."""
    spec, lock = tmp_path / "job.yaml", tmp_path / "job.lock.json"
    shutil.copy(FAQ, spec)
    plcgen.lock(spec, out=lock)
    assert '"request": "03 01 02 01 10 01 C4 7F 00 00", "positive": 10, "negative": 10' in lock.read_text("utf-8")
    spec.write_text(FAQ.read_text("utf-8").replace("P50304: 100.0", "P50304: 50.0").replace("256", "300"), "utf-8")
    found = {c.kind: c.message for c in plcgen.check_lock(lock=lock).changes}
    assert found["telegram-value"].startswith("byte 12: parameter 1 value 100.0")
    assert found["drive-address"].endswith("256 (16#0100) -> 300 (16#012C)")


@pytest.mark.usefixtures("project")
def test_an_edited_lock_is_told():
    """A line that was changed by hand does not hide a move."""
    edit("plcgen.lock.json", '"offset": "2.0"', '"offset": "4.0"')
    result = plcgen.check_lock()
    assert [(d.code, d.span.line) for d in result.diagnostics] == [("PG634", 6)]
    assert plcgen.lock("plc").changed


HOSTILE = {
    "another format": ('"format": 2', '"format": 3', "PG633"),
    "outside": ('["plc"]', '["../plc"]', "PG633"),
    "absolute": ('["plc"]', '["/etc"]', "PG633"),
    "drive letter": ('["plc"]', '["C:/x"]', "PG633"),
    "no sources": ('["plc"]', "[]", "PG633"),
    "access": ('"standard"', '"standart"', "PG633"),
    "number": ('"bytes": 24', '"bytes": -1', "PG633"),
    "no number": ('"bytes": 24', '"bytes": "many"', "PG633"),
    "large number": ('"bytes": 24', f'"bytes": {"9" * 5000}', "PG633"),
    "not a block": ('"kind": "DB"', '"kind": "XB"', "PG633"),
    "not a member": ('{"path": "run", "type": "BOOL", "offset": "0.0", "bits": 1}', '"run"', "PG633"),
    "no offset": ('"offset": "0.0"', '"offset": "0.8"', "PG633"),
    "invisible": ('"path": "run"', '"path": "r\\u200bun"', "PG633"),
    "tag": ('"format": 2', '"format": !!int 2', "PG109"),
    "twice": ('"bytes": 24', '"bytes": 24, "name": "Motor", "name": "Other"', "PG634"),
    "deep": ('["plc"]', "[" * 5000 + "]" * 5000, "PG109"),
    "syntax": ('"format": 2', '"format": [2', "PG101"),
}


@pytest.mark.parametrize("name", HOSTILE)
@pytest.mark.usefixtures("project")
def test_hostile_locks(name):
    """A lock is read like any file from outside: wrong values are diagnostics with a place."""
    old, new, code = HOSTILE[name]
    edit("plcgen.lock.json", old, new)
    result = plcgen.check_lock()
    assert not result.readable
    assert code in {d.code for d in result.diagnostics}
    assert result.changes == ()


@pytest.mark.usefixtures("project")
def test_a_block_that_a_merge_has_doubled():
    """Two entries of one block are refused: the second one would hide a change of the first."""
    lines = lock_text().splitlines(keepends=True)
    block = "".join(lines[5:-2])
    Path("plcgen.lock.json").write_text("".join(lines[:5]) + block.rstrip() + ",\n" + block + "]\n}\n", "utf-8")
    assert [(d.code, d.message) for d in plcgen.check_lock().diagnostics] == [("PG634", "DB Motor: stands there twice")]


def test_files_of_the_user_are_safe(project):
    """A file that is no lock is not overwritten; sources with errors write nothing."""
    other = Path("notes.yaml")
    other.write_text("mine: true\n")
    result = plcgen.lock("plc", out=other)
    assert [d.code for d in result.diagnostics] == ["PG501"]
    assert other.read_text() == "mine: true\n"
    assert plcgen.lock("plc", out=other, force=True).ok
    before = lock_text()
    edit("plc/Motor.db", "speed : Real", "speed : ")
    assert not plcgen.lock("plc").ok
    assert lock_text() == before
    assert [path.name for path in project.iterdir() if path.name.startswith(".")] == []


def test_nothing_to_lock(tmp_path, monkeypatch):
    """Without paths and without a lock there is nothing to do; the folder must exist."""
    monkeypatch.chdir(tmp_path)
    assert [d.code for d in plcgen.lock().diagnostics] == ["PG632"]
    assert [d.code for d in plcgen.check_lock().diagnostics] == ["PG110"]
    (tmp_path / "a.db").write_text(SOURCE)
    assert [d.code for d in plcgen.lock("a.db", out="no/such/lock.yaml").diagnostics] == ["PG503"]
    (tmp_path / "job.yaml").write_text("x")
    assert [d.code for d in plcgen.lock("job.yaml", "a.db").diagnostics] == ["PG632"]


@pytest.mark.usefixtures("project")
def test_members_are_bounded():
    """A text of more than 2,000 characters is none of a lock."""
    edit("plcgen.lock.json", '"BOOL"', f'"{"B" * 2500}"')
    assert "PG633" in {d.code for d in plcgen.check_lock().diagnostics}


@pytest.mark.usefixtures("project")
def test_a_block_declared_twice_is_not_locked():
    """The second version would never be compared: an error with both places, for writing and for checking."""
    before = Path("plcgen.lock.json").read_bytes()
    Path("plc/Other.db").write_text(SOURCE.replace("10.0", "20.0"), encoding="utf-8")
    for result in (plcgen.lock("plc"), plcgen.check_lock("plc")):
        (found,) = result.diagnostics
        assert (found.code, found.severity.label, found.span.file) == ("PG805", "error", "plc/Other.db")
        assert [(note.message, note.span.file) for note in found.notes] == [("first declared here", "plc/Motor.db")]
    assert not plcgen.lock("plc").ok
    assert not plcgen.check_lock("plc").readable
    assert Path("plcgen.lock.json").read_bytes() == before


WRONG = """\
{"format": 2, "source": ["plc"],
"sources": ["plc", {"a": "b"}],
"drives": [
{"key": "d", "what": "drive", "address": "many"},
{"key": "e", "address": 1, "settings": {"colour": ["red"]}}],
"jobs": [
{"key": "j", "driv": "d", "timing": {"cycle": {"a": 1}}, "telegrams": [
  {"request": "0G", "positive": 1, "negative": 2, "protocol": "ds47"},
  {"request": "01", "positive": -1, "negative": 4294967296, "buffer": 1, "protocol": "modbus"},
  5]},
[1]],
"blocks": [
{"kind": "XB", "name": "a", "hash": "", "access": "standard"},
{"kind": "DB", "name": "", "hash": "", "access": "standard"},
{"kind": "DB", "name": "a", "hash": "", "number": 70000, "bytes": "16#10", "acess": "standard", "retain": true,
 "members": [{"path": "a", "type": [1]}, {"path": "b"}, {"path": "c", "type": "BOOL", "offset": "0.9"}],
 "attributes": {"a": {"b": "c"}}},
5]}
"""

MISTAKES = [
    (1, 15, 'unknown key "source" in the lock'),
    (2, 20, "expected text instead of a mapping"),
    (4, 42, 'expected a whole number instead of "many"'),
    (5, 1, 'drives.1 lacks the key "what"'),
    (5, 51, "expected text instead of a list"),
    (7, 1, 'jobs.0 lacks the key "drive"'),
    (7, 14, 'unknown key "driv" in jobs.0'),
    (7, 47, "expected text instead of a mapping"),
    (8, 3, 'jobs.0.telegrams.0 lacks the key "buffer"'),
    (8, 15, "a request is 1 to 255 bytes in hexadecimal"),
    (9, 33, '"positive": must be greater than or equal to 0'),
    (9, 49, '"negative": must be less than or equal to 4294967295'),
    (9, 86, '"modbus" is not a protocol: ds47, ppi'),
    (10, 3, 'expected a mapping instead of "5"'),
    (11, 1, "expected a mapping instead of a list"),
    (13, 10, '"XB" is not a value of "kind"'),
    (14, 24, '"name"'),
    (15, 1, 'blocks.2 lacks the key "access"'),
    (15, 51, '"number": must be less than or equal to 65535'),
    (15, 67, 'expected a whole number instead of "16#10"'),
    (15, 76, 'unknown key "acess" in blocks.2'),
    (15, 107, '"true" is not a value of "retain"'),
    (16, 36, "expected text instead of a list"),
    (16, 42, 'blocks.2.members.1 lacks the key "type"'),
    (16, 97, "an offset is a byte and a bit: 2.0"),
    (17, 22, "expected text instead of a mapping"),
    (18, 1, 'expected a mapping instead of "5"'),
]
"""Written by hand, next to the text: line, column, how the message begins."""


def test_every_mistake_is_told_in_one_run(tmp_path):
    """Whatever is no part of a lock is PG633 at its line and column, and how to get a right one."""
    path = tmp_path / "plcgen.lock.json"
    path.write_text(WRONG, "utf-8")
    found = plcgen.check_lock(lock=path).diagnostics
    assert {(d.code, d.help) for d in found} == {("PG633", "write the lock again: plcgen lock")}
    told = [(d.span.line, d.span.column, d.message) for d in found]
    assert [entry[:2] for entry in told] == [entry[:2] for entry in MISTAKES]
    for (*_, said), (*_, start) in zip(told, MISTAKES, strict=True):
        assert said.startswith(start)


@pytest.mark.usefixtures("project")
def test_a_reformatted_lock_has_places():
    """JSON in one line or spread out is the same lock; what differs from it has its column there."""
    text = lock_text()
    Path("plcgen.lock.json").write_text(json.dumps(json.loads(text)), "utf-8")
    edit("plc/Motor.db", "speed : Real", "speed : DInt")
    changed = plcgen.check_lock().changes[0]
    line = Path("plcgen.lock.json").read_text("utf-8")
    assert changed.old_span is not None
    assert (changed.old_span.line, changed.old_span.column) == (1, line.index('{"path": "speed"') + 1)
