"""What the tests of all kinds of jobs do with a plant: find a job, run it to its end, look at the wire."""

from __future__ import annotations

from pathlib import Path

from plcgen import api
from plcgen.base.diagnostics import Diagnostic
from plcgen.ds47.plan.nouns import DriveJob
from plcgen.ds47.proof.plant import Plant


def job_of(plant: Plant, key: str) -> DriveJob:
    """A job by its key."""
    return next(job for job in plant.plan.jobs if job.key == key)


def status_of(plant: Plant, job: DriveJob, scans: int = 600) -> int:
    """Start a job anew and wait for its end; its status."""
    plant.execute(job, value=False)
    plant.step()
    return ended(plant, job, scans)


def ended(plant: Plant, job: DriveJob, scans: int = 600) -> int:
    """Start a job and wait for its end; its status."""
    plant.execute(job)
    for _ in range(scans):
        plant.step()
        over, status = plant.result(job)
        if over:
            return status
    raise AssertionError(f"{job.key} has not ended")


def sent(plant: Plant) -> list[str]:
    """Requests that the one unit has taken, without their references."""
    (unit,) = plant.units.values()
    return [one.data[1:].hex(" ") for one in unit.journal if one.direction == "write" and not one.status]


def noticed(folder: Path, text: str, old: str, new: str) -> list[Diagnostic]:
    """What verify says of one change of the source of a spec, named ``Plant``, besides that the file was changed."""
    spec = folder / "job.yaml"
    spec.write_text(text, "utf-8")
    assert api.generate(spec, folder / "out").ok
    source = folder / "out" / "Plant.scl"
    before = source.read_text("utf-8-sig")
    assert old in before
    source.write_text(before.replace(old, new), "utf-8-sig")
    problems = api.verify(spec, folder / "out", faults="quick").problems
    return [one for one in problems if not one.span.file.endswith("manifest.json")]


def told_of(job: str, found: list[Diagnostic]) -> bool:
    """Whether a run of this job, or what it sends, is told to be wrong."""
    return any(one.code in {"PG620", "PG621", "PG641"} and one.message.startswith(f"{job}: ") for one in found)
