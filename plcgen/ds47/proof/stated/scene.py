"""A run in which something happens: what the inputs stand at, what the drive says, what is expected at the end."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field

from plcgen.ds47.proof.stated.nominal import fill_device, supply_of
from plcgen.ds47.proof.stated.rig import StatedRig, StatedRun
from plcgen.ds47.proof.stated.supply import Unique
from plcgen.oracles.spec.ds47.boundaries import Answer, meeting
from plcgen.oracles.spec.ds47.course import Difference, StatedCourse
from plcgen.oracles.spec.ds47.recorder import RecordingDevice
from plcgen.oracles.spec.ds47.statement import Number, Source, StatedJob, StatedStep
from plcgen.oracles.spec.place import SpecPlace

Says = Callable[[int, int], Answer | None]
"""Number of a step that waits and of the question: an answer that misses something; None: the one that meets all."""


def yes(_step: int, _question: int) -> None:
    """Everything is met at once."""


@dataclass
class Scene:
    """A job on its first drive, and what was found in all of its runs."""

    rig: StatedRig
    job: StatedJob
    unique: Unique
    found: list[Difference] = field(default_factory=list)

    @property
    def device(self) -> RecordingDevice:
        """The device of the drive."""
        return self.rig.units[self.job.drive.unit]

    def key(self, number: int, index: int) -> tuple[int, int, int]:
        """A value of the drive."""
        return self.job.drive.drive_object, number, index

    def demand(self, place: SpecPlace, expected: str, found: str, *, good: bool) -> None:
        """Note a difference."""
        if not good:
            self.found.append(Difference(place, expected, found))

    def status(self, run: StatedRun, *wanted: int, when: str) -> bool:
        """The job ends with one of these words."""
        good = run.status in wanted
        words = " or ".join(f"16#{word:04X}" for word in wanted)
        self.demand(self.job.place, f"status {words} {when}", f"16#{run.status & 0xFFFF:04X}", good=good)
        return good

    def run(
        self,
        ends: Callable[[StatedRun], None],
        *,
        steps: Sequence[StatedStep] | None = None,
        says: Says = yes,
        before: Callable[[], None] = lambda: None,
        record: int = 1,
    ) -> StatedRun:
        """A run that follows these steps (None: all of the job); ``before`` is done when all values are there."""
        supply = supply_of(self.rig, self.job, self.unique)
        supplied: dict[Source, Number | bytes] = {}
        followed = self.job.steps if steps is None else steps

        def answers(step: int, question: int) -> Answer | None:
            if not followed[step].until:
                return None
            said = says(step, question)
            return meeting(followed[step], supplied) if said is None else said

        course = StatedCourse(
            self.job,
            followed,
            self.rig.identifiers[self.job.drive.key],
            supplied,
            lambda key: self.device.values.get(key, b""),
            answers,
            lambda step, question: says(step, question) is None,
        )

        def prepare() -> None:
            supply.record = record
            supplied.update(supply.draw())
            supply.store()
            fill_device(self.rig, self.job, self.unique)
            before()

        return StatedRun(self.job, course, prepare, ends=ends)

    def asked(self, run: StatedRun) -> Iterable[Difference]:
        """What was wrong in the conversation so far."""
        return [*(run.course.differences if run.course is not None else ()), *self.complaints(run)]

    def complaints(self, run: StatedRun) -> Iterable[Difference]:
        """What could not be decoded."""
        return [Difference(self.job.place, "a parameter request", text) for text in run.complaints]
