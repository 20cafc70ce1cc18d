"""Paths that somebody else wrote: they mean one file on every system, or they are refused, at every door."""

from __future__ import annotations

import io
import itertools
import json
import os
import stat
import zipfile
from collections.abc import Callable
from pathlib import Path, PurePosixPath, PureWindowsPath

import pytest

from plcgen import api
from plcgen.base.diagnostics import DiagnosticError
from plcgen.base.files.files import below
from plcgen.base.files.workbook import WorkbookError, read_sheets
from plcgen.base.paths import trap_in
from plcgen.base.programs import candidates, find_program
from plcgen.build.environment import RenderedFile
from plcgen.build.writing import add_files
from plcgen.report.revision import _of_interest
from tests.projects import FAQ

# What Python 3.13 offers in its place does not exist in 3.11.
pytestmark = pytest.mark.filterwarnings(r"ignore:pathlib\.PurePath\.is_reserved:DeprecationWarning")

ROOM = PureWindowsPath(r"C:\Users\me\AppData\Local\Temp\plcgen-base-1")
TRAPS = (
    "C:/Users/me/evil.yaml", "C:evil.yaml", "c:/x.yaml", "sub/C:/x.yaml", "spec.yaml:hidden.yaml", "a:b/c.yaml",
    "//server/share/x.yaml", "\\\\server\\share\\x.yaml", "..\\evil.yaml", "sub\\..\\..\\evil.yaml", "\\evil.yaml",
    "../evil.yaml", "sub/../../evil.yaml", "aux.yaml", "sub/CON.yaml", "NUL", "nul.tar.yaml", "con .yaml",
    "COM1.yaml", "com9", "LPT\u00b9.yaml", "CONIN$", "lpt3/x.yaml", "evil.yaml.", "evil.yaml ", "sub./x.yaml",
    "sub /x.yaml", "a\0b.yaml", "a\nb.yaml", "a\x1fb.yaml",
)  # fmt: skip
"""Names after Microsoft's "Naming Files, Paths, and Namespaces"."""
FINE = (
    "spec.yaml",
    "sub/spec.yaml",
    "a.b/c.d.yaml",
    "console.yaml",
    "com.yaml",
    "com10.yaml",
    ".plc/x.yaml",
    "Ü/ß x.yaml",
)


def below_room(path: str) -> bool:
    """Whether Windows puts a path below the room, as the same file that POSIX sees."""
    target = ROOM / path
    same = target.parts[len(ROOM.parts) :] == PurePosixPath(path).parts
    devices = any(PureWindowsPath(part).is_reserved() for part in PureWindowsPath(path).parts)
    return target.is_relative_to(ROOM) and ".." not in target.parts and same and not devices and ":" not in path


def test_nothing_that_passes_leaves_a_room_on_windows() -> None:
    """All paths of up to four pieces that mean something on Windows: what passes is judged by pathlib."""
    pieces = ("a", "C", ":", "/", "\\", ".", "..", " ", "NUL", "com1", ".yaml", "\0")
    passed = 0
    for length in range(1, 5):
        for path in map("".join, itertools.product(pieces, repeat=length)):
            if not trap_in(path):
                passed += 1
                assert below_room(path), path
    assert passed > 500


@pytest.mark.parametrize("path", TRAPS)
def test_traps(path: str) -> None:
    """Each is refused, with a reason."""
    assert trap_in(path)


@pytest.mark.parametrize("path", FINE)
def test_other_names_pass(path: str) -> None:
    """As they are."""
    assert trap_in(path) == ""
    assert below_room(path)


def test_a_revision_is_not_written_outside_its_room() -> None:
    """A commit may hold any name: those that Windows takes for another place are left alone."""
    assert [path for path in TRAPS if _of_interest(path, ["spec.yaml", "plc"])] == []
    assert _of_interest("sub/spec.yaml", ["spec.yaml"])


def spec_with(folder: Path, **keys: object) -> list[str]:
    """What is said about a spec with these keys."""
    (folder / "spec.yaml").write_text(
        json.dumps({"plc": {"name": "a", "family": "s7-1500", "toolchain": "tia-v19"}, **keys})
    )
    return [f"{d.code} {d.message}" for d in api.check(folder / "spec.yaml").diagnostics]


def include(folder: Path, name: str) -> list[str]:
    return spec_with(folder, include=[name])


def device(folder: Path, name: str) -> list[str]:
    return spec_with(
        folder, drives={"d": {"device": name, "hardware_id": 270}}, jobs={"j": {"drive": "d", "read": ["P1"]}}
    )


def symbols(folder: Path, name: str) -> list[str]:
    stations = {"p": {"address": 2, "symbols": name}}
    jobs = {"j": {"station": "p", "read": ["VB100"]}}
    return spec_with(folder, ppi={"m": {"module": "cm1241", "port": 270, "stations": stations, "jobs": jobs}})


