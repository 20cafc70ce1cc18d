"""The CPU: memory, scan cycle on a virtual clock, start-up, access to symbols, misuse."""

from __future__ import annotations

import math
import struct
import sys
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from functools import partial
from types import FrameType, TracebackType
from typing import Any, Literal

from plcgen.base.diagnostics import DiagnosticError, PlcgenError
from plcgen.s7.cpu import arithmetic
from plcgen.s7.cpu.kinds import Kind, element_at, kind_at, typed
from plcgen.s7.cpu.linkage import Compiled, Probe, ProgramBlock, Table
from plcgen.s7.cpu.memory import Memory, codec_functions
from plcgen.s7.cpu.outside import Symbols, call_function, stand_in
from plcgen.s7.cpu.preemption import Passage, Plan, Preemption
from plcgen.s7.cpu.program import Program
from plcgen.s7.cpu.start_values import restart_block
from plcgen.s7.cpu.system import moments
from plcgen.s7.cpu.system.clock import SystemClock
from plcgen.s7.cpu.system.interfaces import TIMERS, SystemFb
from plcgen.s7.cpu.system.library import ROWS, Hooks
from plcgen.s7.cpu.system.moves import AccessFaultError, MemoryMoves
from plcgen.s7.cpu.system.point_to_point import PORT_BLOCKS, PortBlock
from plcgen.s7.cpu.system.port import Periphery
from plcgen.s7.cpu.system.record import PLACES, RecordBlock, RecordJobs, RecordPlaces
from plcgen.s7.cpu.system.timers import Cells, control, counter, edge, query, timer
from plcgen.s7.layout.image import Tree
from plcgen.s7.layout.layout import layout_block
from plcgen.s7.types.blocks import Block, BlockKind
from plcgen.s7.types.data_types import UnknownPathError
from plcgen.s7.types.system import CONTROL, Family

AREA_SIZE = 65536
LOOP_LIMIT = 1_000_000
MAX_MISUSES = 1000


class StoppedError(PlcgenError):
    """STP was executed: nothing runs until a restart."""


@dataclass(frozen=True, slots=True)
class Misuse:
    """Something a CPU would not forgive: code, message and the SCL statement that did it."""

    code: str
    message: str
    file: str
    line: int

    def __str__(self) -> str:
        return f"{self.file}:{self.line}: {self.code} {self.message}"


