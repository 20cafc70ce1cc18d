"""``plcgen lock``: exit codes and streams."""

import json
from pathlib import Path

import pytest

SOURCE = 'DATA_BLOCK "B"\nSTRUCT\n  a : Word;\n  b : Word;\nEND_STRUCT;\nBEGIN\nEND_DATA_BLOCK\n'


@pytest.fixture
def source(tmp_path):
    """Write one source."""
    path = tmp_path / "b.db"
    path.write_text(SOURCE, encoding="utf-8")
    return path


def test_write_and_check(plcgen, source):
    """Chatter on stderr, nothing on stdout; drift ends with 1 and shows both offsets."""
    result = plcgen("lock", "b.db")
    assert (result.code, result.out, result.err) == (0, "", "wrote plcgen.lock.json, 1 block\n")
    assert plcgen("lock").err == "unchanged: plcgen.lock.json, 1 block\n"
    result = plcgen("lock", "--check")
    assert (result.code, result.out, result.err) == (0, "", "1 block as in plcgen.lock.json\n")
    source.write_text(SOURCE.replace("  b :", "  x : Word;\n  b :"), encoding="utf-8")
    result = plcgen("lock", "--check")
    assert result.code == 1
    assert "breaking       member-moved        b: moved by +2 bytes: 2.0 -> 4.0\n" in result.out
    assert result.err == "intended? write the lock again: plcgen lock --out plcgen.lock.json\n"
    assert plcgen("lock", "--check", "--fail-on", "never").code == 0
    data = json.loads(plcgen("lock", "--check", "--json").out)
    assert (data["ok"], data["old"]) == (False, "plcgen.lock.json")
    assert json.loads(plcgen("lock", "--check", "-f", "sarif").out)["version"] == "2.1.0"
    assert "b: moved by" in plcgen("lock", "--check", "-f", "markdown").out


def test_any_difference_is_drift(plcgen, source):
    """A start value is no move, but the lock no longer says what is in the sources."""
    plcgen("lock", "b.db")
    source.write_text(SOURCE.replace("a : Word", "a : Word := 1"), encoding="utf-8")
    assert plcgen("lock", "--check").code == 1
    assert plcgen("lock", "--check", "--fail-on", "breaking").code == 0


def test_errors(plcgen, source):
    """Nothing is written if the sources have errors; formats belong to --check."""
    source.write_text(SOURCE.replace("Word", ""), encoding="utf-8")
    result = plcgen("lock", "b.db")
    assert result.code == 1
    assert result.err.endswith("nothing was written\n")
    assert not Path("plcgen.lock.json").exists()
    assert plcgen("lock", "b.db", "--json").code == 2
    assert plcgen("lock", "--check").code == 1


@pytest.mark.parametrize(
    ("start", "said"), [("'x\u200by'", "the character U+200B in DB B"), (f"'{'x' * 2000}'", "a text of 20")]
)
def test_what_is_written_can_be_read_again(plcgen, source, start, said):
    """What a lock cannot hold is told when it would be written, not when it is compared."""
    source.write_text(SOURCE.replace("a : Word", f"a : String[9] := {start}"), encoding="utf-8")
    result = plcgen("lock", "b.db")
    assert result.code == 1
    assert f"error[PG633]: a lock cannot keep {said}" in result.err
    assert "b.db:1:1" in result.err
    assert not Path("plcgen.lock.json").exists()


def test_a_repository_without_a_lock(plcgen):
    """As the hook calls it: how to make one, not where the file might be."""
    result = plcgen("lock", "--check", "--out", "plcgen.lock.json", "--fail-on", "any")
    assert result.code == 1
    assert "there is no layout lock yet" in result.err
    assert "plcgen lock FOLDER --out plcgen.lock.json" in " ".join(result.err.split())


SPEC = """
plc: {name: Press, family: s7-1500, toolchain: tia-v19}
drives: {axis: {device: sinamics-s120, hardware_id: 281, drive_object: 3}}
jobs:
  actual: {drive: axis, read: [r21, r27]}
  ramps: {drive: axis, write: {P1120: 6.0}}
"""


def test_a_lock_of_a_spec_tells_what_has_changed_alone(plcgen):
    """Nothing of the same spec, also by diff; of another value its sentence, and none of the other job."""
    Path("press.yaml").write_text(SPEC, "utf-8")
    assert plcgen("lock", "press.yaml").code == 0
    assert plcgen("lock", "--check").code == 0
    assert "no semantic differences" in plcgen("diff", "plcgen.lock.json", "press.yaml").out
    Path("press.yaml").write_text(SPEC.replace("6.0", "7.0"), "utf-8")
    for words in (("lock", "--check", "--fail-on", "any"), ("diff", "plcgen.lock.json", "press.yaml")):
        out = plcgen(*words).out
        assert "ramps: P1120 6.0 -> 7.0" in out
        assert "actual" not in out


def test_a_lock_without_what_jobs_do(plcgen):
    """One that was written before locks had it: nothing is told to be new."""
    Path("press.yaml").write_text(SPEC, "utf-8")
    assert plcgen("lock", "press.yaml").code == 0
    lock = json.loads(Path("plcgen.lock.json").read_text("utf-8"))
    for job in lock["jobs"]:
        for key in ("items", "group", "block", "place"):
            del job[key]
    Path("plcgen.lock.json").write_text(json.dumps(lock), "utf-8")
    result = plcgen("lock", "--check", "--fail-on", "any")
    assert (result.code, "added" in result.out) == (0, False)
