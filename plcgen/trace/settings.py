"""What a run is told: faults, values and scan times as people type them. Every mistake is a diagnostic."""

from __future__ import annotations

import copy
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from plcgen.diagnostics import Diagnostic, DiagnosticError, Span
from plcgen.diagnostics.suggest import did_you_mean
from plcgen.input.text import read_text
from plcgen.input.yaml import Node, load_yaml, resolve_plain
from plcgen.protocols.ds47.sim.faults import Fault, FaultKind
from plcgen.protocols.ds47.sim.load import faults_from

USAGE = "PG901"
_TIME = re.compile(r"([0-9]+(?:\.[0-9]+)?)\s*(ms|s)?", re.ASCII)
_HEX = re.compile(r"(?=.*[A-Fa-f])[0-9A-Fa-f]{2,8}|[0-9A-Fa-f]{2,8}h|[0-9A-Fa-f]{8}", re.ASCII)
_SET = re.compile(r"(?P<path>[^=]+?)\s*=\s*(?P<value>.*?)(?:@(?P<scan>[0-9]+))?", re.DOTALL)
_HEX_KEYS = frozenset({"status", "code", "number", "value"})
LONGEST_SCAN = 60_000


def usage(option: str, message: str, text: str = "") -> DiagnosticError:
    """Build the error of an argument that makes no sense; ``option`` is quoted as the place."""
    return DiagnosticError([Diagnostic(USAGE, message, Span(option), help=text)])


@dataclass(frozen=True, slots=True)
class Assignment:
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


def parse_assignment(text: str) -> Assignment:
    """Read ``MEMBER=VALUE`` or ``MEMBER=VALUE@SCAN``. Raises DiagnosticError."""
    match = _SET.fullmatch(text.strip())
    if match is None or not match["value"].strip():
        raise usage(f"--set {text}", "a member and its value are needed", "for example DriveJobs.setRamps.execute=TRUE")
    return Assignment(match["path"].strip(), match["value"].strip(), int(match["scan"] or 1))


def plan_faults(texts: Sequence[str], file: Path | None, drives: Sequence[str]) -> FaultPlan:
    """Faults of the command line and of a YAML file. Raises DiagnosticError with every problem."""
    plan = FaultPlan()
    problems: list[Diagnostic] = []
    for text in texts:
        try:
            plan.add(*_typed(text, drives))
        except DiagnosticError as problem:
            problems += problem.diagnostics
    if file is not None:
        for node in _entries(load_yaml(read_text(file), str(file)), str(file)):
            try:
                plan.add(*_listed(node, str(file), drives))
            except DiagnosticError as problem:
                problems += [replace(d, span=d.span if d.span.line else node.span) for d in problem.diagnostics]
    if problems:
        raise DiagnosticError(problems)
    return plan


def _typed(text: str, drives: Sequence[str]) -> tuple[str | None, list[Fault]]:
    """One ``KIND[:KEY=VALUE,...]`` of the command line."""
    option = f"--fault {text}"
    kind, _, rest = text.partition(":")
    known = [item.value for item in FaultKind]
    if kind.strip() not in known:
        hint = did_you_mean(kind.strip(), known)
        raise usage(option, f'there is no fault "{kind.strip()}"', hint or f"faults: {', '.join(known)}")
    entry: dict[str, Any] = {"kind": kind.strip()}
    for pair in filter(None, (part.strip() for part in rest.split(","))):
        key, equals, value = (part.strip() for part in pair.partition("="))
        if not equals or not value:
            raise usage(option, f'"{pair}" has no value', f"for example {kind.strip()}:times=2")
        entry[key] = _plain(key, value)
    return _build(entry, option, drives, code=USAGE)


def _plain(key: str, text: str) -> Any:
    """A typed value: ``2``, ``16#B5``, ``0xB5``, ``B5h``; where codes are meant also ``B5`` and ``DE80B500``."""
    if key in {"data", "drive"}:
        return text
    if key in _HEX_KEYS and _HEX.fullmatch(text):
        return int(text.rstrip("h"), 16)
    return resolve_plain(text)


def _entries(root: Node, file: str) -> list[Node]:
    """The list of faults: the document itself or its key ``faults``."""
    found = root.get("faults") if root.kind == "map" else root
    if found is None or found.kind != "seq":
        text = "a list of faults is needed, or a mapping with the key faults"
        raise DiagnosticError([Diagnostic("PG106", text, root.span if root.span.line else Span(file))])
    return found.items


def _listed(node: Node, file: str, drives: Sequence[str]) -> tuple[str | None, list[Fault]]:
    """One fault of a YAML file."""
    if node.kind != "map":
        raise DiagnosticError([Diagnostic("PG106", "a fault is a mapping", node.span)])
    return _build({key: value.value for key, (_, value) in node.pairs.items()}, file, drives)


def _build(
    entry: Mapping[str, Any], where: str, drives: Sequence[str], code: str = ""
) -> tuple[str | None, list[Fault]]:
    """Build one fault and say for which drive it is; ``code`` replaces those of a file."""
    chosen = {key: value for key, value in entry.items() if key != "drive"}
    drive = None if entry.get("drive") is None else str(entry["drive"])
    if drive is not None and drive not in drives:
        hint = did_you_mean(drive, drives) or f"drives: {', '.join(drives)}"
        raise DiagnosticError([Diagnostic(code or "PG107", f'there is no drive "{drive}"', Span(where), help=hint)])
    try:
        return drive, faults_from([chosen], where)
    except DiagnosticError as problem:
        raise DiagnosticError(replace(d, code=code or d.code) for d in problem.diagnostics) from None
