"""Times and counts on the clock of the CPU: timeout, retries, pauses, limits, how far saves are apart."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator, Mapping, Sequence

from plcgen.ds47.proof.stated.nominal import SCANS_LATE, AnyInput
from plcgen.ds47.proof.stated.rig import DONE, LONGEST_SCAN, SCAN, StatedRun
from plcgen.ds47.proof.stated.scene import Scene
from plcgen.oracles.spec.ds47.boundaries import Answer, failing
from plcgen.oracles.spec.ds47.recorder import NO_ANSWER_YET, HeardTelegram, Key
from plcgen.oracles.spec.ds47.settings import SOON_MS
from plcgen.oracles.spec.ds47.statement import StatedJob, StatedStep

TIMEOUT, RETRIES, LOST, TOO_SOON = 0x8101, 0x8203, 0x8205, 0x8502
"""Status words (docs/generated-code.md, "status")."""
TEMPORARY_WRITE, NO_ANSWER = 0xDF80A200, 0xDE80A000
"""STATUS of WRREC: ask again; of RDREC: there is no answer to wait for."""
TELEGRAM_MS = 15 * SCAN
"""What a telegram takes with whatever is around it."""
AGAIN = 2
MARGIN_MS = 3000
"""How long before and behind the end of a wait between two saves a job is started; a minute is the shortest one."""
MOST_OVER_MS = 3000
"""A record job that lasts 5 s longer than the timeout is given up (DRAIN_LIMIT)."""
HOUR_MS = 3_600_000
"""A clock starts over then, and the scan in which it does so does not count."""
LATE_RETRY_MS = 30
"""How much longer than the pause it takes until WRREC has failed again, with scans of 1 ms."""
MOST_QUESTIONS = 150


def timed_runs(scene: Scene) -> Iterator[Sequence[StatedRun]]:
    """Each is a series of runs, one after the other."""
    job = scene.job
    yield [silent(scene, too_long=True)]
    if job.timeout_ms - spare_ms(job) > 0:
        yield [silent(scene, too_long=False)]
    yield [retried(scene)]
    if job.retries and job.timeout_ms > 3 * (sum(SOON_MS) + 2 * TELEGRAM_MS):
        yield [waited(scene)]
    if not job.steps[0].once and job.retries and job.timeout_ms - spare_ms(job) > job.pause_ms + 2 * TELEGRAM_MS:
        yield [sent_again(scene)]
    for number, step in enumerate(job.steps):
        if step.until:
            for late, answer in last_answers(step):
                yield [limited_run(scene, number, late, answer)]
        if step.once:
            yield [lost(scene, number)]
    if job.wear_ms:
        yield worn(scene)


def spare_ms(job: StatedJob) -> int:
    """What a run needs besides the record job that takes long."""
    values = sum(access.count for step in job.steps for access in step.accesses)
    telegrams = 2 * len(job.steps) + values // 30
    pauses = sum(step.interval_ms for step in job.steps if step.until and step.pause_first)
    return max(job.timeout_ms // 10, telegrams * TELEGRAM_MS) + pauses


def silent(scene: Scene, *, too_long: bool) -> StatedRun:
    """The first record job takes a little longer than the timeout, or a little less."""
    job = scene.job
    first = itertools.count()

    def ends(run: StatedRun) -> None:
        if too_long:
            scene.status(run, TIMEOUT, when=f"after {job.timeout_ms} ms")
        else:
            scene.status(run, DONE, when=f"if the answer comes within {job.timeout_ms} ms")

    run = scene.run(ends)
    extra = min(job.timeout_ms // 10 + TELEGRAM_MS, MOST_OVER_MS)
    takes = job.timeout_ms + extra if too_long else job.timeout_ms - spare_ms(job)
    run.delay = lambda _kind: takes if next(first) == 0 else None
    coarse = max(SCAN, min(job.timeout_ms // 40, MOST_OVER_MS // (2 * (2 + starts_over(job.timeout_ms)))))
    run.idle = lambda: 0 if scene.device.calls else coarse
    return run


def starts_over(passed: int) -> int:
    """How often a clock starts over in so many ms, if not once more: that of an S7-1200/1500 once an hour."""
    return passed // HOUR_MS


def retried(scene: Scene) -> StatedRun:
    """WRREC fails again and again: as many times as the retries allow, a pause between each two."""
    job = scene.job
    place = job.place

    def pace() -> int:
        calls = scene.device.calls
        left = calls[-1][0] + job.pause_ms - scene.rig.cpu.clock if calls else SCAN
        return max(1, min(left - 1, LONGEST_SCAN if calls else SCAN))

    def ends(run: StatedRun) -> None:
        times = [at for at, kind in run.calls if kind == "WRREC"]
        gaps = [later - earlier for earlier, later in itertools.pairwise(times)]
        if job.retries * (job.pause_ms + LATE_RETRY_MS) >= job.timeout_ms:
            scene.status(run, RETRIES, TIMEOUT, when="if WRREC fails again and again")
            return
        if scene.status(run, RETRIES, when="after all retries"):
            scene.demand(place, f"{job.retries} retries", f"{len(times) - 1}", good=len(times) == job.retries + 1)
            wrong = [gap for gap in gaps if not job.pause_ms <= gap <= job.pause_ms + LATE_RETRY_MS]
            twice = [gap for gap in wrong if job.pause_ms < gap <= 2 * (job.pause_ms + LATE_RETRY_MS)]
            good = wrong == twice[: starts_over(run.took)]
            scene.demand(place, f"a pause of {job.pause_ms} ms", f"{wrong[:1]} ms", good=good)

    run = scene.run(ends, before=lambda: setattr(scene.device, "write_status", lambda: TEMPORARY_WRITE))
    run.pace = pace
    return run


def waited(scene: Scene) -> StatedRun:
    """RDREC has no answer yet, a few times: it is asked soon again at first, but for a shorter pause of the job."""
    job, left = scene.job, [len(SOON_MS)]

    def status() -> int:
        left[0] -= 1
        return NO_ANSWER_YET if left[0] >= 0 else 0

    def ends(run: StatedRun) -> None:
        times = [at for at, kind in run.calls if kind == "RDREC"][: len(SOON_MS) + 1]
        gaps = [later - earlier for earlier, later in itertools.pairwise(times)]
        wanted = [min(pause, job.pause_ms) for pause in SOON_MS]
        late = [gap - pause for gap, pause in zip(gaps, wanted, strict=True)]
        good = min(late) >= 0 and sorted(late)[-1 - starts_over(run.took)] <= LATE_RETRY_MS
        scene.demand(job.place, f"pauses of {wanted} ms before an answer", f"{gaps} ms", good=good)
        scene.status(run, DONE, when="if the answer is late")

    run = scene.run(ends, before=lambda: setattr(scene.device, "read_status", status))
    run.pace = lambda: 1 if left[0] >= 0 else SCAN
    return run


def last_answers(step: StatedStep) -> Iterator[tuple[int, Answer]]:
    """How the job ends at the limit, each with an answer that makes it end so."""
    known: dict[int, Answer] = {}
    for condition in step.until:
        alone = failing(one_condition(step, condition), AnyInput())
        known.setdefault(condition.late or step.late, alone[0])
    yield from known.items()


def one_condition(step: StatedStep, missed: object) -> StatedStep:
    """The step with this condition in front: the first answer that misses something misses it."""
    from dataclasses import replace

    others = [one for one in step.until if one is not missed]
    return replace(step, until=(*[one for one in step.until if one is missed], *others))


def limited_run(scene: Scene, number: int, late: int, answer: Answer) -> StatedRun:
    """The drive says no for ever: the question at the limit or later is the last one."""
    job, step = scene.job, scene.job.steps[number]
    rare = max(0, step.limit_ms // MOST_QUESTIONS - step.interval_ms)
    takes = min(rare, max(0, job.timeout_ms // 4 - TELEGRAM_MS))
    idle = max(SCAN, min(step.interval_ms // 8, 250, job.timeout_ms // 40))
    slack = SCANS_LATE * idle + 3 * takes

    def ends(run: StatedRun) -> None:
        scene.found += scene.asked(run)
        course = run.course
        if course is None or not scene.status(run, late, when=f"after {step.limit_ms} ms"):
            return
        asked = [telegram.at for telegram in course.asked.get(number, [])]
        before = course.asked.get(number - 1, []) if step.pause_first else []
        start = before[-1].fetched if before and before[-1].fetched is not None else asked[0]
        last = asked[-1] - start
        good = step.limit_ms - slack <= last <= step.limit_ms + step.interval_ms + slack
        scene.demand(step.accesses[0].place, f"a last question at {step.limit_ms} ms", f"at {last} ms", good=good)
        failed_step(scene, step, answer)

    run = scene.run(ends, says=lambda at, _question: answer if at == number else None)
    run.idle = lambda: idle
    if takes:
        run.delay = lambda kind: takes if kind == "WRREC" else None
    return run


def failed_step(scene: Scene, step: StatedStep, answer: Answer) -> None:
    """A job in steps says where it failed."""
    if not step.number:
        return
    member = scene.rig.member(scene.job)
    found = scene.rig.cpu[f"{member}.failedStep"], scene.rig.cpu[f"{member}.failedParameter"]
    numbers = {number for number, _ in answer}
    good = found[0] == step.number and found[1] in numbers
    expected = f"failedStep {step.number}, failedParameter {' or '.join(map(str, numbers))}"
    scene.demand(step.accesses[0].place, expected, f"{found[0]}, {found[1]}", good=good)


def lost(scene: Scene, number: int) -> StatedRun:
    """The answer to a write that starts something is lost: it is not sent again, and the job says so."""
    job, step = scene.job, scene.job.steps[number]

    def ends(run: StatedRun) -> None:
        sent = [telegram for telegram in run.heard if telegram.write and wanted_write(telegram.accesses, step)]
        place = step.accesses[0].place
        scene.demand(place, "a write that is sent once", f"{len(sent)} times", good=len(sent) == 1)
        cause = scene.rig.cpu[f"{scene.rig.member(job)}.cause"] if job.restore else run.status
        scene.demand(place, "status 16#8205 if the answer is lost", f"16#{cause:04X}", good=cause == LOST)

    run = scene.run(ends, steps=job.steps[: number + 1])
    course, device = run.course, scene.device

    def status() -> int:
        return NO_ANSWER if course is not None and course.step > number else 0

    def prepare(then: Callable[[], None] = run.prepare) -> None:
        then()
        device.read_status = status

    run.prepare = prepare
    return run


def sent_again(scene: Scene) -> StatedRun:
    """The answer to the first telegram is lost: it is sent again as it was, but for its reference."""
    run = scene.run(lambda _: None)
    course, device, lost = run.course, scene.device, [True]
    answers: list[Mapping[Key, bytes]] = []

    def hears(telegram: HeardTelegram) -> Mapping[Key, bytes]:
        again = len(device.heard) == AGAIN
        if course is not None and not again:
            answers.append(course.hear(telegram))
        return answers[-1] if answers else {}

    def status() -> int:
        if lost[0]:
            lost[0] = False
            return NO_ANSWER
        return 0

    def ends(run: StatedRun) -> None:
        sent = [telegram.data[1:] for telegram in run.heard[:AGAIN]]
        good = len(sent) == AGAIN and sent[0] == sent[1]
        scene.demand(scene.job.place, "a lost request sent again as it was", f"{len(run.heard)} requests", good=good)
        scene.status(run, DONE, when="if the first answer is lost")

    def prepare(then: Callable[[], None] = run.prepare) -> None:
        then()
        device.read_status = status

    run.hears, run.prepare, run.ends = hears, prepare, ends
    return run


def wanted_write(accesses: Sequence[object], step: StatedStep) -> bool:
    """Whether a telegram is the write of a step."""
    numbers = {access.number for access in step.accesses}
    return {getattr(access, "number", 0) for access in accesses} <= numbers


def worn(scene: Scene) -> Sequence[StatedRun]:
    """A save, another one a little too soon, another one when it may be."""
    job = scene.job
    place = next(step.accesses[0].place for step in job.steps if step.title == "saves")
    written = [0]

    def first(run: StatedRun) -> None:
        scene.status(run, DONE, when="for the first save")
        save = next(number for number, step in enumerate(job.steps) if step.title == "saves")
        sent = run.course.asked.get(save, []) if run.course is not None else []
        written[0] = sent[-1].at if sent else run.started

    def soon(run: StatedRun) -> None:
        scene.status(run, TOO_SOON, when=f"before {job.wear_ms} ms are over")
        scene.demand(place, "no request that soon after a save", f"{len(run.heard)}", good=not run.heard)

    def later(run: StatedRun) -> None:
        scene.status(run, DONE, when=f"when {job.wear_ms} ms are over")

    runs = [scene.run(first), scene.run(soon, steps=()), scene.run(later)]
    runs[1].due = lambda: written[0] + job.wear_ms - MARGIN_MS
    runs[2].due = lambda: written[0] + job.wear_ms + MARGIN_MS
    return runs
