"""The lock file: its text, drift, and what hostile or edited ones do."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest
import yaml

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
  DB Motor:
    hash: {hash}
    bytes: 24
    access: standard
    retain: false
    members:
      run: 0.0 1 bit BOOL
      ready: 0.1 1 bit BOOL {{EXTERNALWRITABLE=FALSE}}
      speed: 2.0 4 B REAL := 10.0
      limits: 6.0 4 B STRUCT
      limits.low: 6.0 2 B INT
      limits.high: 8.0 2 B INT := 100
      name: "10.0 10 B STRING[8] := 'a: b #c'"
      table: 20.0 4 B ARRAY[0..3] OF BYTE := [16#01, 2(16#02), 16#00]
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
    return Path("plcgen.lock.yaml").read_text("utf-8")


def edit(path: str, old: str, new: str) -> None:
    text = Path(path).read_text("utf-8")
    assert old in text
    Path(path).write_text(text.replace(old, new, 1), encoding="utf-8")


@pytest.mark.usefixtures("project")
def test_text():
    """One line a member with offset, size, type, start value; sorted, no dates; any YAML reader sees the same."""
    text = lock_text()
    data = yaml.safe_load(text)
    block = data["blocks"]["DB Motor"]
    assert text.endswith(LOCKED.format(hash=block["hash"]))
    assert (data["format"], data["sources"]) == (1, ["plc"])
    assert block["members"]["name"] == "10.0 10 B STRING[8] := 'a: b #c'"


def test_no_drift(project):
    """The lock fits, from any folder, and writing it again changes nothing."""
    assert plcgen.check_lock().changes == ()
    assert not plcgen.lock().changed
    assert plcgen.check_lock(project / "plc", lock=project / "plcgen.lock.yaml").changes == ()


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
    assert moved.old_span.file == "plcgen.lock.yaml"


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
    lock = tmp_path / "x.lock.yaml"
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
        lock = tmp_path / "x.lock.yaml"
        if plcgen.lock(path, out=lock).ok:
            assert plcgen.check_lock(path, lock=lock).changes == (), path


def test_a_spec_is_locked_with_its_telegrams(tmp_path):
    """A changed telegram is drift; its bytes are named."""
    spec, lock = tmp_path / "job.yaml", tmp_path / "job.lock.yaml"
    shutil.copy(FAQ, spec)
    plcgen.lock(spec, out=lock)
    assert 'request: "03 01 02 01 10 01 C4 7F 00 00", positive: 10, negative: 10' in lock.read_text("utf-8")
    spec.write_text(FAQ.read_text("utf-8").replace("P50304: 100.0", "P50304: 50.0").replace("256", "300"), "utf-8")
    found = {c.kind: c.message for c in plcgen.check_lock(lock=lock).changes}
    assert found["telegram-value"].startswith("byte 12: parameter 1 value 100.0")
    assert found["drive-address"].endswith("256 (16#0100) -> 300 (16#012C)")


@pytest.mark.usefixtures("project")
def test_an_edited_lock_is_told():
    """A line that was changed by hand does not hide a move."""
    edit("plcgen.lock.yaml", "speed: 2.0", "speed: 4.0")
    result = plcgen.check_lock()
    assert [(d.code, d.span.line) for d in result.diagnostics] == [("PG634", 7)]
    assert plcgen.lock("plc").changed


HOSTILE = {
    "another format": ("format: 1", "format: 2", "PG633"),
    "outside": ("sources: [plc]", "sources: [../plc]", "PG633"),
    "absolute": ("sources: [plc]", "sources: [/etc]", "PG633"),
    "drive letter": ("sources: [plc]", 'sources: ["C:/x"]', "PG633"),
    "no sources": ("sources: [plc]", "sources: []", "PG633"),
    "access": ("access: standard", "access: standart", "PG633"),
    "number": ("bytes: 24", "bytes: -1", "PG633"),
    "no number": ("bytes: 24", "bytes: many", "PG633"),
    "not a block": ("DB Motor:", "Motor:", "PG633"),
    "not a member": ("run: 0.0 1 bit BOOL", "run: [1]", "PG633"),
    "unbalanced": ("run: 0.0 1 bit BOOL", "run: '0.0 1 bit \"B'", "PG633"),
    "tag": ("format: 1", "format: !!int 1", "PG109"),
    "duplicate": ("      run: 0.0 1 bit BOOL\n", "      run: 0.0 1 bit BOOL\n" * 2, "PG103"),
    "syntax": ("format: 1", "format: [1", "PG101"),
}


@pytest.mark.parametrize("name", HOSTILE)
@pytest.mark.usefixtures("project")
def test_hostile_locks(name):
    """A lock is read like any file from outside: wrong values are diagnostics with a place."""
    old, new, code = HOSTILE[name]
    edit("plcgen.lock.yaml", old, new)
    result = plcgen.check_lock()
    assert not result.readable
    assert code in {d.code for d in result.diagnostics}
    assert result.changes == ()


@pytest.mark.usefixtures("project")
def test_slow_members_do_not_exist():
    """A member made to keep a regular expression busy is refused or read in no time."""
    for value in ('"' * 1999, " := " * 499, '" " ' * 499 + "\\n", " {" * 900):
        text = lock_text()
        edit("plcgen.lock.yaml", "run: 0.0 1 bit BOOL", 'run: "' + value.replace('"', '\\"') + '"')
        assert not plcgen.check_lock().readable
        Path("plcgen.lock.yaml").write_text(text, encoding="utf-8")


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
def test_every_reader_sees_the_same_words():
    """Names and values that YAML 1.1 takes for truth values or numbers are quoted."""
    edit("plc/Motor.db", "run : Bool", "no : Bool")
    plcgen.lock()
    assert "no" in yaml.safe_load(lock_text())["blocks"]["DB Motor"]["members"]
    spec = Path("job.yaml")
    head = "plc: {name: a, family: s7-1200, toolchain: tia-v19}\nppi: {m: {module: cm1241, port: 270, stations: "
    text = head + '{p: {address: 2, cpu: "224"}}, jobs: {j: {station: p, read: [VW1]}}}}\n'
    spec.write_text(text, encoding="utf-8")
    plcgen.lock(spec, out="job.lock.yaml")
    assert yaml.safe_load(Path("job.lock.yaml").read_text("utf-8"))["drives"]["m.p"]["cpu"] == "224"


@pytest.mark.usefixtures("project")
def test_members_are_bounded():
    """A line of more than 2,000 characters is no member."""
    edit("plcgen.lock.yaml", "run: 0.0 1 bit BOOL", f"run: 0.0 1 bit {'B' * 2500}")
    assert "PG633" in {d.code for d in plcgen.check_lock().diagnostics}


@pytest.mark.usefixtures("project")
def test_a_block_declared_twice_is_not_locked():
    """The second version would never be compared: an error with both places, for writing and for checking."""
    before = Path("plcgen.lock.yaml").read_bytes()
    Path("plc/Other.db").write_text(SOURCE.replace("10.0", "20.0"), encoding="utf-8")
    for result in (plcgen.lock("plc"), plcgen.check_lock("plc")):
        (found,) = result.diagnostics
        assert (found.code, found.severity.label, found.span.file) == ("PG805", "error", "plc/Other.db")
        assert [(note.message, note.span.file) for note in found.notes] == [("first declared here", "plc/Motor.db")]
    assert not plcgen.lock("plc").ok
    assert not plcgen.check_lock("plc").readable
    assert Path("plcgen.lock.yaml").read_bytes() == before


WRONG = """\
format: 1
source: [plc]
sources: [plc, {a: b}]
drives:
  d: {what: drive, address: many}
  e: {address: 1, colour: [red]}
