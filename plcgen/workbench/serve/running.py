"""The soft CPU while somebody watches: scan by scan, with values, partners and faults set by hand."""

from __future__ import annotations

import threading
from collections.abc import Iterator, Sequence
from typing import Any

from plcgen.base.diagnostics import Report
from plcgen.base.files.options import usage
from plcgen.report.trace.data import trace_data
from plcgen.report.trace.run import Run, RunSettings, Simulation
from plcgen.report.trace.settings import all_right, parse_timed_value
from plcgen.report.trace.values import located, valued_members

MAX_SCANS = 200
"""Scans of one request."""
MAX_STEPS = 4000
"""Steps that a run keeps: beyond it, it ends."""
MAX_MEMBERS = 3000


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
                    {"key": job.facts.key, "partner": job.facts.partner, "execute": job.facts.execute}
                    for job in run.jobs
                ],
                "members": [path for path, _ in zip(_settable(run), range(MAX_MEMBERS), strict=False)],
                "faults": sorted({kind for recording in run.recordings for kind in recording.faults}),
                "example": run.recordings[0].fault,
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

    def strike(self, text: str) -> dict[str, Any]:
        """One more fault, for the protocol that knows its kind. Raises DiagnosticError."""
        with self._lock:
            run = self._loaded()
            kind = text.partition(":")[0]
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
            "partners": [list(one) for recording in run.recordings for one in recording.contents()],
            "diagnostics": found["diagnostics"],
        }


def _settable(run: Run) -> Iterator[str]:
    """Members of the data blocks with commands, then those of all others."""
    controls: Sequence[str] = run.controls
    members = list(valued_members(run.cpu))
    first = [path for path in members if any(path.startswith(f'"{name}".') for name in controls)]
    yield from first
    yield from (path for path in members if path not in set(first))
