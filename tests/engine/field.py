"""Several jobs on one CPU: they are given errands, started, called from organization blocks, and held to the end."""

from __future__ import annotations

import random
from collections.abc import Iterable, Mapping, Sequence

from plcgen.ds47.proof.words import DONE, HOLD, state_name
from plcgen.proof.scenario import ScenarioError
from plcgen.s7.cpu.cpu import Misuse
from plcgen.s7.cpu.preemption import Plan
from tests.engine.errands import READ_SPLIT, WRITE_SPLIT, Errand, parameter_bytes
from tests.engine.rig import EngineRig, JobPlace
from tests.engine.scenario import PAUSE, RETRIES, TIMEOUT, EngineScenario
from tests.engine.sources import DriveEngine
from tests.engine.stimulus import FIRST_CHANNEL, FIRST_JOB, GATE

ALL = (GATE, FIRST_CHANNEL, FIRST_CHANNEL + 1, FIRST_CHANNEL + 2, *range(FIRST_JOB, FIRST_JOB + 5))
"""Everything, in the order in which a caller has it."""


class JobField:
    """A rig with jobs that were given something to do; ``place`` and ``scans`` are for a failure's message."""

    def __init__(
        self, engine: DriveEngine, errands: Sequence[Errand] = (READ_SPLIT, WRITE_SPLIT), job_limit: int | None = None
    ) -> None:
        self.rig = EngineRig(engine, errands, job_limit)
        self.cpu = self.rig.cpu
        self.draw = random.Random(1)  # test values
        self.rig.begin(EngineScenario(name="field"))
        self.sent: dict[int, list[bytes]] = {}
        self.granted: list[int] = []
        self.tolerated: tuple[str, ...] = ()

    @property
    def place(self) -> tuple[str, int]:
        """The channel."""
        return self.rig.place

    @property
    def scans(self) -> int:
        """Scans so far."""
        return self.rig.scans

    def job(self, number: int) -> JobPlace:
        """One of the five jobs, counted from 1."""
        return self.rig.jobs[number - 1]

    def give(
        self, number: int, errand: Errand, slot: int = 1, drive_object: int = 2, timeout: int = TIMEOUT
    ) -> JobPlace:
        """Tell a job what to do."""
        job = self.job(number)
        job.give(errand, drive_object)
        job.times(timeout, PAUSE, RETRIES)
        job.db.set("slot", slot)
        return job

    def start(self, *numbers: int) -> None:
        """Give jobs new values and the command."""
        for number in numbers:
            job = self.job(number)
            job.draw(self.draw)
            self.sent.setdefault(job.unit, []).extend(request[1:] for request in job.requests())
            job.db.set("execute", 1)

    def times_sent(self, number: int) -> int:
        """How often the drive has taken the first request of a job since its journal began."""
        job = self.job(number)
        journal = self.rig.drives[job.unit - 1].journal
        return [e.data[1:] for e in journal if e.direction == "write" and not e.status].count(job.requests()[0][1:])

    def drop(self, *numbers: int) -> None:
        """Take the commands away."""
        for number in numbers:
            self.job(number).db.set("execute", 0)

    def step(self, milliseconds: int = 10, plan: Plan | None = None, block: str = "OB1") -> None:
        """One scan of OB1, interrupted by a plan."""
        self.rig.scans += 1
        if plan is None:
            self.cpu.call(block, milliseconds)
        else:
            self.cpu.run(block, milliseconds, plan)
        self.check()

    def steps(self, scans: int, milliseconds: int = 10) -> None:
        """So many scans of OB1."""
        for _ in range(scans):
            self.step(milliseconds)

    def check(self) -> None:
        """Nothing happened that a CPU does not forgive."""
        misuses: list[Misuse] = [misuse for misuse in self.cpu.misuses if misuse.code not in self.tolerated]
        if misuses or self.cpu.faulted:
            raise ScenarioError(f"misuse {misuses[0] if misuses else ''}")
        self.cpu.misuses.clear()
        unit = self.rig.units[0]
        grant, state = unit.get("turn.grant"), unit.get("state")
        if grant and state < HOLD:
            raise ScenarioError(f"grant is {grant} in state {state_name(state)}")
        if grant and (not self.granted or self.granted[-1] != grant):
            self.granted.append(grant)

    def statuses(self, *numbers: int) -> dict[int, int]:
        """Status words of jobs."""
        return {number: self.job(number).signals()[3] for number in numbers}

    def until_end(self, numbers: Iterable[int], most: int = 30_000) -> dict[int, int]:
        """Scan until all of these jobs have ended; their status words. Raises ScenarioError if one has not in time."""
        ended: dict[int, int] = {}
        waiting = set(numbers)
        began = self.cpu.clock
        while waiting:
            self.step()
            for number in list(waiting):
                busy, done, error, status = self.job(number).signals()
                if not busy and (done or error or not self.job(number).db.flag("execute")):
                    ended[number] = status
                    waiting.discard(number)
            if waiting and self.cpu.clock - began > most:
                states = [unit.get("state") for unit in self.rig.units]
                raise ScenarioError(f"jobs {sorted(waiting)} have not ended within {most} ms, channels are in {states}")
        return ended

    def expect(self, found: Mapping[int, int], wanted: Mapping[int, Iterable[int]]) -> None:
        """Status words as wanted."""
        for number, words in wanted.items():
            if found.get(number) not in set(words):
                names = " or ".join(f"16#{word:04X}" for word in words)
                raise ScenarioError(f"job {number} ends with 16#{found.get(number, 0xFFFF):04X} instead of {names}")

    def done(self, *numbers: int, most: int = 30_000) -> None:
        """Scan until these jobs are done, with the right values."""
        self.expect(self.until_end(numbers, most=most), dict.fromkeys(numbers, (DONE,)))
        self.right(*numbers)

    def right(self, *numbers: int) -> None:
        """These jobs have what the drive has, or the drive has what they wrote."""
        for number in numbers:
            job = self.job(number)
            good = job.written() if job.errand is not None and job.errand.writes else job.has_read()
            if not good:
                raise ScenarioError(f"job {number} is done with wrong values")

    def wire(self) -> None:
        """Every request that reached a drive is one that a job of its unit was told to send."""
        for unit, drive in enumerate(self.rig.drives, 1):
            known = {*self.sent.get(unit, ())}
            for exchange in drive.journal:
                if exchange.direction == "write" and exchange.data[1:] not in known:
                    raise ScenarioError(f"unit {unit} was sent {exchange.data.hex(' ').upper()}")

    def idle(self, *numbers: int) -> None:
        """Commands fall; behind a few scans jobs and channels are idle."""
        self.drop(*numbers)
        self.steps(6)
        busy = [number for number in numbers if self.job(number).signals() != (False, False, False, 0x7000)]
        states = [unit.get("state") for unit in self.rig.units]
        if busy or any(states):
            raise ScenarioError(f"jobs {busy} are not idle, channels are in {states}")

    def again(self, *numbers: int, most: int = 30_000) -> None:
        """Once more: all of them must work."""
        self.drop(*numbers)
        self.steps(6)
        for drive in self.rig.drives:
            drive.journal.clear()
        self.start(*numbers)
        self.done(*numbers, most=most)
        self.idle(*numbers)


def same(before: Mapping[int, bytes], job: JobPlace) -> bool:
    """Whether every parameter of a job's drive holds what it held or what the job wrote."""
    parameters = job.rig.drives[job.unit - 1].objects[job.drive_object].parameters
    letters = job.errand.letters if job.errand is not None else ()
    wanted = {
        p.pnu: v for letter, vs in zip(letters, job.values, strict=True) for p, v in zip(letter.parts, vs, strict=True)
    }
    return all(parameter_bytes(p) in {before[pnu], wanted.get(pnu)} for pnu, p in parameters.items())
