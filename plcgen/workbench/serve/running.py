"""The soft CPU while somebody watches: scan by scan, with values, partners and faults set by hand."""

from __future__ import annotations

import re
import threading
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import asdict, replace
from typing import Any

from plcgen.base.diagnostics import DiagnosticError, Report, Span
from plcgen.base.files.options import usage
from plcgen.report.trace.data import trace_data
from plcgen.report.trace.face import JobInput, PendingFault, RecordedJob
from plcgen.report.trace.recorder import recorded_value, watch
from plcgen.report.trace.run import Run, RunSettings, Simulation
from plcgen.report.trace.settings import all_right, parse_timed_value
from plcgen.report.trace.values import located, valued_members
from plcgen.s7.types.data_types import ArrayType
from plcgen.s7.types.literals import type_text

_DECIMAL_COMMA = re.compile(r"(?<=[=])(\s*[-+]?\d+),(\d+\s*)\Z", re.ASCII)
MAX_SCANS = 200
"""Scans of one request."""
MAX_STEPS = 4000
"""Steps that a run keeps: beyond it, it ends."""
MAX_MEMBERS = 3000
MAX_ELEMENTS = 16
"""Of an array at an input."""


class Live:
    """One program that is loaded, or none; ``number`` tells one load from the next."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._run: Run | None = None
        self._sent = self._known = 0
        self._struck: list[tuple[str, Sequence[PendingFault]]] = []
        self.number = 0

    def load(self, simulation: Simulation, scan_time: int) -> dict[str, Any]:
        """Load a program and restart it. Raises DiagnosticError."""
        with self._lock:
            run = simulation.begin(RunSettings(scan_time=scan_time), Report())
            self._run, self._sent, self._known, self.number = run, 0, 0, self.number + 1
            self._struck = []
            found = trace_data(run.trace())
            return {
                "number": self.number,
                "target": found["target"],
                "jobs": [
                    {
                        "key": job.facts.key,
                        "partner": job.facts.partner,
                        "execute": job.facts.execute,
                        "inputs": list(_inputs(run, job.job)),
                    }
                    for job in run.jobs
                ],
                "members": [path for path, _ in zip(_settable(run), range(MAX_MEMBERS), strict=False)],
                "faults": [
                    {
                        "kind": kind.kind,
                        "text": kind.text,
                        "keys": [asdict(key) for key in kind.keys],
                    }
                    for recording in run.recordings
                    for kind in recording.kinds
                ],
                **self._now(run),
            }

    def step(self, scans: int) -> dict[str, Any]:
        """So many scans; what came since the last answer. Raises DiagnosticError."""
        with self._lock:
            run = self._loaded()
            for _ in range(scans):
                if run.cpu.faulted or len(run.steps) >= MAX_STEPS:
                    break
                run.scan()
                for job in run.jobs:
                    job.again()
            return self._now(run)

    def put(self, text: str) -> dict[str, Any]:
        """Set a member, tag or address, or something of a partner: ``NAME=VALUE``. Raises DiagnosticError."""
        with self._lock:
            run = self._loaded()
            text = text.replace('"', "").replace(":=", "=")  # as SCL writes it, too
            text = _DECIMAL_COMMA.sub(r"\1.\2", text)
            with _of_the_page():
                if not any(recording.put(text) for recording in run.recordings):
                    (item,) = all_right([parse_timed_value(text)])
                    ((_, path, value),) = all_right([located(run.cpu, item, run.controls)])
                    run.cpu[path] = value
            return self._now(run)

    def strike(self, kind: str, keys: Mapping[str, str]) -> dict[str, Any]:
        """One more fault, for the protocol that knows its kind. Raises DiagnosticError."""
        with self._lock:
            run = self._loaded()
            given = {key: value.strip() for key, value in keys.items() if value.strip()}
            wrong = next((value for value in (kind, *given, *given.values()) if set(value) & set(",:=")), None)
            if wrong is not None:
                raise usage(f"fault {kind}", f'"{wrong}" is no value', "a number, bytes in hexadecimal, or a word")
            text = f"{kind}:{','.join(f'{key}={value}' for key, value in given.items())}"
            known = [recording for recording in run.recordings if kind in recording.faults]
            with _of_the_page():
                struck = [fault for recording in known or run.recordings[:1] for fault in recording.strike(text)]
            self._struck.append((text.rstrip(":").replace(":", ": ", 1).replace(",", ", "), struck))
            return self._now(run)

    def withdraw(self, number: int) -> dict[str, Any]:
        """End one of the faults that were let in. Raises DiagnosticError."""
        with self._lock:
            run = self._loaded()
            for fault in self._struck[number][1] if number < len(self._struck) else ():
                fault.times = 0
            return self._now(run)

    def _loaded(self) -> Run:
        if self._run is None:
            raise usage("run", "no program is loaded", "load it first")
        return self._run

    def _now(self, run: Run) -> dict[str, Any]:
        """Where the run is: steps since the last answer, values of partners and of what starts the jobs."""
        found = trace_data(run.trace(since=self._sent))
        self._sent = len(run.steps)
        fresh, self._known = found["signals"][self._known :], len(run.signals)
        return {
            "scan": run.cpu.scans,
            "time": run.cpu.clock,
            "stopped": run.cpu.faulted,
            "full": len(run.steps) >= MAX_STEPS,
            "steps": found["steps"],
            "results": found["jobs"],
            "signals": fresh,
            "inputs": {path: _shown(run.cpu[path]) for job in run.jobs for path, _ in _elements(run, job.job)},
            "struck": [
                {"number": number, "text": text, "left": max(times) if (times := _left(faults)) else None}
                for number, (text, faults) in enumerate(self._struck)
                if not all(fault.spent for fault in faults)
            ],
            "partners": [asdict(one) for recording in run.recordings for one in recording.contents()],
            "diagnostics": found["diagnostics"],
        }


def _left(faults: Iterable[PendingFault]) -> list[int]:
    """How often faults still strike; those without an end do not count."""
    return [fault.times for fault in faults if fault.times is not None]


@contextmanager
def _of_the_page() -> Iterator[None]:
    """Problems of what was typed into a field have no option of the command line as their place."""
    try:
        yield
    except DiagnosticError as problem:
        raise DiagnosticError([replace(one, span=Span("")) for one in problem.diagnostics]) from None


def _elements(run: Run, job: RecordedJob) -> Iterator[tuple[str, JobInput]]:
    """Paths of the single values of each input: of an array the first ones."""
    for one in job.inputs():
        value = run.cpu[one.path]
        if isinstance(value, list):
            _, type_ = watch(run.cpu, one.path)
            first = type_.bounds[0][0] if isinstance(type_, ArrayType) else 0
            yield from ((f"{one.path}[{first + place}]", one) for place in range(min(len(value), MAX_ELEMENTS)))
        elif not isinstance(value, dict):
            yield one.path, one


def _inputs(run: Run, job: RecordedJob) -> Iterator[dict[str, Any]]:
    """The values that a job takes, each with its type as SCL names it and what is known of it."""
    for path, one in _elements(run, job):
        yield {
            "path": path,
            "name": path.replace('"', "").partition(".")[2].partition(".")[2] or path,
            "type": type_text(watch(run.cpu, path)[1]),
            "title": one.title,
            "unit": one.unit,
            "low": one.low,
            "high": one.high,
            "names": [[name, number] for name, number in one.names.items()],
        }


def _shown(value: Any) -> str:
    found = recorded_value(value)
    return str(found).upper() if isinstance(found, bool) else str(found)


def _settable(run: Run) -> Iterator[str]:
    """Members of the data blocks with commands, then those of all others."""
    controls: Sequence[str] = run.controls
    members = list(valued_members(run.cpu))
    first = [path for path in members if any(path.startswith(f'"{name}".') for name in controls)]
    yield from first
    yield from (path for path in members if path not in set(first))
