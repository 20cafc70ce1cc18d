"""The soft CPU while somebody watches: scan by scan, with values, partners and faults set by hand."""

from __future__ import annotations

import threading
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict
from typing import Any

from plcgen.base.diagnostics import Report
from plcgen.base.files.options import usage
from plcgen.report.trace.data import trace_data
from plcgen.report.trace.face import JobInput, RecordedJob
from plcgen.report.trace.recorder import recorded_value, watch
from plcgen.report.trace.run import Run, RunSettings, Simulation
from plcgen.report.trace.settings import all_right, parse_timed_value
from plcgen.report.trace.values import located, valued_members
from plcgen.s7.types.data_types import ArrayType
from plcgen.s7.types.spelling import type_text

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
        self.number = 0

    def load(self, simulation: Simulation, scan_time: int) -> dict[str, Any]:
        """Load a program and restart it. Raises DiagnosticError."""
        with self._lock:
            run = simulation.begin(RunSettings(scan_time=scan_time), Report())
            self._run, self._sent, self._known, self.number = run, 0, 0, self.number + 1
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
            for recording in known or run.recordings[:1]:
                recording.strike(text)
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
            "partners": [list(one) for recording in run.recordings for one in recording.contents()],
            "diagnostics": found["diagnostics"],
        }


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
