"""What a run is told: values and scan times as people type them. Every mistake is a diagnostic."""

from __future__ import annotations

import re
from dataclasses import dataclass, replace
from pathlib import Path

from plcgen.base.diagnostics import Diagnostic, DiagnosticError, Span
from plcgen.base.files.options import usage
from plcgen.base.files.text import read_text
from plcgen.base.files.yaml import YamlNode

_TIME = re.compile(r"([0-9]+(?:\.[0-9]+)?)\s*(ms|s)?", re.ASCII)
_SET = re.compile(r"(?P<path>[^=]+?)\s*=\s*(?P<value>.*?)(?:@(?P<scan>[0-9]+))?", re.DOTALL)
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


def parse_time(text: str) -> int:
    """Milliseconds of ``10ms``, ``10`` or ``0.5s``. Raises DiagnosticError."""
    match = _TIME.fullmatch(text.strip())
    time = float(match[1]) * (1000 if match[2] == "s" else 1) if match else 0.0
    if not 1 <= time <= LONGEST_SCAN or time != int(time):
        raise usage(f"--scan-time {text}", "a scan takes whole milliseconds, from 1ms to 60s", "for example 10ms")
    return int(time)


def parse_timed_value(text: str) -> TimedValue:
    """Read ``MEMBER=VALUE`` or ``MEMBER=VALUE@SCAN``. Raises DiagnosticError."""
    match = _SET.fullmatch(text.strip())
    if match is None or not match["value"].strip():
        raise usage(f"--set {text}", "a member and its value are needed", "for example DriveJobs.setRamps.execute=TRUE")
    return TimedValue(match["path"].strip(), match["value"].strip(), int(match["scan"] or 1))


def read_inputs(path: Path) -> tuple[str, ...]:
    """The values of a file, one ``MEMBER=VALUE@SCAN`` a line; empty lines and those that begin with # do not count.

    Raises DiagnosticError, at its line for one that is no such value.
    """
    found: list[str] = []
    problems: list[Diagnostic] = []
    for number, line in enumerate(read_text(path).splitlines(), 1):
        text = line.strip()
        if not text or text.startswith("#"):
            continue
        try:
            parse_timed_value(text)
        except DiagnosticError as problem:
            place = Span(str(path), number, 1, number, len(line) + 1)
            problems += (replace(one, span=place) for one in problem.diagnostics)
        found.append(text)
    if problems:
        raise DiagnosticError(problems)
    return tuple(found)


FAULTS_SHAPE = "a list of faults is needed, or a mapping with the key faults"


def with_faults_key(root: YamlNode) -> YamlNode:
    """Widen a file that is the list of faults itself."""
    if root.kind != "seq":
        return root
    return YamlNode("map", root.span, pairs={"faults": (YamlNode("scalar", root.span, "faults"), root)})
