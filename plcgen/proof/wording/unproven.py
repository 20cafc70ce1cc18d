"""Why a generated file is experimental: one table for the manifest and the page about the documents."""

from __future__ import annotations

from collections.abc import Sequence

from plcgen.project.nouns import Project
from plcgen.proof.folder import Folder
from plcgen.proof.wording.model import Wording
from plcgen.s7.types.blocks import BlockKind

SCRIPT, WORKBOOK = "the script was not run against a TIA Portal", "the workbook was not imported into a TIA Portal"
WATCH = "watch tables follow the Openness manual; no genuine export was available to compare with"
VERSION = "no genuine export of this TIA Portal version was available to compare with"
EARLY, INFERRED = ("V14 SP1", "V15", "V15.1"), ("V14 SP1", "V15", "V15.1", "V20")
"""Versions of which no genuine document was at hand: not at all, or none with a code block."""


def unproven(project: Project, folder: Folder, stated: Sequence[Wording], path: str) -> str:
    """Why a file is experimental, "" if it is not."""
    if path in {"tags.xlsx", "xml/import.ps1"}:
        return WORKBOOK if path == "tags.xlsx" else SCRIPT
    name, version = path.removeprefix("xml/").removesuffix(".xml"), project.target.xml_version
    if not path.endswith(".xml"):
        return ""
    if name.startswith("Watch_"):
        return WATCH
    block = folder.text.get(name.upper())
    if block is not None and block.kind is BlockKind.FB:
        return next((one.note for one in stated if one.title(block) is not None), "")
    made = block is not None and (block.kind is BlockKind.OB or bool(block.instance_of))
    return VERSION if version in (INFERRED if made else EARLY) else ""