def lock(folder: Path, name: str) -> list[str]:
    (folder / "l.yaml").write_text(f"format: 2\nsources: [{json.dumps(name)}]\nblocks: []\n")
    return [f"{d.code} {d.message}" for d in api.check_lock(lock=folder / "l.yaml").diagnostics]


def manifest(folder: Path, name: str) -> list[str]:
    api.generate(FAQ, folder / "out")
    text = json.loads((folder / "out" / "manifest.json").read_text("utf-8"))
    text["files"].append({"path": name, "sha256": "0" * 64, "bytes": 1})
    (folder / "out" / "manifest.json").write_text(json.dumps(text), "utf-8")
    return [d.code for d in api.verify(FAQ, folder / "out", faults="none").problems if d.code == "PG611"]


def output(folder: Path, name: str) -> list[str]:
    try:
        add_files([RenderedFile(name, b"x")], folder / "out")
    except DiagnosticError as problem:
        return [f"{d.code} {d.message}" for d in problem.diagnostics]
    return []


def workbook(_: Path, name: str) -> list[str]:
    data = io.BytesIO()
    with zipfile.ZipFile(data, "w") as book:
        book.writestr("xl/worksheets/sheet1.xml", "<worksheet/>")
        book.writestr(name, "x")
    try:
        list(read_sheets(data.getvalue(), 10))
    except WorkbookError as problem:
        return [str(problem)]
    return []


DOORS: dict[Callable[[Path, str], list[str]], str] = {
    include: "PG112", device: "PG201", symbols: "PG236", lock: "PG633", output: "PG506", workbook: "it has a part",
}  # fmt: skip


@pytest.mark.parametrize("door", DOORS)
def test_every_door_refuses_every_trap(door: Callable[[Path, str], list[str]], tmp_path: Path) -> None:
    """Includes, profiles, symbol tables, locks, outputs, workbooks: on Linux as on Windows, and nothing is written."""
    before = set(tmp_path.parent.rglob("evil*"))
    for trap in TRAPS:
        name = f"{trap}/x.yaml" if door is device and not trap.endswith(".yaml") else trap
        if door is workbook and "\0" in name:
            continue  # zipfile ends a name there
        if door in {device, symbols, lock} and not name.isprintable():
            assert door(tmp_path, name), "no text of a file has such a character"
            continue
        why = trap_in(name, up=door in {include, device, symbols}) or "is not below the folder of the spec"
        said = [text for text in door(tmp_path, name) if text.startswith(DOORS[door])]
        assert len(said) == 1, trap
        assert why in said[0], trap
    assert set(tmp_path.parent.rglob("evil*")) == before


@pytest.mark.parametrize("trap", ["C:/Users/me/x.scl", "//server/share/x.scl", "scl/NUL.scl", "scl\\x.scl"])
def test_a_manifest_names_no_trap(trap: str, tmp_path: Path) -> None:
    """It comes with the folder that is judged; nobody even asks the disk about such a path."""
    assert manifest(tmp_path, trap) == ["PG611"]


def test_a_computer_is_not_asked(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Windows would log on to whatever stands behind //: the path is refused before anybody looks for it."""
    monkeypatch.setattr(Path, "resolve", lambda _: pytest.fail("looked for"))
    assert below(tmp_path, "//server/share/x.yaml") is None
    assert below(tmp_path, "\\\\server\\share\\x.yaml") is None


def program(folder: Path, name: str) -> Path:
    folder.mkdir(exist_ok=True)
    path = folder / name
    path.write_text("#!/bin/sh\n")
    path.chmod(path.stat().st_mode | stat.S_IXUSR)
    return path


@pytest.mark.skipif(os.name == "nt", reason="programs as POSIX has them")
def test_a_program_is_not_taken_from_the_current_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Whether PATH has a dot, nothing between two colons, a relative folder or the folder itself."""
    here, there = tmp_path / "repository", tmp_path / "bin"
    program(here, "git")
    program(here / "sub", "git")
    monkeypatch.chdir(here)
    for path in ("", ".", "sub", ":", f"{here}", f"{here}/", f".:{here}:sub", f"{here}/../repository"):
        monkeypatch.setenv("PATH", path)
        assert find_program("git") is None, path
    good = program(there, "git")
    monkeypatch.setenv("PATH", f".::sub:{here}:{there}")
    assert find_program("git") == str(good)


def test_where_windows_is_looked_for_programs() -> None:
    """Absolute folders of PATH in their order, only .exe: no current folder, no drive without a root, no batch file."""
    path = r'C:\Windows\System32;;.;bin;\tools;D:tools;"C:\Program Files\Git\cmd"'
    found = list(candidates("git", path, windows=True))
    assert found == [
        PureWindowsPath(r"C:\Windows\System32\git.exe"), PureWindowsPath(r"C:\Program Files\Git\cmd\git.exe"),
    ]  # fmt: skip
