"""Writing an output folder: all or nothing, and the user's own files are safe."""

from __future__ import annotations

import errno
import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

import pytest

from plcgen import api
from plcgen.base import replacing
from plcgen.base.diagnostics import DiagnosticError
from plcgen.build import writing as write
from plcgen.build.environment import RenderedFile
from plcgen.build.folder_lock import exclusive
from plcgen.build.manifest import digest
from plcgen.build.staging import STAGE, recover
from plcgen.build.writing import JOURNAL, compare_folder, write_folder
from tests.projects import FAQ, ROOT


def files(**content: str) -> list[RenderedFile]:
    found = [RenderedFile(name.replace("__", "/"), text.encode()) for name, text in content.items()]
    entries = [{"path": f.path, "sha256": digest(f.data)} for f in found]
    return [*found, RenderedFile("manifest.json", json.dumps({"files": entries}).encode())]


def tree(folder: Path) -> dict[str, str]:
    return {p.relative_to(folder).as_posix(): p.read_text() for p in sorted(folder.rglob("*")) if p.is_file()}


def codes(error: pytest.ExceptionInfo[DiagnosticError]) -> list[str]:
    return [d.code for d in error.value.diagnostics]


def test_second_run_changes_nothing(tmp_path: Path) -> None:
    """Unchanged files are not written again: their time stamps stay."""
    first = write_folder(files(a="1", b__c="2"), tmp_path / "out")
    assert set(first.written) == {"a", "b/c", "manifest.json"}
    before = {p: p.stat().st_mtime_ns for p in (tmp_path / "out").rglob("*")}
    second = write_folder(files(a="1", b__c="2"), tmp_path / "out")
    assert second.written == ()
    assert {p: p.stat().st_mtime_ns for p in (tmp_path / "out").rglob("*")} == before


def test_another_project_is_not_written_over(tmp_path: Path) -> None:
    """The folder of one plant given for another: nothing is lost before somebody says --force."""
    text = "plc: {{name: {}, family: s7-1500, toolchain: tia-v19}}\n"
    text += "drives: {{fan: {{device: sinamics-g120, hardware_id: 270}}}}\n"
    for name in ("North", "South"):
        (tmp_path / f"{name}.yaml").write_text(
            text.format(name) + f"jobs: {{{name.lower()}: {{drive: fan, read: [P1120]}}}}\n", "utf-8"
        )
    out = tmp_path / "out"
    assert api.generate(tmp_path / "North.yaml", out).ok
    before = tree(out)
    found = api.generate(tmp_path / "South.yaml", out)
    assert [(d.code, d.message) for d in found.diagnostics if d.code.startswith("PG5")] == [
        ("PG501", 'the folder has the files of another project, "North"')
    ]
    assert tree(out) == before
    assert api.generate(tmp_path / "South.yaml", out, force=True).ok
    assert not (out / "scl" / "North.scl").exists()


def test_a_manifest_removes_nothing_hidden(tmp_path: Path) -> None:
    """It may come with a folder from elsewhere, and everybody knows the bytes of some files below .git."""
    (tmp_path / ".git").mkdir()
    (tmp_path / ".git" / "HEAD").write_text("ref: refs/heads/main\n")
    entries = [{"path": ".git/HEAD", "sha256": digest(b"ref: refs/heads/main\n")}]
    (tmp_path / "manifest.json").write_text(json.dumps({"files": entries}))
    assert write_folder(files(a="1"), tmp_path).removed == ()
    assert (tmp_path / ".git" / "HEAD").is_file()


def test_files_no_longer_generated_are_removed_unless_changed(tmp_path: Path) -> None:
    """A dropped job takes its own files with it, but not one that somebody edited."""
    write_folder(files(a="1", sub__b="2", c="3"), tmp_path)
    (tmp_path / "c").write_text("mine now")
    result = write_folder(files(a="1"), tmp_path)
    assert result.removed == ("sub/b",)
    assert sorted(tree(tmp_path)) == ["a", "c", "manifest.json"]
    assert not (tmp_path / "sub").exists()


