"""The callers: function blocks that call the gate, every job and every channel, a line of the OB for each."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

from plcgen.build import control
from plcgen.build.nouns import Command, FunctionBlock
from plcgen.build.simaticml import RECORD_NOTE
from plcgen.ds47.plan.nouns import DriveCaller, DriveJob, DrivePlan, PlannedUnit
from plcgen.ds47.views.engine import engine_names
from plcgen.ds47.views.parts import parts_of
from plcgen.ds47.words import RECORD_JOBS

GATE_MEMBER = "driveGate"
RECORD_INDEX, WAIT_LIMIT = 47, 60_000
"""Start values of the inputs of a channel, as its template has them."""
TITLES = ("Calls of all drive jobs", "Calls of drive jobs, part {number}")
CONTROL_TITLES = ("Commands and results of all drive jobs", "Commands and results of drive jobs, part {number}")
"""Titles of what is alone, and of what is one of several."""


def part(plan: DrivePlan, caller: DriveCaller, titles: tuple[str, str]) -> str:
    """The title of something of a caller."""
    return titles[len(plan.callers) > 1].format(number=caller.number)


def calls(plan: DrivePlan, caller: DriveCaller, commands: Sequence[tuple[DriveJob, Command]]) -> FunctionBlock:
    """A caller with its instance DB."""
    title = part(plan, caller, TITLES)
    places = {unit.key: number for number, unit in enumerate(plan.units, 1)}  # of its channel in the gate
    view = {
        "names": engine_names(plan),
        "v5": plan.target.v5,
        "title": title,
        "block": caller.block,
        "first": caller.number == 1,
        "channels": len(plan.units),
        "places": RECORD_JOBS[plan.target.family],
        "gate": f'"{plan.engine.gate_db.name}".gate',
        "gate_member": GATE_MEMBER,
        "units": [_unit(plan, unit, places[unit.key]) for unit in plan.channels(caller)],
        "jobs": [_job(plan, job, command) for job, command in commands],
    }
    return FunctionBlock(caller.block, caller.instance, title, "ds47/calls.scl.j2", view, RECORD_NOTE, (), (), ())


def _unit(plan: DrivePlan, unit: PlannedUnit, place: int) -> dict[str, Any]:
    """A channel; ``index`` and ``wait`` are empty if they are what the channel has of itself."""
    index = unit.record_index if plan.target.t15 or unit.record_index <= 0x7FFF else unit.record_index - 0x10000
    return {
        "member": unit.member,
        "db": unit.db.name,
        "slots": plan.slots(unit),
        "number": place,
        "wait": "" if unit.wait == WAIT_LIMIT else str(unit.wait),
        "index": "" if unit.record_index == RECORD_INDEX else str(index),
        "key": unit.key,
    }


def _job(plan: DrivePlan, job: DriveJob, command: Command) -> dict[str, Any]:
    drive = job.drive
    where = [("slot", str(job.slot)), ("unit", f'"{drive.unit.db.name}".unit')]
    if plan.target.t15:
        identifier = ("hardwareId", f'"{drive.id_name}"' if drive.id_name else str(drive.id_value))
    else:
        identifier = ("driveAddress", f"DW#16#{drive.id_value:08X}")
    own = [identifier, ("driveObject", f"B#16#{drive.drive_object:02X}"), *where]
    if job.pinned:
        telegram = job.telegrams[0]
        own[2:2] = [
            ("requestDb", f'"{telegram.request.home.name}"'),
            ("responseDb", f'"{telegram.response.home.name}"'),
        ]
    own += [argument for part in parts_of(job) for argument in part.arguments(job)]
    execute, *results = [signal.name for signal in command.signals]
    tia = not plan.target.v5

    def places(names: Iterable[str]) -> list[tuple[str, str]]:
        return [(name, control.signal_operand(command, name)) for name in names]

    inputs, outputs = places(v.member.name for v in command.inputs), places(v.member.name for v in command.outputs)
    shared = places(v.member.name for v in command.shared)
    return {
        "member": job.member,
        "block": job.block.name,
        "drive": drive.key,
        "given": _lines([places([execute]) + own + shared, inputs], ", ", ",\n  ", ",\n  " if tia else ""),
        "returned": _lines([places(results), outputs], *((", ", ",\n  ", "") if tia else (" ", "\n", "\n"))),
    }


def _lines(lines: list[list[tuple[str, str]]], between: str, line_end: str, end: str) -> list[tuple[str, str, str]]:
    """Name and place of every argument, a list for each line, and what is written behind it."""
    found = [(*row, line_end if row is line[-1] else between) for line in lines for row in line]
    return [*found[:-1], (*found[-1][:2], end)]