jobs:
  j:
    driv: d
    timing: {cycle: {a: 1}}
    telegrams:
      - {request: "0G", positive: 1, negative: 2}
      - {request: "01", positive: -1, negative: 4294967296, buffer: 1, protocol: modbus}
      - 5
  k: [1]
blocks:
  XB a: {access: standard}
  DB: {access: standard}
  DB a:
    number: 70000
    bytes: 16#10
    acess: standard
    retain: true
    members: {a: [1], b: "", c: 0.0 1 bit BOOL}
    attributes: {a: {b: c}}
  DB b: 5
  FB c: {access: open, static: {x: {y: z}}, output: 5, hash: [1]}
"""

MISTAKES = [
    (2, 1, 'unknown key "source" in the lock'),
    (3, 16, "expected text instead of a mapping"),
    (5, 29, '"many" is not a number'),
    (6, 6, 'drives.e lacks the key "what"'),
    (6, 27, "expected text instead of a list"),
    (9, 5, 'jobs.j lacks the key "drive"'),
    (9, 5, 'unknown key "driv" in jobs.j'),
    (10, 21, "expected text instead of a mapping"),
    (12, 9, 'jobs.j.telegrams.0 lacks the key "buffer"'),
    (12, 19, "a request is 1 to 255 bytes in hexadecimal"),
    (13, 35, '"-1" is not a number'),
    (13, 49, '"negative": must be less than or equal to 4294967295'),
    (13, 82, '"modbus" is not a protocol: ds47, ppi'),
    (14, 9, 'expected a mapping instead of "5"'),
    (15, 6, "expected a mapping instead of a list"),
    (17, 3, '"XB a" is not a block: kind (DB, FB, FC, OB, UDT) and name'),
    (18, 3, '"DB" is not a block: kind (DB, FB, FC, OB, UDT) and name'),
    (20, 5, 'blocks.DB a lacks the key "access"'),
    (20, 13, '"number": must be less than or equal to 65535, not "70000"'),
    (21, 12, '"16#10" is not a number'),
    (22, 5, 'unknown key "acess" in blocks.DB a'),
    (23, 13, '"true" is not a value of "retain"'),
    (24, 18, "this is not a member: offset, size, type, start value"),
    (24, 26, "this is not a member: offset, size, type, start value"),
    (25, 21, "expected text instead of a mapping"),
    (26, 9, 'expected a mapping instead of "5"'),
    (27, 18, '"open" is not a value of "access"'),
    (27, 36, "this is not a member: offset, size, type, start value"),
    (27, 53, 'expected a mapping instead of "5"'),
    (27, 62, "expected text instead of a list"),
]
"""Written by hand, next to the text: line, column, how the message begins."""


def test_every_mistake_is_told_in_one_run(tmp_path):
    """Whatever is no part of a lock is PG633 at its line and column, and how to get a right one."""
    path = tmp_path / "plcgen.lock.yaml"
    path.write_text(WRONG, "utf-8")
    found = plcgen.check_lock(lock=path).diagnostics
    assert {(d.code, d.help) for d in found} == {("PG633", "write the lock again: plcgen lock")}
    told = [(d.span.line, d.span.column, d.message) for d in found]
    assert [entry[:2] for entry in told] == [entry[:2] for entry in MISTAKES]
    for (*_, said), (*_, start) in zip(told, MISTAKES, strict=True):
        assert said.startswith(start)
