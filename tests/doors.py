"""Every kind of file that somebody may have written: what reads its text, and the schema of its shape."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from plcgen import api
from plcgen.base.diagnostics import Diagnostic, DiagnosticError, Report
from plcgen.base.files.validation import load_document
from plcgen.cli import config
from plcgen.ds47.profile import PROFILE
from plcgen.ds47.recording import faults as drive_faults
from plcgen.ds47.sim.load import load_drive
from plcgen.ppi import recording as line_faults
from plcgen.ppi.sim.load import load_bus
from plcgen.project.editor import file_schema
from plcgen.project.loading import parse_spec
from plcgen.report.diff import lockfile
from plcgen.s7.compare import policy

Door = Callable[[str], list[Diagnostic]]


def spec_problems(text: str) -> list[Diagnostic]:
    """Shape of a spec alone: what the rules say of it is not looked at."""
    report = Report()
    parse_spec(text, "job.yaml", report)
    return list(report)


def problems_of(read: Callable[[str], object]) -> Door:
    """What is wrong with a text by its reader."""

    def problems(text: str) -> list[Diagnostic]:
        try:
            read(text)
        except DiagnosticError as wrong:
            return list(wrong.diagnostics)
        return []

    return problems


def _lock(text: str) -> object:
    if text.startswith("{") and '"format"' not in text:
        text = text.replace("{", '{"format": 2,', 1)
    return load_document(text, "plcgen.lock.json", lockfile.LOCK)


DOORS: dict[str, Door] = {
    "spec": spec_problems,
    "profile": problems_of(lambda text: load_document(text, "acme.yaml", PROFILE, {"lenders": {}})),
    "drive": problems_of(load_drive),
    "station": problems_of(load_bus),
    "lock": problems_of(_lock),
    "policy": problems_of(lambda text: load_document(text, "policy.yaml", policy.POLICY)),
    "drive faults": problems_of(lambda text: load_document(text, "f.yaml", drive_faults._FILE, {"drives": ["d"]})),
    "line faults": problems_of(lambda text: load_document(text, "f.yaml", line_faults._FILE)),
    "config": problems_of(lambda text: load_document(text, config.NAME, config._SHAPE)),
}
"""``config`` reads YAML here: it is the shape that is tried, which has nothing to do with TOML."""


def schema_of(kind: str) -> dict[str, Any]:
    """The published schema of a kind of file; that of the model where none is."""
    models = {
        "drive faults": drive_faults.DriveFaults, "line faults": line_faults.LineFaults, "config": config.Config
    }  # fmt: skip
    return file_schema(kind, kind, models[kind]) if kind in models else api.schema(kind)
