"""The generated blocks against the drive of a drive file: every job once."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from plcgen.cpu.program import Program
from plcgen.diagnostics import Diagnostic
from plcgen.proof.checks import Check, Outcome
from plcgen.protocols.ds47.plan.nouns import DriveJob, DrivePlan, Use
from plcgen.protocols.ds47.proof.rig import JobRig, ScenarioError
from plcgen.protocols.ds47.proof.scenario import DONE
from plcgen.protocols.ds47.sim.drive import Drive
from plcgen.protocols.ds47.sim.parameters import Parameter
from plcgen.protocols.ds47.wire import errors
from plcgen.protocols.ds47.wire.formats import pack_values
from plcgen.protocols.ds47.words import STATUS_WORDS

SCAN = 10
MEANINGS = {word: text for _, word, text in STATUS_WORDS}


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
    rig.set_flag("execute", value=True)
    latest = rig.limits.timeout + rig.limits.drain + 100
    scans = 0
    while scans * SCAN < latest:
        scans += 1
        rig.cpu.call(name, SCAN)
        if rig.cpu.misuses:
            raise ScenarioError(str(rig.cpu.misuses[0]))
        if not rig.flag("busy"):
            break
    status = rig.get("status")
    if status != DONE:
        raise ScenarioError(f"with your drive it ends with 16#{status:04X}, {MEANINGS.get(status, '')}{_refused(rig)}")
    for use in job.uses:
        expected = _held(drive, job, use)
        found = use.data if job.writes else rig.shown(rig.instance, rig.spots[use.member], len(expected))
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


def _held(drive: Drive, job: DriveJob, use: Use) -> bytes:
    """Wire bytes of a value the drive holds. Raises ScenarioError."""
    number = drive.habits.aliases.get(job.drive.drive_object, job.drive.drive_object)
    parameter: Parameter = drive.objects[number].parameters[use.parameter.pnu]
    values = parameter.values
    chosen = [values[0]] if use.format.is_string else values[use.subindex : use.subindex + use.count]
    return pack_values(use.format, chosen)
