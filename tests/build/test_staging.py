"""How new files take the place of old ones: exactly old or exactly new, and nobody's edit is lost."""

from __future__ import annotations

import json
import os
import signal
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from plcgen.base.diagnostics import DiagnosticError
from plcgen.base.interrupts import ENDING, unwinding
from plcgen.build.environment import RenderedFile
from plcgen.build.manifest import digest
from plcgen.build.staging import STAGE, recover
from plcgen.build.writing import add_files, write_folder

Moment = Callable[[str, Path], None]
"""Called before an operation on the disk, with its name and the file that it moves or removes."""

OLD = {"a": "1", "sub/b": "1", "gone": "1"}
NEW = {"a": "2", "sub/b": "2", "fresh": "2"}
MOMENTS = 40
"""More operations than a change of these files takes."""


def files(content: dict[str, str]) -> list[RenderedFile]:
    found = [RenderedFile(name, text.encode()) for name, text in content.items()]
    entries = [{"path": f.path, "sha256": digest(f.data)} for f in found]
    return [*found, RenderedFile("manifest.json", json.dumps({"files": entries}).encode())]


def tree(folder: Path) -> dict[str, str]:
    return {p.relative_to(folder).as_posix(): p.read_text() for p in sorted(folder.rglob("*")) if p.is_file()}


def state(content: dict[str, str]) -> dict[str, str]:
    return {f.path: f.data.decode() for f in files(content)}


def before_each_operation(patch: pytest.MonkeyPatch, moment: Moment) -> None:
    """Call ``moment`` before every operation that moves or removes a file."""
    link = os.link
    patch.setattr(os, "link", lambda source, target: (moment("link", Path(target)), link(source, target))[1])
    for name in ("rename", "replace", "unlink"):
        real = getattr(Path, name)

        def told(self: Path, *given: object, _real: Callable[..., object] = real, _name: str = name, **more: object):
            moment(_name, self)
            return _real(self, *given, **more)

        patch.setattr(Path, name, told)


