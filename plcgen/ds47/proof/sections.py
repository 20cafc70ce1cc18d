"""What of a plant runs at a time: all of it, or the jobs of one caller where there are too many for one OB1.

A scan calls every job, and the scans that all jobs need together grow with their number: the time would grow with its
square. The jobs of one caller need a share of the scans, and of the callers only those that they cannot do without.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

from plcgen.ds47.plan.nouns import DriveCaller, DrivePlan

LARGE = 2_000
"""With more jobs than that those of one caller run at a time."""


@dataclass(frozen=True, slots=True)
class PlantSection:
    """Some jobs, as a plan of their own. ``blocks`` are called instead of OB1; ``outer``: everything is tried."""

    plan: DrivePlan
    name: str = ""
    blocks: tuple[str, ...] = ()
    outer: bool = True


def plant_sections(plan: DrivePlan) -> list[PlantSection]:
    """The whole plan, or a section for every caller, of which the first and the last are the outer ones."""
    if len(plan.jobs) <= LARGE:
        return [PlantSection(plan)]
    first: dict[str, DriveCaller] = {}
    for job in plan.jobs:
        first.setdefault(job.drive.unit.key, job.caller)
    found = []
    for caller in plan.callers:
        jobs = tuple(job for job in plan.jobs if job.caller is caller)
        keys = {job.drive.unit.key for job in jobs}
        channels = {first[key].number for key in keys}
        own = replace(
            plan,
            jobs=jobs,
            units=tuple(unit for unit in plan.units if unit.key in keys),
            drives=tuple(drive for drive in plan.drives if drive.unit.key in keys),
            callers=(caller,),
        )
        needed = (each for each in plan.callers if each.number in {1, caller.number, *channels})
        blocks = tuple(each.instance.name for each in needed)
        outer = caller in {plan.callers[0], plan.callers[-1]}
        found.append(PlantSection(own, f"{caller.block.name}: ", blocks, outer))
    return found
