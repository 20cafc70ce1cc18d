"""One run: program, drives and jobs put together, scanned until every job has ended, recorded step by step."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Literal, cast

from plcgen.cpu.cpu import Family, Misuse
from plcgen.cpu.system.bus import Periphery
from plcgen.diagnostics import Diagnostic, DiagnosticError, Report, Span
from plcgen.diagnostics.suggest import did_you_mean
from plcgen.input.options import usage
from plcgen.proof.standins import stand_ins
from plcgen.protocols.ds47.plan.nouns import DriveJob, DrivePlan
from plcgen.protocols.ds47.words import DRAIN_MS
from plcgen.trace.jobs import JobWatch, UnitWatch, job_signals
from plcgen.trace.model import RecordCall, Signal, Step, Trace, Value
from plcgen.trace.program import connect, load_program
from plcgen.trace.recorder import Derived, RecordingCpu, Watched, name_drives, signal
from plcgen.trace.settings import TimedValue, parse_assignment, parse_time, plan_faults
from plcgen.trace.values import assign, full_path

Progress = Callable[[str, int, int], None]


@dataclass(frozen=True, slots=True)
class RunSettings:
    """What a run is told. ``jobs`` empty: all; ``scans`` None: until every job must have ended; times in ms."""

    jobs: Sequence[str] = ()
    scans: int | None = None
    scan_time: int | str = 10
    sets: Sequence[str] = ()
    watches: Sequence[str] = ()
    faults: Sequence[str] = ()
    fault_file: Path | None = None
    drives: Sequence[str] = ()
    own: Sequence[Path] = ()


def simulate(spec: Path, folder: Path, settings: RunSettings, progress: Progress | None = None) -> Trace:
    """Run the generated files in a folder against simulated drives and record it; problems are diagnostics."""
    report = Report()
    try:
        return _simulate(spec, folder, settings, progress, report)
    except DiagnosticError as problem:
        report.extend(problem.diagnostics)
    return Trace(str(spec), str(folder), diagnostics=tuple(report))


def _simulate(spec: Path, folder: Path, settings: RunSettings, progress: Progress | None, report: Report) -> Trace:
    from plcgen.project.opening import open_spec

    opened = open_spec(spec)
    project = opened.sound()
    plan = project.plan(DrivePlan)
    report.extend(opened.diagnostics)
    if plan is None or not plan.jobs:
        help_ = "plcgen verify runs the jobs of every protocol"
        raise usage(str(spec), "there is no drive job to be simulated", help_)
    jobs = _chosen(plan, settings.jobs)
    scan_time = parse_time(str(settings.scan_time))
    assignments = sorted(map(parse_assignment, settings.sets), key=lambda item: item.scan)
    faults = plan_faults(settings.faults, settings.fault_file, [drive.key for drive in plan.drives])
    units = connect(plan, settings.drives, faults)
    if not folder.is_dir():
        missing = Diagnostic("PG507", "there is no such folder", Span(str(folder)), help="run plcgen generate first")
        raise DiagnosticError([missing])
    constants = {drive.id_name: drive.id_value for drive in plan.drives if drive.id_name}
    program = load_program(folder, plan.target.dialect, settings.own, constants, stand_ins(project))
    report.extend(program.diagnostics)
    bus = Periphery({address: unit for address, (_, unit) in units.items()})
    cpu = RecordingCpu(program, bus, cast("Family", plan.target.family))
    name_drives(cpu, units.values())
    run = _Run(cpu, plan, jobs, settings, scan_time, assignments)
    run.go(folder, progress)
    report.extend(map(_diagnostic, dict.fromkeys(cpu.misuses)))
    main = program.main()
    return Trace(
        str(spec),
        str(folder),
        plan.name,
        f"{plan.target.family} / {plan.target.toolchain}",
        main.name if main else "",
        scan_time,
        cpu.scans,
        cpu.clock,
        run.ended,
        settings.scans is not None,
        tuple(run.signals),
        tuple(run.start),
        tuple(run.steps),
        tuple(watch.result() for watch in run.jobs),
        tuple(report),
    )


def _chosen(plan: DrivePlan, names: Sequence[str]) -> list[DriveJob]:
    known = {job.key: job for job in plan.jobs}
    for name in names:
        if name not in known:
            text = f"{did_you_mean(name, known)} jobs of this spec: {', '.join(known)}".strip()
            raise usage(f"--job {name}", f'the spec has no job "{name}"', text)
    return [job for key, job in known.items() if not names or key in names]


def _diagnostic(misuse: Misuse) -> Diagnostic:
    """A misuse at its SCL statement; the excerpt shows the line from its first character on."""
    if not misuse.file:
        return Diagnostic(misuse.code, misuse.message, Span(""))
    first, last = 1, 1
    path = Path(misuse.file)
    if path.is_file():
        lines = path.read_bytes().decode("utf-8-sig", "replace").splitlines()
        line = lines[misuse.line - 1] if 0 < misuse.line <= len(lines) else ""
        first, last = len(line) - len(line.lstrip()) + 1, len(line.split("//")[0].rstrip()) + 1
    return Diagnostic(
        misuse.code, misuse.message, Span(misuse.file, misuse.line, first, misuse.line, max(last, first + 1))
    )


_FLAGS = ("REQ", "BUSY", "DONE", "ERROR", "STATUS", "LEN")


@dataclass(slots=True)
class _Run:
    """The state of one run: signals with what they watch, and the steps so far."""

    cpu: RecordingCpu
    plan: DrivePlan
    planned: Sequence[DriveJob]
    settings: RunSettings
    scan_time: int
    assignments: Sequence[TimedValue]
    signals: list[Signal] = field(default_factory=list)
    start: list[Value] = field(default_factory=list)
    now: list[Value] = field(default_factory=list)
    steps: list[Step] = field(default_factory=list)
    jobs: list[JobWatch] = field(default_factory=list)
    ended: Literal["jobs", "scans", "stop"] = "scans"
    watched: list[tuple[int, Watched | Derived]] = field(default_factory=list)
    positions: dict[str, int] = field(default_factory=dict)

    def go(self, folder: Path, progress: Progress | None) -> None:
        """Prepare, then scan until the end."""
        self.cpu.restart("cold")
        self.prepare(folder)
        limit = self.settings.scans or self.longest()
        pending = list(self.assignments)
        for number in range(1, limit + 1):
            while pending and pending[0].scan <= number:
                assign(self.cpu, pending.pop(0), self.plan)
            if number == 1:
                for job in self.jobs:
                    job.begin()
            self.cpu.scan(self.scan_time)
            self.record(number)
            if progress is not None and number % 100 == 0:
                progress("scans", number, limit)
            if self.cpu.faulted:
                self.ended = "stop"
                return
            if all(job.finished for job in self.jobs) and not pending:
                self.ended = "jobs"
                return

    def longest(self) -> int:
        """Scans after which every job must have ended: the longest time-out, draining, a few scans to start."""
        time = max((job.timeout for job in self.planned), default=1000) + DRAIN_MS
        last = max((item.scan for item in self.assignments), default=0)
        return last + -(-time // self.scan_time) + 10

    def prepare(self, folder: Path) -> None:
        """Look up everything that is recorded. Raises DiagnosticError if the folder holds other blocks."""
        try:
            self.prepare_jobs()
        except KeyError as problem:
            text = "the folder was generated from another spec, or by another version: run plcgen generate"
            message = f"a block or member of this spec is missing: {problem.args[0]}"
            raise DiagnosticError([Diagnostic("PG608", message, Span(str(folder)), help=text)]) from None
        extra = [*(item.path for item in self.assignments), *self.settings.watches]
        for path in dict.fromkeys(extra):
            option = "--watch" if path in self.settings.watches else "--set"
            full = full_path(self.cpu, path, self.plan, option)
            if f"memory.{path}" not in self.positions:
                self.add(*signal(self.cpu, "memory", path, full, listed=True))

    def prepare_jobs(self) -> None:
        """Look up the members of the jobs and units. Raises KeyError for one that is not there."""
        units = UnitWatch(self.cpu, self.plan)
        self.cpu.group = units.job_of
        for job in self.planned:
            for found, watched in job_signals(self.cpu, self.plan, job, units):
                self.add(found, watched)
            for block in ("WRREC", "RDREC"):
                self.add_record(job.key, block)
            self.jobs.append(JobWatch(self.cpu, self.plan, job, units))
        for found, watched in units.signals():
            self.add(found, watched)

    def add(self, found: Signal, watched: Watched | Derived) -> None:
        """Record a member from now on."""
        watched.changed()
        self.watched.append((len(self.signals), watched))
        self._append(found, watched.value())

    def _append(self, found: Signal, value: Value) -> None:
        self.positions[found.id] = len(self.signals)
        self.signals.append(found)
        self.start.append(value)
        self.now.append(value)

    def add_record(self, group: str, block: str) -> None:
        """Record the calls of WRREC or RDREC of a job or instance."""
        for flag in _FLAGS:
            if flag == "LEN" and block == "WRREC":
                continue
            name = "VALID" if flag == "DONE" and block == "RDREC" else flag
            bits = {"STATUS": 32, "LEN": 16}.get(flag, 1)
            kind: Literal["bool", "word", "integer"] = "word" if flag == "STATUS" else "bool"
            kind = "integer" if flag == "LEN" else kind
            self._append(Signal(group, f"{block}.{name}", kind, bits), 0 if bits > 1 else False)

    def record(self, number: int) -> None:
        """Keep what changed in this scan."""
        calls, contacts = self.cpu.take()
        changes: dict[int, Value] = {}
        for position, watched in self.watched:
            if watched.changed():
                changes[position] = watched.value()
        seen = self.record_values(calls)
        changes |= {position: value for position, value in seen.items() if value != self.now[position]}
        self.now = [changes.get(position, value) for position, value in enumerate(self.now)]
        for job in self.jobs:
            job.after(number, [c for c in contacts if c.group == job.planned.key])
        if changes or contacts:
            ordered = tuple(sorted(changes.items()))
            self.steps.append(Step(number, self.cpu.clock, ordered, calls, contacts))

    def record_values(self, calls: Sequence[RecordCall]) -> dict[int, Value]:
        """Signals of record calls after a scan: flags fall where the block was not called, STATUS and LEN stay."""
        values: dict[int, Value] = {
            position: False for position, found in enumerate(self.signals) if not found.path and found.kind == "bool"
        }
        for call in calls:
            if f"{call.group}.{call.block}.REQ" not in self.positions:
                self.add_record(call.group, call.block)
            done = "DONE" if call.block == "WRREC" else "VALID"
            found: dict[str, Value] = {"REQ": call.request, "BUSY": call.busy, done: call.finished}
            found |= {"ERROR": call.error, "STATUS": call.status}
            if call.block == "RDREC" and call.finished:
                found["LEN"] = call.length
            for name, value in found.items():
                values[self.positions[f"{call.group}.{call.block}.{name}"]] = value
        return values
