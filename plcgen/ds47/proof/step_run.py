"""How far a run of a sequence has come: what it hands over, when its unit is free, what it says has failed."""

from __future__ import annotations

from collections.abc import Sequence

from plcgen.ds47.plan.nouns import DriveTelegram
from plcgen.ds47.proof.contents import told
from plcgen.ds47.proof.rig import JobRig
from plcgen.ds47.proof.scenario import DriveScenario
from plcgen.ds47.proof.step_facts import Steps
from plcgen.ds47.proof.words import DONE, IDLE, NO_ANSWER, WORDS
from plcgen.proof.scenario import ScenarioError


class StepRun:
    """How far a run of a sequence has come: ``handed`` telegrams of its route have been handed over."""

    def __init__(self, rig: JobRig, telegrams: Sequence[DriveTelegram], *, exact: bool) -> None:
        self.rig, self.telegrams, self.exact = rig, telegrams, exact
        self.handed = 0
        self.free: set[int] = set()
        """Behind which of them the unit was free while the job went on."""
        self._last = (0, 0)

    def number(self, found: bytes, requests: Sequence[bytes]) -> int:
        """Which one is handed over, from 1; where a restart may have come in between, what it looks like says so.

        Raises ScenarioError.
        """
        if not self.exact:
            same = [n for n, one in enumerate(requests, 1) if one[1:] == found[1 : len(one)]]
            number = next((n for n in same if n >= self.handed), same[0] if same else 1)
            self.handed = number
            return number
        now = self._now()
        if now != self._last:
            self._last = now
            self.handed += 1
        if self.handed > len(self.telegrams):
            raise ScenarioError(f"a telegram {self.handed} is handed over, the run has {len(self.telegrams)}")
        return self.handed

    def _now(self) -> tuple[int, int]:
        """The number under which the job asks, and the telegram that it has handed over in this turn."""
        return self.rig.unit.get("asks[1].want"), self.rig.telegram

    def observe(self, *, busy: bool) -> None:
        """Behind a call."""
        if busy and self.exact and self.handed and self.rig.unit.get("state") == IDLE:
            self.free.add(self.handed)

    def unanswered(self) -> int:
        """The first telegram that has not been answered yet, while the present one is on its way."""
        if not self.exact:
            return len(self.rig.job.telegrams) + 1
        if not self.handed:
            return 0
        asked = self.telegrams[self.handed - 1]
        repeated = self.handed > 1 and self.telegrams[self.handed - 2] is asked
        return asked.number + (repeated or self._now() != self._last)

    def check(self, scenario: DriveScenario, status: int) -> None:
        """The unit is given back between two questions, and only then; the job says what has failed.

        Raises ScenarioError.
        """
        found = self.rig.db.get("failedStep"), self.rig.db.get("failedParameter")
        if self.exact and not self.handed and found != (0, 0):
            raise ScenarioError(f"failedStep, failedParameter are {found} although no step was begun")
        if not self.exact or not scenario.checked:
            return
        pairs = zip(self.telegrams[: self.handed], self.telegrams[1 : self.handed], strict=False)
        again = {n for n, (one, other) in enumerate(pairs, 1) if one is other}
        again |= {self.handed} if status == WORDS["OCCUPIED"] and self.handed else set()
        if self.free != again:
            raise ScenarioError(f"the unit was free after telegrams {sorted(self.free)} instead of {sorted(again)}")
        if status == WORDS["NOT_REACHED"]:
            self._questions(scenario)
        step = self.telegrams[self.handed - 1].step if status != DONE and self.handed else 0
        wanted = step, scenario.of(Steps).missed or self._refused(scenario)
        if found != wanted:
            raise ScenarioError(f"failedStep, failedParameter are {found} instead of {wanted}")

    def _questions(self, scenario: DriveScenario) -> None:
        """The last question is the first one behind the limit."""
        asked = self.telegrams[self.handed - 1]
        if asked.number != scenario.telegram:
            raise ScenarioError(f"the job ends with telegram {asked.number} instead of {scenario.telegram}")

    def _refused(self, scenario: DriveScenario) -> int:
        """The first parameter with an error."""
        errors = sorted((place, error) for place, (error, _) in scenario.errors.items() if error not in {0, NO_ANSWER})
        if not errors:
            return 0
        (telegram, place), _ = errors[0]
        return self.rig.job.telegrams[telegram - 1].parts[place - 1].use.parameter.pnu

    def came(self, requests: Sequence[bytes], before: list[list[bytes]]) -> list[list[bytes]]:
        """The last good value of every part that is read, as the drive has answered; as before if there is none.

        A request that looks like the one before it and like the next one is the same again as long as nothing with its
        reference has come.
        """
        found = [list(parts) for parts in before]
        at, reference, open_ = -1, b"", False
        for exchange in (one for one in self.rig.drive.journal if not one.status):
            head, data = exchange.data[:1], exchange.data[1:]
            if exchange.direction == "write":
                again = open_ and data == requests[at][1:]
                if not again and at + 1 < len(requests) and data == requests[at + 1][1:]:
                    at += 1
                reference, open_ = head, True
                continue
            open_ = open_ and head != reference
            if at >= 0 and not self.telegrams[at].writes:
                for place, value in told(self.telegrams[at], exchange.data):
                    found[self.telegrams[at].number - 1][place] = value
        return found
