"""Hashes of texts that do not depend on line ends: git on Windows may have turned LF into CRLF."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator, Sequence
from pathlib import Path

from plcgen.base.files.files import read_bounded

_MAX_BYTES = 64 * 1024 * 1024
_MAX_FILES = 5000
_SHOWN = 12


def text_digest(data: bytes) -> str:
    """SHA-256 of a text as if its lines ended in LF, as lower-case hexadecimal digits."""
    return hashlib.sha256(data.replace(b"\r\n", b"\n")).hexdigest()


def same_text(one: bytes, other: bytes) -> bool:
    """Whether two files differ in nothing but line ends."""
    return one == other or one.replace(b"\r\n", b"\n") == other.replace(b"\r\n", b"\n")


def has_digest(data: bytes, digest: str) -> bool:
    """Whether a SHA-256 is that of a file as it is, or with the other line ends."""
    if hashlib.sha256(data).hexdigest() == digest:
        return True
    plain = data.replace(b"\r\n", b"\n")
    return digest in {hashlib.sha256(text).hexdigest() for text in (plain, plain.replace(b"\n", b"\r\n"))}


def path_hashes(paths: Sequence[Path]) -> Iterator[tuple[str, str]]:
    """Each path with its hash; a folder has that over the sorted list of its files, a file that is large has none."""
    for path in paths[:_SHOWN]:
        digest = _folder_digest(path) if path.is_dir() else _file_digest(path)
        if digest:
            yield path.as_posix(), digest


def _file_digest(path: Path) -> str:
    try:
        data = read_bounded(path, _MAX_BYTES)
    except OSError:
        return ""
    return "" if len(data) > _MAX_BYTES else text_digest(data)


def _folder_digest(folder: Path) -> str:
    files = sorted(path for path in folder.rglob("*") if path.is_file())
    if len(files) > _MAX_FILES:
        return ""
    lines = [f"{_file_digest(path)}  {path.relative_to(folder).as_posix()}\n" for path in files]
    return hashlib.sha256("".join(lines).encode("utf-8", "replace")).hexdigest()
