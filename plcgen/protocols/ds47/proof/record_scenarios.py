"""Scenarios of the record calls and the CPU: STATUS, busy, late, silent, restart, execute, owner, clock."""

from __future__ import annotations

from collections.abc import Iterator
from math import ceil

from plcgen.protocols.ds47.plan.nouns import DriveJob
from plcgen.protocols.ds47.proof.scenario import DriveScenario, Foreign, TimeLimits
from plcgen.protocols.ds47.proof.words import WORDS

STATE_CONFLICT = 0xDE80B500
WRITE, READ, LOCAL = 0xDF800000, 0xDE800000, 0xC0800000
CODES = (*range(0x90, 0x93), *range(0xA0, 0xD0), 0xFF)
"""Values of Error_Code_1: everything around the temporary ones."""
CODES_FOR_EVER = (0xA0, 0xA1, 0xA2, 0xA7, 0xB5, 0xC3)
BUSY_SCANS = (0, 1, 2, 3, 7, 20, 120)
CLOCK_END = 2**31
ALWAYS = 10**6


def temporary(code: int, *, write: bool) -> bool:
    """Whether docs/generated-code.md calls an Error_Code_1 temporary: a retry of the same call."""
    return 0xA2 <= code <= 0xA4 or code in {0xA7, 0xB5} or 0xC0 <= code <= 0xC6 or (write and code == 0xA1)


def ends(job: DriveJob) -> tuple[int, ...]:
    """The first and the last telegram of a job."""
    return tuple(sorted({1, len(job.telegrams)}))


def record_scenarios(job: DriveJob, limits: TimeLimits) -> Iterator[DriveScenario]:
    """Everything the record calls may do."""
    yield from _status_once(job, limits)
    yield from _status_always(limits)
    yield from _busy(job, limits)
    yield from _late(job, limits)
    yield from _stale(job, limits)


def _status_once(job: DriveJob, limits: TimeLimits) -> Iterator[DriveScenario]:
    for number in ends(job):
        for code in CODES:
            for base, name in ((WRITE, "WRREC"), (READ, "RDREC"), (LOCAL, "WRREC locally"), (LOCAL, "RDREC locally")):
                if base == LOCAL and (number > 1 or not temporary(code, write=name[0] == "W")):
                    continue
                yield _once(name, base | code << 8, number, job, limits)
    for decode in range(0x81, 0x90):
        for base, name in ((0xDF000000, "WRREC"), (0xDE000000, "RDREC")):
            for code in (0xA0, 0xA7):
                yield _once(name, base | decode << 16 | code << 8, 1, job, limits)


def _once(name: str, status: int, number: int, job: DriveJob, limits: TimeLimits) -> DriveScenario:
    """One STATUS on the call of one telegram."""
    total = len(job.telegrams)
    title = f"{name} of telegram {number} ends with {status:08X}"
    writing = name[0] == "W"
    script = {"writes" if writing else "reads": {number: status}}
    dpv1 = status & 0x00FF0000 == 0x00800000
    again = dpv1 and not writing and status & 0x0000FF00 == 0xA000
    if again or (dpv1 and temporary(status >> 8 & 0xFF, write=writing)):
        retries = 1 if number == total else 0
        calls = (1 if writing or again else 0, 0 if writing else 1)
        expected = limits.after(1, total, retries=retries, calls=calls)
        return DriveScenario(name=title, follow=False, **expected, **script)  # type: ignore[arg-type]
    word = WORDS["WRITE_ERROR" if writing else "READ_ERROR"]
    calls = (0, -1 if writing else 0)
    return DriveScenario(name=title, status=(word,), telegram=number, calls=calls, **script)  # type: ignore[arg-type]