class Cpu:
    """One CPU with a program.

    ``family`` decides how many record jobs run at once (``job_limit`` overrides it, a number counts each of WRREC and
    RDREC); ``loop_limit`` is how many passes of loops and calls of blocks one scan may take. ``misuses`` collects what
    went wrong, ``clock`` is in ms.
    """

    def __init__(
        self,
        program: Program,
        bus: Periphery | None = None,
        *,
        family: Family | None = None,
        job_limit: int | RecordPlaces | None = None,
        loop_limit: int = LOOP_LIMIT,
    ) -> None:
        if not program.ok:
            raise DiagnosticError(program.diagnostics)
        self.program = program
        self.bus = bus if bus is not None else Periphery()
        default: Family = "s7-300" if program.link.classic else "s7-1500"
        self.family: Family = family or default
        self.misuses: list[Misuse] = []
        self.watchers: list[Callable[[], None]] = []
        """Called before every scan: with what the one before it has left."""
        self.scans = 0
        self.faulted = False
        self.stopped = False
        self.time = SystemClock()
        self._clock = self.time.cell
        self.cells = Cells(self._clock)
        places = RecordPlaces(each=job_limit) if isinstance(job_limit, int) else job_limit or PLACES[self.family]
        self._eno = [True]
        self.records = RecordJobs(self.bus, self._clock, self._eno, places, idle_needs_place=self.family == "s7-1500")
        self._passes = [0, loop_limit]
        self.counters = [0] * len(program.probes)
        self._decisions: list[Table] = []
        self._kinds: list[Kind] = []
        self._compiled: dict[str, Compiled] = {}
        self._callables: dict[str, tuple[ProgramBlock, tuple[Any, ...]]] = {}
        self.areas = {area: Memory(AREA_SIZE, area) for area in "IQMP"}
        self.blocks: dict[int, Memory] = {}
        self._numbers: dict[int, Memory] = {}
        self._moves = MemoryMoves(self._locate, self._report)
        self._records: list[RecordBlock | PortBlock] = []
        for entry in self.program.link.blocks.values():
            content = self.program.images.get(entry.index)
            if content is not None and entry.block.kind is BlockKind.DB:
                optimized = self.program.link.optimized(entry)
                memory = Memory(content, "DB", entry.number or 0, entry.name, optimized=optimized)
                self.blocks[entry.index] = memory
                if entry.number:
                    self._numbers[entry.number] = memory
        free = 60000
        for memory in self.blocks.values():
            if not memory.number:
                memory.number = free
                self._numbers[free] = memory
                free += 1
        self.symbols = Symbols(program.link, self.blocks, self.areas)
        self.preemption = Preemption(program.link.points, self._start, self._eno)
        self._names = self._namespace()
        self._load(program.compiled)
        self._main = program.main()
        self._start_up = program.start_up()
        self._started = False

    # --- building -------------------------------------------------------------------------------------

    def _namespace(self) -> dict[str, Any]:
        names: dict[str, Any] = {"__builtins__": {}, "inf": math.inf, "nan": math.nan}
        for name in (abs, min, max, int, float, ord, chr, round):
            names[name.__name__] = name
        names |= codec_functions() | arithmetic.functions() | self._moves.functions()
        names |= {"moment": moments.convert, "ns": moments.to_ns, "add_ns": moments.add, "sub_ns": moments.subtract}
        names |= {"typed": typed, "element_at": element_at, "kind_at": kind_at, "K": self._kinds}
        cpu_parts = {"cells": self.cells, "time": self.time, "hooks": Hooks(self._type_of, self._stop)}
        for key, row in ROWS.items():
            names[f"L_{key}"] = partial(row.function, cpu_parts[row.of]) if row.of else row.function
        names |= self.areas
        names |= {f"d{index}": memory for index, memory in self.blocks.items()}
        names |= {
            "T": self._clock,
            "ob_info": self.time.start_information,
            "W": self._passes,
            "E": self._eno,
            "G": [False],
            "H": self.counters,
            "D": self._decisions,
        }
        names |= {"Z": self.preemption.point, "dis_airt": self.preemption.delay, "en_airt": self.preemption.enable}
        names |= {"unsupported": _unsupported, "ix": _bad_index, "ck": _address, "late": self._late}
        names |= {"w_bit": _write_bit, "st": self._status_read}
        names |= arithmetic.Division(self._report).functions()
        for system in {id(system): system for system in self.program.systems.values()}.values():
            names[f"S_{system.block.name}"] = self._runner(system)
            if system.block.name in {"TONR_TIME", "TONR_LTIME"}:
                shape = layout_block(system.block, {}).shape
                names[f"query{shape.index['ET'].shape.bits}"] = query(shape, self._clock)
        return names

    def _load(self, blocks: Iterable[Compiled]) -> None:
        """Make the functions of compiled blocks, with the tables of their conditions."""
        self._kinds[:] = self.program.link.kinds
        decisions = self.program.link.decisions[len(self._decisions) :]
        self._decisions += (Table(decision, self.counters) for decision in decisions)
        for compiled in blocks:
            if compiled.code is not None:
                exec(compiled.code, self._names)  # noqa: S102 - code of our own compiler
                self._compiled[compiled.function] = compiled
            answer = self.program.answers.get(compiled.name.upper())
            if answer is not None:
                entry = self.program.link.blocks[compiled.name.upper()]
                self._names[compiled.function] = stand_in(entry, self.program.link, answer)

    def _runner(self, system: SystemFb) -> Callable[..., None]:
        types: dict[str, Block] = {}
        shape = layout_block(system.block, types).shape
        if system.record:
            block = RecordBlock(system, shape, self.records, self._report)
            self._records.append(block)
            return block
        if system.kind in PORT_BLOCKS:
            serial = PORT_BLOCKS[system.kind](system, shape, self.bus, self._report, self._locate)
            self._records.append(serial)
            return serial
        if system.kind in TIMERS:
            return timer(system.kind, shape, self._clock)
        if system.kind in CONTROL:
            return control(system.kind, shape, self._clock)
        return edge(system, shape) if system.kind.endswith("_TRIG") else counter(system, shape)

    def _locate(self, area: str, number: int) -> Memory | None:
        return self._numbers.get(number) if area == "DB" else self.areas.get(area)

    # --- the cycle ------------------------------------------------------------------------------------

    @property
    def clock(self) -> int:
        """Milliseconds since the CPU was switched on. Set back, it is TIME_TCK too, as after a restart."""
        return self._clock[0]

    @clock.setter
    def clock(self, milliseconds: int) -> None:
        if milliseconds < self._clock[0]:
            self._clock[1] = 0
        self._clock[0] = milliseconds

    def scan(self, milliseconds: int = 10, count: int = 1, blocks: Sequence[str] = ()) -> None:
        """Run scans of a length each: time passes, then the cyclic OB runs once, or some ``blocks`` instead."""
        if not self._started:
            self.restart("cold")
        called = [self._callable(name) for name in blocks or ([self._main.name] if self._main is not None else ())]
        for _ in range(count):
            self._next(milliseconds)
            self.faulted = False
            for block, arguments in called:
                if self._run(block, arguments):
                    break

    def call(self, name: str, /, milliseconds: int = 0, **inputs: Any) -> dict[str, Any]:
        """Call one instance data block, OB or FC as one scan; inputs are set before.

        Of an FC, its outputs, in-outs and its value are returned by name. Raises ValueError for an input that it does
        not have.
        """
        block, arguments = self._callable(name)
        if not self._started:
            self.restart("cold")
        self._next(milliseconds)
        if block.block.kind is BlockKind.FC:
            return call_function(block, self.program.link, lambda found: self._returned(block, tuple(found)), inputs)
        for member, value in inputs.items():
            self[f'"{name}".{member}'] = value
        self._run(block, arguments)
        return {}

    def run(self, name: str, milliseconds: int = 0, interrupt: Plan | None = None) -> Passage:
        """Run an OB, or what ``call`` takes, as one scan, and let other blocks interrupt it by a plan.

        An empty plan counts: the result has the points and statements that were passed. Without a plan nothing is
        counted and it is ``call``. Raises KeyError for an unknown block.
        """
        if interrupt is None:
            self.call(name, milliseconds)
            return Passage()
        self._callable(name)
        if not self.program.interruptible or self.program.interruptible[0].function not in self._compiled:
            self._load(self.program.preemptive())
        if not self._started:
            self.restart("cold")
        self._next(milliseconds)
        self.faulted = False
        return self.preemption.run(name, interrupt)

    def _start(self, name: str) -> None:
        """Run a block that can be interrupted; one that interrupts it does not hide its fault."""
        faulted = self.faulted
        self._run(*self._callable(name), "p")
        self.faulted |= faulted

    def _callable(self, name: str) -> tuple[ProgramBlock, tuple[Any, ...]]:
        """Block and arguments behind the name of an instance data block, OB or FC."""
        if name not in self._callables:
            self._callables[name] = self._find_callable(name)
        return self._callables[name]

    def _find_callable(self, name: str) -> tuple[ProgramBlock, tuple[Any, ...]]:
        entry = self.program.link.find(name)
        if entry is None:
            raise UnknownPathError(f"there is no block {name}")
        if entry.block.kind is not BlockKind.DB:
            return entry, ()
        block = self.program.link.find(self.program.link.instance_type(entry) or "?")
        if block is None:
            raise UnknownPathError(f"{name} is not an instance of a block of the program")
        return block, (self.blocks[entry.index],)

    def _next(self, milliseconds: int) -> None:
        for watcher in self.watchers:
            watcher()
        self.scans += 1
        self.time.pass_time(milliseconds)
        if milliseconds:
            self.bus.advance(milliseconds)
        if self.records.jobs or self.records.orphans:
            self.records.advance()
        self._passes[0] = self.preemption.delays = self._moves.moved = 0
        for block in self._records:
            block.scan = self.scans

    def _run(self, entry: ProgramBlock, arguments: tuple[Any, ...], form: str = "b") -> bool:
        """Run one block; an access fault ends it, is kept as a misuse, and returned."""
        self._returned(entry, arguments, form)
        return self.faulted

    def _returned(self, entry: ProgramBlock, arguments: tuple[Any, ...], form: str = "b") -> Any:
        """Run one block for what it returns; None behind a fault."""
        self.faulted = False
        if self.stopped:
            return None
        function = self._names[f"{form}{entry.index}"]
        try:
            return function(*arguments)
        except StoppedError:
            pass
        except AccessFaultError as fault:
            self._keep(fault.code, str(fault), fault.__traceback__)
        except (IndexError, struct.error) as fault:
            self._keep("PG834", "the access is beyond the end of its data block", fault.__traceback__)
        except RecursionError as fault:
            self._keep("PG826", "the calls are nested too deeply", fault.__traceback__)
        return None

    def restart(self, kind: Literal["cold", "warm"] = "warm", *, keep_ticks: bool = False) -> None:
        """Start again: record jobs are dropped, TIME_TCK begins at 0, the start-up OB runs once.

        A cold restart resets every data block to its start values, a warm one only what is not retentive: in STEP 7 V5
        all values stay. Inputs, outputs and flags are cleared. ``keep_ticks`` lets TIME_TCK go on, as only the restart
        of an S7-400 does that is neither cold nor warm.
        """
        self.time.restart(cold=kind == "cold", keep_ticks=keep_ticks or not self._started)
        self._started = True
        self.stopped = False
        for entry in self.program.link.blocks.values():
            memory = self.blocks.get(entry.index)
            if memory is not None and kind == "cold":
                memory[:] = self.program.images[entry.index]
            elif memory is not None:
                restart_block(memory, self.program.images[entry.index], entry, self.program.link)
        for memory in self.areas.values():
            memory[:] = bytes(AREA_SIZE)
        self.cells.timers.clear()
        self.cells.counters.clear()
        self.drop_records()
        if self._start_up is not None:
            self._passes[0] = self._moves.moved = 0
            self._run(self._start_up, ())

    def download(self, *names: str) -> None:
        """Load data blocks again, all at once: start values; record jobs of instances in them go on without them."""
        blocks = [self.db(name) for name in names]
        entries = [self.program.link.find(name) for name in names]
        for memory, entry in zip(blocks, entries, strict=True):
            if entry is not None:
                memory[:] = self.program.images[entry.index]
                self.records.abandon(memory)

    def drop_records(self) -> None:
        """Forget the record jobs that run, as after a failure of the bus: their blocks are neither busy nor done."""
        self.records.drop()
        for block in self._records:
            if isinstance(block, PortBlock):
                block.drop()

    # --- access ---------------------------------------------------------------------------------------

    def __getitem__(self, path: str) -> Tree:
        return self.symbols.read(path)

    def __setitem__(self, path: str, value: Any) -> None:
        if not self._started:
            self.restart("cold")
        self.symbols.write(path, value)

    def function(self, name: str) -> Callable[..., Any]:
        """The Python function of a block: an FB takes the bytes of its instance. Raises KeyError."""
        entry = self.program.link.find(name)
        if entry is None or f"b{entry.index}" not in self._names:
            raise UnknownPathError(f"there is no code block {name}")
        function: Callable[..., Any] = self._names[f"b{entry.index}"]
        return function

    def db(self, which: int | str) -> Memory:
        """Bytes of a data block by number or name. Raises KeyError if there is none."""
        if isinstance(which, int):
            return self._numbers[which]
        entry = self.program.link.find(which)
        if entry is None or entry.index not in self.blocks:
            raise UnknownPathError(f"there is no data block {which}")
        return self.blocks[entry.index]

    @property
    def jobs(self) -> int:
        """Record jobs whose end no call has reported yet, and transfers through serial ports."""
        transfers = sum(len(block.jobs) for block in self._records if isinstance(block, PortBlock))
        return transfers + len(self.records.jobs)

    @property
    def coverage(self) -> list[int]:
        """How often each place of the program was passed, in the order of its probes."""
        return self.program.passed(self.counters)

    def forget_coverage(self) -> None:
        """Count from 0 again."""
        self.counters[:] = bytes(len(self.counters))
        for table in self._decisions:
            table.clear()

    def uncovered(self) -> list[Probe]:
        """Statements and branches that never ran, operands that never decided; empty without coverage."""
        return [probe for probe, count in zip(self.program.probes, self.coverage, strict=True) if not count]

    # --- misuse ---------------------------------------------------------------------------------------

    def _report(self, code: str, message: str) -> None:
        """Keep a misuse at the statement that runs now."""
        self._add(code, message, self._place(sys._getframe(1)))  # noqa: SLF001 - the statement is found by its frame

    def _keep(self, code: str, message: str, traceback: TracebackType | None) -> None:
        place = ("", 0)
        while traceback is not None:
            found = self._line(traceback.tb_frame.f_code.co_name, traceback.tb_lineno, traceback.tb_frame)
            place = found or place
            traceback = traceback.tb_next
        self.faulted = True
        self._add(code, message, place)

    def _place(self, frame: FrameType | None) -> tuple[str, int]:
        while frame is not None:
            found = self._line(frame.f_code.co_name, frame.f_lineno, frame)
            if found is not None:
                return found
            frame = frame.f_back
        return "", 0

    def _line(self, function: str, line: int, frame: FrameType) -> tuple[str, int] | None:
        compiled = self._compiled.get(function)
        if compiled is None or frame.f_globals is not self._names:
            return None
        return compiled.file, compiled.lines[line - 1]

    def _add(self, code: str, message: str, place: tuple[str, int]) -> None:
        misuse = Misuse(code, message, *place)
        if len(self.misuses) < MAX_MISUSES and misuse not in self.misuses:
            self.misuses.append(misuse)

    def _type_of(self, number: int) -> str:
        """Name of the type that a data block is an instance of, in upper case; empty for any other (TypeOfDB)."""
        memory = self._numbers.get(number)
        entry = self.program.link.find(memory.name) if memory is not None else None
        return self.program.link.instance_type(entry) if entry is not None else ""

    def _stop(self) -> None:
        self.stopped = True
        raise StoppedError

    def _late(self) -> None:
        raise AccessFaultError("PG835", f"one scan took more than {self._passes[1]} passes of loops and calls")

    def _status_read(self, memory: Memory, offset: int) -> None:
        for block in self._records:
            block.watch(memory, offset)


def _bad_index(value: int, low: int, high: int) -> int:
    raise AccessFaultError("PG834", f"index {value} is outside {low}..{high}")


def _unsupported(what: str) -> None:
    raise AccessFaultError("PG827", what)


def _address(value: int, last: int) -> int:
    """Computed address; AccessFaultError outside 0 to ``last``."""
    if 0 <= value <= last:
        return value
    raise AccessFaultError("PG834", f"address {value} is outside 0..{last}")


def _write_bit(memory: bytearray, base: int, bit: int, value: object) -> None:
    at, mask = base + (bit >> 3), 1 << (bit & 7)
    memory[at] = memory[at] | mask if value else memory[at] & 255 - mask
