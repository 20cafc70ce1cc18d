"""The import script for TIA Openness and the page beside it: which documents, in which order."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from plcgen.documents.code import RECORD_NOTE, VERSION_NOTE, version_note
from plcgen.documents.document import Document
from plcgen.documents.simaticml import TAG_TABLE, WATCH_NOTE
from plcgen.project.nouns import Project
from plcgen.protocols.ds47.plan.nouns import DrivePlan
from plcgen.protocols.ds47.views.tables import tags
from plcgen.protocols.ppi.plan.nouns import PpiPlan

SCRIPT_NOTE = "the script was not run against a TIA Portal"


def openness_documents(project: Project) -> Iterator[Document]:
    """The page, and for S7-1200/1500 the script."""
    steps = _steps(project)
    view: dict[str, Any] = {
        "project": project.name,
        "version": project.target.xml_version,
        "t15": project.target.t15,
        "steps": steps,
        "experimental": _experimental(project, steps),
    }
    yield Document("xml/IMPORT.md", "text/xml_import.md.j2", view)
    if project.target.t15:
        yield Document("xml/import.ps1", "text/import.ps1.j2", view, "utf-8-sig", "\r\n", SCRIPT_NOTE)


def _steps(project: Project) -> list[dict[str, Any]]:
    """Import order: every document after what it needs."""
    drives, ppi = project.plan(DrivePlan), project.plan(PpiPlan)
    jobs = drives.jobs if drives else ()
    types = [drives.diagnostics_type, drives.token_type] if drives and jobs else []
    data = [token for token, _ in drives.tokens] if drives else []
    for job in jobs:
        for telegram in job.telegrams:
            types += [telegram.request.type, telegram.response.type]
            data += [telegram.request.db, telegram.response.db]
    data += [drives.control_db] if drives and jobs else []
    blocks = [(job.block.name, job.instance.name) for job in jobs]
    tables = [TAG_TABLE] if drives and tags(drives) else []
    if ppi is not None:
        from plcgen.protocols.ppi.views.blocks import master_data, master_types, ppi_tags
        from plcgen.protocols.ppi.views.tables import PPI_TAG_TABLE

        types += master_types(ppi)
        data += master_data(ppi)
        blocks += [(master.block.name, master.instance.name) for master in ppi.masters]
        tables += [PPI_TAG_TABLE] if ppi_tags(ppi) else []
    found = [
        _step("types", "type", [block.name for block in types]),
        _step("tag table", "tags", tables),
        _step("data blocks", "block", [block.name for block in data]),
        _step("function blocks", "block", [block for block, _ in blocks]),
        _step("instance data blocks", "block", [instance for _, instance in blocks]),
        _step("example of the main program", "block", ["Main"], "Main"),
        _step("watch tables", "watch", [f"Watch_{block}" for block, _ in blocks], "WatchTables"),
    ]
    return [step for step in found if step["files"]]


def _step(title: str, kind: str, names: list[str], switch: str = "") -> dict[str, Any]:
    return {"title": title, "kind": kind, "switch": switch, "files": [f"{name}.xml" for name in names]}


def _experimental(project: Project, steps: list[dict[str, Any]]) -> list[tuple[str, list[str]]]:
    by_title = {step["title"]: step["files"] for step in steps}
    found = [(RECORD_NOTE, by_title["function blocks"]), (WATCH_NOTE, by_title["watch tables"])]
    note = version_note(project)
    if note:
        found.append((VERSION_NOTE, ["all other documents" if project.target.xml_version != "V20" else "Main.xml"]))
    return found
