"""The caller: one function block that calls the gate, every channel and every job, so that the OB needs one line."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from plcgen.documents import control
from plcgen.documents.nouns import Command, FunctionBlock
from plcgen.documents.simaticml import RECORD_NOTE
from plcgen.protocols.ds47.plan.nouns import DriveJob, DrivePlan, PlannedUnit
from plcgen.protocols.ds47.views.engine import names
from plcgen.protocols.ds47.words import RECORD_JOBS

GATE_MEMBER = "driveGate"


def caller(plan: DrivePlan, commands: Sequence[tuple[DriveJob, Command]]) -> FunctionBlock:
    """The caller with its instance DB."""
    view = {
        "names": names(plan),
        "v5": plan.target.v5,
        "title": "Calls of all drive jobs",
        "block": plan.engine.calls,
        "places": RECORD_JOBS[plan.target.family],
        "gate": f'"{plan.engine.gate_db.name}".gate',
        "gate_member": GATE_MEMBER,
        "units": [_unit(plan, unit) for unit in plan.units],
        "jobs": [_job(plan, job, command) for job, command in commands],
    }
    engine = plan.engine
    title = "Calls of all drive jobs"
    return FunctionBlock(engine.calls, engine.calls_db, title, "ds47/calls.scl.j2", view, RECORD_NOTE, (), (), ())


def _unit(plan: DrivePlan, unit: PlannedUnit) -> dict[str, Any]:
    index = unit.record_index if unit.record_index <= 0x7FFF else unit.record_index - 0x10000
    return {
        "member": unit.member,
        "db": unit.db.name,
        "slots": plan.slots(unit),
        "number": unit.number,
        "wait": unit.wait,
        "index": unit.record_index if plan.target.t15 else index,
        "index_text": f"16#{unit.record_index:04X}",
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
    execute, *results = [signal.name for signal in command.signals]
    inputs = [(name, control.place(plan.control_db, command, name)) for name in (v.member.name for v in command.inputs)]
    outputs = [
        (name, control.place(plan.control_db, command, name)) for name in (v.member.name for v in command.outputs)
    ]
    return {
        "member": job.member,
        "block": job.block.name,
        "key": job.key,
        "drive": drive.key,
        "first": [("execute", control.place(plan.control_db, command, execute)), *own],
        "inputs": inputs,
        "results": [(name, control.place(plan.control_db, command, name)) for name in results],
        "outputs": outputs,
    }
