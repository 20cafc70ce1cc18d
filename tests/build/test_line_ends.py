"""Line ends: git on Windows turns LF into CRLF, and nothing that plcgen compares depends on it."""

from __future__ import annotations

import csv
import subprocess
from pathlib import Path

import pytest

from plcgen import api
from plcgen.base.files.hashes import has_digest, same_text, text_digest
from plcgen.s7.cpu.sources import read_tags
from tests.projects import FAQ, ROOT

V5 = ROOT / "specs" / "s7-300_mm440_dp.yaml"


def git(room: Path, *arguments: str) -> None:
    who = ["-c", "user.name=Test", "-c", "user.email=test@example.org"]
    subprocess.run(["git", "-C", str(room), *who, *arguments], capture_output=True, check=True)


@pytest.fixture(params=[FAQ, V5], ids=["tia", "v5"])
def clone(request: pytest.FixtureRequest, tmp_path: Path) -> Path:
    """A clone as git makes it on Windows of a repository with a spec, its files and a lock."""
    origin = tmp_path / "origin"
    origin.mkdir()
    (origin / "job.yaml").write_bytes(request.param.read_bytes())
    assert api.generate(origin / "job.yaml").ok
    assert api.lock(origin / "job_generated", out=origin / "plcgen.lock.json").ok
    git(origin, "init", "--quiet")
    git(origin, "add", ".")
    git(origin, "commit", "--quiet", "-m", "generated")
    git(tmp_path, "-c", "core.autocrlf=true", "clone", "--quiet", str(origin), "clone")
    return tmp_path / "clone"


def holds(folder: Path) -> None:
    """Nothing is stale, nothing would be written, every hash and the lock are right."""
    before = {path: path.read_bytes() for path in folder.rglob("*") if path.is_file() and ".git" not in path.parts}
    assert api.generate(folder / "job.yaml", check_only=True).diff == ""
    made = api.generate(folder / "job.yaml")
    assert (made.ok, made.written, made.removed) == (True, (), ())
    assert api.check_lock(lock=folder / "plcgen.lock.json").changes == ()
    assert not api.lock(folder / "job_generated", out=folder / "plcgen.lock.json").changed
    files = next(group for group in api.verify(folder / "job.yaml", faults="none").groups if group.name == "files")
    assert {check.outcome.value for check in files.checks} == {"ok"}
    assert {path: path.read_bytes() for path in before} == before


@pytest.mark.slow
def test_a_clone_with_autocrlf_is_up_to_date(clone: Path) -> None:
    """The spec and the lock have CRLF, the files of the folder are left alone by its .gitattributes."""
    assert b"\r\n" in (clone / "job.yaml").read_bytes()
    assert b"\r\n" in (clone / "plcgen.lock.json").read_bytes()
    assert b"\r\n" not in (clone / "job_generated" / "manifest.json").read_bytes()
    holds(clone)


def test_line_ends_that_changed_all_the_same_change_nothing(clone: Path) -> None:
    """Without the .gitattributes git rewrites every text: hashes, --check and lock still hold."""
    for path in (clone / "job_generated").rglob("*"):
        if path.is_file() and b"\0" not in path.read_bytes():
            path.write_bytes(path.read_bytes().replace(b"\r\n", b"\n").replace(b"\n", b"\r\n"))
    assert b"\r\n" in (clone / "job_generated" / "manifest.json").read_bytes()
    holds(clone)


def test_another_change_is_still_seen(clone: Path) -> None:
    """CRLF and one other byte: stale, and never overwritten without --force."""
    source = clone / "job_generated" / "example" / "Main.scl"
    source.write_bytes(source.read_bytes().replace(b"\n", b"\r\n").replace(b"Example", b"example", 1))
    assert "Example" in api.generate(clone / "job.yaml", check_only=True).diff
    assert [d.code for d in api.generate(clone / "job.yaml").diagnostics if d.severity.label == "error"] == ["PG502"]


def test_digests_with_either_line_end() -> None:
    """The hash of a text is that of the same text with the other line ends, and of no other."""
    digest = text_digest(b"a\nb\n")
    assert has_digest(b"a\r\nb\r\n", digest)
    assert has_digest(b"a\nb\n", text_digest(b"a\r\nb\r\n"))
    assert not has_digest(b"a\nb", digest)
    assert same_text(b"a\r\nb", b"a\nb")
    assert not same_text(b"a\rb", b"a\nb")


def test_tables_open_in_a_spreadsheet_with_german_settings(tmp_path: Path) -> None:
    """Semicolons between cells, a byte order mark in front, nothing that a spreadsheet would compute."""
    text = FAQ.read_text("utf-8").replace("Read the ramp-up time P50303", "Größe lesen =1+1")
    (tmp_path / "job.yaml").write_text(text, "utf-8")
    assert api.generate(tmp_path / "job.yaml").ok
    data = (tmp_path / "job_generated" / "tags.csv").read_bytes()
    assert data.startswith(b"\xef\xbb\xbfName;Data Type;")
    rows = list(csv.reader(data.decode("utf-8-sig").splitlines(), delimiter=";"))
    assert rows[1] == ["readRampUpExecute", "Bool", "%M50.0", "execute: Größe lesen =1+1"]


def test_tables_of_earlier_releases_are_still_read(tmp_path: Path) -> None:
    """Commas up to 0.1.0, semicolons since; a comment may hold the other one."""
    for separator, other in ((",", ";"), (";", ",")):
        rows = (("Name", "Data Type", "Logical Address", "Comment"), ("a", "Bool", "%M1.0", f"x{other} y"))
        (tmp_path / "tags.csv").write_text("".join(f"{separator.join(row)}\n" for row in rows), "utf-8")
        assert read_tags(tmp_path / "tags.csv") == {"a": ("M1.0", "Bool")}
