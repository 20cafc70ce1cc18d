"""Preemption: one OB runs into another, at points that a test chooses and can count.

A block that runs with a plan is compiled a second time, with points: before every statement and condition, before every
further read of a variable that others can write, between the evaluation of a value and its store, between the inputs of
a system block and its execution, between the end of a call and its outputs, and in the middle of every copy of a
structure. A CPU may be interrupted between any two instructions. Here at most one variable that others can write is
read or written between two points; statics of the own instance and local data count as private when they are read.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field

from plcgen.s7.cpu.linkage import Probe

NOT_DELAYED = 0x8080 - 0x10000
"""RET_VAL of EN_AIRT without a DIS_AIRT before it (System and Standard Functions, SFC42)."""


@dataclass(frozen=True, slots=True)
class Point:
    """A place in a running block where another one may run.

    ``number`` counts from 0 in each run of an OB, ``depth`` is 0 in the block that was started and 1 in what interrupts
    it; ``kind`` is statement, condition, read, store, call, output or copy.
    """

    number: int
    depth: int
    kind: str
    file: str
    line: int


@dataclass(frozen=True, slots=True)
class Interrupt:
    """An OB that interrupts, or an instance data block whose FB is called; ``plan`` is what interrupts it in turn."""

    block: str
    plan: Plan | None = None


Chosen = str | Interrupt
Plan = Mapping[int, Chosen] | Callable[[Point], Chosen | None]
"""What interrupts where: blocks by number of the point, or a function that is asked at every point of every depth."""


@dataclass(slots=True)
class Passage:
    """What a block did: the points it went through, itself and not what interrupted it."""

    points: list[Point] = field(default_factory=list)
    interrupts: list[Point] = field(default_factory=list)
    """Where an interrupt came, also those that DIS_AIRT delayed."""

    @property
    def statements(self) -> int:
        """Statements that were executed, those of called blocks included."""
        return sum(point.kind == "statement" for point in self.points)


@dataclass(slots=True)
class _Level:
    """An OB that runs."""

    plan: Plan
    depth: int
    run: Passage


class Preemption:
    """The interrupts of one CPU; ``start`` runs a block by its name, ``eno`` is the cell of ENO."""

    def __init__(self, places: Sequence[Probe], start: Callable[[str], None], eno: list[bool]) -> None:
        self.places = places
        self.start = start
        self.eno = eno
        self.levels: list[_Level] = []
        self.delays = 0
        self.pending: list[Interrupt] = []

    def run(self, name: str, plan: Plan) -> Passage:
        """Run a block with a plan; what its end no longer delays runs behind it."""
        with self.level(plan) as level:
            self.start(name)
        self.release()
        return level.run

    @contextmanager
    def level(self, plan: Plan) -> Iterator[_Level]:
        """An OB begins and ends: its delays end with it (help of DIS_AIRT)."""
        level = _Level(plan, len(self.levels), Passage())
        self.levels.append(level)
        eno = self.eno[0]
        try:
            yield level
        finally:
            self.levels.pop()
            self.eno[0] = eno
            self.delays = 0

    def point(self, site: int) -> None:
        """A point of the running block: generated code comes here."""
        level, place = self.levels[-1], self.places[site]
        point = Point(len(level.run.points), level.depth, place.kind, place.file, place.line)
        level.run.points.append(point)
        plan = level.plan
        chosen = plan(point) if callable(plan) else plan.get(point.number)
        if chosen is None:
            return
        level.run.interrupts.append(point)
        inherited: Plan = plan if callable(plan) else {}
        interrupt = Interrupt(chosen, inherited) if isinstance(chosen, str) else chosen
        if interrupt.plan is None:
            interrupt = Interrupt(interrupt.block, inherited)
        self.pending.append(interrupt)
        if not self.delays:
            self.release()

    def release(self) -> None:
        """Run what waits, in the order in which it came."""
        while self.pending and not self.delays:
            interrupt = self.pending.pop(0)
            with self.level(interrupt.plan or {}):
                self.start(interrupt.block)

    def delay(self) -> int:
        """DIS_AIRT: interrupts of higher priority wait; the number of delays."""
        self.delays += 1
        return self.delays

    def enable(self) -> int:
        """EN_AIRT: the number of delays that are left; what waited runs at 0."""
        if not self.delays:
            return NOT_DELAYED
        self.delays -= 1
        self.release()
        return self.delays
