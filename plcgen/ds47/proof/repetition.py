"""What a job with a cycle does behind the end of its first run, call by call."""

from __future__ import annotations

from collections.abc import Iterator

from plcgen.ds47.proof.cycles import AGE, SINCE, SLOW, Repeats, oldest_valid, slow_scan
from plcgen.ds47.proof.rig import WAIT_LIMIT_MS, JobRig
from plcgen.ds47.proof.scenario import DriveScenario
from plcgen.proof.runner import Run
from plcgen.proof.scenario import IDLE, ScenarioError

LOST_CALLS = 3
"""So many calls do not count when the clock of a block on S7-1200/1500 starts over, once in ``HOUR_MS``."""
CALLS = 2
"""In so many calls the next run starts: the one in which the cycle is over, and the one behind it."""
FINE, LONGEST_MS = 40, 1000
"""So many calls are in a cycle, none of them longer."""
HOUR_MS = 3_600_000
SCAN_MS = 10
TURN = 2
"""Calls in which a channel takes the unit from one job and gives it to the next."""
MANY_CALLS = 20_000


class Repetition:
    """What goes on behind the end of the first run of a job, call by call; ``begun`` is when that run started."""

    def __init__(self, rig: JobRig, run: Run[DriveScenario], begun: int) -> None:
        self.rig, self.run, self.begun, self.good = rig, run, begun, begun
        self.length = max(1, min(LONGEST_MS, rig.job.cycle // FINE))
        self.values = rig.delivered()

    def go(self) -> None:
        """As the scenario says. Raises ScenarioError."""
        asked, rig = self.run.scenario.of(Repeats), self.rig
        self.check_age()
        if asked.given_up:
            rig.give_up()
        if asked.taken:
            if asked.late:
                self.almost()
            self.another_job(asked.taken, short=0 if asked.late else TURN)
        elif asked.goes_on:
            self.ends(self.next_start())
        if asked.away:
            self.away()
        if asked.stopped:
            self.stopped()

    def call(self, *, execute: bool = True, length: int = 0) -> None:
        """One call, behind which the age is right."""
        self.run.execute = execute
        self.run.call(length or self.length)
        self.run.no_misuse()
        self.check_age()

    def check_age(self) -> None:
        """Age and valid, which are outputs."""
        rig = self.rig
        found = rig.db.get(AGE[1]), bool(rig.db.flag(AGE[0]))
        if self.run.seen[1]:
            self.good = self.begun
        age = rig.cpu.clock - self.good
        if not age - self.lost() <= found[0] <= age:
            raise ScenarioError(f"age is {found[0]} ms instead of {age}")
        if found[1] != (found[0] <= oldest_valid(rig.job)):
            raise ScenarioError(f"valid is {found[1]} while the values are {found[0]} ms old")

    def lost(self) -> int:
        """Time in ms that may not have counted since the last good start."""
        scenario = self.run.scenario
        slow = slow_scan(self.rig.job, waits=scenario.occupied > 0) if scenario.of(Repeats).slow else 0
        return self.length * LOST_CALLS * (1 + (self.rig.cpu.clock - self.good) // HOUR_MS) + len(SLOW) * slow

    def calls(self) -> Iterator[int]:
        """Calls while a result stays; yields the time since the start of the last run."""
        result = self.run.seen
        for _ in range(MANY_CALLS):
            self.call()
            yield self.rig.cpu.clock - self.begun
            if self.run.seen[0]:
                return
            if self.run.seen not in {result, (False, False, False, IDLE)}:
                raise ScenarioError(f"the result does not stay until the next run: {self.run.seen}")
        raise ScenarioError("there is no other run")

    def next_start(self) -> int:
        """Until the next run starts, when the cycle is over and the last run too; when that is."""
        due, passed = max(self.rig.job.cycle, self.rig.cpu.clock - self.begun), 0
        for passed in self.calls():
            if passed > due + CALLS * self.length + self.lost():
                break
        if not self.run.seen[0] or passed < due:
            raise ScenarioError(f"the next run does not start {due} ms after the last one, but at {passed} ms")
        return self.rig.cpu.clock

    def ends(self, begun: int, *, well: bool = True) -> None:
        """A run that has started ends, with its values or without."""
        self.begun = begun
        for _ in range(MANY_CALLS):
            if not self.run.seen[0]:
                break
            self.call(length=SCAN_MS)
        if self.run.seen[1] is not well or self.run.seen[2] is well:
            raise ScenarioError(f"another run ends with 16#{self.run.seen[-1]:04X}")
        if self.rig.delivered() != self.values:
            raise ScenarioError("another run has other values, though the drive has the same")

    def almost(self) -> None:
        """Until the cycle is over in the next call."""
        while self.rig.db.get(SINCE) + self.length < self.rig.job.cycle:
            self.call()

    def another_job(self, taken: int, short: int) -> None:
        """Another job gets the unit, in so many ``short`` calls, and keeps it: it goes first, for one cycle."""
        rig, cycle, sent, calls = self.rig, self.rig.job.cycle, len(self.rig.drive.journal), 0
        left = max(self.begun + cycle, rig.cpu.clock) + taken
        last = max(self.begun + 2 * cycle, rig.cpu.clock)
        rig.take()
        rig.channel.set("waitLimit", WAIT_LIMIT_MS)  # one call may take longer than the short limit
        while rig.cpu.clock < left and not self.run.seen[0]:
            calls += 1
            self.call(length=SCAN_MS if calls <= short else 0)
            rig.alive()
        started = rig.cpu.clock if self.run.seen[0] else 0
        latest = last + CALLS * self.length + self.lost()
        if started and not self.begun + 2 * cycle <= started <= latest:
            passed = started - self.begun
            raise ScenarioError(f"it starts {passed} ms after the last run, while another job has the unit")
        if not started and rig.cpu.clock > latest:
            raise ScenarioError(f"it lets another job go first for {rig.cpu.clock - self.begun} ms")
        if len(rig.drive.journal) > sent:
            raise ScenarioError("it sends something while another job has the unit")
        rig.leave()
        self.run.seen = self.run.signals()
        for _ in range(CALLS + TURN):
            if self.run.seen[0]:
                break
            self.call(length=SCAN_MS)
        if not self.run.seen[0]:
            raise ScenarioError("it does not start although nobody has the unit any more")
        self.ends(started or rig.cpu.clock)

    def away(self) -> None:
        """The drive is gone: the values stay, and are not valid when they are old; then it is there again."""
        rig = self.rig
        there = rig.bus.drives.pop(rig.id_value)
        for _ in range(MANY_CALLS):
            self.ends(self.next_start(), well=False)
            if not rig.db.flag("valid"):
                break
        rig.bus.drives[rig.id_value] = there
        self.ends(self.next_start())

    def stopped(self) -> None:
        """Without execute it does not run, and the values get old."""
        rig = self.rig
        sent = len(rig.drive.journal)
        for _ in range(2 * FINE):
            self.call(execute=False)
            if self.run.seen != (False, False, False, IDLE) or len(rig.drive.journal) > sent:
                raise ScenarioError("it runs although execute is FALSE")
        if rig.delivered() != self.values:
            raise ScenarioError("the values do not stay while it is stopped")