def _status_always(limits: TimeLimits) -> Iterator[DriveScenario]:
    for code in CODES_FOR_EVER:
        for base, name in ((WRITE, "WRREC"), (READ, "RDREC")):
            writing = name[0] == "W"
            again = not writing and code == 0xA0
            if not temporary(code, write=writing) and not again:
                continue
            script = {"writes" if writing else "reads": {0: base | code << 8}}
            results = limits.repeated(1, 4 if again else 1)
            retries = limits.retries if results == (WORDS["RETRIES"],) else None
            yield DriveScenario(
                name=f"{name} always ends with {base | code << 8:08X}",
                status=results,
                scan=1,
                busy=(0, 0),
                retries=retries,
                telegram=1,
                calls=None,
                **script,  # type: ignore[arg-type]
            )
    scan = max(20, limits.timeout // 500)
    slow = max(1, ceil((limits.timeout / max(limits.retries, 1) - limits.pause) / scan) + 3)
    step = max(1, limits.pause // 20)
    if limits.retries and limits.timeout > limits.pause + 20 * step:
        yield DriveScenario(
            name="TIMEOUT in the pause after a late error",
            status=(WORDS["TIMEOUT"],),
            writes={1: 0xDF80C300},
            busy=((limits.timeout - limits.pause // 2) // step - 4, 0),
            scan=step,
            took=(limits.timed_out(step),) * 2,
            retries=1,
            telegram=1,
            calls=(0, -1),
        )
    if not limits.retries or slow * scan > limits.drain // 2:
        return
    for script in ({"writes": {0: 0xDF80C300}}, {"reads": {0: STATE_CONFLICT}}):
        yield DriveScenario(
            name=f"{'WRREC' if 'writes' in script else 'RDREC'} always ends with a temporary error on a slow bus",
            status=(WORDS["TIMEOUT"],),
            busy=(slow, slow),
            scan=scan,
            took=(limits.timeout, limits.timed_out(scan) + (slow + 4) * scan),
            retries=None,
            telegram=1,
            calls=None,
            **script,  # type: ignore[arg-type]
        )


def _busy(job: DriveJob, limits: TimeLimits) -> Iterator[DriveScenario]:
    tries = len(job.telegrams)
    for scans in BUSY_SCANS:
        if (scans + 10) * 10 * tries * 2 > limits.timeout:
            continue
        yield DriveScenario(name=f"WRREC busy for {scans} scans", busy=(scans, 0), follow=False)
        yield DriveScenario(name=f"RDREC busy for {scans} scans", busy=(0, scans), follow=False)
    scan = limits.even(max(50, limits.timeout // 200))
    long = ceil((limits.timeout + 1000) / scan)
    for_ever = ceil((limits.timeout + limits.drain + 2000) / scan)
    timeout, drained = limits.timeout, limits.drained(scan)
    for write, name in ((True, "WRREC"), (False, "RDREC")):
        yield DriveScenario(
            name=f"{name} busy beyond TIMEOUT",
            status=(WORDS["TIMEOUT"],),
            busy=(long, 0) if write else (0, long),
            scan=scan,
            took=(timeout + 1000, timeout + 1000 + 10 * scan),
            telegram=1,
            calls=(0, -1) if write else (0, 0),
        )
        for clock in (None, CLOCK_END - timeout - 2000, CLOCK_END - 3000):
            yield DriveScenario(
                name=f"{name} busy forever"
                + ("" if clock is None else f", the clock wraps after {CLOCK_END - clock} ms"),
                status=(WORDS["DRAIN_TIMEOUT"],),
                busy=(for_ever, 0) if write else (0, for_ever),
                scan=scan,
                took=(drained, drained),
                telegram=1,
                calls=(-1, -1) if write else (0, -1),
                clock=clock,
                leftover=True,
            )


def _late(job: DriveJob, limits: TimeLimits) -> Iterator[DriveScenario]:
    total = len(job.telegrams)
    for late in (25, 350, 2000):
        if limits.fits(ceil(late / limits.pause) * total, total) and late < limits.retries * limits.pause:
            yield DriveScenario(name=f"answer after {late} ms", processing=late, retries=None, calls=None, follow=False)
    once = {"busy": (0, 0), "telegram": 1, "calls": None}
    for name, silent, late in (("drive silent", True, 0), ("answer after TIMEOUT", False, limits.timeout + 500)):
        results = limits.repeated(10, 1)
        left = late - limits.retries * limits.pause
        yield DriveScenario(
            name=name,
            follow=limits.fits(max(0, ceil(left / limits.pause)) + 2, total) if late else True,
            status=results,
            silent=silent,
            processing=late,
            retries=limits.retries if results == (WORDS["RETRIES"],) else None,
            **once,  # type: ignore[arg-type]
        )


def _stale(job: DriveJob, limits: TimeLimits) -> Iterator[DriveScenario]:
    total = len(job.telegrams)
    for number in ends(job):
        for count in (1, 3):
            yield DriveScenario(
                name=f"{count} old answers before that of telegram {number}",
                stale=range(number, number + count),
                follow=False,
                **limits.after(count, total, retries=count if number == total else 0, calls=(0, count)),
            )
    results = limits.repeated(10, 2)
    yield DriveScenario(
        name="old answers forever",
        status=results,
        stale=range(1, ALWAYS),
        busy=(0, 0),
        retries=limits.retries if results == (WORDS["RETRIES"],) else None,
        telegram=1,
        calls=None,
    )


# --- the CPU ----------------------------------------------------------------------------------------------


def cpu_scenarios(job: DriveJob, limits: TimeLimits, scans: int, *, retentive: bool) -> Iterator[DriveScenario]:
    """What the CPU and its program may do.

    ``scans`` is how long a good run takes, ``retentive`` says that instances keep their values at a warm restart.
    """
    total = len(job.telegrams)
    loose = {"retries": None, "telegram": None, "calls": None}
    lost = limits.after(1, total, least=0, **loose)
    pause = limits.pause // 10 + 4
    for at in range(2, scans + 1):
        yield DriveScenario(name=f"execute falls before scan {at}", happens={at: "drop"}, follow=False)
    for kind in ("cold", "warm"):
        for at in range(2, scans + 1):
            happens: dict[int, str] = {at: "cold" if kind == "cold" else "warm"}
            yield DriveScenario(name=f"{kind} restart before scan {at}", happens=happens, **lost)
        for at in range(5, 8 + pause, 3):
            happens = {at: "cold" if kind == "cold" else "warm"}
            yield DriveScenario(
                name=f"{kind} restart before scan {at} of a job with a retry",
                happens=happens,
                reads={1: STATE_CONFLICT},
                **limits.after(2, total, least=0, **loose),
            )
    long = ceil((limits.timeout + 2000) / 50)
    for busy in ((long, 0), (0, long)) if retentive else ():
        yield DriveScenario(
            name=f"warm restart while {'WRREC' if busy[0] else 'RDREC'} is drained",
            status=(WORDS["TIMEOUT"],),
            busy=busy,
            scan=50,
            happens={limits.timeout // 50 + 10: "warm"},
            **loose,  # type: ignore[arg-type]
        )
    for at in range(3, scans) if retentive else ():
        yield DriveScenario(
            name=f"warm restart before scan {at}, the clock starts again",
            status=(WORDS["TIMEOUT"],),
            happens={at: "reset"},
            **loose,  # type: ignore[arg-type]
        )
    for at in range(5, scans):
        yield DriveScenario(name=f"the record call is lost before scan {at}", happens={at: "lost"}, busy=(2, 2), **lost)
    options = (400, 150, 0)
    for number in range(6) if limits.fits(0, 3 * total) else ():
        yield DriveScenario(
            name=f"scans of random length {number}",
            jitter=True,
            busy=(number, 5 - number),
            processing=next(
                late for late in options[number % 3 :] if limits.fits(3 * total * ceil(late / limits.pause), 3 * total)
            ),
            retries=None,
            calls=None,
            follow=False,
        )
    yield from _owner(limits, scans)
    yield from _clock(limits, total)


def _owner(limits: TimeLimits, scans: int) -> Iterator[DriveScenario]:
    loose = {"retries": None, "telegram": None, "calls": None}
    none = {"telegram": 1, "calls": (-1, -1)}
    if limits.fits(0, 3):
        yield DriveScenario(name="the drive is busy with another job", owner=Foreign(20, leaves=True))
    yield DriveScenario(
        name="another job keeps the drive",
        status=(WORDS["DRIVE_OCCUPIED"],),
        owner=Foreign(ALWAYS),
        scan=50,
        took=(limits.timed_out(50), limits.timed_out(50)),
        **none,  # type: ignore[arg-type]
    )
    if limits.timeout <= limits.lease + 500 + 10 * scans:
        early = limits.timeout <= limits.lease
        yield DriveScenario(
            name="the owner of the drive is not called any more, TIMEOUT comes at the same time",
            status=tuple(WORDS[w] for w in (("DRIVE_OCCUPIED",) if early else ("DRIVE_OCCUPIED", "TIMEOUT", "DONE"))),
            owner=Foreign(8),
            **loose,  # type: ignore[arg-type]
        )
    else:
        for clock in (None, CLOCK_END - 1000):
            yield DriveScenario(
                name="the owner of the drive is not called any more" + ("" if clock is None else ", the clock wraps"),
                owner=Foreign(8),
                took=(limits.lease + 70, limits.lease + 70 + (scans + 8) * 10),
                clock=clock,
            )
    if limits.timeout > limits.lease + 2500 + 10 * scans:
        yield DriveScenario(
            name="a dead owner of the drive is followed by another one",
            owner=Foreign(8, follows=200),
            took=(limits.lease + 1990, limits.lease + 1990 + (scans + 8) * 10),
        )
        yield DriveScenario(
            name="the drive is taken away between claim and confirmation",
            happens={2: "steal"},
            took=(limits.lease, limits.lease + (scans + 8) * 10),
        )
        yield DriveScenario(name="not called for a while", happens={5: "away"}, **loose)  # type: ignore[arg-type]
    for at in range(3, scans):
        yield DriveScenario(
            name=f"another job takes the drive before scan {at}",
            status=(WORDS["DRIVE_LOST"],),
            happens={at: "steal"},
            **loose,  # type: ignore[arg-type]
        )
    yield DriveScenario(name="another job takes the drive at the end", happens={scans: "steal"})


def _clock(limits: TimeLimits, total: int) -> Iterator[DriveScenario]:
    for before in (15, 60, 150):
        yield DriveScenario(
            name=f"the clock wraps after {before} ms",
            reads={1: STATE_CONFLICT},
            clock=CLOCK_END - before,
            **limits.after(1, total, retries=None, calls=(0, 1)),
        )
    for beat in (0, 29_995, 29_998, 30_000, 30_001, 32_767):
        yield DriveScenario(name=f"heartbeat starts at {beat}", heartbeat=beat, follow=False)
    for reference in (0, 1, 126, 127, 128, 253, 254, 255, 256, 1000, -1, -300):
        yield DriveScenario(name=f"last reference was {reference}", reference=reference, follow=False)
