"""A job that runs by itself: when it asks, how old its values are said to be, what it says of a silent drive."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

from plcgen.ds47.proof.stated.rig import LONGEST_SCAN, SCAN, StatedRun
from plcgen.ds47.proof.stated.scene import Scene
from plcgen.oracles.spec.ds47.recorder import NO_RECORD

RUNS, CYCLES_VALID, LEAST_VALID_MS = 3, 3, 1000
"""Values are valid for three cycles, at least 1 s (docs/spec.md, "In a cycle")."""
SCANS_OF_CYCLE, HOUR_MS = 20, 3_600_000
LOST_SCANS = 3
"""So many scans do not count when a clock starts over (docs/generated-code.md, "Times")."""
LATE_SCANS = 2
"""The scan in which the cycle is over, and the one behind it."""


@dataclass
class Watch:
    """What is seen of a job scan by scan: when its runs began and ended well, and what was said of the age then."""

    scene: Scene
    length: int
    begun: list[int] = field(default_factory=list)
    took: list[int] = field(default_factory=list)
    good: int = 0
    """When the last run that ended well began."""
    wrong: str = ""
    busy: bool = False

    def look(self) -> None:
        """Behind a scan."""
        rig, job = self.scene.rig, self.scene.job
        busy, done = (bool(rig.signal(job, name)) for name in ("busy", "done"))
        if busy and not self.busy:
            self.begun.append(rig.cpu.clock)
        if self.busy and not busy:
            self.took.append(rig.cpu.clock - self.begun[-1])
        if self.busy and done:
            self.good = self.begun[-1]
        self.busy = busy
        age, valid = rig.signal(job, "age"), bool(rig.signal(job, "valid"))
        if not self.good:
            self.note(not valid, "valid is TRUE before anything was read")
            return
        passed = rig.cpu.clock - self.good
        lost = LOST_SCANS * (1 + passed // HOUR_MS) * self.length
        self.note(passed - lost <= age <= passed, f"age is {age} ms, {passed} ms behind the start of the run")
        limit = max(LEAST_VALID_MS, CYCLES_VALID * job.cycle_ms)
        self.note(valid == (age <= limit), f"valid is {valid} while the values are {age} ms old")

    def note(self, good: bool, text: str) -> None:  # noqa: FBT001
        """Keep the first thing that is wrong."""
        self.wrong = self.wrong or ("" if good else text)


def cyclic_runs(scene: Scene) -> Iterator[Sequence[StatedRun]]:
    """Runs of a job with a cycle; none of another one."""
    if scene.job.cycle_ms:
        yield [repeated(scene)]


def repeated(scene: Scene) -> StatedRun:
    """Some runs, then the drive takes nothing any more until the values are too old, then one good run more."""
    job, device = scene.job, scene.device
    length = max(SCAN, min(LONGEST_SCAN, job.cycle_ms // SCANS_OF_CYCLE))
    watch = Watch(scene, length)
    states = iter(("good", "lost", "back"))
    now = [next(states)]
    last = [0]

    def over() -> bool:
        watch.look()
        enough = len(watch.begun) > RUNS and watch.good == watch.begun[-1]
        if now[0] == "good" and enough:
            now[0], device.write_status = "lost", lambda: NO_RECORD
        elif now[0] == "lost" and not scene.rig.signal(job, "valid"):
            now[0], device.write_status, last[0] = "back", None, watch.good
        patience = (RUNS + 2 * CYCLES_VALID + 2) * (job.cycle_ms + job.timeout_ms)
        late = scene.rig.cpu.clock - run.started > patience
        return bool(watch.wrong) or late or (now[0] == "back" and watch.good > last[0])

    def ends(_: StatedRun) -> None:
        late = (LATE_SCANS + LOST_SCANS * (1 + job.cycle_ms // HOUR_MS)) * length
        gaps = [later - earlier for earlier, later in itertools.pairwise(watch.begun)]
        pairs = zip(gaps, watch.took, strict=False)
        wrong = [gap for gap, took in pairs if not job.cycle_ms <= gap <= max(job.cycle_ms, took) + late]
        expected = f"{job.cycle_ms} ms from one start to the next, if a run takes no longer"
        scene.demand(job.place, expected, f"{wrong[:1]} ms", good=not wrong)
        scene.demand(job.place, f"{RUNS} runs, and another one when the drive is back", "fewer", good=now[0] == "back")
        scene.demand(job.place, "an age of the values", watch.wrong, good=not watch.wrong)

    run = scene.run(ends)
    # long scans pass the time between the runs; in a run they would use up its timeout
    run.course, run.over, run.idle = None, over, lambda: SCAN if watch.busy else length
    return run
