"""Bytes of files from outside: regular files only, as far as a bound."""

from __future__ import annotations

import errno
import os
import stat
from collections.abc import Iterator
from pathlib import Path

from plcgen.base.paths import trap_in

YAML_SUFFIXES = frozenset({".yaml", ".yml"})


def read_bounded(path: Path, limit: int) -> bytes:
    """At most ``limit`` + 1 bytes of a file; so many mean that it is larger than ``limit``, whatever its size says.

    Raises:
        OSError: if it cannot be read, or is something without an end: a device, a FIFO, a socket.
    """
    try:
        with open(path, "rb", opener=_opened) as stream:
            if not stat.S_ISREG(os.fstat(stream.fileno()).st_mode):
                raise OSError(errno.EINVAL, "not a file", str(path))
            return stream.read(limit + 1)
    except ValueError as problem:  # a NUL in the path
        raise OSError(errno.EINVAL, str(problem), str(path)) from problem


def below(folder: Path, name: str) -> Path | None:
    """Path of a file that a spec names; None if it leaves the folder of the spec, also behind links or on Windows.

    A spec may come from anybody: it reads regular files of its own folder and below only.
    """
    path = folder / name
    try:
        inside = not trap_in(name, up=True) and path.resolve().is_relative_to(folder.resolve())
    except (OSError, ValueError, RuntimeError):  # ValueError: a NUL in the path; RuntimeError: links in a circle
        return path  # reading it tells why
    return path if inside else None


def refusal(name: str, place: str = "the folder of the spec") -> str:
    """Why :func:`below` finds no path: the predicate of a sentence about the name."""
    why = trap_in(name, up=True)
    return f"is refused: {why}" if why else f"is not below {place}"


def walk(folder: Path) -> Iterator[tuple[Path, list[str], list[str]]]:
    """A folder and all below it, each with its folders and files, sorted; hidden ones and links to folders left out.

    Raises:
        OSError: if one of them cannot be read: what is in it must not be passed over in silence.
    """
    for name, folders, files in os.walk(folder, onerror=_raise):
        folders[:] = sorted(each for each in folders if not each.startswith("."))
        yield Path(name), folders, sorted(each for each in files if not each.startswith("."))


def _raise(problem: OSError) -> None:
    if not isinstance(problem, FileNotFoundError):  # gone since it was seen
        raise problem


def _opened(path: str, flags: int) -> int:
    """Opening a FIFO that nobody writes must not wait."""
    return os.open(path, flags | getattr(os, "O_NONBLOCK", 0))