def test_a_file_of_the_user_is_never_overwritten(tmp_path: Path) -> None:
    """A foreign file, an edited file and a folder in the way: all reported at once, nothing touched."""
    write_folder(files(edited="1", plain="1"), tmp_path)
    (tmp_path / "edited").write_text("by hand")
    (tmp_path / "foreign").write_text("mine")
    (tmp_path / "folder").mkdir()
    before = tree(tmp_path)
    with pytest.raises(DiagnosticError) as error:
        write_folder(files(edited="2", foreign="2", folder="2", plain="2"), tmp_path)
    assert sorted(codes(error)) == ["PG501", "PG501", "PG502"]
    assert tree(tmp_path) == before
    (tmp_path / "folder").rmdir()
    write_folder(files(edited="2", foreign="2", plain="2"), tmp_path, force=True)
    assert tree(tmp_path)["edited"] == tree(tmp_path)["foreign"] == "2"


def test_a_foreign_manifest_is_not_overwritten(tmp_path: Path) -> None:
    """manifest.json is a common name: one that is not ours stays."""
    (tmp_path / "manifest.json").write_text('{"name": "web app"}')
    with pytest.raises(DiagnosticError) as error:
        write_folder(files(a="1"), tmp_path)
    assert codes(error) == ["PG501"]
    assert list(tree(tmp_path)) == ["manifest.json"]


@pytest.mark.parametrize("path", ["../out.txt", "/etc/out", "a/../../b", "c:/x", "a\\b", "scl/NUL.scl", "a:stream"])
def test_no_path_leaves_the_folder(path: str, tmp_path: Path) -> None:
    """A hostile block name cannot write elsewhere."""
    with pytest.raises(DiagnosticError) as error:
        write_folder([RenderedFile(path, b"x")], tmp_path / "out")
    assert codes(error) == ["PG506"]
    assert list(tmp_path.rglob("*.txt")) == []


def test_no_symbolic_link_leaves_the_folder(tmp_path: Path) -> None:
    """A link inside the output folder is not followed, neither as a folder nor as a file."""
    outside = tmp_path / "outside"
    outside.mkdir()
    (outside / "x").write_text("keep")
    out = tmp_path / "out"
    out.mkdir()
    (out / "db").symlink_to(outside)
    (out / "file").symlink_to(outside / "x")
    with pytest.raises(DiagnosticError) as error:
        write_folder(files(db__x="1", file="1"), out, force=True)
    assert codes(error) == ["PG506", "PG506"]
    assert tree(outside) == {"x": "keep"}


