"""The manifest against spec, telegrams and files: what was generated for which target, how long each file is."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence

from plcgen._version import __version__
from plcgen.base.files.files import read_bounded
from plcgen.project.nouns import Project
from plcgen.project.ownership import is_owned
from plcgen.proof.folder import Folder
from plcgen.proof.wording.guides import unproven
from plcgen.proof.wording.model import Wording

FILE = "manifest.json"
MAX_BYTES = 64 * 1024 * 1024


def check_manifest(project: Project, folder: Folder, stated: Sequence[Wording], text: str) -> Iterator[tuple[int, str]]:
    """Everything that the manifest says but for the hashes of the files, which are looked at elsewhere."""
    try:
        found = json.loads(text)
        listed = {one["path"]: one for one in found["files"]}
    except (ValueError, KeyError, TypeError):
        return  # told where it is read
    wanted: dict[str, object] = {
        "format": 1,
        "generator": f"plcgen {__version__}",
        "project": project.name,
        "family": project.target.family,
        "toolchain": project.target.toolchain,
        "spec_sha256": project.loaded.digest,
        "jobs": [],
    }
    if names := project.loaded.included_names:
        wanted["included"] = list(names)
    for one in stated:
        wanted |= one.manifest()
    loose = {"generator", "spec_sha256"}  # another version made it, or the spec has changed since: told elsewhere
    for key in sorted({*found, *wanted} - {"files", *loose}):
        yield from ((_line(text, key), what) for what in _difference(key, wanted.get(key), found.get(key)))
    for path, one in listed.items():
        yield from ((_line(text, path), f"{path}: {what}") for what in _file(project, folder, stated, path, one))


def _file(
    project: Project, folder: Folder, stated: Sequence[Wording], path: str, entry: dict[str, object]
) -> Iterator[str]:
    place = folder.path / path
    if place.is_file() and not is_owned(path, project.loaded.spec.plc.user_owned):
        data = read_bounded(place, MAX_BYTES)
        plain = data.replace(b"\r\n", b"\n")
        if entry.get("bytes") not in {
            len(data),
            len(plain),
            len(plain) + plain.count(b"\n"),
        }:  # git may change line ends
            yield f"{entry.get('bytes')} bytes, the file has {len(data)}"
    note = entry.get("experimental", "")
    if note != (right := unproven(project, folder, stated, path)):
        yield f"experimental: {note or 'nothing'}, not {right or 'nothing'}"


def _difference(path: str, wanted: object, found: object) -> Iterator[str]:
    """The first values in which two trees differ, with the way to each."""
    if isinstance(wanted, dict) and isinstance(found, dict):
        for key in dict.fromkeys((*wanted, *found)):
            yield from _difference(f"{path}.{key}", wanted.get(key), found.get(key))
    elif isinstance(wanted, list) and isinstance(found, list) and len(wanted) == len(found):
        for number, (one, two) in enumerate(zip(wanted, found, strict=True)):
            yield from _difference(f"{path}[{number}]", one, two)
    elif wanted != found:
        yield f"{path} is {found!r}, not {wanted!r}"


def _line(text: str, key: str) -> int:
    return text[: max(0, text.find(f'"{key}"'))].count("\n") + 1
