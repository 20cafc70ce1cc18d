"""Preemption: gate, channel and jobs in OB1, OB35 and OB82, interrupted at every point of a scan."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial

from plcgen.ds47.proof.words import DONE, WORDS
from plcgen.proof.scenario import ScenarioError
from plcgen.s7.cpu.preemption import Chosen, Interrupt, Point
from tests.engine.errands import READ_ONE, READ_SPLIT, TRIGGER, WRITE_ONE, WRITE_SPLIT
from tests.engine.field import JobField
from tests.engine.mailboxes import three

Run = Callable[[JobField], None]
LEVELS: tuple[tuple[tuple[int, ...], tuple[int, ...], tuple[int, ...]], ...] = (
    # OB1, OB35, OB82: gate 1, channel 2, jobs 5, 6, 7
    ((1, 2, 6), (5,), (7,)),
    ((1, 2), (5, 6), (7,)),
    ((2, 5), (1, 6), (7,)),
    ((5, 6), (1, 2), (7,)),
    ((5, 6), (2,), (1, 7)),
    ((5,), (6,), (1, 2, 7)),
    ((1, 5), (6,), (2, 7)),
    ((5,), (1, 6), (2, 7)),
    ((5, 6, 7), (), (1, 2)),
    ((1, 2), (), (5, 6, 7)),
)
ONE_SLOT = (
    ((1, 2, 5), (6,), ()),
    ((5, 1, 2), (6,), ()),
    ((5,), (6, 1, 2), ()),
    ((5, 2), (1, 6), ()),
    ((5,), (6,), (1, 2)),
)
"""Jobs 5 and 6 have the same slot."""
FEW = 40
"""Runs of a level unless every point is asked for: the points of a scan are met at different scans of each run."""


def interrupts(*, thorough: bool = False) -> Iterator[tuple[str, Run]]:
    """Names and procedures; ``thorough`` puts an interrupt at every point of every scan."""
    for levels in LEVELS:
        yield f"OB1 calls {levels[0]}, OB35 {levels[1]}, OB82 {levels[2]}", partial(_everywhere, levels, thorough)
    for levels in ONE_SLOT:
        yield f"one slot for two: OB1 calls {levels[0]}, OB35 {levels[1]}, OB82 {levels[2]}", partial(_one_slot, levels)


def _everywhere(levels: tuple[tuple[int, ...], ...], thorough: bool, field: JobField) -> None:
    """In every scan OB35 comes at one point of OB1, and OB82 at one of OB35 and one of OB1; the points wander."""
    three(field)
    field.give(2, WRITE_ONE, slot=3, drive_object=3)
    field.give(3, TRIGGER, slot=4, drive_object=4)
    field.rig.call(*levels)
    _all_levels(field)
    points = _points(field)
    step = 1 if thorough else max(1, points // FEW)
    for first in range(0, points, step):
        field.start(1, 2, 3)
        for scan in range(120):
            at = (first + scan * (1 if thorough else 7)) % points
            _scan(field, at, (at * 5 + scan) % 60, (at + points // 2 + scan) % points)
            if set(field.statuses(1, 2, 3).values()) == {DONE}:
                break
        field.expect(field.statuses(1, 2, 3), dict.fromkeys((1, 2, 3), (DONE,)))
        field.right(1, 2, 3)
        field.wire()
        for drive in field.rig.drives:
            writes = sum(exchange.direction == "write" for exchange in drive.journal)
            if writes not in {0, 4}:
                raise ScenarioError(f"{writes} requests for three jobs with four telegrams")
            drive.journal.clear()
        field.drop(1, 2, 3)
        for scan in range(8):
            _scan(field, (first + scan) % points, scan, (first + scan * 9) % points)
        _all_levels(field)


def _points(field: JobField) -> int:
    """Points of the longest scan of OB1 in an ordinary run; OB35 and OB82 come at its end."""
    most = 0
    field.start(1, 2, 3)
    for _ in range(60):
        field.rig.scans += 1
        passage = field.cpu.run("OB1", 10, {})
        most = max(most, len(passage.points))
        field.step(0, block="OB35")
        field.step(0, block="OB82")
    field.expect(field.statuses(1, 2, 3), dict.fromkeys((1, 2, 3), (DONE,)))
    for drive in field.rig.drives:
        drive.journal.clear()
    field.drop(1, 2, 3)
    _all_levels(field)
    return most


def _all_levels(field: JobField) -> None:
    """Every organization block a few times, one behind the other."""
    for _ in range(4):
        for block in ("OB1", "OB35", "OB82"):
            field.step(5, block=block)


def _scan(field: JobField, at: int, inner: int, second: int) -> None:
    """OB35 at one point, OB82 at one of it and at another one of OB1; what did not come comes after it."""
    came = {"OB35": False, "OB82": False}

    def chosen(point: Point) -> Chosen | None:
        if point.depth:
            return None
        if point.number == at:
            came["OB35"] = True
            return Interrupt("OB35", {inner: "OB82"})
        if point.number == second:
            came["OB82"] = True
            return "OB82"
        return None

    field.step(10, chosen)
    for block in [name for name, seen in came.items() if not seen]:
        field.step(0, block=block)


def _one_slot(levels: tuple[tuple[int, ...], ...], field: JobField) -> None:
    """The start of one job comes at every point of the scan in which the other starts: both hear it, none is served."""
    taken, blocks = (WORDS["SLOT_TAKEN"],), ("OB35", "OB82")
    for first, second in ((READ_SPLIT, WRITE_SPLIT), (WRITE_ONE, READ_ONE)):
        field.give(1, first, slot=2)
        field.give(2, second, slot=2, drive_object=3)
        field.rig.call(*levels)
        _all_levels(field)
        at, came = 0, True
        while came:
            field.start(1, 2)
            came = _come(field, at)
            for _ in range(20):
                field.step(10)
                for block in blocks:
                    field.step(0, block=block)
            field.expect(field.statuses(1, 2), {1: taken, 2: taken})
            field.wire()
            field.drop(1, 2)
            for _ in range(3):
                _all_levels(field)
            at += 1


def _come(field: JobField, at: int) -> bool:
    """OB35 comes at one point of OB1, else behind it; OB82 behind both. Whether the scan had that point."""
    came: list[Point] = []

    def chosen(point: Point) -> Chosen | None:
        if point.depth or point.number != at:
            return None
        came.append(point)
        return Interrupt("OB35", {})

    field.step(10, chosen)
    if not came:
        field.step(0, block="OB35")
    field.step(0, block="OB82")
    return bool(came)
