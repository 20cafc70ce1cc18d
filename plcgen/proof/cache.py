"""Verdicts of earlier runs in a folder of the user's own, by the hash of everything that they depend on.

Whoever can write there can make a wrong project look right, so the folder must be the user's alone; and it must be
the cache's alone, since what is too much is deleted: a tag says that it is, and only names that the cache gives are
looked at. An entry that is damaged is none. Only what went well is kept: what fails is run again, and says where.
Several processes may use one folder: an entry is written beside its place and moved there.
"""

from __future__ import annotations

import contextlib
import errno
import hashlib
import os
import re
import stat
import sys
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from datetime import UTC, datetime
from pathlib import Path
from typing import Annotated

from pydantic import BaseModel, ConfigDict, StringConstraints, TypeAdapter, ValidationError

from plcgen.base.files.files import read_bounded
from plcgen.base.replacing import DRAFT, digest_of, replace_file
from plcgen.proof.results import Result

RESULT: TypeAdapter[Result] = TypeAdapter(Result)
FORMAT = 1
VARIABLE = "PLCGEN_CACHE"
"""Names the folder, or is one of ``OFF``."""
OFF = frozenset({"", "0", "off", "no", "none", "false"})
MAX_ENTRY = 4 * 1024 * 1024
MAX_BYTES = 128 * 1024 * 1024
"""Bytes of all entries; what was used least recently goes first."""
TAG = "CACHEDIR.TAG"
_MARK = b"""\
Signature: 8a477f597d28d172789f06886806bc55
# Verdicts of plcgen verify, which deletes files here: keep nothing else in this folder.
# Backups may leave it out: https://bford.info/cachedir/
"""
_KEY = re.compile(r"[0-9a-f]{64}")
_SUFFIX = ".json"
_ROOM = re.compile(r"[0-9a-f]{2}")
_OWN = re.compile(rf"[0-9a-f]{{64}}{re.escape(_SUFFIX)}|{re.escape(DRAFT)}[0-9a-f]{{16}}")
"""Names of entries, and of one that is being written."""
_TIME = r"^\d{4}-\d\d-\d\dT\d\d:\d\d:\d\dZ$"


class CacheEntry(BaseModel):
    """One file of the cache; ``result`` is checked as it is read, too."""

    model_config = ConfigDict(extra="forbid", strict=True)

    format: int
    key: str
    made: Annotated[str, StringConstraints(pattern=_TIME)]
    result: str


def user_folder() -> Path:
    """Where the system wants caches of a user's programs."""
    if sys.platform == "win32":
        base = Path(os.environ.get("LOCALAPPDATA") or Path.home() / "AppData" / "Local")
        return base / "plcgen" / "Cache" / "verdicts"
    if sys.platform == "darwin":
        return Path.home() / "Library" / "Caches" / "plcgen" / "verdicts"
    base = Path(os.environ.get("XDG_CACHE_HOME", ""))
    return (base if base.is_absolute() else Path.home() / ".cache") / "plcgen" / "verdicts"


def chosen_folder() -> Path | None:
    """The folder of the environment, else the user's; None if there is to be none."""
    given = os.environ.get(VARIABLE)
    if given is None:
        return user_folder()
    return None if given.strip().lower() in OFF else Path(given)


