"""Faults of drives as people type them, for all drives of a run or for one. Every mistake is a diagnostic."""

from __future__ import annotations

import copy
import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from pydantic import Field, ValidationInfo, field_validator

from plcgen.base.diagnostics import DiagnosticError, Report
from plcgen.base.diagnostics.suggest import did_you_mean
from plcgen.base.files.options import read_fault
from plcgen.base.files.printed import Name
from plcgen.base.files.text import read_text
from plcgen.base.files.validation import FileShape, StrictModel, load_document, problem, validate_option
from plcgen.base.files.yaml import resolve_plain
from plcgen.ds47.sim.faults import KINDS, Fault, FaultKind
from plcgen.ds47.sim.load import FaultKeys
from plcgen.ds47.wire.errors import error_text, known_numbers
from plcgen.ds47.wire.status import known_codes, status_of
from plcgen.report.trace.face import FaultKind as Kind
from plcgen.report.trace.faults import fault_kinds
from plcgen.report.trace.settings import FAULTS_SHAPE, with_faults_key

_HEX = re.compile(r"(?=.*[A-Fa-f])[0-9A-Fa-f]{2,8}|[0-9A-Fa-f]{2,8}h|[0-9A-Fa-f]{8}", re.ASCII)
_HEX_KEYS = frozenset({"status", "code", "number", "value"})


@dataclass(slots=True)
class FaultPlan:
    """Faults for every drive, and for single drives by key."""

    common: list[Fault] = field(default_factory=list)
    own: dict[str, list[Fault]] = field(default_factory=dict)

    def of(self, *drives: str) -> list[Fault]:
        """Fresh faults of a drive known by one or more keys."""
        found = [*self.common, *(fault for key in drives for fault in self.own.get(key, []))]
        return [copy.copy(fault) for fault in found]

    def add(self, drive: str | None, faults: Iterable[Fault]) -> None:
        """Add faults for one drive, or for all."""
        (self.common if drive is None else self.own.setdefault(drive, [])).extend(faults)


def plan_faults(texts: Sequence[str], file: Path | None, drives: Sequence[str]) -> FaultPlan:
    """Faults of the command line and of a YAML file. Raises DiagnosticError with every problem."""
    plan = FaultPlan()
    report = Report()
    faults: list[DriveFault] = []
    for text in texts:
        with report.catch():
            faults.append(_typed(text, drives))
    if file is not None:
        with report.catch():
            faults += load_document(read_text(file), str(file), _FILE, {"drives": drives}).model.faults
    for fault in faults:
        plan.add(fault.drive, [fault.fault()])
    if report.diagnostics:
        raise DiagnosticError(report.diagnostics)
    return plan


class DriveFault(FaultKeys):
    """A fault of ``simulate``: for one drive, or for all."""

    drive: Name | None = Field(None, description="this drive only")

    @field_validator("drive")
    @classmethod
    def _exists(cls, drive: str | None, info: ValidationInfo) -> str | None:
        drives = info.context["drives"] if info.context else ()
        if drive is not None and drive not in drives:
            hint = did_you_mean(drive, drives) or f"drives: {', '.join(drives)}"
            raise problem(f'there is no drive "{drive}"', help_=hint)
        return drive


class DriveFaults(StrictModel):
    """A file of faults."""

    faults: tuple[DriveFault, ...]


def drive_faults(drives: Sequence[str]) -> tuple[Kind, ...]:
    """Everything that can go wrong with some drives."""
    codes = known_codes()
    known = {
        "number": [(f"16#{number:02X}", error_text(number).meaning) for number in known_numbers()],
        "code": [(f"16#{code:02X}", text) for code, text in codes],
        "status": [
            (f"16#{status_of(call, code):08X}", f"{'RDREC' if call == 'read' else 'WRREC'}: {text}")
            for call in ("read", "write")
            for code, text in codes
        ],
    }
    return fault_kinds(DriveFault, KINDS, known, {"drive": drives})


_FILE = FileShape(DriveFaults, "the file", FAULTS_SHAPE, prepare=with_faults_key)
_OPTION = FileShape(DriveFault, "the fault", FAULTS_SHAPE)


def _typed(text: str, drives: Sequence[str]) -> DriveFault:
    """One ``KIND[:KEY=VALUE,...]`` of the command line."""
    option = f"--fault {text}"
    entry = read_fault(text, option, [item.value for item in FaultKind], _plain)
    return validate_option(entry, option, _OPTION, {"drives": drives})


def _plain(key: str, text: str) -> Any:
    """A typed value: ``2``, ``16#B5``, ``0xB5``, ``B5h``; where codes are meant also ``B5`` and ``DE80B500``."""
    if key in {"data", "drive"}:
        return text
    if key in _HEX_KEYS and _HEX.fullmatch(text):
        return int(text.rstrip("h"), 16)
    return resolve_plain(text)
