"""What drive jobs contribute to the documents: shared types, tokens, function blocks, parts of the import guide."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from typing import Any

from plcgen.build.members import absolute_address, plain
from plcgen.build.nouns import Contribution, DataBlock, FunctionBlock, GuidePart, TypeBlock
from plcgen.ds47 import guards, hardware
from plcgen.ds47.effects import UNCLASSIFIED
from plcgen.ds47.plan.access import Use
from plcgen.ds47.plan.nouns import DriveJob, DrivePlan, DriveTelegram, Permitted, PlannedUnit
from plcgen.ds47.plan.values import literals_text
from plcgen.ds47.views.calls import CONTROL_TITLES, calls, part
from plcgen.ds47.views.engine import programs as engine_programs
from plcgen.ds47.views.engine import types
from plcgen.ds47.views.parts import all_parts
from plcgen.ds47.views.program import diagnosis_type, program
from plcgen.project.target import Target
from plcgen.s7.types.error_obs import ERROR_OBS, PULL_PLUG, ErrorOb


def contribution(plan: DrivePlan) -> Contribution:
    """Everything of a plan with jobs."""
    engine = plan.engine
    gate = plain(plan, "gate", f'"{engine.gate_type.name}"', "written by the channels and the gate")
    return Contribution(
        family="DS47",
        jobs="drive jobs",
        types=[*types(plan), *_types(plan)],
        data=[
            *(_unit(plan, unit) for unit in plan.units),
            *(one for each in all_parts() for one in each.shared_data(plan)),
            DataBlock(engine.gate_db, "Places for record jobs", (gate,)),
        ],
        programs=_programs(plan),
        controls={caller.control: part(plan, caller, CONTROL_TITLES) for caller in plan.callers},
        tag_table=f"{plan.prefix}DriveJobTags",
        guide=partial(_guide, plan),
        manifest=partial(_manifest, plan),
        system_blocks=("SFB52", "SFB53"),
    )


def _types(plan: DrivePlan) -> Iterator[TypeBlock]:
    """What kinds of jobs need for all of them, and for each of them."""
    for one in all_parts():
        yield from one.shared_types(plan)
    for job in plan.shapes:
        yield diagnosis_type(plan, job)
    for one in all_parts():
        for job in filter(one.has, plan.shapes):
            yield from one.types(plan, job)


def _unit(plan: DrivePlan, unit: PlannedUnit) -> DataBlock:
    drives = [drive for drive in plan.drives if drive.unit is unit]
    shown = ", ".join(drive.key for drive in drives[:3])
    member = plain(plan, "unit", f'"{plan.engine.unit.name}"', "shared by the channel and the jobs of the unit")
    return DataBlock(unit.db, f"Unit {unit.key}: {shown}", (member,), (), drives[0].comment if len(drives) == 1 else {})


def _programs(plan: DrivePlan) -> Iterator[FunctionBlock]:
    """The engine, a block for each job of the spec, and the callers of their instances."""
    yield from engine_programs(plan)
    commands = []
    for shape in plan.shapes:
        instances = plan.instances(shape)
        made = program(plan, shape, instances)
        commands += list(zip(instances, made.commands, strict=True))
        yield made
    for caller in plan.callers:
        yield calls(plan, caller, [(job, command) for job, command in commands if job.caller is caller])


def _guide(plan: DrivePlan) -> tuple[list[GuidePart], list[GuidePart]]:
    """Identifiers of the drives and numbers of the buffers; what is written."""
    numbered = [
        buffer.db for job in plan.shapes for telegram in job.telegrams for buffer in telegram.buffers if buffer.db
    ]
    writes = [_write_row(plan, job, use) for job in plan.jobs for use in job.own if use.writes]
    writes += [row for job in plan.jobs if job.permitted is not None for row in _service_rows(plan, job, job.permitted)]
    before: list[GuidePart] = [("ds47/import_drives.md.j2", _identifiers(plan))]
    if served := [job for job in plan.jobs if job.serves]:
        names = [f'"{job.caller.control.name}".{job.member}' for job in served]
        before.append(("ds47/import_service.md.j2", {"jobs": names, "writes": any(job.permitted for job in served)}))
    if numbered:
        before.append(("ds47/import.md.j2", {"numbered": numbered}))
    return before, [("ds47/import_writes.md.j2", {"writes": writes})] if writes else []


def _identifiers(plan: DrivePlan) -> dict[str, Any]:
    """What leads to each drive that has a job, and where to compare it."""
    used = {job.drive.key for job in plan.jobs}
    classic = plan.target.classic
    rows = [
        {
            "drive": drive.key,
            "id": drive.id_name or _number(drive.id_value, classic=classic),
            "object": drive.drive_object,
            "index": drive.record_index if drive.record_index < 0x8000 else f"16#{drive.record_index:X}",
            "where": hardware.lookup(drive, classic=classic),
        }
        for drive in plan.drives
        if drive.key in used
    ]
    ambiguous = not classic and any(row["index"] == hardware.PROFIBUS_INDEX for row in rows)
    return {
        "what": "address" if classic else "identifier",
        "drives": rows,
        "controls": [caller.control.name for caller in plan.callers],
        "named": any(job.trigger.items() for job in plan.jobs),
        "classic": classic,
        "error_obs": list(_error_obs(plan.target)),
        "on_profinet": ambiguous,
    }


def _error_obs(target: Target) -> Iterator[ErrorOb]:
    """The OBs without which the CPU can go to STOP. Of the S7-300, only CPUs with PROFINET have OB83."""
    known = target.cpu.name if target.cpu is not None else ""
    profibus_only = target.family == "s7-300" and known != "" and "PN" not in known
    return (ob for ob in ERROR_OBS if target.family in ob.stops and not (ob.number == PULL_PLUG and profibus_only))


def _number(value: int, *, classic: bool) -> str:
    return f"{value & 0x7FFF}, output" if classic and value & 0x8000 else str(value)


def _write_row(plan: DrivePlan, job: DriveJob, use: Use) -> dict[str, Any]:
    danger = plan.danger(job, use) or (UNCLASSIFIED if plan.unclassified(job, use) else "")
    signed = plan.sign_off(job, use.parameter.pnu) if danger else None
    value = literals_text(use, plan.target)
    notes = [f"{danger}; signed off: {signed or 'no'}"] if danger else []
    notes += ["all other bits as they are read in front of the write"] if use.bits else []
    restores = plan.entry(job).on_error if use not in job.saving else None
    if restores is not None and restores.reason:
        notes.append(f"restored while the drive runs, too; signed off: {restores.reason}")
    elif restores is not None:
        notes.append("restored if the job fails and the drive does not run")
    if use.constant and not use.bits and job.pinned:
        notes.append(_held(job, use))
    if doubt := use.parameter.type_note:
        notes.append(doubt)
    return {
        "job": job.block.name,
        "drive": job.drive.key,
        "label": use.label,
        "title": use.parameter.title,
        "value": value if use.constant else _open(job, use, value),
        "note": "; ".join(notes),
        "safety": use.parameter.pnu in guards.SAFETY,
    }


def _held(job: DriveJob, use: Use) -> str:
    """Where a constant lies that is part of a request in a data block: what is there at run time is sent."""
    requests = [one.request for one in job.telegrams]
    db, field = next(
        (request.db, field)
        for request in requests
        for field in request.fields
        if request.db is not None and field.role == "value" and field.part and field.part.use.position == use.position
    )
    where = absolute_address(db, field.type, field.offset)
    return f"start value. A run sends what {db.name}.{field.name} ({where}) holds"


def _service_rows(plan: DrivePlan, job: DriveJob, permitted: Permitted) -> Iterator[dict[str, Any]]:
    """What a service may write: the numbers of its table, and each one that the spec names."""
    count = sum(last - first + 1 for first, last in permitted.ranges)
    row = {"job": job.block.name, "drive": job.drive.key, "value": "an input", "safety": False}
    note = "only while enableWrite is TRUE; limits are not known"
    yield {**row, "label": f"{count} numbers", "title": f"those of {permitted.db.name}", "note": note}
    for pnu in sorted(permitted.named):
        device = job.drive.device
        danger = device.danger(pnu, None, job.drive.object_type) or ("" if device.classified(pnu) else UNCLASSIFIED)
        signed = f"signed off: {plan.sign_off(job, pnu)}"
        yield {
            **row,
            "label": f"P{pnu}",
            "title": "named by the spec",
            "note": f"{danger}; {signed}" if danger else signed,
        }


def _open(job: DriveJob, use: Use, value: str) -> str:
    """What comes from outside; a time that nothing is connected to is refused."""
    if job.recipe is not None and use.recorded:
        return f"record of {job.recipe.db.name}"
    return "input, made of the time at utc" if use in job.timed else f"input, {value} if nothing is connected"


def _numbers(telegram: DriveTelegram) -> dict[str, str]:
    """Data blocks of a telegram that has its own."""
    request, response = telegram.request.db, telegram.response.db
    if request is None or response is None:
        return {}
    return {"request_db": f"DB{request.number}", "response_db": f"DB{response.number}"}


def _manifest(plan: DrivePlan) -> dict[str, Any]:
    """Jobs with their telegrams."""
    jobs = [
        {
            "job": job.key,
            "drive": job.drive.key,
            "block": job.block.name,
            "telegrams": [
                {
                    "request": telegram.request.data.hex(" ").upper(),
                    **_numbers(telegram),
                    "positive_bytes": telegram.positive_length,
                    "longest_bytes": telegram.response.size,
                }
                for telegram in job.telegrams
            ],
        }
        for job in plan.jobs
    ]
    return {"jobs": jobs}
