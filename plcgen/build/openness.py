"""The import script for TIA Openness and the page beside it: which documents, in which order."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from plcgen.build.document import Document
from plcgen.build.guides import guide
from plcgen.build.overview import Overview
from plcgen.build.simaticml import VERSION_NOTE, WATCH_NOTE
from plcgen.build.spelling import culture
from plcgen.project.nouns import Project

SCRIPT_NOTE = "the script was not run against a TIA Portal"


def openness_documents(project: Project, seen: Overview, note: str) -> Iterator[Document]:
    """The page, and for S7-1200/1500 the script; ``note`` says why documents of this version are experimental.

    PowerShell ends a string in single quotes at U+2018..U+201B too, and other surprises may follow: the script has no
    word of the project in it, it reads the names as JSON.
    """
    steps = _steps(seen)
    version = project.target.xml_version
    view: dict[str, Any] = {
        "project": project.name,
        "version": version,
        "t15": project.target.t15,
        "steps": steps,
        "cultures": [culture(language) for language in project.languages],
        "experimental": _experimental(version, steps, seen.notes, note),
    }
    yield guide(project, "xml/IMPORT.md", "text/xml_import.md.j2", view)
    if project.target.t15:
        yield Document("xml/import.ps1", "text/import.ps1.j2", {"version": version}, "", "ascii", "\r\n", SCRIPT_NOTE)
        yield Document("xml/import.json", text=json.dumps({"steps": steps}, indent=2) + "\n")


def _steps(seen: Overview) -> list[dict[str, Any]]:
    """Import order: every document after what it needs."""
    found = [
        _step("types", "type", seen.types),
        _step("tag table", "tags", list(seen.tags)),
        _step("data blocks", "block", seen.documented),
        _step("function blocks", "block", seen.programs),
        _step("instance data blocks", "block", [call.instance for call in seen.calls]),
        _step("example of the main program", "block", ["Main"], "Main"),
        _step("watch tables", "watch", [f"Watch_{block}" for block in seen.watched], "WatchTables"),
    ]
    return [step for step in found if step["files"]]


def _step(title: str, kind: str, names: Sequence[str], switch: str = "") -> dict[str, Any]:
    return {"title": title, "kind": kind, "switch": switch, "files": _documents(names)}


def _experimental(
    version: str | None, steps: list[dict[str, Any]], notes: Mapping[str, Sequence[str]], note: str
) -> list[tuple[str, list[str]]]:
    files = {step["title"]: step["files"] for step in steps}
    found = [*((why, _documents(blocks)) for why, blocks in notes.items()), (WATCH_NOTE, files.get("watch tables", []))]
    if note:
        code = [*files.get("instance data blocks", []), *files.get("example of the main program", [])]
        found.append((VERSION_NOTE, code if version == "V20" else ["all other documents"]))
    return [(why, named) for why, named in found if why and named]


def _documents(names: Sequence[str]) -> list[str]:
    return [f"{name}.xml" for name in names]