def test_a_full_disk_leaves_the_old_state(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """ENOSPC while staging: the old files are all there, no temporary file is left."""
    write_folder(files(a="1", b="1"), tmp_path)
    before = tree(tmp_path)
    real = Path.write_bytes

    def full(self: Path, data: bytes) -> int:
        if STAGE in str(self) and self.name == "1":
            raise OSError(errno.ENOSPC, "No space left on device", str(self))
        return real(self, data)

    monkeypatch.setattr(Path, "write_bytes", full)
    with pytest.raises(DiagnosticError) as error:
        write_folder(files(a="2", b="2"), tmp_path)
    assert codes(error) == ["PG503"]
    assert tree(tmp_path) == before
    with pytest.raises(DiagnosticError):
        write_folder(files(a="2", b="2"), tmp_path / "new")
    assert not (tmp_path / "new").exists()


def test_a_damaged_journal_is_discarded(tmp_path: Path) -> None:
    """A journal that is not ours, or that points elsewhere, never moves a file."""
    write_folder(files(a="1"), tmp_path)
    for text in ("{", "[]", '{"stage": "../x", "moves": {"../../a": "0"}, "removals": ["/etc/passwd"]}'):
        (tmp_path / JOURNAL).write_text(text)
        assert recover(tmp_path)
        assert sorted(tree(tmp_path)) == ["a", "manifest.json"]


def test_a_staged_file_with_other_bytes_is_left_out(tmp_path: Path) -> None:
    """After a power cut a staged file may be empty: its hash decides."""
    write_folder(files(a="1"), tmp_path)
    stage = tmp_path / f"{STAGE}x"
    stage.mkdir()
    (stage / "0").write_text("")
    (tmp_path / JOURNAL).write_text(
        json.dumps({"stage": stage.name, "moves": {"a": digest(b"2")}, "removals": [], "before": {"a": digest(b"1")}})
    )
    recover(tmp_path)
    assert tree(tmp_path)["a"] == "1"


@pytest.mark.parametrize(
    ("moves", "removals", "before", "stage"),
    [
        ({}, ["mine"], {}, "x"),
        ({}, ["mine"], {"mine": digest(b"guess")}, "x"),
        ({"mine": digest(b"theirs")}, [], {}, "x"),
        ({".git/hooks/post-commit": digest(b"theirs")}, [], {}, "x"),
        ({"sub/.hidden": digest(b"theirs")}, [], {}, "x"),
        ({"new": digest(b"secret")}, [], {}, "link"),
    ],
)
def test_a_crafted_journal_touches_nothing_of_the_user(
    moves: dict[str, str], removals: list[str], before: dict[str, str], stage: str, tmp_path: Path
) -> None:
    """A journal may come with a folder from elsewhere: only files with the bytes that it knows are touched."""
    out, secret = tmp_path / "out", tmp_path / "secret"
    write_folder(files(a="1"), out)
    (out / "mine").write_text("written by hand")
    (out / f"{STAGE}x").mkdir()
    (out / f"{STAGE}x/0").write_text("theirs")
    secret.mkdir()
    (secret / "0").write_text("secret")
    (out / f"{STAGE}link").symlink_to(secret)
    plan = {"stage": f"{STAGE}{stage}", "moves": moves, "removals": removals, "before": before}
    (out / JOURNAL).write_text(json.dumps(plan))
    assert recover(out)
    (out / f"{STAGE}link").unlink(missing_ok=True)
    assert sorted(tree(out)) == ["a", "manifest.json", "mine"]
    assert (out / "mine").read_text() == "written by hand"
    assert tree(secret) == {"0": "secret"}


def test_what_the_user_changed_after_a_crash_is_kept(tmp_path: Path) -> None:
    """Between the crash and the next run somebody edits a file that the run would have replaced."""
    write_folder(files(a="1", b="1"), tmp_path)
    (tmp_path / f"{STAGE}x").mkdir()
    for number in (0, 1):
        (tmp_path / f"{STAGE}x/{number}").write_text("2")
    one, two = digest(b"1"), digest(b"2")
    plan = {"stage": f"{STAGE}x", "moves": {"a": two, "b": two}, "removals": [], "before": {"a": one, "b": one}}
    (tmp_path / JOURNAL).write_text(json.dumps(plan))
    (tmp_path / "a").write_text("edited")
    recover(tmp_path)
    assert (tmp_path / "a").read_text() == "edited"
    assert (tmp_path / "b").read_text() == "2"


@pytest.mark.skipif(sys.platform == "win32", reason="the temporary folder is the user's own there")
@pytest.mark.parametrize("trap", ["folder", "file"])
def test_a_lock_follows_no_link(trap: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Somebody else's link in the public temporary folder makes no file and opens none."""
    public, out, victim = tmp_path / "tmp", tmp_path / "out", tmp_path / "victim"
    public.mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(public))
    with exclusive(out):
        (lock,) = public.rglob("*.lock")
    assert lock.parent.stat().st_mode & 0o777 == 0o700
    lock.unlink()
    if trap == "file":
        lock.symlink_to(victim)
    else:
        victim.mkdir()
        lock.parent.rmdir()
        lock.parent.symlink_to(victim)
    with exclusive(out):
        pass
    assert not victim.exists() if trap == "file" else not list(victim.iterdir())


def test_check_notices_one_changed_byte(tmp_path: Path) -> None:
    """Generate --check: clean after generation, a diff and PG504 after one changed, missing or extra byte."""
    out = tmp_path / "out"
    assert api.generate(FAQ, out).ok
    clean = api.generate(FAQ, out, check_only=True)
    assert clean.ok
    assert clean.diff == ""
    (target,) = out.glob("*.scl")
    target.write_bytes(target.read_bytes().replace(b"16#C47F", b"16#C47E"))
    stale = api.generate(FAQ, out, check_only=True)
    assert [d.code for d in stale.diagnostics] == ["PG504"]
    assert "-    Para_No : Word := 16#C47E;" in stale.diff
    assert "+    Para_No : Word := 16#C47F;" in stale.diff
    target.unlink()
    assert [d.message for d in api.generate(FAQ, out, check_only=True).diagnostics] == ["file is missing"]


def test_compare_writes_nothing(tmp_path: Path) -> None:
    """--check on a folder that does not exist reports every file and creates none."""
    diff, found = compare_folder(files(a="1"), tmp_path / "none")
    assert [d.code for d in found] == ["PG504", "PG504"]
    assert "+1" in diff
    assert not (tmp_path / "none").exists()
    assert write.JOURNAL.startswith(".")


def test_a_recovered_folder_is_mentioned(tmp_path: Path) -> None:
    """The run after an interrupted one says so: PG505 is a note."""
    out = tmp_path / "out"
    assert api.generate(FAQ, out).ok
    (out / f"{STAGE}left").mkdir()
    result = api.generate(FAQ, out)
    assert [(d.code, d.severity.label) for d in result.diagnostics] == [("PG505", "note")]
    assert not list(out.glob(f"{STAGE}*"))


def test_a_file_in_the_way_of_a_folder_is_reported_before_anything_is_written(tmp_path: Path) -> None:
    """A user's file called scl stays, and no other file is written."""
    (tmp_path / "scl").write_text("mine")
    with pytest.raises(DiagnosticError) as error:
        write_folder(files(a="1", scl__b="1"), tmp_path, force=True)
    assert codes(error) == ["PG501"]
    assert tree(tmp_path) == {"scl": "mine"}


def test_an_edited_file_that_is_no_longer_generated_is_kept_and_told(tmp_path: Path) -> None:
    """It would be imported along with the new ones: the result names it."""
    write_folder(files(a="1", b="1"), tmp_path)
    (tmp_path / "b").write_text("by hand")
    assert write_folder(files(a="1"), tmp_path).kept == ("b",)
    assert tree(tmp_path)["b"] == "by hand"


def test_a_failure_half_way_is_completed_by_the_next_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """An error after the point of no return is told as such; the next run completes the folder."""
    real = replacing.place

    def broken(source: Path, target: Path) -> None:
        if str(target).endswith("b"):
            raise OSError(errno.EIO, "Input/output error", str(target))
        real(source, target)

    new = files(a="1", b="1")
    with monkeypatch.context() as patch:
        patch.setattr(replacing, "place", broken)
        with pytest.raises(DiagnosticError) as error:
            write_folder(new, tmp_path)
    assert "interrupted half-way" in error.value.diagnostics[0].message
    assert write_folder(new, tmp_path).recovered
    assert tree(tmp_path) == {f.path: f.data.decode() for f in new}


def test_a_file_where_the_folder_should_be(tmp_path: Path) -> None:
    """The remedy is another name, not permissions."""
    (tmp_path / "file").write_text("mine", "utf-8")
    for folder, what in ((tmp_path / "file", "the folder"), (tmp_path / "file" / "below", "a folder above it")):
        with pytest.raises(DiagnosticError) as error:
            write_folder(files(a="1"), folder)
        assert codes(error) == ["PG503"]
        assert error.value.diagnostics[0].help == f"a file has the name of {what}: choose another one"
    assert (tmp_path / "file").read_text("utf-8") == "mine"


def test_a_loop_of_links_is_a_diagnostic(tmp_path: Path) -> None:
    """--out that points at itself ends in PG503, not in a traceback."""
    (tmp_path / "loop").symlink_to("loop")
    with pytest.raises(DiagnosticError) as error:
        write_folder(files(a="1"), tmp_path / "loop")
    assert codes(error) == ["PG503"]


def test_two_writers_take_turns(tmp_path: Path) -> None:
    """While one holds the folder the other one waits, and gives up with PG508."""
    with exclusive(tmp_path), pytest.raises(DiagnosticError) as error, exclusive(tmp_path, patience=0):
        raise AssertionError
    assert codes(error) == ["PG508"]
    with exclusive(tmp_path, patience=0):
        pass


@pytest.mark.slow
def test_parallel_processes_leave_a_complete_folder(tmp_path: Path) -> None:
    """Four generations into one folder at once: all succeed and nothing is missing."""
    command = [sys.executable, "-m", "plcgen", "generate", str(FAQ), "--out", str(tmp_path / "out"), "--quiet"]
    running = [subprocess.Popen(command, stderr=subprocess.PIPE) for _ in range(4)]
    assert [(process.wait(), process.communicate()[1]) for process in running] == [(0, b"")] * 4
    assert api.generate(FAQ, tmp_path / "out", check_only=True).ok


def test_a_big_difference_is_named_not_compared(tmp_path: Path) -> None:
    """The manifest and very long files are reported without a line-by-line diff, in no time."""
    long = "\n".join(str(n) for n in range(100_000))
    write_folder(files(a=long), tmp_path)
    (tmp_path / "a").write_text(long[::-1])
    diff, found = compare_folder(files(a=long), tmp_path)
    assert [d.code for d in found] == ["PG504"]
    assert diff.count("\n") == 3


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="needs fork")
def test_killed_writers_lose_nothing(tmp_path: Path) -> None:
    """SIGKILL at random moments: the next run finds exactly the old or exactly the new state, --check the half-way."""
    command = [sys.executable, str(Path(__file__).with_name("kills.py")), str(tmp_path / "out"), "40"]
    done = subprocess.run(
        command, capture_output=True, text=True, check=False, env={**os.environ, "PYTHONPATH": str(ROOT)}
    )
    assert (done.returncode, done.stderr) == (0, "")


