"""One writer per output folder: a lock of the operating system that ends with its process."""

from __future__ import annotations

import errno
import hashlib
import os
import stat
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from plcgen.base.diagnostics import Diagnostic, DiagnosticError, Span

PATIENCE = 30.0
"""Seconds to wait for another writer."""


_FLAGS = os.O_RDWR | os.O_CREAT | getattr(os, "O_NOFOLLOW", 0)


def _own_folder() -> Path:
    """Where the user's lock files lie.

    Raises:
        OSError: if it is not the user's alone.
    """
    base = Path(tempfile.gettempdir())
    if sys.platform == "win32":
        return base  # which is the user's own there
    folder = base / f"plcgen-{os.getuid()}"
    folder.mkdir(mode=0o700, exist_ok=True)
    found = folder.lstat()
    if not stat.S_ISDIR(found.st_mode) or found.st_uid != os.getuid() or found.st_mode & 0o077:
        raise PermissionError(errno.EACCES, "somebody else can write here", str(folder))
    return folder


@contextmanager
def exclusive(folder: Path, patience: float = PATIENCE) -> Iterator[None]:
    """Hold the folder's lock; wait for another plcgen that writes there.

    The lock file lies in a folder of the user's own below the system's temporary one, so that nothing is left beside
    the user's files and nobody else can put a link in its place or hold it.

    Raises:
        DiagnosticError: PG508 if the other one does not finish in time.
    """
    name = hashlib.sha256(os.path.realpath(folder).encode(errors="surrogateescape")).hexdigest()[:24]
    try:
        handle = os.open(_own_folder() / f"plcgen-{name}.lock", _FLAGS, 0o600)
    except OSError:
        yield  # no place for a lock: go on without one rather than not at all
        return
    try:
        deadline = time.monotonic() + patience
        while not _take(handle):
            if time.monotonic() >= deadline:
                message = f"another plcgen has been writing here for {patience:.0f} seconds"
                raise DiagnosticError([Diagnostic("PG508", message, Span(str(folder)), help="wait for it, or end it")])
            time.sleep(0.05)
        yield
    finally:
        os.close(handle)


if sys.platform == "win32":
    import msvcrt

    def _take(handle: int) -> bool:
        try:
            msvcrt.locking(handle, msvcrt.LK_NBLCK, 1)
        except OSError:
            return False
        return True

else:
    import fcntl

    def _take(handle: int) -> bool:
        try:
            fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            return False
        return True