@dataclass
class VerdictCache:
    """A folder of verdicts, for the files of ``base``.

    ``hits`` counts what was found.
    """

    folder: Path
    base: Path
    limit: int = MAX_BYTES
    hits: int = 0
    _written: bool = field(default=False, repr=False)

    def open(self) -> None:
        """Make the folder.

        Raises:
            OSError: if that is not possible, others may write there, or there is something else in it.
        """
        self.folder.mkdir(mode=0o700, parents=True, exist_ok=True)
        found = self.folder.stat()
        if not stat.S_ISDIR(found.st_mode):
            raise NotADirectoryError(errno.ENOTDIR, "not a folder", str(self.folder))
        if sys.platform != "win32" and (found.st_uid != os.getuid() or found.st_mode & 0o077):
            why = "it belongs to another user" if found.st_uid != os.getuid() else "other users can read or write it"
            raise PermissionError(errno.EACCES, why, str(self.folder))
        tag = self.folder / TAG
        if digest_of(tag) == hashlib.sha256(_MARK).hexdigest():
            return
        if not all(self._is_room(each) for each in self.folder.iterdir() if not _OWN.fullmatch(each.name)):
            raise FileExistsError(errno.EEXIST, "it has other files than verdicts", str(self.folder))
        with contextlib.suppress(FileExistsError):  # another process was faster
            replace_file(tag, _MARK, None)

    def find(self, key: str) -> Result | None:
        """What is known by a key; None if nothing is, or nothing that can be believed."""
        path = self._place(key)
        try:
            if not self._is_own(path):
                return None
            data = read_bounded(path, MAX_ENTRY)
            if len(data) > MAX_ENTRY:
                return None
            entry = CacheEntry.model_validate_json(data)
            result = RESULT.validate_json(entry.result)
        except (OSError, ValidationError):
            return None
        if entry.format != FORMAT or entry.key != key or result.failures or result.broken:
            return None
        with contextlib.suppress(OSError):
            os.utime(path)
        self.hits += 1
        return replace(with_folder(result, self.base), made=entry.made)

    def keep(self, key: str, result: Result) -> None:
        """Keep what went well; a cache that cannot be written is none."""
        if result.failures or result.broken:
            return
        made = datetime.now(UTC).strftime("%Y-%m-%dT%H:%M:%SZ")
        text = RESULT.dump_json(portable(result, self.base)).decode()
        data = CacheEntry(format=FORMAT, key=key, made=made, result=text).model_dump_json().encode()
        if len(data) > MAX_ENTRY:
            return
        with contextlib.suppress(OSError):
            self._write(self._place(key), data)
            self._written = True

    def close(self) -> None:
        """Delete what is too much, the longest unused first."""
        if not self._written:
            return
        found = []
        for path in self._entries():
            with contextlib.suppress(OSError):
                seen = path.stat()
                found.append((seen.st_mtime, seen.st_size, path))
        total = sum(size for _, size, _ in found)
        for _, size, path in sorted(found) if total > self.limit else ():
            with contextlib.suppress(OSError):
                path.unlink()
                total -= size
            if total <= self.limit * 4 // 5:
                break

    def _entries(self) -> Iterator[Path]:
        """Every file that this or another process has put here."""
        for room in self.folder.iterdir():
            if _ROOM.fullmatch(room.name) and not room.is_symlink() and room.is_dir():
                yield from (path for path in room.iterdir() if _OWN.fullmatch(path.name) and self._is_own(path))

    @staticmethod
    def _is_room(folder: Path) -> bool:
        """Whether there are entries in a folder and nothing else; the tag of a process that is faster counts, too."""
        if folder.name == TAG:
            return digest_of(folder) == hashlib.sha256(_MARK).hexdigest()
        inside = folder.iterdir() if folder.is_dir() and not folder.is_symlink() else iter([folder])
        return _ROOM.fullmatch(folder.name) is not None and all(_OWN.fullmatch(path.name) for path in inside)

    def _place(self, key: str) -> Path:
        if not _KEY.fullmatch(key):
            raise ValueError(f"{key!r} is no key")
        return self.folder / key[:2] / f"{key}{_SUFFIX}"

    @staticmethod
    def _is_own(path: Path) -> bool:
        found = path.lstat()
        return stat.S_ISREG(found.st_mode) and (sys.platform == "win32" or found.st_uid == os.getuid())

    @staticmethod
    def _write(path: Path, data: bytes) -> None:
        path.parent.mkdir(mode=0o700, exist_ok=True)
        replace_file(path, data)


def portable(result: Result, folder: Path) -> Result:
    """With the names of files below the folder, and the counters of these alone."""

    def name(file: str) -> str:
        path = Path(file)
        return path.relative_to(folder).as_posix() if path.is_relative_to(folder) else file

    counts = {name(file): own for file, own in result.counts.items() if Path(file).is_relative_to(folder)}
    failures = [replace(failure, file=name(failure.file)) for failure in result.failures]
    return replace(result, counts=counts, failures=failures)


def with_folder(result: Result, folder: Path) -> Result:
    """The same for the files of a folder."""

    def file(name: str) -> str:
        return str(folder / name) if name and (folder / name).is_file() else name

    failures = [replace(failure, file=file(failure.file)) for failure in result.failures]
    return replace(result, counts={str(folder / name): own for name, own in result.counts.items()}, failures=failures)