def test_what_is_the_users_own_is_left_alone(tmp_path: Path) -> None:
    """``user_owned: [Main]``: a changed Main stays, whatever --force says; verify reports it; others are errors."""
    spec, out = tmp_path / "job.yaml", tmp_path / "out"
    text = FAQ.read_text("utf-8")
    spec.write_text(text.replace("names: faq,", "names: faq, user_owned: [Main, notes.md],"), "utf-8")
    assert api.generate(spec, out).ok
    main = out / "example/Main.scl"
    main.write_text(main.read_text("utf-8").replace("An example: if", "Mine: if"), "utf-8")
    (out / "notes.md").write_text("mine")
    mine = main.read_bytes()
    assert api.generate(spec, out, force=True).ok
    assert main.read_bytes() == mine
    assert api.generate(spec, out, check_only=True).ok
    found = api.verify(spec, out, faults="none")
    assert found.ok, [check.verdict for check in found.checks()]
    assert next(check.text for check in found.checks() if check.id == "files.owned") == "example/Main.scl, notes.md"
    (out / "more.scl").write_text("// not mine")
    codes = {check.diagnostic.code for check in api.verify(spec, out, faults="none").checks() if check.diagnostic}
    assert "PG613" in codes


def test_the_way_to_keep_a_change_is_told_and_works(tmp_path: Path) -> None:
    """Generate and verify name the same key for a file that was changed; with it in the spec, the change stays."""
    spec, out = tmp_path / "job.yaml", tmp_path / "out"
    text = FAQ.read_text("utf-8")
    spec.write_text(text, "utf-8")
    assert api.generate(spec, out).ok
    main = out / "example/Main.scl"
    main.write_text(main.read_text("utf-8").replace("An example: if", "Mine: if"), "utf-8")
    refused = next(one for one in api.generate(spec, out).diagnostics if one.code == "PG502")
    files = next(check for check in api.verify(spec, out, faults="none").checks() if check.id == "files.manifest")
    advice = "declare it as yours: plc: {user_owned: [Main]}"
    assert refused.help == f"{advice}, or overwrite it with --force: your change is lost then"
    assert files.diagnostic is not None
    assert files.diagnostic.help == f"generate again with --force, or {advice}"
    spec.write_text(text.replace("names: faq,", "names: faq, user_owned: [Main],"), "utf-8")
    assert api.generate(spec, out).ok
    assert "Mine: if" in main.read_text("utf-8")
