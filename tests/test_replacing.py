"""One file in place of another."""

from __future__ import annotations

import os
import threading
from pathlib import Path

import pytest

from plcgen.replacing import replace_file


def test_the_old_file_is_there_until_the_new_one_is(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """If the last step fails, nothing has changed, and nothing is left behind."""
    path = tmp_path / "report.json"
    path.write_bytes(b"old")

    def fail(_self: Path, _target: Path) -> None:
        assert path.read_bytes() == b"old"
        raise PermissionError(13, "in use")

    with monkeypatch.context() as patch:
        patch.setattr(Path, "replace", fail)
        with pytest.raises(PermissionError):
            replace_file(path, b"new")
    assert {each.name: each.read_bytes() for each in tmp_path.iterdir()} == {"report.json": b"old"}
    replace_file(path, b"new")
    assert {each.name: each.read_bytes() for each in tmp_path.iterdir()} == {"report.json": b"new"}


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