def test_a_killed_process_leaves_the_old_or_the_new_state(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Killed before any operation on the disk: after the next run's recovery the folder is exactly old or exactly new.

    Old before the journal, new from then on; nothing of a stage is left.
    """

    class KilledError(BaseException):
        pass

    found = []
    for number in range(MOMENTS):
        folder = tmp_path / str(number)
        write_folder(files(OLD), folder)
        left = number

        def count(_name: str, _path: Path) -> None:
            nonlocal left
            left -= 1
            if left < 0:  # and from then on: a dead process tidies nothing up
                raise KilledError

        try:
            with monkeypatch.context() as patch:
                before_each_operation(patch, count)
                write_folder(files(NEW), folder)
        except KilledError:
            recover(folder)
        assert tree(folder) in (state(OLD), state(NEW)), number
        found.append(tree(folder) == state(NEW))
        if left >= 0:
            break
    assert found == sorted(found)
    assert 15 < len(found) < MOMENTS
    assert found[0] is False


def in_place(path: Path) -> None:
    path.parent.mkdir(exist_ok=True)
    with path.open("a") as out:
        out.write("by hand")


def another_file(path: Path) -> None:
    path.parent.mkdir(exist_ok=True)
    path.with_name("draft").write_text("by hand")
    os.rename(path.with_name("draft"), path)  # noqa: PTH104 - the operations of Path are watched


def written(patch: pytest.MonkeyPatch, folder: Path, number: int, edit: Callable[[], object]) -> tuple[int, list[str]]:
    """Write ``NEW``; ``edit`` comes before the operation of a number, or with -1 before there is any.

    How many operations it took, and the codes of what was wrong.
    """
    done = 0

    def count(_name: str, _path: Path) -> None:
        nonlocal done
        done += 1
        if done == number + 1:
            edit()

    def slowly() -> Iterator[RenderedFile]:
        yield from files(NEW)
        if number == -1:
            edit()

    with patch.context() as here:
        before_each_operation(here, count)
        try:
            write_folder(slowly(), folder)
        except DiagnosticError as problem:
            return done, [d.code for d in problem.diagnostics]
        return done, []


@pytest.mark.parametrize("edit", [in_place, another_file])
@pytest.mark.parametrize("name", ["a", "sub/b", "gone", "fresh", "manifest.json"])
def test_an_edit_at_any_moment_is_kept(
    name: str, edit: Callable[[Path], None], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Whoever saves a file while plcgen is writing finds his words there afterwards.

    Either nothing was written, and PG509 says why, or he saved after the new file had come; the rest is of one run.
    """
    said = []
    for number in range(0 if name == "gone" else -1, MOMENTS):  # what is left over is looked for after all else
        folder = tmp_path / str(number)
        write_folder(files(OLD), folder)
        done, codes = written(monkeypatch, folder, number, lambda path=folder / name: edit(path))
        if done <= number:
            break
        after = tree(folder)
        assert "by hand" in after.pop(name, ""), (number, codes, after)
        expected = state(OLD if codes else NEW)
        expected.pop(name, None)
        assert codes in ([], ["PG509"])
        assert after == expected, (number, codes)
        assert not list(folder.glob(f"{STAGE}*"))
        said.append(bool(codes))
    assert said[0]
    assert said == sorted(said, reverse=True)


def test_every_edit_is_told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Whoever saves several files while the new ones are made is told of each."""
    write_folder(files(OLD), tmp_path)
    edited = [tmp_path / name for name in ("a", "sub/b", "fresh")]
    _, codes = written(monkeypatch, tmp_path, -1, lambda: [in_place(path) for path in edited])
    assert codes == ["PG509"] * 3
    assert tree(tmp_path) == state(OLD) | {"a": "1by hand", "sub/b": "1by hand", "fresh": "by hand"}


def test_an_edit_of_a_new_file_survives_the_way_back(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """One file has come and is saved by hand, then another one stops the change: neither edit is lost."""
    write_folder(files(OLD), tmp_path)

    def edit(name: str, path: Path) -> None:
        if (name, path.name) == ("link", "b") and not (tmp_path / "fresh").exists():
            in_place(tmp_path / "a")
            in_place(tmp_path / "fresh")

    before_each_operation(monkeypatch, edit)
    with pytest.raises(DiagnosticError) as error:
        write_folder(files(NEW), tmp_path)
    assert [d.span.file for d in error.value.diagnostics] == [str(tmp_path / "fresh")]
    assert tree(tmp_path) == state(OLD) | {"a": "2by hand", "fresh": "by hand"}


def test_an_edit_through_an_open_file_is_kept(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """An editor that opened the old file before it went aside writes into it until the change is through."""
    write_folder(files(OLD), tmp_path)
    with (tmp_path / "a").open("a") as editor:

        def late(_name: str, path: Path) -> None:
            if path.name == "fresh" and not editor.closed:
                editor.write("by hand")
                editor.close()

        before_each_operation(monkeypatch, late)
        with pytest.raises(DiagnosticError) as error:
            write_folder(files(NEW), tmp_path)
    assert [d.code for d in error.value.diagnostics] == ["PG509"]
    assert tree(tmp_path) == state(OLD) | {"a": "1by hand"}


@pytest.mark.parametrize("write", [write_folder, add_files])
@pytest.mark.parametrize("end", [*ENDING, DiagnosticError, OSError])
def test_what_ends_a_run_leaves_only_what_others_made(
    end: signal.Signals | type[Exception], write: Callable[..., object], tmp_path: Path
) -> None:
    """Ctrl-C, kill, a closed terminal, an error: a new folder and its stage go, but not what somebody put into them."""

    def broken(folder: Path, *, busy: bool) -> Iterator[RenderedFile]:
        yield from files(NEW)
        (stage,) = folder.glob(f"{STAGE}*")
        if busy:
            (folder / "notes.txt").write_text("a day of work")
            (folder / "docs").mkdir()
            (stage / "mine.txt").write_text("a strange place")
        if isinstance(end, int):
            signal.raise_signal(end)
        raise end() if end is OSError else end([])

    for busy in (False, True):
        folder = tmp_path / "new" / "out"
        with unwinding(), pytest.raises(BaseException) as error:
            write(broken(folder, busy=busy), folder)
        if isinstance(end, int):
            assert isinstance(error.value, KeyboardInterrupt if end == signal.SIGINT else SystemExit)
        assert sorted(each.rpartition("/")[2] for each in tree(tmp_path)) == (["mine.txt", "notes.txt"] if busy else [])
        assert (folder / "docs").is_dir() == busy
        assert (tmp_path / "new").exists() == busy
    assert not recover(folder), "nothing of ours is left"


def test_a_signal_waits_for_the_end_of_a_change(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Ctrl-C while files are moved: all of them are, then the run ends."""
    write_folder(files(OLD), tmp_path)

    def interrupt(_name: str, path: Path) -> None:
        if path.name == "fresh":
            signal.raise_signal(signal.SIGINT)

    before_each_operation(monkeypatch, interrupt)
    with pytest.raises(KeyboardInterrupt):
        write_folder(files(NEW), tmp_path)
    assert tree(tmp_path) == state(NEW)


def test_a_file_system_without_links(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """FAT has no hard links: files are moved all the same, and a name that is taken still is not overwritten."""

    def none(*_: object) -> None:
        raise PermissionError(1, "Operation not permitted")

    monkeypatch.setattr(os, "link", none)
    write_folder(files(OLD), tmp_path)
    write_folder(files(NEW), tmp_path)
    assert tree(tmp_path) == state(NEW)
    with pytest.raises(DiagnosticError):
        add_files(files(OLD), tmp_path)
