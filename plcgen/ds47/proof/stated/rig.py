"""OB1 from the files on disk, with a recording device behind every identifier of the spec."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from plcgen.oracles.profidrive import SUBSTITUTES, TYPES
from plcgen.oracles.spec.ds47.course import OUTPUTS_ONLY, Difference, StatedCourse
from plcgen.oracles.spec.ds47.recorder import HeardTelegram, RecordingDevice
from plcgen.oracles.spec.ds47.statement import StatedAccess, StatedDrive, StatedJob, Statement
from plcgen.oracles.spec.ds47.types import ANY, size_of
from plcgen.proof.rig import layout_of
from plcgen.s7.cpu.cpu import Cpu
from plcgen.s7.cpu.program import Program
from plcgen.s7.cpu.system.port import Periphery, RecordServer
from plcgen.s7.layout.layout import Layout
from plcgen.s7.types.blocks import BlockKind
from plcgen.s7.types.names import TIA_LIMIT, V5_LIMIT, shorten

CONTROL = r"DriveJobs\d*"
"""Data blocks with a structure for each instance (docs/generated-code.md, "What is in which data block")."""
SCAN, IDLE_SCAN, QUIET = 10, 50, 120
"""Length of a scan in ms, and the longest one when nothing was heard for so long."""
LONGEST_SCAN = 1000
"""More than that of the time between two calls does not count (docs/generated-code.md, "Times")."""
FINE = 10
"""So many scans at least are in an interval."""
SPARE_MS = 30_000
"""How much longer than its own times a job may take before it counts as hung."""
PLACES = 4
"""So many record jobs run at once in the smallest CPU: when times are measured, nobody waits for a place."""
DONE = 0
ANSWERS = sorted(set(TYPES) - {"VisibleString", "OctetString"})
"""Types of values of which only the answer tells one: the number of the parameter chooses."""


class RecordLine(Periphery):
    """Every identifier leads to somebody who listens: ``port`` makes him; ``last`` is who was looked for last."""

    def __init__(self, port: Callable[[int], RecordServer]) -> None:
        super().__init__(write_busy=1, read_busy=1)
        self.port = port
        self.last = 0
        self.delay: Callable[[int, str], int | None] = lambda _identifier, _kind: None

    def find(self, address: int) -> RecordServer | None:
        """Whoever is there, whether the spec knows him or not."""
        self.last = address
        if address not in self.drives:
            self.drives[address] = self.port(address)
        return self.drives[address]

    def duration(self, kind: str) -> tuple[int | None, int | None]:
        """One scan, or as many ms as asked for."""
        asked = self.delay(self.last, kind)
        return (1, None) if asked is None else (None, asked)


@dataclass
class _Port:
    """One identifier of a device."""

    device: RecordingDevice
    identifier: int
    objects: Mapping[int, int]
    local: bool

    def write_record(self, index: int, data: bytes) -> int:
        return self.device.write(self.identifier, index & 0xFFFF, data, self.objects, local=self.local)

    def read_record(self, index: int, max_length: int) -> tuple[int, bytes]:
        status, data = self.device.read(index & 0xFFFF)
        return status, data[:max_length]

    def advance(self, milliseconds: int) -> None:
        """Time is that of the CPU."""


@dataclass
class StatedRun:
    """One run of a job: what it is to do (``course``), what happens before it starts, and how it ended.

    ``hears`` follows the conversation instead of the course.
    """

    job: StatedJob
    course: StatedCourse | None = None
    prepare: Callable[[], None] = lambda: None
    hears: Callable[[HeardTelegram], Mapping[tuple[int, int, int], bytes]] | None = None
    due: Callable[[], int] = lambda: 0
    """When it may start."""
    idle: Callable[[], int] = lambda: 0
    """Length of a scan while nothing is heard; 0: as the intervals of the job ask for."""
    pace: Callable[[], int] = lambda: 0
    """Length of the next scan if times are measured to the millisecond; 0: that does not matter."""
    delay: Callable[[str], int | None] = lambda _kind: None
    """How many ms a record job takes; None: one scan."""
    over: Callable[[], bool] | None = None
    """Whether it has run often enough; None: once."""
    status: int = -1
    flags: tuple[bool, bool, bool] = (False, False, False)
    """Whether it has been busy; done and error at the end."""
    busy: bool = False
    started: int = 0
    ended: int = 0
    heard: list[HeardTelegram] = field(default_factory=list)
    calls: list[tuple[int, str]] = field(default_factory=list)
    complaints: list[str] = field(default_factory=list)
    ends: Callable[[StatedRun], None] = lambda _run: None

    @property
    def took(self) -> int:
        """Time from the edge to the end in ms."""
        return self.ended - self.started


class StatedRig:
    """The program with its devices; jobs of one unit run one after the other, units at the same time.

    So do jobs with one recipe: they have their records from one data block.
    """

    def __init__(self, program: Program, statement: Statement, constants: Mapping[str, int], family: str) -> None:
        self.program, self.statement = program, statement
        self.line = RecordLine(self._stray)
        self.cpu = Cpu(program, self.line, family=family)  # type: ignore[arg-type]
        self.cpu.restart("cold")
        self.identifiers = {drive.key: identifier_of(drive, constants) for drive in statement.drives}
        self.units = {unit: RecordingDevice({}, lambda: self.cpu.clock) for unit in self._unit_names()}
        self.stray = RecordingDevice({}, lambda: self.cpu.clock)
        self.strays: list[int] = []
        self.going: dict[str, StatedRun] = {}
        self.line.delay = self._delay
        self.structures = dict(self._structures())
        self._connect()

    def _unit_names(self) -> Sequence[str]:
        return list(dict.fromkeys(self.unit_of(drive) for drive in self.statement.drives))

    @staticmethod
    def unit_of(drive: StatedDrive) -> str:
        """The device of a drive."""
        return drive.unit

    def _connect(self) -> None:
        for unit, device in self.units.items():
            own = [drive for drive in self.statement.drives if drive.unit == unit]
            objects = {self.identifiers[drive.key]: drive.drive_object for drive in own}
            for drive in own:
                device.by_size = drive.by_size
                number = self.identifiers[drive.key]
                self.line.drives[number] = _Port(device, number, objects, drive.local)
        for job in self.statement.jobs:
            for step in job.steps:
                for access in step.accesses:
                    type_ = ANSWERS[access.number % len(ANSWERS)] if access.type == ANY else access.type
                    self.units[job.drive.unit].types[job.drive.drive_object, access.number] = type_

    def _stray(self, identifier: int) -> RecordServer:
        self.strays.append(identifier)
        return _Port(self.stray, identifier, {}, local=False)

    def answered_type(self, job: StatedJob, access: StatedAccess) -> str:
        """What the device answers, which says the size alone if it answers so."""
        device = self.units[job.drive.unit]
        type_ = device.types[job.drive.drive_object, access.number]
        code = SUBSTITUTES.get(size_of(type_)) if device.by_size else None
        return next((name for name, (known, _) in TYPES.items() if known == code), type_)

    # --- where a job is commanded ---------------------------------------------------------------------

    def _structures(self) -> Iterator[tuple[str, tuple[str, Layout]]]:
        """Structures of all DriveJobs by their names in upper case: data block and its layout."""
        for entry in self.program.link.blocks.values():
            if entry.block.kind is BlockKind.DB and re.fullmatch(self.statement.prefix + CONTROL, entry.name):
                layout = layout_of(self.program, entry.name)
                for child in layout.shape.fields:
                    yield child.member.name.upper(), (entry.name, layout)

    def record_path(self, recipe: str, number: int, member: str) -> str:
        """A member of a record: the data block is named after the recipe."""
        name = "".join(part[:1].upper() + part[1:] for part in re.split(r"[_\W]+", recipe) if part)
        return f'"{self.statement.prefix}Recipe{name}".records[{number}].{member}'

    def member(self, job: StatedJob) -> str | None:
        """Path of the structure of a job; None if there is none. The tags of its flags are called ``..Execute``."""
        around = len(f"{self.statement.prefix}Execute") if job.signals else 0
        for name in (job.member, *(shorten(job.member, limit - around) for limit in (TIA_LIMIT, V5_LIMIT))):
            found = self.structures.get(name.upper())
            if found is not None:
                return f'"{found[0]}".{name}'
        return None

    def path(self, job: StatedJob, signal: str) -> str:
        """Where OB1 takes or leaves a signal of a job. Raises KeyError."""
        for name, address in job.signals:
            if name == signal:
                return address
        return f"{self.member(job)}.{signal}"

    def signal(self, job: StatedJob, name: str) -> int:
        """A bit, or the status word."""
        value: Any = self.cpu[self.path(job, name)]
        return int(value)

    # --- running --------------------------------------------------------------------------------------

    def run(self, runs: Sequence[StatedRun], units: int | None = None) -> None:
        """All runs: those of one unit one after the other, so many ``units`` at the same time."""
        waiting: dict[str, list[StatedRun]] = {}
        for run in runs:
            waiting.setdefault(run.job.drive.unit, []).append(run)
        heard = self.cpu.clock
        while waiting or self.going:
            heard = self._begin_due(waiting, units) or heard
            self.cpu.scan(self._length(waiting, heard))
            if any(d.calls and d.calls[-1][0] >= self.cpu.clock - SCAN for d in self.units.values()):
                heard = self.cpu.clock
            while over := [unit for unit, run in self.going.items() if self.ended(run)]:
                for unit in over:
                    self.finish(self.going.pop(unit))
                self.cpu.scan(SCAN)
                heard = self.cpu.clock

    def _begin_due(self, waiting: dict[str, list[StatedRun]], units: int | None) -> int:
        """Start the next run of every unit that is free; when the last one was started."""
        begun = 0
        for unit in [unit for unit in waiting if unit not in self.going]:
            if waiting[unit][0].due() > self.cpu.clock or (units is not None and len(self.going) >= units):
                continue
            if waiting[unit][0].job.recipe in {run.job.recipe for run in self.going.values()} - {""}:
                continue  # its records would change under the other job
            self.going[unit] = waiting[unit].pop(0)
            if not waiting[unit]:
                del waiting[unit]
            self.begin(self.going[unit])
            begun = self.cpu.clock
        return begun

    def _length(self, waiting: Mapping[str, Sequence[StatedRun]], heard: int) -> int:
        """Of the next scan: long while nothing is heard, and no run is due."""
        paces = [pace for run in self.going.values() if (pace := run.pace())]
        if paces:
            return min(paces)
        if self.cpu.clock - heard <= QUIET:
            return SCAN
        idle = [run.idle() or idle_scan(run.job) for run in self.going.values()]
        due = [own[0].due() for unit, own in waiting.items() if unit not in self.going]
        left = [at - self.cpu.clock for at in due if at > self.cpu.clock]  # the others wait for a place among the units
        return max(1, min([LONGEST_SCAN, *idle, *left]))

    def _delay(self, identifier: int, kind: str) -> int | None:
        for run in self.going.values():
            if self.identifiers[run.job.drive.key] == identifier:
                return run.delay(kind)
        return None

    def restart(self) -> None:
        """As after a download: everything has its start values, but nothing runs by itself."""
        self.cpu.restart("cold")
        for job in self.statement.jobs:
            if job.cycle_ms:
                self.cpu[self.path(job, "execute")] = False
        self.cpu.misuses.clear()
        self.strays.clear()
        for device in self.units.values():
            device.reset()

    def begin(self, run: StatedRun) -> None:
        """The edge of one job."""
        device = self.units[run.job.drive.unit]
        device.reset()
        run.prepare()
        hears = run.hears or (run.course.hear if run.course is not None else None)
        device.hears = hears
        run.started = self.cpu.clock
        self.cpu[self.path(run.job, "execute")] = True

    def ended(self, run: StatedRun) -> bool:
        """Whether a job has ended, or hangs: then it is over too, with its status."""
        done, error, busy = (self.signal(run.job, name) for name in ("done", "error", "busy"))
        run.busy = run.busy or bool(busy)
        late = self.cpu.clock - run.started > patience(run.job)
        return bool(done or error or late) if run.over is None else run.over()

    def finish(self, run: StatedRun) -> None:
        """Keep what came of a run; the command falls."""
        device = self.units[run.job.drive.unit]
        run.status, run.ended = self.signal(run.job, "status"), self.cpu.clock
        run.flags = run.busy, bool(self.signal(run.job, "done")), bool(self.signal(run.job, "error"))
        run.heard, run.complaints, run.calls = device.heard, device.complaints, device.calls
        run.ends(run)
        self.cpu[self.path(run.job, "execute")] = False
        device.reset()

    def missing(self, run: StatedRun) -> list[Difference]:
        """What the conversation of a run was not."""
        found: list[Difference] = []
        if run.course is not None:
            run.course.missing()
            found += run.course.differences
        found += [Difference(run.job.place, "a parameter request", text) for text in run.complaints]
        if found and self.strays:
            asked = ", ".join(map(str, dict.fromkeys(self.strays)))
            found.append(Difference(run.job.drive.place, "identifiers of the spec", f"requests to identifier {asked}"))
        return found


def idle_scan(job: StatedJob) -> int:
    """Length of a scan while nothing is heard, fine enough to measure the intervals of a job."""
    shortest = min((step.interval_ms for step in job.steps if step.until), default=IDLE_SCAN * FINE)
    return max(SCAN, min(IDLE_SCAN, shortest // FINE))


def patience(job: StatedJob) -> int:
    """The longest time that a job may take by its own times."""
    steps = sum(step.limit_ms + step.interval_ms + job.timeout_ms for step in job.steps)
    return steps + job.timeout_ms + SPARE_MS


def identifier_of(drive: StatedDrive, constants: Mapping[str, int]) -> int:
    """What stands in the ID: the number, or that of the system constant; bit 15 for an address of outputs."""
    number = drive.identifier if isinstance(drive.identifier, int) else constants[drive.identifier]
    return number | OUTPUTS_ONLY if drive.output else number
