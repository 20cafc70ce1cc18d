"""What must hold of a sequence: which telegrams it hands over, when its unit is free, what has failed; by hand."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from plcgen.proof.scenario import ScenarioError
from plcgen.protocols.ds47.plan.nouns import DriveJob, DriveTelegram, Use
from plcgen.protocols.ds47.proof.scenario import DriveScenario
from plcgen.protocols.ds47.proof.words import DONE, IDLE, NO_ANSWER, WORDS
from plcgen.protocols.ds47.sim.drive import Drive
from plcgen.protocols.ds47.wire.formats import find, padded

if TYPE_CHECKING:
    from plcgen.protocols.ds47.proof.rig import JobRig

TRIGGERS = {15, 970, 971, 972, 973, 974, 976, 977, 3900, 3981}
"""What starts something when it is written, as docs/generated-code.md lists them."""
FAILED = ("failedStep", "failedParameter")
"""Of a sequence: which step has failed, and which parameter."""
ERROR = 0x44


def triggers(use: Use) -> bool:
    """Whether a use starts something."""
    return use.writes and use.parameter.pnu in TRIGGERS


def overwritten(job: DriveJob, use: Use) -> bool:
    """Whether a later step of a sequence writes the parameter too, or waits for another value of it."""
    later = (one for one in job.uses if one.step > use.step and one.parameter.pnu == use.parameter.pnu)
    return any(one.writes or one.awaited is not None for one in later)


def longest_waits(job: DriveJob) -> int:
    """Time in ms that the steps of a sequence may wait, their last questions and other jobs in between included."""
    found = [telegram.awaited for telegram in job.telegrams if telegram.awaited is not None]
    return sum(awaited.limit + 2 * awaited.interval + job.timeout for awaited in found)


def route(job: DriveJob, scenario: DriveScenario) -> list[DriveTelegram]:
    """The telegrams of a run in the order in which they are handed over; each once where a restart may come between."""
    if not job.in_steps:
        return list(job.telegrams) * scenario.rounds
    questions = scenario.questions if scenario.again is not None else {}
    return [one for one in job.telegrams for _ in range(questions.get(one.number, 1))]


def expect(drive: Drive, drive_object: int, telegram: DriveTelegram) -> None:
    """What a telegram waits for comes when it is asked, also if it is sent again or another one has waited before.

    The first value of a parameter comes first: others of the telegram follow in the order in which they are asked.
    """
    for part in reversed(telegram.parts):
        if part.use.awaited is not None:
            drive.objects[drive_object].parameters[part.use.parameter.pnu].expect(part.use)


class Course:
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
            expect(self.rig.drive, self.rig.drive_object, self.telegrams[number - 1])
            return number
        now = self._now()
        if now != self._last:
            self._last = now
            self.handed += 1
        if self.handed > len(self.telegrams):
            raise ScenarioError(f"a telegram {self.handed} is handed over, the run has {len(self.telegrams)}")
        expect(self.rig.drive, self.rig.drive_object, self.telegrams[self.handed - 1])
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
        if not self.exact or not scenario.checked:
            return
        pairs = zip(self.telegrams[: self.handed], self.telegrams[1 : self.handed], strict=False)
        again = {n for n, (one, other) in enumerate(pairs, 1) if one is other}
        again |= {self.handed} if status == WORDS["OCCUPIED"] and self.handed else set()
        if self.free != again:
            raise ScenarioError(f"the unit was free behind telegrams {sorted(self.free)} instead of {sorted(again)}")
        if status == WORDS["NOT_REACHED"]:
            self._questions(scenario)
        found = self.rig.db.get("failedStep"), self.rig.db.get("failedParameter")
        step = self.telegrams[self.handed - 1].step if status != DONE and self.handed else 0
        wanted = step, scenario.missed or self._refused(scenario)
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
        """The last good value of every part that is read, as the drive has answered; as before if there is none."""
        found = [list(parts) for parts in before]
        at = -1
        for exchange in self.rig.drive.journal:
            if exchange.direction == "write":
                data = exchange.data[1:]
                if at + 1 < len(requests) and data == requests[at + 1][1:] and not exchange.status:
                    at += 1
            elif not exchange.status and at >= 0 and not self.telegrams[at].writes:
                for place, value in _values(self.telegrams[at], exchange.data):
                    found[self.telegrams[at].number - 1][place] = value
        return found


def _values(telegram: DriveTelegram, answer: bytes) -> list[tuple[int, bytes]]:
    """Values by place, from 0, of an answer to a read; an error block ends nothing, what is no block does."""
    found: list[tuple[int, bytes]] = []
    if len(answer) < 4 or answer[1] not in {1, 0x81} or answer[3] != len(telegram.parts):
        return found
    at = 4
    for place, part in enumerate(telegram.parts):
        if at + 2 > len(answer):
            return []
        fmt, count = find(answer[at]), answer[at + 1]
        size = 2 * count if answer[at] == ERROR else fmt.size * count if fmt is not None else 0
        fits = fmt is not None and count == part.count and size == part.size
        if fits and answer[at] in {part.use.format.code, {1: 0x41, 2: 0x42, 4: 0x43}.get(part.use.format.size)}:
            found.append((place, answer[at + 2 : at + 2 + size]))
        at += 2 + padded(size)
    return found if at == len(answer) else []
