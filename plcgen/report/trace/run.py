"""One run: program, partners and jobs put together, scanned until every job has ended, recorded step by step."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Literal, cast

from plcgen.base.diagnostics import Diagnostic, DiagnosticError, Report, Span
from plcgen.base.diagnostics.suggest import job_hint
from plcgen.base.files.options import usage
from plcgen.project.composing import from_disk
from plcgen.project.includes import Read
from plcgen.project.nouns import Project
from plcgen.project.opening import Opened, open_spec
from plcgen.proof.standins import stand_ins
from plcgen.report.trace.face import PartnerOptions, Recorded, Recording
from plcgen.report.trace.jobs import JobWatch
from plcgen.report.trace.model import BlockCall, CallShape, Contact, Kind, Signal, Step, Trace, Value
from plcgen.report.trace.program import load_program
from plcgen.report.trace.recorder import Derived, RecordingCpu, Watched, signal
from plcgen.report.trace.settings import TimedValue, all_right, parse_time, parse_timed_value, read_inputs
from plcgen.report.trace.values import full_path, located, no_member, valued_members
from plcgen.s7.cpu.cpu import Misuse
from plcgen.s7.cpu.program import Program
from plcgen.s7.cpu.system.port import Periphery
from plcgen.s7.types.system import Family

Progress = Callable[[str, int, int], None]
EVERYTHING = "*"
"""``--watch`` for every member of every data block."""


@dataclass(frozen=True, slots=True)
class RunSettings:
    """What a run is told. ``jobs`` empty: all; ``scans`` None: until every job must have ended; times in ms.

    ``inputs`` is a file with more ``sets``; ``*`` among ``watches`` are all members of all data blocks.
    """

    jobs: Sequence[str] = ()
    scans: int | None = None
    scan_time: int | str = 10
    sets: Sequence[str] = ()
    watches: Sequence[str] = ()
    faults: Sequence[str] = ()
    fault_file: Path | None = None
    drives: Sequence[str] = ()
    inputs: Path | None = None


class Simulation:
    """The generated files of a spec with the user's ``own`` sources, read and compiled once for any number of runs.

    ``read`` gives the text of the spec.
    """

    def __init__(self, spec: Path, folder: Path, own: Sequence[Path] = (), read: Read = from_disk) -> None:
        self.spec, self.folder, self.own, self.read = spec, folder, own, read

    @cached_property
    def _opened(self) -> Opened:
        return open_spec(self.spec, self.read)

    @cached_property
    def program(self) -> Program:
        """The program. Raises DiagnosticError."""
        if not self.folder.is_dir():
            place, text = Span(str(self.folder)), "run plcgen generate first"
            raise DiagnosticError([Diagnostic("PG507", "there is no such folder", place, help=text)])
        project = self._opened.sound()
        constants = {name: value for recording in _recordings(project) for name, value in recording.constants.items()}
        return load_program(self.folder, project.target.dialect, self.own, constants, stand_ins(project))

    def run(self, settings: RunSettings, progress: Progress | None = None) -> Trace:
        """Run against simulated partners and record it; problems are diagnostics."""
        report = Report()
        try:
            run = self.begin(settings, report)
            run.go(progress)
            return run.trace()
        except DiagnosticError as problem:
            report.extend(problem.diagnostics)
        return Trace(str(self.spec), str(self.folder), diagnostics=tuple(report))

    def begin(self, settings: RunSettings, report: Report) -> Run:
        """A run before its first scan. Raises DiagnosticError; what is no error is in the report."""
        project = self._opened.sound()
        report.extend(self._opened.diagnostics)
        recordings = _recordings(project)
        chosen = _chosen(recordings, settings.jobs, self.spec)
        scan_time = parse_time(str(settings.scan_time))
        lines = [] if settings.inputs is None else read_inputs(settings.inputs)
        assignments = sorted(all_right([*lines, *map(parse_timed_value, settings.sets)]), key=lambda item: item.scan)
        target = project.target
        bus = Periphery()
        _connect(recordings, chosen, settings, bus)
        program = self.program
        report.extend(program.diagnostics)
        cpu = RecordingCpu(program, bus, cast("Family", target.family))
        run = Run(self, project, cpu, recordings, chosen, settings, scan_time, assignments, report)
        cpu.restart("cold")
        run.prepare()
        return run


def _recordings(project: Project) -> list[Recording]:
    """New ones, with partners in their first state, of every protocol that records."""
    found = (plan.protocol.recording(plan) for plan in project.plans)
    return [recording for recording in found if recording is not None]


def _chosen(recordings: Sequence[Recording], names: Sequence[str], spec: Path) -> list[tuple[int, str]]:
    """Jobs, each with the number of its protocol. Raises DiagnosticError if there is none, or none of that name."""
    known = {key: number for number, recording in enumerate(recordings) for key in recording.jobs}
    if not known:
        raise usage(str(spec), "there is no job to simulate", "plcgen verify runs the jobs of every protocol")
    for name in names:
        if name not in known:
            raise usage(f"--job {name}", f'the spec has no job "{name}"', job_hint(name, known))
    return [(number, key) for key, number in known.items() if not names or key in names]


def _connect(
    recordings: Sequence[Recording], chosen: Sequence[tuple[int, str]], settings: RunSettings, bus: Periphery
) -> None:
    """Put all partners on the bus; those of the chosen jobs are told what goes wrong. Raises DiagnosticError.

    A fault is for the protocols that know its kind, a file for the one that knows the partner it names.
    """
    told = sorted({number for number, _ in chosen})
    for number, recording in enumerate(recordings):
        options = PartnerOptions()
        if number in told:
            others = [recordings[other] for other in told if other != number]
            faults = [text for text in settings.faults if _mine(text.partition(":")[0], recording.faults, others)]
            files = [text for text in settings.drives if _ours(text, recording, others)]
            options = PartnerOptions(faults, settings.fault_file, files)
        recording.connect(bus, options)


def _mine(kind: str, kinds: Sequence[str], others: Sequence[Recording]) -> bool:
    """Whether a fault is for a protocol: it knows the kind, or nobody does."""
    return kind in kinds or not any(kind in other.faults for other in others)


def _ours(text: str, recording: Recording, others: Sequence[Recording]) -> bool:
    """Whether a file is for the partners of a protocol."""
    name = text.partition("=")[0]
    return name in recording.partners or not any(name in other.partners for other in others)


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


def _columns(shape: CallShape) -> dict[str, tuple[Kind, int]]:
    """What is recorded of a call: name, kind and bits."""
    found: dict[str, tuple[Kind, int]] = dict.fromkeys(("REQ", "BUSY", shape.success, "ERROR"), ("bool", 1))
    found["STATUS"] = "word", shape.bits
    return found | ({"LEN": ("integer", 16)} if shape.answers else {})


@dataclass(slots=True)
class Run:
    """The state of one run: signals with what they watch, and the steps so far."""

    simulation: Simulation
    project: Project
    cpu: RecordingCpu
    recordings: Sequence[Recording]
    chosen: Sequence[tuple[int, str]]
    settings: RunSettings
    scan_time: int
    assignments: Sequence[TimedValue]
    report: Report
    pending: deque[tuple[int, str, object]] = field(default_factory=deque)
    signals: list[Signal] = field(default_factory=list)
    start: list[Value] = field(default_factory=list)
    now: list[Value] = field(default_factory=list)
    steps: list[Step] = field(default_factory=list)
    jobs: list[JobWatch] = field(default_factory=list)
    recorded: list[Recorded] = field(default_factory=list)
    others: list[str] = field(default_factory=list)
    ended: Literal["jobs", "scans", "stop"] = "scans"
    watched: list[tuple[int, Watched | Derived]] = field(default_factory=list)
    positions: dict[str, int] = field(default_factory=dict)

    def go(self, progress: Progress | None) -> None:
        """Scan until the end."""
        limit, pending = self.settings.scans or self.longest(), self.pending
        for number in range(1, limit + 1):
            while pending and pending[0][0] <= number:
                _, path, value = pending.popleft()
                self.cpu[path] = value
            if number == 1 and self.settings.inputs is None:  # else the file says when a job starts
                for job in self.jobs:
                    job.begin()
            self.scan()
            if progress is not None and number % 100 == 0:
                progress("scans", number, limit)
            if self.cpu.faulted:
                self.ended = "stop"
                return
            if all(job.finished for job in self.jobs) and not pending:
                self.ended = "jobs"
                return

    def scan(self) -> None:
        """One scan of the program, recorded."""
        self.cpu.scan(self.scan_time)
        self.record(self.cpu.scans)

    def trace(self, since: int = 0) -> Trace:
        """Everything that was recorded so far, without the first ``since`` steps."""
        main = self.simulation.program.main()
        words = {recording.words for recording in self.recordings}
        self.report.extend(map(_diagnostic, dict.fromkeys(self.cpu.misuses)))
        return Trace(
            str(self.simulation.spec),
            str(self.simulation.folder),
            self.project.name,
            f"{self.project.target.family} / {self.project.target.toolchain}",
            main.name if main else "",
            words.pop() if len(words) == 1 else ("call", "partner"),
            self.scan_time,
            self.cpu.scans,
            self.cpu.clock,
            self.ended,
            self.settings.scans is not None,
            tuple(self.signals),
            tuple(self.start),
            tuple(self.steps[since:]),
            tuple(watch.result() for watch in self.jobs),
            tuple(self.report),
        )

    @property
    def controls(self) -> list[str]:
        """The DBs with commands."""
        return [name for recording in self.recordings for name in recording.controls]

    def longest(self) -> int:
        """Scans after which every job must have ended: the longest time-out, draining, a few scans to start."""
        drain = max(recording.drain for recording in self.recordings)
        time = max(job.facts.timeout for job in self.jobs) + drain
        last = max((item.scan for item in self.assignments), default=0)
        return last + -(-time // self.scan_time) + 10

    def prepare(self) -> None:
        """Look up everything that is recorded. Raises DiagnosticError if the folder holds other blocks."""
        try:
            self.prepare_jobs()
        except KeyError as problem:
            text = "the folder was generated from another spec, or by another version: run plcgen generate"
            message = f"a block or member of this spec is missing: {problem.args[0]}"
            place = Span(str(self.simulation.folder))
            raise DiagnosticError([Diagnostic("PG608", message, place, help=text)]) from None
        controls = self.controls
        self.pending.extend(all_right(located(self.cpu, item, controls) for item in self.assignments))
        shown = {item.path: where for item, (_, where, _) in zip(self.assignments, self.pending, strict=True)}
        for path in self.settings.watches:
            if path != EVERYTHING:
                try:
                    shown[path] = full_path(self.cpu, path, controls)
                except LookupError as problem:
                    raise usage(f"--watch {path}", no_member(path), str(problem)) from None
        for path, where in shown.items():
            if f"memory.{path}" not in self.positions:
                self.add(*signal(self.cpu, "memory", path, where, listed=True))
        if EVERYTHING in self.settings.watches:
            for path in valued_members(self.cpu):
                if f"memory.{path}" not in self.positions:
                    self.add(*signal(self.cpu, "memory", path, path))
        for path in self.others:  # a job with a cycle starts automatically
            self.cpu[path] = False

    def prepare_jobs(self) -> None:
        """Look up the members of the jobs and what they share. Raises KeyError for one that is not there."""
        self.recorded = [recording.attach(self.cpu) for recording in self.recordings]
        self.cpu.group = self.job_of
        for number, key in self.chosen:
            job = self.recorded[number].job(key)
            for found, watched in job.signals():
                self.add(found, watched)
            for shape in self.recordings[number].calls:
                self.add_calls(key, shape)
            self.jobs.append(JobWatch(self.cpu, job))
        known = ((number, key) for number, recording in enumerate(self.recordings) for key in recording.jobs)
        self.others = [
            self.recorded[number].job(key).facts.execute for number, key in known if (number, key) not in self.chosen
        ]
        for number in sorted({number for number, _ in self.chosen}):
            for found, watched in self.recorded[number].signals():
                self.add(found, watched)

    def job_of(self, instance: str) -> str:
        """The job for which an instance of a system block works; its own name if for none."""
        return next((job for recorded in self.recorded if (job := recorded.job_of(instance))), instance)

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

    def add_calls(self, group: str, shape: CallShape) -> None:
        """Record the calls of a system block for a job or instance."""
        for name, (kind, bits) in _columns(shape).items():
            self._append(Signal(group, f"{shape.block}.{name}", kind, bits), 0 if bits > 1 else False)

    def record(self, number: int) -> None:
        """Keep what changed in this scan."""
        calls = self.cpu.take()
        contacts: tuple[Contact, ...] = tuple(contact for one in self.recorded for contact in one.take())
        changes: dict[int, Value] = {}
        for position, watched in self.watched:
            if watched.changed():
                changes[position] = watched.value()
        seen = self.record_values(calls)
        changes |= {position: value for position, value in seen.items() if value != self.now[position]}
        self.now = [changes.get(position, value) for position, value in enumerate(self.now)]
        for job in self.jobs:
            job.after([c for c in contacts if c.group == job.facts.key])
        if changes or contacts:
            ordered = tuple(sorted(changes.items()))
            self.steps.append(Step(number, self.cpu.clock, ordered, calls, contacts))

    def record_values(self, calls: Sequence[BlockCall]) -> dict[int, Value]:
        """Signals of calls after a scan: flags fall where the block was not called, STATUS and LEN stay."""
        values: dict[int, Value] = {
            position: False for position, found in enumerate(self.signals) if not found.path and found.kind == "bool"
        }
        for call in calls:
            if f"{call.group}.{call.block}.REQ" not in self.positions:
                self.add_calls(call.group, call.shape)
            found: dict[str, Value] = {"REQ": call.request, "BUSY": call.busy, call.shape.success: call.finished}
            found |= {"ERROR": call.error, "STATUS": call.status}
            if call.shape.answers and call.finished:
                found["LEN"] = call.length
            for name, value in found.items():
                values[self.positions[f"{call.group}.{call.block}.{name}"]] = value
        return values
