"""What a run is told: faults, values and scan times as people type them. Every mistake is a diagnostic."""

from __future__ import annotations

import copy
import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from pydantic import ValidationInfo, field_validator

from plcgen.diagnostics import Diagnostic, DiagnosticError
from plcgen.diagnostics.suggest import did_you_mean
from plcgen.input.options import read_fault, usage
from plcgen.input.text import read_text
from plcgen.input.validation import FileShape, StrictModel, load_document, problem, validate_option
from plcgen.input.yaml import YamlNode, resolve_plain
from plcgen.protocols.ds47.sim.faults import Fault, FaultKind
from plcgen.protocols.ds47.sim.load import FaultKeys

_TIME = re.compile(r"([0-9]+(?:\.[0-9]+)?)\s*(ms|s)?", re.ASCII)
_HEX = re.compile(r"(?=.*[A-Fa-f])[0-9A-Fa-f]{2,8}|[0-9A-Fa-f]{2,8}h|[0-9A-Fa-f]{8}", re.ASCII)
_SET = re.compile(r"(?P<path>[^=]+?)\s*=\s*(?P<value>.*?)(?:@(?P<scan>[0-9]+))?", re.DOTALL)
_HEX_KEYS = frozenset({"status", "code", "number", "value"})
LONGEST_SCAN = 60_000


@dataclass(frozen=True, slots=True)
class TimedValue:
    """A value given to a member, tag or address before scan ``scan``."""

    path: str
    value: str
    scan: int = 1

    @property
    def option(self) -> str:
        """The assignment as it was typed."""
        return f"--set {self.path}={self.value}" + (f"@{self.scan}" if self.scan > 1 else "")


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


def parse_time(text: str) -> int:
    """Milliseconds of ``10ms``, ``10`` or ``0.5s``. Raises DiagnosticError."""
    match = _TIME.fullmatch(text.strip())
    time = float(match[1]) * (1000 if match[2] == "s" else 1) if match else 0.0
    if not 1 <= time <= LONGEST_SCAN or time != int(time):
        raise usage(f"--scan-time {text}", "a scan takes whole milliseconds, from 1ms to 60s", "for example 10ms")
    return int(time)


def parse_assignment(text: str) -> TimedValue:
    """Read ``MEMBER=VALUE`` or ``MEMBER=VALUE@SCAN``. Raises DiagnosticError."""
    match = _SET.fullmatch(text.strip())
    if match is None or not match["value"].strip():
        raise usage(f"--set {text}", "a member and its value are needed", "for example DriveJobs.setRamps.execute=TRUE")
    return TimedValue(match["path"].strip(), match["value"].strip(), int(match["scan"] or 1))


def plan_faults(texts: Sequence[str], file: Path | None, drives: Sequence[str]) -> FaultPlan:
    """Faults of the command line and of a YAML file. Raises DiagnosticError with every problem."""
    plan = FaultPlan()
    problems: list[Diagnostic] = []
    faults: list[_Fault] = []
    for text in texts:
        try:
            faults.append(_typed(text, drives))
        except DiagnosticError as wrong:
            problems += wrong.diagnostics
    if file is not None:
        try:
            faults += load_document(read_text(file), str(file), _FILE, {"drives": drives}).model.faults
        except DiagnosticError as wrong:
            problems += wrong.diagnostics
    for fault in faults:
        plan.add(fault.drive, [fault.fault()])
    if problems:
        raise DiagnosticError(problems)
    return plan


class _Fault(FaultKeys):
    """A fault of ``simulate``: for one drive, or for all."""

    drive: str | None = None

    @field_validator("drive")
    @classmethod
    def _exists(cls, drive: str | None, info: ValidationInfo) -> str | None:
        drives = info.context["drives"] if info.context else ()
        if drive is not None and drive not in drives:
            hint = did_you_mean(drive, drives) or f"drives: {', '.join(drives)}"
            raise problem(f'there is no drive "{drive}"', help_=hint)
        return drive


class _Faults(StrictModel):
    """A file of faults."""

    faults: tuple[_Fault, ...]


def _with_key(root: YamlNode) -> YamlNode:
    """Widen a file that is the list of faults itself."""
    if root.kind != "seq":
        return root
    return YamlNode("map", root.span, pairs={"faults": (YamlNode("scalar", root.span, "faults"), root)})


_SHAPE = "a list of faults is needed, or a mapping with the key faults"
_FILE = FileShape(_Faults, "the file", _SHAPE, prepare=_with_key)
_OPTION = FileShape(_Fault, "the fault", _SHAPE)


def _typed(text: str, drives: Sequence[str]) -> _Fault:
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
