"""Every run of every job, and what was not as the spec demands."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence

from plcgen.ds47.proof.stated.cyclic import cyclic_runs
from plcgen.ds47.proof.stated.failing import failing_runs
from plcgen.ds47.proof.stated.nominal import fill_device, supply_of, trials
from plcgen.ds47.proof.stated.outputs import delivered_records, start_difference
from plcgen.ds47.proof.stated.rig import PLACES, StatedRig
from plcgen.ds47.proof.stated.scene import Scene
from plcgen.ds47.proof.stated.supply import Unique, sources
from plcgen.ds47.proof.stated.timed import timed_runs
from plcgen.oracles.spec.ds47.course import Difference
from plcgen.oracles.spec.ds47.statement import FromInput, FromRecord, StatedJob, Statement
from plcgen.s7.cpu.program import Program
from plcgen.s7.types.names import V5_LIMIT, pascal_case, shorten

INSTANCE, CHANNEL = r"DriveCalls\d*_DB", "channel"
"""Instances of the callers, and what the names of channels in them begin with (docs/generated-code.md)."""


MANY = 30
TOGETHER_SCANS = 150


def jobs_kept(
    program: Program, statement: Statement, constants: Mapping[str, int], family: str
) -> dict[str, list[Difference]]:
    """What is wrong, by the key of the job; nothing if all is well."""
    found: dict[str, list[Difference]] = {}
    rig = StatedRig(program, statement, constants, family)
    jobs = []
    for job in statement.jobs:
        own = found.setdefault(job.key, [])
        missing = list(unreachable(rig, job)) or list(start_differences(rig, job))
        own += missing
        jobs += [] if missing else [job]
    for key, difference in channel_differences(rig):
        found[key].append(difference)
    unique, chosen = Unique(), firsts(jobs)
    every = [list(trials(rig, job, unique, first=job in chosen)) for job in jobs]
    for number in range(max(map(len, every), default=0)):
        rig.restart()
        now = [own[number] for own in every if number < len(own)]
        waits = any(step.until for trial in now for step in trial.job.steps)
        rig.run([trial.run() for trial in now], PLACES if waits else None)
        for trial in now:
            found[trial.job.key] += trial.differences
    for pair in jobs_beside(jobs):
        found[pair[0].key] += overlapping(rig, pair, unique)
    run_scenes(rig, [job for job in unlike(chosen) if not found[job.key]], unique, found)
    return found


def channel_differences(rig: StatedRig) -> Iterator[tuple[str, Difference]]:
    """What a channel is called with: how long a job may wait for its turn; by the key of a job of the unit."""
    rig.cpu.scan()
    instance = rig.statement.prefix + INSTANCE
    blocks = [entry for entry in rig.program.link.blocks.values() if re.fullmatch(instance, entry.name)]
    paths = {
        child.member.name.upper(): f'"{entry.name}".{child.member.name}'
        for entry in blocks
        for child in (entry.shape.fields if entry.shape is not None else ())
    }
    for job in {job.drive.unit: job for job in reversed(rig.statement.jobs)}.values():
        drive = job.drive
        name = f"{CHANNEL}{pascal_case(drive.unit)}"
        path = paths.get(name.upper(), paths.get(shorten(name, V5_LIMIT).upper()))
        found = rig.cpu[f"{path}.waitLimit"] if path is not None else None
        if found != drive.wait_ms:
            yield job.key, Difference(drive.place, f"{name} waits for {drive.wait_ms} ms", f"{found}")


def firsts(jobs: Sequence[StatedJob]) -> list[StatedJob]:
    """Every job on one of its drives, what its block does is the same on all; on many units they run at one time."""
    busy: dict[str, int] = {}
    found = []
    for key in dict.fromkeys(job.key for job in jobs):
        chosen = min((job for job in jobs if job.key == key), key=lambda job: busy.get(job.drive.unit, 0))
        busy[chosen.drive.unit] = busy.get(chosen.drive.unit, 0) + 1
        found.append(chosen)
    return found


def jobs_beside(jobs: Sequence[StatedJob]) -> Iterator[tuple[StatedJob, StatedJob]]:
    """Of every unit with several drives two jobs that do not wait for anything, on different drives."""
    units: dict[str, list[StatedJob]] = {}
    for job in jobs:
        if not any(step.until for step in job.steps) and job.listing is None:
            units.setdefault(job.drive.unit, []).append(job)
    for own in units.values():
        other = next((job for job in own if job.drive.key != own[0].drive.key), None)
        if other is not None:
            yield own[0], other


def overlapping(rig: StatedRig, pair: Sequence[StatedJob], unique: Unique) -> Iterator[Difference]:
    """Both are started at once: a device has one parameter server, so the second one waits."""
    rig.restart()
    device = rig.units[pair[0].drive.unit]
    for job in pair:
        supply = supply_of(rig, job, unique)
        supply.draw()
        supply.store()
        fill_device(rig, job, unique)
        rig.cpu[rig.path(job, "execute")] = True
    for _ in range(TOGETHER_SCANS):
        rig.cpu.scan()
    asked = {(telegram.identifier, telegram.drive_object) for telegram in device.heard}
    if device.overlaps or len(asked) < len(pair):
        found = f"{device.overlaps} requests before the answer to another one, of {len(device.heard)}"
        yield Difference(pair[0].drive.place, f"one request at a time to unit {pair[0].drive.unit}", found)


def unlike(jobs: Sequence[StatedJob]) -> Sequence[StatedJob]:
    """All jobs, or if they are many one of those that do the same for as long."""
    if len(jobs) <= MANY:
        return jobs
    alike: dict[object, StatedJob] = {}
    for job in jobs:
        steps = tuple((step.title, step.limit_ms, step.interval_ms, step.once) for step in job.steps)
        times = (job.timeout_ms, job.pause_ms, job.retries, job.wear_ms, job.tries, job.cycle_ms)
        alike.setdefault((job.kind, steps, times, job.restore, job.recipe), job)
    return list(alike.values())


def run_scenes(rig: StatedRig, jobs: Sequence[StatedJob], unique: Unique, found: dict[str, list[Difference]]) -> None:
    """Times, counts and failures of every job."""
    scenes = [Scene(rig, job, unique) for job in jobs]
    every = [[*timed_runs(scene), *failing_runs(scene), *cyclic_runs(scene)] for scene in scenes]
    for number in range(max(map(len, every), default=0)):
        rig.restart()
        rig.run([run for own in every if number < len(own) for run in own[number]], PLACES)
    for scene in scenes:
        found[scene.job.key] += scene.found


def unreachable(rig: StatedRig, job: StatedJob) -> Iterator[Difference]:
    """A job that cannot be started: its structure or a trigger is not there."""
    everywhere = {"execute", "busy", "done", "error", "status"} <= set(dict(job.signals))  # no structure is needed
    if rig.member(job) is None and not everywhere:
        yield Difference(job.place, f"a structure {job.member} in DriveJobs", "none")
        return
    for signal in ("execute", "done", "error", "status"):
        try:
            rig.signal(job, signal)
        except (KeyError, ValueError, TypeError):
            yield Difference(job.place, f"{signal} at {rig.path(job, signal)}", "nothing there")


def start_differences(rig: StatedRig, job: StatedJob) -> Iterator[Difference]:
    """Start values of inputs and records, and whether the job runs by itself, before anything has run."""
    if "execute" not in dict(job.signals) and bool(rig.cpu[rig.path(job, "execute")]) != bool(job.cycle_ms):
        yield Difference(job.place, f"execute {'TRUE' if job.cycle_ms else 'FALSE'} at start", "the other one")
    for source, access in sources(job).items():
        if isinstance(source, FromInput):
            yield from start_difference(rig, f"{rig.member(job)}.{source.name}", source.index, source.start, access)
        elif isinstance(source, FromRecord):
            yield from delivered_records(rig, access, source)
