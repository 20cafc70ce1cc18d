"""Runs that end well: every input and every answer has a value of its own, conditions are missed and met by a hair."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace

from plcgen.ds47.proof.stated.outputs import (
    deviation_differences,
    message_differences,
    output_differences,
    record_differences,
)
from plcgen.ds47.proof.stated.rig import DONE, StatedRig, StatedRun, idle_scan
from plcgen.ds47.proof.stated.supply import MOMENTS, Supply, Unique, two_valued
from plcgen.oracles.spec.ds47.boundaries import Answer, failing, meeting, nearest
from plcgen.oracles.spec.ds47.course import Difference, StatedCourse, value_bytes
from plcgen.oracles.spec.ds47.statement import FromInput, Number, Source, StatedAccess, StatedJob, StatedStep
from plcgen.oracles.spec.ds47.types import ANY, packed, unpacked

RUNS_BITS = 0x0804
"""Bits 2 and 11 of r0899: the drive runs."""
STATE, COUNTERS = 899, frozenset({944, 2121})
PRESENT = (3, 8, 0, 5, 1)
"""How many messages the groups of a list have."""
SCANS_LATE = 8
"""So many scans after it is due a question may come: the job asks for the unit, and the telegram takes its way."""
GROUP = 8
STATES = (0, 2)
"""What an input may stand at that decides what is waited for, besides 1."""


@dataclass
class NominalRun:
    """One nominal run of a job, and what it found."""

    rig: StatedRig
    job: StatedJob
    supply: Supply
    bits: Mapping[Source, int] | None = None
    no: Mapping[int, Sequence[Answer]] = field(default_factory=dict)
    """Answers that miss a condition, by the number of the step."""
    beside: int = 1
    """Of a job that compares: how many units what the drive has is beside what is wanted."""
    record: int = 1
    far: bool = False
    """Whether conditions are met by the lowest or highest values."""
    differences: list[Difference] = field(default_factory=list)

    def run(self) -> StatedRun:
        """What is to be run; the findings come when it has ended."""
        supplied: dict[Source, Number | bytes] = {}
        course = StatedCourse(
            self.job,
            self.job.steps,
            self.rig.identifiers[self.job.drive.key],
            supplied,
            lambda key: self.rig.units[self.job.drive.unit].values.get(key, b""),
            self._answers(supplied),
            lambda step, question: question >= len(self.no.get(step, ())),
        )

        def prepare() -> None:
            self.supply.record = self.record
            supplied.update(self.supply.draw(self.bits))
            self.supply.store()
            self.differences += self.supply.missing
            fill_device(self.rig, self.job, self.supply.unique)
            if self.job.kind in {"compare", "compare_recipe"}:
                self._put_beside(supplied)

        run = StatedRun(self.job, course, prepare)
        run.ends = lambda ended: self.differences.extend(self._found(ended, course, supplied))
        return run

    def _answers(self, supplied: Mapping[Source, Number | bytes]) -> Callable[[int, int], Answer | None]:
        def said(step: int, question: int) -> Answer | None:
            if not self.job.steps[step].until:
                return None
            missed = self.no.get(step, ())
            return missed[question] if question < len(missed) else meeting(self.job.steps[step], supplied, far=self.far)

        return said

    def _put_beside(self, supplied: Mapping[Source, Number | bytes]) -> None:
        """What the drive has is just beside, or just equal to, what is wanted."""
        values = self.rig.units[self.job.drive.unit].values
        for access in self.job.steps[0].accesses:
            for at in range(access.count):
                wanted = unpacked(access.type, value_bytes(access, at, supplied))
                data = packed(access.type, value_beside(access, wanted, self.beside))
                values[self.job.drive.drive_object, access.number, access.index + at] = data

    def _found(
        self, run: StatedRun, course: StatedCourse, supplied: Mapping[Source, Number | bytes]
    ) -> Iterator[Difference]:
        yield from self.rig.missing(run)
        if run.status != DONE:
            if not course.differences:
                yield Difference(self.job.place, "a run that is done", f"status 16#{run.status & 0xFFFF:04X}")
            return
        if run.flags != (True, True, False):
            busy, done, error = run.flags
            yield Difference(
                self.job.place, "busy, then done without error", f"busy {busy}, done {done}, error {error}"
            )
        if course.differences:
            return
        yield from question_times(course)
        yield from output_differences(self.rig, self.job, without_lists(course)) if not self.job.listing else ()
        if self.job.kind in {"compare", "compare_recipe"}:
            yield from deviation_differences(self.rig, self.job, course, supplied)
        if self.job.kind == "read_recipe":
            yield from record_differences(self.rig, self.job, course, self.record)
        yield from message_differences(self.rig, self.job, course)


def without_lists(course: StatedCourse) -> StatedCourse:
    """A job that reads into a record shows nothing else."""
    if course.job.kind != "read_recipe":
        return course
    return replace(course, steps=())


def value_beside(access: StatedAccess, wanted: Number, units: int) -> Number:
    """A value so many units in the last place away: floating-point numbers one unit apart count as equal."""
    if isinstance(wanted, float):
        return nearest(access.type, wanted, 2 if units else 1)
    return nearest(access.type, wanted, 1 if units else 0)


def question_times(course: StatedCourse) -> Iterator[Difference]:
    """From one question to the next passes the interval, and not much more."""
    late = SCANS_LATE * idle_scan(course.job)
    for number, step in enumerate(course.steps):
        asked = course.asked.get(number, []) if step.until else []
        before = course.asked.get(number - 1, []) if step.pause_first else []
        starts = [t.fetched for t in before[-1:] if t.fetched is not None]
        times = [*starts, *(telegram.at for telegram in asked)]
        for earlier, later in itertools.pairwise(times):
            if not step.interval_ms - late // 2 <= later - earlier <= step.interval_ms + late:
                expected = f"{step.interval_ms} ms from one question to the next"
                yield Difference(step.accesses[0].place, expected, f"{later - earlier} ms")
                return


def fill_device(rig: StatedRig, job: StatedJob, unique: Unique) -> None:
    """Another value of everything that the job touches; the drive stands still, no message is left."""
    values = rig.units[job.drive.unit].values
    owner = job.drive.drive_object
    for step in job.steps:
        for access in step.accesses:
            if access.type == ANY:
                type_ = rig.units[job.drive.unit].types[owner, access.number]
                values[owner, access.number, access.index] = packed(type_, unique.number(type_))
                continue
            for at in range(access.count):
                number = 0x41 + at if access.string else unique.number(access.type)
                if access.number == STATE:
                    number = int(number) & ~RUNS_BITS
                values[owner, access.number, access.index + at] = packed(access.type, number)
    if job.listing is not None:
        _messages(values, job, unique)


def _messages(values: dict[tuple[int, int, int], bytes], job: StatedJob, unique: Unique) -> None:
    """Codes: some groups are full, some empty, in each the places in front are taken."""
    columns = next(step for step in job.steps if step.title == "reads the columns")
    asked = job.listing
    if asked is None:
        return
    access = columns.accesses[asked.columns.index("code")]
    for group in range(asked.groups):
        taken = PRESENT[group % len(PRESENT)]
        for place in range(GROUP):
            number = unique.number(access.type) if place < taken else 0
            key = (job.drive.drive_object, access.number, group * GROUP + place)
            values[key] = packed(access.type, number)


# --- which runs -----------------------------------------------------------------------------------------------


def trials(rig: StatedRig, job: StatedJob, unique: Unique, *, first: bool) -> Iterator[NominalRun]:
    """One run of every instance; of the first one of a job also what else decides."""
    chosen = needs_choice(job)
    supply = supply_of(rig, job, unique)
    chunks = list(answers_that_miss(job))
    yield NominalRun(rig, job, supply, no=chunks[0] if chunks else {}, record=min(2, max(1, job.records)))
    if not first:
        return
    if any(condition.relation not in {"=", "<>"} for step in job.steps for condition in step.until):
        yield NominalRun(rig, job, supply, far=True)
    for missed in chunks[1:]:
        yield NominalRun(rig, job, supply, no=missed)
    if job.kind in {"compare", "compare_recipe"}:
        yield NominalRun(rig, job, supply, beside=0)
    if job.kind == "clock":
        yield from (NominalRun(rig, job, supply) for _ in MOMENTS)
    for number in {1, job.records} - {2} if job.records else ():
        yield NominalRun(rig, job, supply, record=number)
    for bits in bit_patterns(job):
        yield NominalRun(rig, job, supply, bits=bits)
    yield from (NominalRun(rig, job, Chosen(rig, job, unique, state=state)) for state in STATES if chosen)


def needs_choice(job: StatedJob) -> bool:
    """Whether an input decides what is waited for."""
    return any(isinstance(condition.value, FromInput) for step in job.steps for condition in step.until)


@dataclass
class Chosen(Supply):
    """An input with three values stands at one of them."""

    state: int = 1

    def draw(self, bits: Mapping[Source, int] | None = None) -> dict[Source, Number | bytes]:
        """The state."""
        super().draw(bits)
        self.values.update(dict.fromkeys(self.values, self.state))
        return self.values


def supply_of(rig: StatedRig, job: StatedJob, unique: Unique) -> Supply:
    """Any values; where an input decides what is waited for, one that it may have."""
    return Chosen(rig, job, unique) if needs_choice(job) else Supply(rig, job, unique)


def bit_patterns(job: StatedJob) -> Iterator[Mapping[Source, int]]:
    """All FALSE, all TRUE, then each two of them differ in one pattern at least, and in its opposite."""
    inputs = two_valued(job)
    if not inputs:
        return
    yield dict.fromkeys(inputs, 0)
    yield dict.fromkeys(inputs, 1)
    for place in range(len(inputs).bit_length() if len(inputs) > 1 else 0):
        pattern = {one: (number + 1) >> place & 1 for number, one in enumerate(inputs)}
        yield pattern
        yield {one: 1 - value for one, value in pattern.items()}


def answers_that_miss(job: StatedJob) -> Iterator[Mapping[int, Sequence[Answer]]]:
    """Answers that miss one condition each, as many in a run as its limit has room for."""
    every = {n: list(failing(step, AnyInput())) for n, step in enumerate(job.steps) if step.until}
    rooms = {n: room(job.steps[n], SCANS_LATE * idle_scan(job)) for n in every}
    while any(every.values()):
        taken = {n: answers[: rooms[n]] for n, answers in every.items()}
        yield taken
        every = {n: answers[rooms[n] :] if rooms[n] else [] for n, answers in every.items()}


def room(step: StatedStep, late: int) -> int:
    """How many questions may be answered with no before the last one is asked."""
    each = step.interval_ms + late
    return max(0, (step.limit_ms - 1) // each - (1 if step.pause_first else 0))


class AnyInput(dict[Source, Number | bytes]):
    """Inputs stand at 1."""

    def __missing__(self, source: Source) -> Number | bytes:
        return 1
