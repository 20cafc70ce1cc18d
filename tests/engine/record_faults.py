"""Scenarios of the record calls and the CPU: STATUS, busy, late, lost, old answers, restart, execute, clock."""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from typing import Any

from plcgen.ds47.proof.words import DONE, DRAIN_MS, SHORT_PAUSES, STEP_MS, WORDS
from tests.engine.errands import Errand
from tests.engine.partner import STATE_CONFLICT
from tests.engine.scenario import CALLS, RETRIES, EngineScenario

WRITE, READ, LOCAL = 0xDF800000, 0xDE800000, 0xC0800000
CODES = (*range(0x90, 0x93), *range(0xA0, 0xD0), 0xFF)
"""Values of Error_Code_1: everything around the temporary ones."""
BUSY_SCANS = (0, 1, 2, 3, 7, 20, 120)
CLOCK_END = 2**31
ALWAYS = range(1, 10**6)
LOOSE: dict[str, Any] = {"retries": None, "telegram": None, "calls": None}
NOT_SENT: dict[str, Any] = {"telegram": 1, "calls": None, "retries": None}
RESOURCES = 0xC3
"""The CPU is busy with other record jobs: it is no retry."""


def temporary(code: int, *, write: bool) -> bool:
    """Whether docs/generated-code.md calls an Error_Code_1 temporary: a retry of the same call."""
    return 0xA2 <= code <= 0xA4 or code in {0xA7, 0xB5} or 0xC0 <= code <= 0xC6 or (write and code == 0xA1)


def outer_telegrams(errand: Errand) -> tuple[int, ...]:
    """The first and the last telegram of a job."""
    return tuple(sorted({1, len(errand.letters)}))


def record_faults(errand: Errand) -> Iterator[EngineScenario]:
    """Everything the record calls may do."""
    yield from _status_once(errand)
    yield from _status_always(errand)
    yield from _busy()
    yield from _late(errand)
    yield from _lost(errand)
    yield from _old(errand)


def _status_once(errand: Errand) -> Iterator[EngineScenario]:
    for number in outer_telegrams(errand):
        for code in CODES:
            for base, name in ((WRITE, "WRREC"), (READ, "RDREC"), (LOCAL, "WRREC locally"), (LOCAL, "RDREC locally")):
                if base == LOCAL and (number > 1 or not temporary(code, write=name[0] == "W")):
                    continue
                yield _once(name, base | code << 8, number, errand)
    for decode in range(0x81, 0x90):
        for base, name in ((0xDF000000, "WRREC"), (0xDE000000, "RDREC")):
            for code in (0xA0, 0xA7):
                yield _once(name, base | decode << 16 | code << 8, 1, errand)


def _once(name: str, status: int, number: int, errand: Errand) -> EngineScenario:
    """One STATUS on the call of one telegram."""
    total = len(errand.letters)
    title = f"{name} of telegram {number} ends with {status:08X}"
    writing = name[0] == "W"
    script: dict[str, Any] = {"writes" if writing else "reads": {number: status}}
    dpv1, code = status & 0x00FF0000 == 0x00800000, status >> 8 & 0xFF
    last = number == total
    if dpv1 and not writing and code == 0xA0:
        return _lost_once(errand, title, number, retries=int(last and not errand.once), calls=(1, 1), **script)
    if dpv1 and temporary(code, write=writing):
        retries = 1 if last and code != RESOURCES else 0
        calls = (1 if writing else 0, 0 if writing else 1)
        return EngineScenario(name=title, follow=False, retries=retries, calls=calls, **script)
    word = WORDS["WRITE_ERROR" if writing else "READ_ERROR"]
    calls = (0, -1 if writing else 0)
    return EngineScenario(name=title, status=(word,), telegram=number, calls=calls, **script)


def _lost_once(errand: Errand, name: str, number: int, **more: Any) -> EngineScenario:
    """A request that gets lost is built again, but for a trigger."""
    if errand.once:
        more = {"retries": 0, **more, "calls": None, "telegram": number, "status": (WORDS["UNKNOWN"],)}
        return EngineScenario(name=name, again=0, **more)
    return EngineScenario(name=name, again=1, follow=False, **more)


