"""The generated blocks against the drive of a drive file: every job once."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from plcgen.base.diagnostics import Diagnostic
from plcgen.ds47.plan.nouns import DrivePlan
from plcgen.ds47.proof import message_lists
from plcgen.ds47.proof.contents import held, masked
from plcgen.ds47.proof.rig import JobRig
from plcgen.ds47.proof.words import DONE, DRAIN_MS, MEANINGS
from plcgen.ds47.sim.drive import Drive
from plcgen.ds47.wire import errors
from plcgen.proof.checks import Check, Outcome
from plcgen.proof.scenario import ScenarioError
from plcgen.s7.cpu.cpu import Cpu
from plcgen.s7.cpu.program import Program

SCAN = 10


def own_checks(plan: DrivePlan, program: Program, make: Callable[[], Drive]) -> Iterator[Check]:
    """Run every job against a new drive of the file."""
    cpu = Cpu(program)
    for number, job in enumerate(plan.shapes, 1):
        name, subject = f"own.{job.shape}", f"your drive {job.shape}"
        try:
            scans = _run(JobRig(plan, program, job, number, cpu), make())
        except (ScenarioError, KeyError) as problem:
            found = Diagnostic("PG620", f"{job.shape}: {problem}", plan.loaded.key_span(job.path))
            yield Check(name, subject, "", Outcome.ERROR, str(problem), found)
        else:
            yield Check(name, subject, f"{scans} scans", Outcome.OK, "ok, values agree")


def _run(rig: JobRig, drive: Drive) -> int:
    """Scans until the job is done. Raises ScenarioError if it ends otherwise or values differ."""
    job = rig.job
    rig.put_inputs()
    rig.bus.attach(job.drive.id_value, drive)
    rig.db.set("execute", 1)
    latest = job.timeout + DRAIN_MS + 100
    scans = 0
    while scans * SCAN < latest:
        scans += 1
        rig.cpu.call(rig.db.block, SCAN)
        if rig.cpu.misuses:
            raise ScenarioError(str(rig.cpu.misuses[0]))
        if not rig.db.flag("busy"):
            break
    status = rig.db.get("status")
    if status != DONE:
        meaning = MEANINGS.get(status, ("", ""))[1]
        raise ScenarioError(f"with your drive it ends with 16#{status:04X}, {meaning}{_refused(rig)}")
    number = drive.behaviour.aliases.get(job.drive.drive_object, job.drive.drive_object)
    if message_lists.shown_list(job, rig.db) != message_lists.wanted(
        job, drive, number, {use.position: use.data for use in job.uses}
    ):
        raise ScenarioError("the list is not that of your drive")
    if rig.records is not None and job.stores:
        there = {use.position: held(drive, number, use) for use in job.uses}
        if rig.records.shown() != rig.records.wanted(there):
            raise ScenarioError("the record is not what your drive has")
    for use in job.uses:
        if (use.writes and use in job.saving) or job.whole or use.precedes:
            continue  # it has returned to 0, or the drive has another value by now
        expected = held(drive, number, use)
        found = use.data if use.writes else rig.db.bytes(use.member, len(expected))
        if use.bits:
            expected, found = (masked(data, use.mask) for data in (expected, found))
        if found != expected:
            raise ScenarioError(f"{use.label} is {found.hex(' ')}, your drive has {expected.hex(' ')}")
    return scans


def _refused(rig: JobRig) -> str:
    """Which parameters the drive refused and why."""
    found = [
        f"{use.label}: error {word & 0xFF:02X}h, {errors.error_text(word & 0xFF).meaning}"
        for use, word in zip(rig.job.uses, rig.words("errors"), strict=True)
        if word >> 8 == 0x80
    ]
    return f" ({'; '.join(found)})" if found else ""
