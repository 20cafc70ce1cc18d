"""The generated blocks against the drive of a drive file: every job once."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from plcgen.cpu.program import Program
from plcgen.diagnostics import Diagnostic
from plcgen.proof.checks import Check, Outcome
from plcgen.proof.scenario import ScenarioError
from plcgen.protocols.ds47.plan.nouns import DrivePlan
from plcgen.protocols.ds47.proof.rig import JobRig, held
from plcgen.protocols.ds47.proof.words import DONE, MEANINGS
from plcgen.protocols.ds47.sim.drive import Drive
from plcgen.protocols.ds47.wire import errors

SCAN = 10


def own_checks(plan: DrivePlan, program: Program, make: Callable[[], Drive]) -> Iterator[Check]:
    """Run every job on a CPU of its own against a new drive of the file."""
    for job in plan.jobs:
        name, subject = f"own.{job.key}", f"your drive {job.key}"
        try:
            rig = JobRig(plan, program, job)
            scans = _run(rig, make())
        except (ScenarioError, KeyError) as problem:
            found = Diagnostic("PG620", f"{job.key}: {problem}", plan.loaded.key_span(job.path))
            yield Check(name, subject, "", Outcome.ERROR, str(problem), found)
        else:
            yield Check(name, subject, f"{scans} scans", Outcome.OK, "ok, values agree")


def _run(rig: JobRig, drive: Drive) -> int:
    """Scans until the job is done. Raises ScenarioError if it ends otherwise or values differ."""
    job, name = rig.job, rig.job.instance.name
    rig.bus.attach(job.drive.id_value, drive)
    rig.db.set("execute", 1)
    latest = rig.limits.timeout + rig.limits.drain + 100
    scans = 0
    while scans * SCAN < latest:
        scans += 1
        rig.cpu.call(name, SCAN)
        if rig.cpu.misuses:
            raise ScenarioError(str(rig.cpu.misuses[0]))
        if not rig.db.flag("busy"):
            break
    status = rig.db.get("status")
    if status != DONE:
        meaning = MEANINGS.get(status, ("", ""))[1]
        raise ScenarioError(f"with your drive it ends with 16#{status:04X}, {meaning}{_refused(rig)}")
    number = drive.behaviour.aliases.get(job.drive.drive_object, job.drive.drive_object)
    for use in job.uses:
        expected = held(drive, number, use)
        found = use.data if job.writes else rig.values.bytes(use.member, len(expected))
        if found != expected:
            raise ScenarioError(f"{use.label} is {found.hex(' ')}, your drive has {expected.hex(' ')}")
    return scans


def _refused(rig: JobRig) -> str:
    """Which parameters the drive refused and why."""
    found = [
        f"{use.label}: error {word & 0xFF:02X}h, {errors.error_text(word & 0xFF).meaning}"
        for use, word in zip(rig.job.uses, rig.words("errors"), strict=True)
        if word
    ]
    return f" ({'; '.join(found)})" if found else ""