def _status_always(errand: Errand) -> Iterator[EngineScenario]:
    # ten retries of 200 ms and a few scans each: the first try and ten more
    # B5: 0 + 20 + 50 + 100 ms are less than one pause, and ten more of 200 ms reach 10 x 200 ms
    for code in (0xA1, 0xA2, 0xA7, 0xB5, 0xC0, 0xC6):
        times = RETRIES + len(SHORT_PAUSES) if code == 0xB5 else RETRIES
        yield EngineScenario(
            name=f"WRREC always ends with DF80{code:02X}00",
            status=(WORDS["RETRIES"],),
            writes={0: WRITE | code << 8},
            retries=times,
            telegram=1,
            calls=(times, -1),
            took=(2000, 2700),
        )
    # no pause is longer than that of the job: 0 + 20 ms, then 30 ms, of which ten more reach 10 x 30 ms
    yield EngineScenario(
        name="WRREC always ends with DF80B500, pauses of 30 ms",
        status=(WORDS["RETRIES"],),
        writes={0: WRITE | 0xB500},
        pause=30,
        retries=RETRIES + 2,
        telegram=1,
        calls=(RETRIES + 2, -1),
        took=(300, 900),
    )
    for code in (0xA2, 0xA7, 0xC0, 0xC6):
        yield EngineScenario(
            name=f"RDREC always ends with DE80{code:02X}00",
            status=(WORDS["RETRIES"],),
            reads={0: READ | code << 8},
            retries=RETRIES,
            telegram=1,
            calls=(0, RETRIES),
            took=(2000, 2600),
        )
    if not errand.once:
        yield EngineScenario(
            name="RDREC always ends with DE80A000: every try is a new request",
            status=(WORDS["RETRIES"],),
            reads={0: READ | 0xA000},
            retries=RETRIES,
            telegram=1,
            calls=(RETRIES, RETRIES),
            again=RETRIES,
            took=(2000, 3000),
        )
    yield from _no_resources()
    yield from _no_answer_yet(errand)


def _no_resources() -> Iterator[EngineScenario]:
    # no retry is counted: 9000 ms end it, in the first call in which they are over
    for base, name in ((WRITE, "WRREC"), (READ, "RDREC"), (LOCAL, "WRREC locally")):
        script: dict[str, Any] = {"reads" if name == "RDREC" else "writes": {0: base | RESOURCES << 8}}
        yield EngineScenario(
            name=f"{name} always ends with {base | RESOURCES << 8:08X}: no retry is counted",
            status=(WORDS["TIMEOUT"], WORDS["NO_PLACE"]),
            took=(9000, 9060),
            **NOT_SENT,
            **script,
        )
        for times in (RETRIES + 1, 3 * RETRIES):
            few: dict[str, Any] = {key: dict.fromkeys(range(1, times + 1), v[0]) for key, v in script.items()}
            yield EngineScenario(
                name=f"{name} ends {times} times so", calls=(times, 0) if name[0] == "W" else (0, times), **few
            )


def _no_answer_yet(errand: Errand) -> Iterator[EngineScenario]:
    for times in (1, 3, RETRIES):
        count = times if len(errand.letters) == 1 else 0
        yield EngineScenario(
            name=f"{times} times no answer yet",
            reads=dict.fromkeys(range(1, times + 1), STATE_CONFLICT),
            retries=count,
            calls=(0, times),
        )
        yield EngineScenario(
            name=f"{times} times no answer yet, every call ends at once",
            reads=dict.fromkeys(range(1, times + 1), STATE_CONFLICT),
            busy=(0, 0),
            retries=count,
            calls=(0, times),
        )
    yield EngineScenario(
        name="no retries", status=(WORDS["RETRIES"],), reads={1: STATE_CONFLICT}, most=0, retries=0, telegram=1,
    )  # fmt: skip
    # 0, 20, 50 and 100 ms are 1 ms less than the pause, of which one may be used up: a fifth retry has all of it
    yield EngineScenario(
        name="short pauses are not quite a pause", status=(WORDS["RETRIES"],), reads={0: STATE_CONFLICT}, pause=171,
        most=1, retries=5, telegram=1, calls=None,
    )  # fmt: skip
    yield EngineScenario(name="no retries needed", most=0)
    # the pause of 8000 ms begins behind the first try: 1000 ms later the time is over
    yield EngineScenario(
        name="the time is over in a pause",
        status=(WORDS["TIMEOUT"],),
        writes={0: WRITE | 0xA700},
        pause=10_000,
        took=(9000, 9060),
        **NOT_SENT,
    )


