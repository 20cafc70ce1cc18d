"""Scenarios: what the module of a PPI master can do wrong."""

from __future__ import annotations

from collections.abc import Iterator

from plcgen.ppi.plan.nouns import PlannedMaster, PpiJob
from plcgen.ppi.proof.scenario import LOST_SCANS, PpiScenario, fault
from plcgen.ppi.proof.words import CLOCK_END, CP_RESET_CALLS, DONE, DRAIN_MS, WORDS

RECEIVE_FAULT = {"RECEIVE_P2P": 0x80E1, "P_RCV_RK": 0x080C}
"""STATUS of a parity error: TIA Portal information system, "Error messages"; CP 341, event class 8."""


def module_scenarios(master: PlannedMaster, job: PpiJob, *, classic: bool) -> Iterator[PpiScenario]:
    """Everything a module can do wrong."""
    most = master.retries
    for transmission, at in ((1, "request"), (2, "poll")):
        yield PpiScenario(
            name=f"sending of the {at} fails once",
            port={transmission: 0x80D1},
            module=0x80D1,
            status=(DONE,) if most else (WORDS["SEND_ERROR"],),
            retries=min(1, most),
            polls=1 if most or at == "poll" else 0,
        )
    first = 3 if most else 2  # noise in front of E5 costs a repetition, or is taken for one
    yield PpiScenario(
        name="noise before E5, then sending of the poll fails forever",
        faults=(fault("noise", "request"),),
        port=dict.fromkeys(range(first, first + max(1, most)), 0x80D1),
        module=0x80D1,
        status=(WORDS["SEND_ERROR"],),
        retries=most,
    )
    yield PpiScenario(
        name="sending fails forever",
        port={0: 0x80D1},
        status=(WORDS["SEND_ERROR"],),
        retries=most,
        polls=0,
        module=0x80D1,
    )
    word = "SEND_ERROR" if classic else "CONFIG_ERROR"
    yield PpiScenario(
        name="module missing", gone=True, status=(WORDS[word],), retries=None, polls=0, fresh=True,
        module=0x1E0E if classic else 0x8080,
    )  # fmt: skip
    if not classic:
        yield from _settings(most)
    yield from hangs(master, job, classic=classic)
    deaf = RECEIVE_FAULT["P_RCV_RK" if classic else "RECEIVE_P2P"]
    yield PpiScenario(
        name="receiving fails", refusals={"P_RCV_RK" if classic else "RECEIVE_P2P": deaf},
        status=(WORDS["NO_ANSWER"],), retries=most, polls=0, module=deaf,
    )  # fmt: skip
    if classic:
        yield PpiScenario(
            name="module hangs, and RESET too",
            hang=True,
            stuck=True,
            status=(WORDS["DRAIN_TIMEOUT"],),
            polls=0,
            took=(job.timeout + DRAIN_MS, job.timeout + DRAIN_MS + 50),
        )
        yield _failed(most)
        yield PpiScenario(
            name="a timeout before the first frame", happens={2: "jump"}, status=(WORDS["TIMEOUT"],), polls=0
        )


def _failed(most: int) -> PpiScenario:
    """A failure whose repetitions the next job must not show."""
    return PpiScenario(
        name="sending fails forever, and another job after it", port={0: 0x80D1}, status=(WORDS["SEND_ERROR"],),
        retries=most, polls=0, module=0x80D1, follow=False,
    )  # fmt: skip


def _settings(most: int) -> Iterator[PpiScenario]:
    yield PpiScenario(
        name="the module forgets its settings", forgets=True, status=(WORDS["NO_ANSWER"],), retries=most, polls=0
    )
    for block, fresh in (("Port_Config", True), ("Receive_Config", True), ("Receive_Reset", False)):
        refused = 0x81C1 if block == "Receive_Config" else 0x81A1
        yield PpiScenario(
            name=f"{block} fails", refusals={block.upper(): refused}, fresh=fresh,
            status=(WORDS["CONFIG_ERROR"],), polls=0, retries=None, module=refused,
        )  # fmt: skip
    yield _failed(most)
    yield PpiScenario(
        name="Port_Config fails after a failure", refusals={"PORT_CONFIG": 0x81A1},
        status=(WORDS["CONFIG_ERROR"],), polls=0, module=0x81A1,
    )  # fmt: skip


def hangs(master: PlannedMaster, job: PpiJob, *, classic: bool) -> Iterator[PpiScenario]:
    """A module that never ends: every job has a timeout of its own, also across the end of the clock."""
    for clock in (None, CLOCK_END - job.timeout // 2):
        # a clock that is 2 ms wrong behind its end shows if so little is missing from a scan to the timeout
        steps = (n for n in (9, 7, 6, 3) if job.timeout % n in {1, 2} and n <= master.ob1_cycle)
        scan = next(steps, 2) if clock and classic else 10
        scan = min(scan, master.ob1_cycle)
        begun = scan * (1 - (-job.timeout // scan))  # the job starts in the first scan
        end = begun + (scan * CP_RESET_CALLS if classic else scan * -(-DRAIN_MS // scan))
        late = LOST_SCANS * scan if clock and not classic else 0
        yield PpiScenario(
            name=f"module hangs{', the clock starts again' if clock else ''}",
            hang=True,
            status=(WORDS["TIMEOUT"] if classic else WORDS["DRAIN_TIMEOUT"],),
            polls=0,
            clock=clock,
            scan=scan,
            took=(end, end + late),
        )
