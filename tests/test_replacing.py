"""One file in place of another."""

from __future__ import annotations

import os
import threading
from pathlib import Path

import pytest

from plcgen.base.replacing import replace_file


def left(folder: Path) -> dict[str, bytes]:
    return {each.name: each.read_bytes() for each in folder.iterdir()}


@pytest.mark.parametrize("links", [True, False])
def test_whatever_fails_the_old_file_is_back(links: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """If the last step fails, with hard links or without, nothing has changed, and nothing is left behind."""
    path = tmp_path / "report.json"
    path.write_bytes(b"old")
    rename, failed = Path.rename, []

    def fail(self: Path, target: Path) -> Path:
        if target == path and not failed:
            failed.append(self)
            raise PermissionError(13, "in use")
        return rename(self, target)

    def no_link(source: Path, target: Path) -> None:
        raise PermissionError(1 if failed or not links else 13, "not permitted", str(source), None, str(target))

    with monkeypatch.context() as patch:
        patch.setattr(os, "link", no_link)
        patch.setattr(Path, "rename", fail)
        with pytest.raises(PermissionError):
            replace_file(path, b"new")
    assert left(tmp_path) == {"report.json": b"old"}
    replace_file(path, b"new")
    assert left(tmp_path) == {"report.json": b"new"}


@pytest.mark.parametrize("existed", [True, False])
def test_an_edit_meanwhile_is_kept(existed: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Whoever saves the file while it is being replaced keeps his words, and the caller is told."""
    told = set()
    for moment in range(10):
        path = tmp_path / str(moment) / "lock.json"
        path.parent.mkdir()
        if existed:
            path.write_bytes(b"old")
        count = 0

        def edit(path: Path = path, moment: int = moment) -> None:
            nonlocal count
            if count == moment:
                with path.open("ab") as out:
                    out.write(b"by hand")
            count += 1

        with monkeypatch.context() as patch:
            for owner, name in ((Path, "rename"), (Path, "unlink"), (os, "link")):
                real = getattr(owner, name)
                patch.setattr(owner, name, lambda *a, real=real, **k: (edit(), real(*a, **k))[1])
            try:
                replace_file(path, b"new")
                refused = False
            except FileExistsError:
                refused = True
        if count <= moment:
            break
        (kept,) = left(path.parent).values()
        assert b"by hand" in kept
        assert (b"new" in kept) != refused
        told.add(refused)
    assert told == {True, False}


def test_a_file_that_may_not_be_written_is_not_replaced(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Whoever protects a file keeps it, although renaming would only need the rights of the folder."""
    path = tmp_path / "report.json"
    path.write_bytes(b"mine")
    monkeypatch.setattr(os, "access", lambda place, mode: (place, mode) != (path.resolve(), os.W_OK))
    with pytest.raises(PermissionError):
        replace_file(path, b"new")
    assert {each.name: each.read_bytes() for each in tmp_path.iterdir()} == {"report.json": b"mine"}


@pytest.mark.skipif(os.name != "posix", reason="modes, links and FIFOs as POSIX has them")
def test_modes_links_and_fifos_stay(tmp_path: Path) -> None:
    """A script stays executable, a link a link, and a FIFO is read by whoever waits for it."""
    script, link, fifo = tmp_path / "script", tmp_path / "link", tmp_path / "fifo"
    script.write_bytes(b"old")
    script.chmod(0o750)
    link.symlink_to(script)
    replace_file(link, b"new")
    assert (script.read_bytes(), script.stat().st_mode & 0o777, link.is_symlink()) == (b"new", 0o750, True)
    os.mkfifo(fifo)
    writer = threading.Thread(target=replace_file, args=(fifo, b"said"))
    writer.start()
    assert fifo.read_bytes() == b"said"
    writer.join()
    assert fifo.is_fifo()


@pytest.mark.skipif(os.name != "posix", reason="umask as POSIX has it")
def test_a_new_file_has_the_mode_that_others_have(tmp_path: Path) -> None:
    """That of the umask, unlike a temporary file."""
    (tmp_path / "usual").touch()
    replace_file(tmp_path / "new", b"")
    assert (tmp_path / "new").stat().st_mode == (tmp_path / "usual").stat().st_mode