def _busy() -> Iterator[EngineScenario]:
    for scans in BUSY_SCANS:
        yield EngineScenario(name=f"WRREC busy for {scans} scans", busy=(scans, 0), follow=False)
        yield EngineScenario(name=f"RDREC busy for {scans} scans", busy=(0, scans), follow=False)
    for write, name in ((True, "WRREC"), (False, "RDREC")):
        calls = (0, -1) if write else (0, 0)
        # 220 calls of 50 ms are 11,000 ms: the end comes when the record call does
        yield EngineScenario(
            name=f"{name} busy beyond the timeout",
            status=(WORDS["TIMEOUT"],),
            busy=(220, 0) if write else (0, 220),
            scan=50,
            took=(11_000, 11_600),
            telegram=1,
            calls=calls,
            again=None,
        )
        for clock in (None, CLOCK_END - 11_000, CLOCK_END - 3000):
            yield EngineScenario(
                name=f"{name} busy beyond DRAIN_LIMIT"
                + ("" if clock is None else f", the clock ends after {CLOCK_END - clock} ms"),
                status=(WORDS["DRAIN_TIMEOUT"],),
                busy=(320, 0) if write else (0, 320),
                scan=50,
                took=(9000 + DRAIN_MS, 9000 + DRAIN_MS + 200 + (0 if clock is None else 3 * STEP_MS)),
                telegram=1,
                calls=None,
                clock=clock,
                leftover=True,
            )


def _late(errand: Errand) -> Iterator[EngineScenario]:
    for late in (25, 350, 1500):
        yield EngineScenario(
            name=f"answer after {late} ms", processing=late, retries=None, calls=None, again=0, follow=False
        )
    # a third of the timeout without an answer, 3000 ms: the request counts as lost, as the next try notices
    word, took = ("UNKNOWN", (3000, 4000)) if errand.once else ("TIMEOUT", (9000, 9060))
    yield EngineScenario(
        name="the drive never answers", status=(WORDS[word],), swallowed=ALWAYS, telegram=1, calls=None, retries=None,
        most=40, pause=500, took=took, again=None,
    )  # fmt: skip


def _lost(errand: Errand) -> Iterator[EngineScenario]:
    """Never again blindly: what may be done twice is sent again and succeeds, a trigger never."""
    for number in outer_telegrams(errand):
        last = number == len(errand.letters)
        # answers of 500 ms of pause: six of them are B5 before 3000 ms are over, the seventh is the loss
        yield _lost_once(
            errand, f"the drive swallows request {number}", number,
            swallowed=range(number, number + 1), pause=500, most=20, retries=None, calls=None,
        )  # fmt: skip
        yield _lost_once(
            errand, f"the drive is switched off and on after request {number}", number,
            away=range(number, number + 1), pause=500, most=20, retries=None, calls=None,
        )  # fmt: skip
        retries = 1 if errand.once else 2 if last else 0
        yield _lost_once(
            errand, f"a foreign answer to request {number}, then none", number,
            reads={number: next_reference}, retries=retries, calls=(1, 2),
        )  # fmt: skip
    # each loss is noticed after a third of the timeout
    for times in (1, 2):
        if not errand.once:
            yield EngineScenario(
                name=f"{times} requests in a row are swallowed",
                swallowed=range(1, times + 1),
                timeout=30_000,
                pause=2500,
                most=40,
                again=times,
                calls=None,
                retries=None,
                follow=False,
            )


def next_reference(answer: bytes) -> bytes:
    """The answer to another request."""
    return bytes((answer[0] % 255 + 1,)) + answer[1:]


