"""What lies in an output folder and belongs to plcgen: the manifest and the files it lists."""

from __future__ import annotations

import json
from collections.abc import Iterable
from pathlib import Path

from plcgen.base.files.files import read_bounded
from plcgen.base.paths import trap_in

MANIFEST = "manifest.json"
JOURNAL = ".plcgen-journal.json"
"""Stands in a folder while its files are replaced."""
ATTRIBUTES = ".gitattributes"
"""Tells git to leave the line ends of the files as they are."""
MAX_MANIFEST = 64 * 1024 * 1024
"""Bytes of a manifest that are read: a hundred thousand files and more."""
SOURCES = (".scl", ".udt", ".db", ".awl")


def known_files(data: bytes) -> dict[str, str]:
    """Path -> SHA-256 of the files a manifest lists.

    Raises:
        ValueError: if the bytes are no manifest.
    """
    try:
        content = json.loads(data)
        return {str(entry["path"]): str(entry["sha256"]) for entry in content["files"]}
    except (ValueError, KeyError, TypeError, RecursionError) as problem:
        raise ValueError(f"not a manifest: {problem}") from problem


def project_of(data: bytes) -> str | None:
    """Name of the project of a manifest; None if it says none."""
    return _stated(data, "project")


def spec_of(folder: Path) -> str | None:
    """Digest of the spec that the files of a folder were made from; None if its manifest does not say."""
    try:
        return _stated(read_bounded(folder / MANIFEST, MAX_MANIFEST), "spec_sha256")
    except OSError:
        return None


def _stated(data: bytes, key: str) -> str | None:
    try:
        found = json.loads(data).get(key)
    except (ValueError, AttributeError, RecursionError):
        return None
    return found if isinstance(found, str) else None


def manifest_of(folder: Path) -> dict[str, str] | None:
    """Path -> SHA-256 of the files the manifest lists; None if there is none or it cannot be read."""
    try:
        return known_files(read_bounded(folder / MANIFEST, MAX_MANIFEST))
    except (OSError, ValueError):
        return None


def foreign_files(paths: Iterable[Path]) -> list[Path]:
    """Files that no manifest lists, of the folder around them or of the one around that: plcgen did not make them."""
    files = list(paths)
    known = {folder: manifest_of(folder) or {} for folder in {folder for path in files for folder in _near(path)}}
    return [path for path in files if all(path.relative_to(at).as_posix() not in known[at] for at in _near(path))]


def _near(path: Path) -> list[Path]:
    return list(path.parents)[:2]


def generated_sources(folder: Path) -> list[Path]:
    """The text sources that belong to plcgen: those of the manifest, else all of its three folders.

    A copy in a subfolder or a source of the user beside them is not looked at.
    """
    known = manifest_of(folder)
    if known is None:
        found = [path for name in ("udt", "db", "scl") for path in (folder / name).glob("*")]
    else:
        root = folder.resolve()
        found = [
            folder / name for name in known if not trap_in(name) and (folder / name).resolve().is_relative_to(root)
        ]
    return sorted(path for path in found if path.suffix.lower() in SOURCES and path.is_file())


def generated_documents(folder: Path) -> list[Path]:
    """The SimaticML documents that belong to plcgen, chosen as :func:`generated_sources` does."""
    known = manifest_of(folder)
    names = [name for name in known if name.startswith("xml/") and not trap_in(name)] if known is not None else None
    found = folder.glob("xml/*.xml") if names is None else (folder / name for name in names)
    return sorted(path for path in found if path.suffix.lower() == ".xml" and path.is_file())
