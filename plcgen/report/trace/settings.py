"""What a run is told: values and scan times as people type them. Every mistake is a diagnostic."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TypeVar

from plcgen.base.diagnostics import Diagnostic, DiagnosticError, Span
from plcgen.base.files.options import USAGE, usage
from plcgen.base.files.text import read_text
from plcgen.base.files.yaml import YamlNode

_TIME = re.compile(r"([0-9]+(?:\.[0-9]+)?)\s*(ms|s)?", re.ASCII)
_SET = re.compile(r"(?P<path>[^=]+?)\s*=\s*(?P<value>.*?)(?:@(?P<scan>[0-9]+))?", re.DOTALL)
LONGEST_SCAN = 60_000
MOST_SCANS = 10_000_000
MOST_SHOWN = 20
"""Of many mistakes in a file so many are reported."""


@dataclass(frozen=True, slots=True)
class TimedValue:
    """A value given to a member, tag or address before scan ``scan``; ``span`` is where that is said."""

    path: str
    value: str
    scan: int
    span: Span

    def wrong(self, message: str, help_: str = "") -> Diagnostic:
        """What is wrong with it."""
        return Diagnostic(USAGE, message, self.span, help=help_)


def parse_time(text: str) -> int:
    """Milliseconds of ``10ms``, ``10`` or ``0.5s``. Raises DiagnosticError."""
    match = _TIME.fullmatch(text.strip())
    time = float(match[1]) * (1000 if match[2] == "s" else 1) if match else 0.0
    if not 1 <= time <= LONGEST_SCAN or time != int(time):
        raise usage(f"--scan-time {text}", "a scan takes whole milliseconds, from 1ms to 60s", "for example 10ms")
    return int(time)


def parse_timed_value(text: str, span: Span | None = None) -> TimedValue | Diagnostic:
    """Read ``MEMBER=VALUE`` or ``MEMBER=VALUE@SCAN``, SCAN from 1 to ``MOST_SCANS``, or say what is wrong with it."""
    match, place = _SET.fullmatch(text.strip()), span or Span(f"--set {text}")
    if match is None or not match["value"].strip():
        example = "for example DriveJobs.setRamps.execute=TRUE"
        return Diagnostic(USAGE, "a member and its value are needed", place, help=example)
    scan = match["scan"] or "1"
    if len(scan) > len(str(MOST_SCANS)) or not 1 <= int(scan) <= MOST_SCANS:
        return Diagnostic(USAGE, f"scans count from 1 to {MOST_SCANS:,}", place, help="for example M50.0=TRUE@3")
    return TimedValue(match["path"].strip(), match["value"].strip(), int(scan), place)


def read_inputs(path: Path) -> Iterator[TimedValue | Diagnostic]:
    """The values of a file, one ``MEMBER=VALUE@SCAN`` a line, or what is wrong with a line.

    Empty lines and those that begin with # do not count. Raises DiagnosticError if it cannot be read.
    """
    for number, line in enumerate(read_text(path).split("\n"), 1):
        text = line.strip()
        if text and not text.startswith("#"):
            yield parse_timed_value(text, Span(str(path), number, 1, number, len(line.rstrip()) + 1))


T = TypeVar("T")


def all_right(found: Iterable[T | Diagnostic]) -> list[T]:
    """All of them. Raises DiagnosticError if something is wrong with some, with the first ``MOST_SHOWN`` of these."""
    good: list[T] = []
    wrong: list[Diagnostic] = []
    for one in found:
        if isinstance(one, Diagnostic):
            wrong.append(one)
            if len(wrong) == MOST_SHOWN:
                break
        else:
            good.append(one)
    if wrong:
        raise DiagnosticError(wrong)
    return good


FAULTS_SHAPE = "a list of faults is needed, or a mapping with the key faults"


def with_faults_key(root: YamlNode) -> YamlNode:
    """Widen a file that is the list of faults itself."""
    if root.kind != "seq":
        return root
    return YamlNode("map", root.span, pairs={"faults": (YamlNode("scalar", root.span, "faults"), root)})