def _old(errand: Errand) -> Iterator[EngineScenario]:
    total = len(errand.letters)
    for number in outer_telegrams(errand):
        for count in (1, 3):
            yield EngineScenario(
                name=f"{count} old answers before that of telegram {number}",
                stale=range(number, number + count),
                follow=False,
                retries=count if number == total else 0,
                calls=(0, count),
            )
    if total > 1:
        yield EngineScenario(
            name="an old answer before that of telegram 1, no answer yet to telegram 2",
            stale=range(1, 2),
            reads={3: STATE_CONFLICT},
            follow=False,
            retries=1 if total == 2 else 0,
            calls=(0, 2),
        )
    yield EngineScenario(
        name="old answers forever",
        status=(WORDS["RETRIES"],),
        stale=ALWAYS,
        retries=RETRIES,
        telegram=1,
        calls=(0, RETRIES),
        took=(2000, 2800),
    )


# --- the CPU ----------------------------------------------------------------------------------------------


def cpu_faults(errand: Errand, scans: int) -> Iterator[EngineScenario]:
    """What the CPU and its program may do; ``scans`` is how long a good run takes."""
    done, unknown = (DONE,), (DONE, WORDS["UNKNOWN"])
    for at in range(2, scans + 1):
        yield EngineScenario(name=f"execute falls before scan {at}", happens={at: "drop"}, follow=False)
    for at in range(2, scans + 1):
        for kind in ("cold", "warm", "lost"):
            yield EngineScenario(
                name=f"{kind} before scan {at}", status=unknown if errand.once else done, happens={at: kind},
                again=None, follow=at % 3 == 0, **LOOSE,
            )  # fmt: skip
        yield EngineScenario(
            name=f"warm restart before scan {at}, the clock begins at 0", status=unknown if errand.once else done,
            happens={at: "warm", at + 1: "zero"}, again=None, follow=False, **LOOSE,
        )  # fmt: skip
        yield EngineScenario(
            name=f"warm restart before scan {at} of a job with busy calls", happens={at: "warm"}, busy=(3, 3),
            status=unknown if errand.once else done, again=None, follow=False, **LOOSE,
        )  # fmt: skip
    for at in range(8, 30, 3):
        for kind in ("cold", "warm"):
            yield EngineScenario(
                name=f"{kind} restart before scan {at} of a job with a retry", happens={at: kind},
                reads={1: STATE_CONFLICT}, status=unknown if errand.once else done, again=None, **LOOSE,
            )  # fmt: skip
    for busy in ((240, 0), (0, 240)):
        yield EngineScenario(
            name=f"warm restart while {'WRREC' if busy[0] else 'RDREC'} is drained",
            status=(WORDS["TIMEOUT"],), busy=busy, scan=50, happens={195: "warm"}, again=None, **LOOSE,
        )  # fmt: skip
    for number in range(6):
        yield EngineScenario(
            name=f"scans of random length {number}", jitter=True, busy=(number, 5 - number),
            processing=(400, 150, 0)[number % 3], retries=None, calls=None, follow=False,
        )  # fmt: skip
    for order in itertools.permutations(CALLS):
        yield EngineScenario(name=f"called in the order {order}", order=order)
        yield EngineScenario(
            name=f"retry in the order {order}", order=order, reads={1: STATE_CONFLICT}, calls=(0, 1), retries=None
        )
    yield from _clock()
    # B5 for a third of the timeout is a lost request
    ends_ = tuple(WORDS[word] for word in ("TIMEOUT", "NO_PLACE", *(["UNKNOWN"] if errand.once else [])))
    for late in range(0, 600, 10):  # in the first call in which the time is over, in whatever state it is
        yield EngineScenario(
            name=f"timeout of {late} ms", timeout=late, status=(*ends_, DONE), reads={1: STATE_CONFLICT}, again=None,
            follow=False, **LOOSE,
        )  # fmt: skip


def _clock() -> Iterator[EngineScenario]:
    for before in (15, 60, 150):
        yield EngineScenario(
            name=f"the clock ends after {before} ms", reads={1: STATE_CONFLICT}, clock=CLOCK_END - before,
            calls=(0, 1), retries=None,
        )  # fmt: skip
    # calls every 5000 ms count for 1000 ms each: 20 s and 5 s last for 25 of them
    yield EngineScenario(name="calls far apart", scan=5000, busy=(1, 1), timeout=20_000)
    yield EngineScenario(
        name="calls far apart, busy forever", scan=5000, busy=(60, 1), timeout=20_000,
        status=(WORDS["DRAIN_TIMEOUT"],), telegram=1, calls=None, took=(125_000, 135_000), leftover=True,
    )  # fmt: skip
