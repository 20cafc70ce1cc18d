"""The manifest: which files belong to plcgen, with their hashes, and what they were made from."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Sequence
from operator import itemgetter
from typing import Any

from plcgen._version import __version__
from plcgen.build.environment import RenderedFile
from plcgen.project.nouns import Project
from plcgen.s7.read.generated import MANIFEST


def digest(data: bytes) -> str:
    """SHA-256 as lower-case hexadecimal digits."""
    return hashlib.sha256(data).hexdigest()


def entry(file: RenderedFile) -> dict[str, Any]:
    """What the manifest says about a file."""
    known = {"path": file.path, "sha256": digest(file.data), "bytes": len(file.data)}
    return known | ({"experimental": file.experimental} if file.experimental else {})


def manifest(project: Project, entries: Sequence[dict[str, Any]]) -> RenderedFile:
    """Manifest of rendered files: reproducible, without date, user or path of the machine."""
    content: dict[str, Any] = {
        "format": 1,
        "generator": f"plcgen {__version__}",
        "project": project.name,
        "family": project.target.family,
        "toolchain": project.target.toolchain,
        "spec_sha256": project.loaded.digest,
        **_included(project),
        "jobs": [],
        **{key: value for plan in project.plans for key, value in plan.protocol.documents(plan).manifest().items()},
        "files": sorted(entries, key=itemgetter("path")),
    }
    return RenderedFile(MANIFEST, (json.dumps(content, indent=1, ensure_ascii=False) + "\n").encode())


def _included(project: Project) -> dict[str, list[str]]:
    """Files that the spec includes, if there are any: the hash of the spec covers them."""
    names = project.loaded.included_names
    return {"included": list(names)} if names else {}
