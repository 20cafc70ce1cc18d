"""The other side of a comparison: a folder, a spec, or a revision in git, as files on disk for the time of a ``with``.

Of a revision only specs, profiles, sources and locks are read, blob by blob, of bounded number and size; nothing is
checked out, no attribute, filter or hook of the repository runs.
"""

from __future__ import annotations

import os
import subprocess
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path, PurePosixPath

from plcgen.base.files.options import usage
from plcgen.base.paths import trap_in
from plcgen.base.programs import find_program
from plcgen.s7.read.generated import SOURCES

OPTION = "--against"
MAX_BYTES = 64 * 1024 * 1024
MAX_FILES = 20_000
"""Of a revision, all files together."""

_SPECS = (".yaml", ".yml")
_FILES = "100"
"""Git's modes of regular files begin like this; links and submodules are left alone."""


@dataclass(frozen=True, slots=True)
class BaseFiles:
    """What there is of the base: ``spec``, ``folder`` of generated sources, ``lock``; None where it has none.

    ``label`` names the base for people, ``root`` is what stands before its paths and means nothing to them.
    """

    label: str
    root: str
    spec: Path | None
    folder: Path | None
    lock: Path | None


@contextmanager
def base_files(against: str, spec: Path, folder: Path, lock: Path | None) -> Iterator[BaseFiles]:
    """Find or fetch the other side. Raises DiagnosticError (PG901) if there is none of that name."""
    path = Path(against)
    if path.suffix.lower() in _SPECS and path.is_file():
        yield BaseFiles(path.as_posix(), "", path, None, None)
    elif path.is_dir():
        yield _in_folder(path, spec, folder, lock)
    else:
        with tempfile.TemporaryDirectory(prefix="plcgen-base-") as room:
            yield _in_revision(against, spec, folder, lock, Path(room))


def _in_folder(base: Path, spec: Path, folder: Path, lock: Path | None) -> BaseFiles:
    there = _existing(base / spec.name, base / folder.name, base / (lock.name if lock else ".no-lock"))
    sources = there[1] or (base if there[0] is None else None)
    return BaseFiles(base.as_posix(), "", there[0], sources, there[2])


def _existing(spec: Path, folder: Path, lock: Path) -> tuple[Path | None, Path | None, Path | None]:
    return (
        spec if spec.is_file() else None,
        folder if folder.is_dir() else None,
        lock if lock.is_file() else None,
    )


def _in_revision(revision: str, spec: Path, folder: Path, lock: Path | None, room: Path) -> BaseFiles:
    top = Path(_git(spec.absolute().parent, ["rev-parse", "--show-toplevel"], revision).decode().strip()).resolve()
    name = f"{revision}^{{commit}}"
    commit = _git(top, ["rev-parse", "--verify", "--quiet", "--end-of-options", name], revision).decode().strip()
    inside = [_relative(path, top) for path in (spec, folder, lock) if path is not None]
    listed = _git(top, ["ls-tree", "-r", "-z", "-l", commit], revision)
    wanted: list[tuple[str, str]] = []
    left = MAX_BYTES
    for line in listed.split(b"\0"):
        head, _, raw = line.partition(b"\t")
        entry = head.decode("ascii", "replace").split()
        path = raw.decode("utf-8", "surrogateescape")
        if len(entry) != 4 or not entry[0].startswith(_FILES) or not _of_interest(path, inside):
            continue
        left -= int(entry[3])
        wanted.append((entry[2], path))
        if left < 0 or len(wanted) > MAX_FILES:
            raise usage(f"{OPTION} {revision}", "the revision has too many specs and sources to be compared")
    _fetch(top, wanted, room, revision)
    there = _existing(room / inside[0], room / inside[1], room / (inside[2] if lock else ".no-lock"))
    return BaseFiles(f"{revision} ({commit[:12]})", f"{room.as_posix()}/", *there)


def _relative(path: Path, top: Path) -> str:
    full = path.resolve()
    if not full.is_relative_to(top):
        raise usage(OPTION, f"{path} is not in the repository of the spec", "name a folder to compare with")
    return full.relative_to(top).as_posix()


def _of_interest(path: str, inside: Sequence[str]) -> bool:
    """The lock, specs and profiles anywhere, since a spec may name them, and the sources of the generated folder."""
    if trap_in(path):
        return False
    suffix = PurePosixPath(path).suffix.lower()
    generated = len(inside) > 1 and path.startswith(f"{inside[1]}/")
    return path in inside or suffix in _SPECS or (generated and suffix in (*SOURCES, ".sdf", ".json"))


def _fetch(top: Path, wanted: Sequence[tuple[str, str]], room: Path, revision: str) -> None:
    asked = "".join(f"{blob}\n" for blob, _ in wanted).encode()
    answer = _git(top, ["cat-file", "--batch"], revision, asked)
    at = 0
    for _, path in wanted:
        end = answer.index(b"\n", at)
        size = int(answer[at:end].split()[2])
        target = room / path
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_bytes(answer[end + 1 : end + 1 + size])
        at = end + 2 + size


def _git(where: Path, arguments: Sequence[str], revision: str, given: bytes = b"") -> bytes:
    program = find_program("git")
    place = f"{OPTION} {revision}"
    if program is None:
        raise usage(place, "there is no such folder, and git is not installed", "name a folder or a spec")
    environment = {**os.environ, "GIT_TERMINAL_PROMPT": "0", "GIT_NO_LAZY_FETCH": "1", "LC_ALL": "C"}
    done = subprocess.run(  # noqa: S603 - git itself, arguments as a list
        [program, "-C", str(where), *arguments], input=given, capture_output=True, check=False, env=environment
    )
    if done.returncode:
        help_ = "name a folder, a spec, or a revision that git rev-parse knows, for example HEAD~1 or origin/main"
        raise usage(place, f'"{revision}" is not a folder, a spec or a git revision here', help_)
    return done.stdout
