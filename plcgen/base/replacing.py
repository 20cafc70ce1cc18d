"""How a single file is written: it is the old one or the new one, never half of either, and nobody's edit is lost.

A file that is to go is first moved aside and looked at there: whatever came to its place meanwhile is found in its
place, and put back. Nothing is ever moved to a name that is taken.
"""

from __future__ import annotations

import errno
import hashlib
import os
import secrets
import stat
import sys
from pathlib import Path

from plcgen.base.interrupts import uninterrupted

DRAFT = ".plcgen-draft-"


def digest_of(path: Path) -> str | None:
    """SHA-256 of a file as lower-case hexadecimal digits; None if there is no regular file of that name itself."""
    try:
        if not stat.S_ISREG(path.lstat().st_mode):
            return None
        with path.open("rb") as stream:
            return hashlib.file_digest(stream, "sha256").hexdigest()
    except (FileNotFoundError, NotADirectoryError):
        return None


def place(source: Path, target: Path) -> None:
    """Move a file to a name that is free.

    Raises:
        FileExistsError: if it is taken.
        OSError: if it cannot be moved.
    """
    if sys.platform != "win32" and stat.S_ISREG(source.lstat().st_mode):
        try:
            os.link(source, target)
        except (FileExistsError, FileNotFoundError):
            raise
        except OSError:  # a file system without hard links
            pass
        else:
            source.unlink()
            return
    if os.path.lexists(target):
        raise FileExistsError(errno.EEXIST, os.strerror(errno.EEXIST), str(target))
    source.rename(target)


def take(target: Path, aside: Path, known: str) -> bool:
    """Move a file aside if it still has the SHA-256 that is known; False if it is another one by now, and stays.

    One that is gone already needs nothing.
    """
    try:
        target.rename(aside)
    except FileNotFoundError:
        return True
    if digest_of(aside) == known:
        return True
    put_back(aside, target)
    return False


def swap(source: Path, target: Path, aside: Path, known: str | None) -> bool:
    """Move a file to the place of another one, which goes aside, as :func:`take` does; ``known`` is None for none.

    False if somebody else's file is there by now: it stays.
    """
    if known is not None and not take(target, aside, known):
        return False
    try:
        place(source, target)
    except FileExistsError:
        return False
    except OSError:
        if os.path.lexists(aside):
            put_back(aside, target)
        raise
    return True


def put_back(aside: Path, target: Path) -> None:
    """Return a file to its place; if that is taken by yet another one, to a new name beside it."""
    try:
        place(aside, target)
    except FileExistsError:
        aside.rename(target.with_name(f"{target.name}.{secrets.token_hex(4)}"))


def replace_file(path: Path, data: bytes, known: str | None = "") -> None:
    """Write beside the file and rename: whatever goes wrong on the way, the old file is still there.

    A link stays, its target is replaced. A device, FIFO or socket is written to. An old file keeps its mode,
    and one that may not be written is not replaced either. ``known`` is the SHA-256 of the file that may be replaced,
    None if there is none; empty for what is there at the moment of the call.

    Raises:
        FileExistsError: if another file is there by now: it stays.
        OSError: if that is not possible; nothing has changed then.
    """
    mode = path.stat().st_mode if path.exists() else None
    if mode is not None and (not stat.S_ISREG(mode) or path.absolute().parts[1:2] == ("dev",)):  # /dev/stdout > file
        path.write_bytes(data)
        return
    target = path.resolve()
    if mode is not None and not os.access(target, os.W_OK):
        raise PermissionError(errno.EACCES, os.strerror(errno.EACCES), str(target))
    old = digest_of(target) if known == "" else known
    draft, aside = (target.with_name(f"{DRAFT}{secrets.token_hex(8)}") for _ in range(2))
    try:
        with draft.open("xb") as out:
            out.write(data)
        if mode is not None:
            draft.chmod(mode)
        with uninterrupted():
            if not swap(draft, target, aside, old):
                raise _changed(path)
            if old is not None and digest_of(aside) not in {old, None}:  # somebody still had it open
                take(target, draft, hashlib.sha256(data).hexdigest())
                put_back(aside, target)
                raise _changed(path)
    finally:
        draft.unlink(missing_ok=True)
        if digest_of(aside) == old:
            aside.unlink(missing_ok=True)


def _changed(path: Path) -> FileExistsError:
    return FileExistsError(errno.EEXIST, "it was changed by somebody else meanwhile", str(path))
