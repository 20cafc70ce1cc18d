"""The callers read: which drive, slot, unit and record each instance is given, and where its signals go.

Running shows the same, job by job; here a wrong address is found without, and by its name.
"""

from __future__ import annotations

import re
from collections.abc import Iterator

from plcgen.base.diagnostics import Diagnostic
from plcgen.base.diagnostics.counting import quantity
from plcgen.ds47.plan.nouns import DriveCaller, DriveJob, DrivePlan, PlannedUnit
from plcgen.ds47.proof.wording.grounds import OUTPUT, Stated, stated_of
from plcgen.proof.checks import Check, Outcome
from plcgen.proof.folder import Folder
from plcgen.s7.types.address import Address

_CALL = re.compile(r"^#?(\w+)\(([^;]*)\);", re.MULTILINE)
_ARGUMENT = re.compile(r"(\w+)\s*(?::=|=>)\s*((?:\[[^\]]*\]|[^,\[])+?)\s*(?:,|$)")
_RETURNED = re.compile(r'(?:^|;)\s*("[^;]*?)\s*:=\s*#?(\w+)\.(\w+)(?=;)', re.MULTILINE)
"""STEP 7 V5 has no ``=>`` in calls: results are assigned after them."""
_NUMBER = re.compile(r"(?:\w+#)?(?:16#)?([0-9A-F]+)")
RECORD, WAIT_MS = 47, 60_000
"""What a channel has if it is given no other record, and no other limit of waiting (docs/generated-code.md)."""


def check_calls(plan: DrivePlan, folder: Folder) -> Iterator[Check]:
    """One check of each caller, in the text source; its document is held against it elsewhere."""
    stated = stated_of(plan)
    for caller in plan.callers if plan.jobs else ():
        block = folder.text.get(caller.block.name.upper())
        if block is None or block.code is None:
            continue  # what is missing is told elsewhere
        jobs = [job for job in plan.jobs if job.caller is caller]
        problems = list(_wrong(plan, caller, jobs, stated, block.code))
        name, figures = caller.block.name, quantity(len(jobs), "job call")
        if problems:
            found = Diagnostic("PG614", f'"{name}": {problems[0]}', folder.place(name))
            yield Check("calls", f'"{name}"', "", Outcome.ERROR, problems[0], found)
        else:
            yield Check("calls", f'"{name}"', figures, Outcome.OK, "drives, places and signals as in the spec")


def _wrong(plan: DrivePlan, caller: DriveCaller, jobs: list[DriveJob], stated: Stated, code: str) -> Iterator[str]:
    calls = {name: dict(_ARGUMENT.findall(text)) for name, text in _CALL.findall(code)}
    for place, name, signal in _RETURNED.findall(code):
        calls.get(name, {})[signal] = place
    for unit in plan.channels(caller):
        yield from _channel(plan, unit, stated, calls.get(unit.member))
    for job in jobs:
        yield from _job(plan, job, stated, calls.get(job.member))


def _channel(plan: DrivePlan, unit: PlannedUnit, stated: Stated, found: dict[str, str] | None) -> Iterator[str]:
    if found is None:
        yield f"{unit.member} is not called"
        return
    drives = [one.stated for one in stated.drives.values() if one.stated.unit == unit.key]
    number = _number(found.get("recordIndex", str(RECORD)))
    wait = _number(found.get("waitLimit", str(WAIT_MS)))
    for one in drives[:1]:
        if number is None or number & 0xFFFF != one.record:
            yield f"{unit.member} uses record {found.get('recordIndex', RECORD)}, the spec says {one.record}"
        if wait != one.wait_ms:
            yield f"{unit.member} lets jobs wait {wait} ms, the spec says {one.wait_ms}"
    places = [other.key for other in plan.units].index(unit.key) + 1
    wanted = {"unit": f'"{unit.db.name}".unit', "place": f'"{plan.engine.gate_db.name}".gate.channels[{places}]'}
    wanted["slots"] = str(plan.slots(unit))
    yield from _other(unit.member, wanted, found)


def _job(plan: DrivePlan, job: DriveJob, stated: Stated, found: dict[str, str] | None) -> Iterator[str]:
    if found is None:
        yield f"{job.member} is not called"
        return
    drive = stated.drives.get(job.drive.key)
    if drive is not None:
        identifier, given = drive.stated.identifier, found.get("hardwareId", found.get("driveAddress", ""))
        if isinstance(identifier, str):
            same = given.strip('"') == identifier
        else:
            same = _number(given) == identifier | OUTPUT * drive.stated.output
        if not same:
            yield f"{job.member} talks to {given}, the spec says {drive.stated}"
        if _number(found.get("driveObject", "")) != drive.stated.drive_object:
            said = f"the spec says {drive.stated.drive_object}"
            yield f"{job.member} talks to drive object {found.get('driveObject')}, {said}"
    wanted = {"slot": str(job.slot), "unit": f'"{job.drive.unit.db.name}".unit'}
    if job.recipe is not None:
        wanted["records"] = f'"{job.recipe.db.name}".records'
    if job.pinned:
        request, response = job.telegrams[0].request.home, job.telegrams[0].response.home
        wanted |= {"requestDb": f'"{request.name}"', "responseDb": f'"{response.name}"'}
    control = f'"{job.caller.control.name}".'
    wanted["diagnosis"] = f"{control}{job.member}.diagnosis"
    for signal, flag in job.trigger.items():
        wanted[signal] = f'"{plan.prefix}{job.member}{signal}"' if isinstance(flag, Address) else flag.text()
    for name, place in found.items():  # every other signal is that of the job
        if name not in wanted and place.startswith(control):
            wanted[name] = f"{control}{job.member}.{name}"
    yield from _other(job.member, wanted, found)


def _other(member: str, wanted: dict[str, str], found: dict[str, str]) -> Iterator[str]:
    for name, place in wanted.items():
        if found.get(name, "").lower() != place.lower():
            yield f"{name} of {member} is {found.get(name, 'nothing')}, not {place}"


def _number(text: str) -> int | None:
    match = _NUMBER.fullmatch(text.lstrip("-"))
    if match is None:
        return None
    value = int(match[1], 16 if "16#" in text else 10)
    return -value if text.startswith("-") else value
