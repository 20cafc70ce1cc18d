"""Scenarios: what depends on a job itself, and one fault of each kind of the rest."""

from __future__ import annotations

from collections.abc import Iterator

from plcgen.ppi.plan.nouns import PlannedMaster, PpiJob
from plcgen.ppi.proof.module_scenarios import hangs
from plcgen.ppi.proof.reply_scenarios import ready, refusals, wrong_replies
from plcgen.ppi.proof.scenario import PpiScenario, fault, lost_once
from plcgen.ppi.proof.words import WORDS


def core_scenarios(master: PlannedMaster, job: PpiJob, scans: int, *, classic: bool) -> Iterator[PpiScenario]:
    """What depends on the job itself, and one fault of each kind of the rest."""
    yield PpiScenario(name="first job after power-up", fresh=True, retries=None, polls=None)
    for at, kind in (("request", "silence"), ("poll", "fcs"), ("poll", "silence")):
        once = fault(kind, "request" if at == "request" else "poll")
        yield PpiScenario(name=f"{kind} at the {at}", faults=(once,), **lost_once(master, polls=at == "poll"))
    dead = (fault("deaf", times=None),)
    yield PpiScenario(
        name="silence forever", faults=dead, status=(WORDS["NO_ANSWER"],), retries=master.retries, polls=0
    )
    yield from ready(master.polls)
    yield from refusals(job, every=False)
    yield from wrong_replies(job)
    yield from hangs(master, job, classic=classic)
    yield PpiScenario(name="execute dropped", happens={scans // 2: "drop"})
    yield PpiScenario(name="cold restart", happens={scans // 2: "cold"}, retries=None, polls=None)
    yield PpiScenario(name="scans of random length", wild=True, retries=None, polls=None)
