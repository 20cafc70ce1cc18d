"""Faults of a PPI line as people type them, for a run. Every mistake is a diagnostic."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from plcgen.base.diagnostics import DiagnosticError, Report
from plcgen.base.files.text import read_text
from plcgen.base.files.validation import FileShape, StrictModel, load_document
from plcgen.ppi.sim import Fault
from plcgen.ppi.sim.fault_text import FaultKeys, parse_fault
from plcgen.report.trace.settings import FAULTS_SHAPE, with_faults_key


class LineFaults(StrictModel):
    """A file of faults."""

    faults: tuple[FaultKeys, ...]


_FILE = FileShape(LineFaults, "the file", FAULTS_SHAPE, prepare=with_faults_key)


def read_faults(texts: Sequence[str], file: Path | None) -> list[Fault]:
    """Faults of the command line and of a YAML file. Raises DiagnosticError with every problem."""
    report = Report()
    faults: list[Fault] = []
    for text in texts:
        with report.catch():
            faults.append(parse_fault(text))
    if file is not None:
        with report.catch():
            faults += [keys.fault() for keys in load_document(read_text(file), str(file), _FILE).model.faults]
    if report.diagnostics:
        raise DiagnosticError(report.diagnostics)
    return faults
