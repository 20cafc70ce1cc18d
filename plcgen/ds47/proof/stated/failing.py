"""What follows when the drive refuses, rounds, changes its buffer, or a record is not allowed."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence

from plcgen.ds47.proof.stated.outputs import message_differences
from plcgen.ds47.proof.stated.restoring import restoring_runs
from plcgen.ds47.proof.stated.rig import DONE, StatedRun
from plcgen.ds47.proof.stated.scene import Scene
from plcgen.oracles.spec.ds47.boundaries import nearest
from plcgen.oracles.spec.ds47.course import StatedCourse
from plcgen.oracles.spec.ds47.recorder import HeardTelegram, Key
from plcgen.oracles.spec.ds47.statement import FromRecord, Number, StatedAccess, StatedStep
from plcgen.oracles.spec.ds47.types import is_float, packed, unpacked

REFUSED, DEVIATES, CHANGED, NO_TIME, NO_RECORD, OUTSIDE = 0x8401, 0x8503, 0x8504, 0x8520, 0x8540, 0x8541
"""Status words (docs/generated-code.md, "status")."""
STATE_ERROR = 0x11
"""Error number of a drive: the request cannot be executed in this state."""
SAMPLE = 4
"""So many parameters of a job are taken, the first ones and the last one."""
UTC_FROM, UTC_TO = 2000, 2089


def failing_runs(scene: Scene) -> Iterator[Sequence[StatedRun]]:
    """Each is a series of runs, one after the other."""
    job = scene.job
    if not job.restore:
        for number, step in enumerate(job.steps):
            yield [refused_run(scene, number, step)]
        back = next((number for number, step in enumerate(job.steps) if step.title == "reads back"), None)
        if back is not None:
            yield from deviating_runs(scene, back)
    else:
        yield from restoring_runs(scene)
    if job.listing is not None:
        yield from ([changing(scene, changes)] for changes in sorted({job.tries - 1, job.tries}))
    if job.kind == "clock":
        yield [no_time(scene, year) for year in (UTC_FROM - 1, UTC_TO + 1)]
    if job.recipe:
        yield [no_record(scene, number) for number in (0, job.records + 1)]
    if job.kind == "write_recipe":
        yield from limit_runs(scene)


# --- refusals -------------------------------------------------------------------------------------------------


def refused_run(scene: Scene, number: int, step: StatedStep) -> StatedRun:
    """The drive refuses something of a step: the job ends, and nothing more is sent."""
    access = step.accesses[-1]

    def ends(run: StatedRun) -> None:
        scene.status(run, REFUSED, when=f"if the drive refuses {access.written}")
        after = [telegram for telegram in run.heard if telegram is not run.heard[-1] and telegram.refused]
        scene.demand(access.place, "no request after a refusal", f"{len(after)} of them", good=not after)
        if step.number:
            member = scene.rig.member(scene.job)
            found = scene.rig.cpu[f"{member}.failedStep"], scene.rig.cpu[f"{member}.failedParameter"]
            wanted = step.number, access.number
            said = f"failedStep {wanted[0]}, failedParameter {wanted[1]}"
            scene.demand(access.place, said, f"{found[0]}, {found[1]}", good=found == wanted)

    run = scene.run(ends)
    course, device = run.course, scene.device
    before = {one.number for earlier in scene.job.steps[:number] for one in earlier.accesses}
    key = (access.write, scene.job.drive.drive_object, access.number)

    def hears(telegram: HeardTelegram) -> dict[Key, bytes]:
        """A telegram may begin in a step before."""
        if course is None:
            return {}
        now = course.step == number or access.number not in before
        device.refuses = {key: STATE_ERROR} if now and telegram.write == access.write else {}
        return dict(course.hear(telegram))

    run.hears = hears
    return run


# --- reading back ---------------------------------------------------------------------------------------------


def deviating_runs(scene: Scene, back: int) -> Iterator[Sequence[StatedRun]]:
    """The drive takes another value than it is told: just the next one, or for a floating-point number two on."""
    accesses = [access for access in scene.job.steps[back].accesses if access.values or access.bits]
    for access in sample(accesses):
        yield [deviating_run(scene, back, access, 2 if is_float(access.type) else 1, good=False)]
    for access in [one for one in accesses if is_float(one.type)][:1]:
        yield [deviating_run(scene, back, access, 1, good=True)]


def sample(accesses: Sequence[StatedAccess]) -> Sequence[StatedAccess]:
    """The first ones and the last one."""
    return [*accesses[: SAMPLE - 1], *accesses[SAMPLE - 1 :][-1:]]


def deviating_run(scene: Scene, back: int, access: StatedAccess, units: int, *, good: bool) -> StatedRun:
    """The last value of a parameter is so many units in the last place beside the one that was written."""
    steps = scene.job.steps if good else scene.job.steps[: back + 1]

    def ends(run: StatedRun) -> None:
        scene.found += scene.asked(run)
        when = f"if {access.written} is {units} beside what was written"
        scene.status(run, DONE if good else DEVIATES, when=when)

    def turned(data: bytes) -> bytes:
        if access.bits:  # a bit that is written, and no other
            return (int.from_bytes(data) ^ 1 << access.bits[0][0]).to_bytes(len(data))
        if access.string:
            return bytes((data[0] ^ 1,))
        return packed(access.type, nearest(access.type, unpacked(access.type, data), units))

    def before() -> None:
        scene.device.turns[scene.key(access.number, access.index + access.count - 1)] = turned

    return scene.run(ends, steps=steps, before=before)


# --- messages -------------------------------------------------------------------------------------------------


def changing(scene: Scene, changes: int) -> StatedRun:
    """What is read twice changes so many times meanwhile: all of it is read again, ``tries`` times in all."""
    job = scene.job
    reads = min(changes + 1, job.tries)
    good = changes < job.tries
    once = job.steps
    twice = once[-1].accesses[0]

    def ends(run: StatedRun) -> None:
        course = run.course
        scene.found += scene.rig.missing(run)
        if (
            course is not None
            and scene.status(run, DONE if good else CHANGED, when=f"after {changes} changes")
            and good
        ):
            scene.found += message_differences(scene.rig, job, course)

    run = scene.run(ends, steps=once * reads)
    course = run.course
    if course is not None:
        course.answers = lambda step, _question: {
            (twice.number, twice.index): counter_value(step, len(once), changes, twice.type)
        }
    return run


def counter_value(step: int, steps: int, changes: int, type_: str) -> Number:
    """What a counter or a code is when a step is heard: in each of the first reads it goes on at the end."""
    read, within = divmod(step, steps)
    value = 2 * read + (1 if within and read < changes else 0)
    return value + (1 << 15 if type_ == "Unsigned16" else 0)


# --- what is refused at once ----------------------------------------------------------------------------------


def nothing_sent(
    scene: Scene, status: int, when: str, more: Callable[[], None] = lambda: None
) -> Callable[[StatedRun], None]:
    """The job ends with a word and has sent nothing."""

    def ends(run: StatedRun) -> None:
        scene.status(run, status, when=when)
        scene.demand(scene.job.place, f"no request {when}", f"{len(run.heard)}", good=not run.heard)
        more()

    return ends


def no_time(scene: Scene, year: int) -> StatedRun:
    """A year that the clock of the drive does not have."""
    run = scene.run(nothing_sent(scene, NO_TIME, f"in the year {year}"), steps=())
    path = f"{scene.rig.member(scene.job)}.utc"

    def prepare(then: Callable[[], None] = run.prepare) -> None:
        then()
        _, member, _, _ = scene.rig.cpu.symbols.find(path)
        if member is None:
            return
        memory = scene.rig.cpu.db(path.split('"')[1])
        if member[2].size // 8 > len(f"{year}") * 2:
            memory[member[2].byte : member[2].byte + 2] = year.to_bytes(2)
        else:  # a DATE_AND_TIME has two digits of the year: a month 13
            memory[member[2].byte + 1] = 0x13

    run.prepare = prepare
    return run


def no_record(scene: Scene, number: int) -> StatedRun:
    """There is no record with this number."""
    run = scene.run(nothing_sent(scene, NO_RECORD, f"for record {number}"), steps=())

    def prepare(then: Callable[[], None] = run.prepare) -> None:
        then()
        scene.rig.cpu[f"{scene.rig.member(scene.job)}.recordNumber"] = number

    run.prepare = prepare
    return run


def limit_runs(scene: Scene) -> Iterator[Sequence[StatedRun]]:
    """Values of a record just at their limits, and just outside."""
    write = next(step for step in scene.job.steps if step.title == "writes")
    for access in write.accesses:
        source = access.values[-1] if access.values else None
        if not isinstance(source, FromRecord):
            continue
        for limit, side in ((source.minimum, -1), (source.maximum, 1)):
            if limit is None or not inside(access, limit, side):
                continue
            yield [outside_run(scene, access, source, nearest(access.type, limit, side), good=False)]
            yield [outside_run(scene, access, source, limit, good=True)]
        if is_float(access.type):
            yield [outside_run(scene, access, source, math.inf, good=False)]


def inside(access: StatedAccess, limit: Number, side: int) -> bool:
    """Whether the type has values beyond a limit, and the limit itself: not if it rounds to another number."""
    exact = float(unpacked(access.type, packed(access.type, limit))) == float(limit)
    beyond = nearest(access.type, limit, side)
    return exact and (beyond > limit) == (side > 0)


def outside_run(scene: Scene, access: StatedAccess, source: FromRecord, value: Number, *, good: bool) -> StatedRun:
    """One value of the record is this one."""
    when = f"if {source.member} of the record is {value}"

    def failed() -> None:
        member = scene.rig.member(scene.job)
        found = scene.rig.cpu[f"{member}.failedParameter"], scene.rig.cpu[f"{member}.failedIndex"]
        wanted = access.number, access.index + access.count - 1
        said = f"failedParameter {wanted[0]}, failedIndex {wanted[1]} {when}"
        scene.demand(access.place, said, f"{found[0]}, {found[1]}", good=found == wanted)

    def accepted(run: StatedRun) -> None:
        scene.found += scene.asked(run)
        scene.status(run, DONE, when=when)

    ends = accepted if good else nothing_sent(scene, OUTSIDE, when, failed)
    run = scene.run(ends, steps=None if good else ())
    course = run.course

    def prepare(then: Callable[[], None] = run.prepare) -> None:
        then()
        path = scene.rig.record_path(source.recipe, 1, source.member)
        scene.rig.cpu[path if source.index is None else f"{path}[{source.index}]"] = value
        if isinstance(course, StatedCourse):
            course.supplied = {**course.supplied, source: value}

    run.prepare = prepare
    return run
