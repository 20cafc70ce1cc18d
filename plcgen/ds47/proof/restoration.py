"""What a job that restores must do, from what its drive has answered: which telegrams it sends, how it ends."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from plcgen.ds47.plan.access import Running, Use, Verify
from plcgen.ds47.plan.nouns import DriveJob, DriveTelegram
from plcgen.ds47.proof.contents import held, told
from plcgen.ds47.proof.scenario import DriveScenario
from plcgen.ds47.proof.words import DEVIATES, DONE, NO_ANSWER, WORDS
from plcgen.ds47.sim.drive import Drive
from plcgen.ds47.wire.formats import FormatKind
from plcgen.proof.scenario import ScenarioError

CAUSE = "cause"
"""Output of a job that restores: why it has failed."""
OUTCOMES = tuple(WORDS[name] for name in ("RESTORED", "NOT_RESTORED", "RUNS", "LEFT"))
"""How such a job may end once it has written."""
RUNS = 0x0804
"""Bits 2 and 11 of r0899: operation enabled, pulses enabled."""
NOT_SAVED = WORDS["NOT_SAVED"]
"""How one ends that saves too, when all values are right and the save is not."""
OLD, WRITE, BACK, NOW, RETURN, CHECK = range(1, 7)
"""Its telegrams; in one that saves NOW is the one that tells the drive to, if all values are right."""
_SHAPES = {OLD: 0, WRITE: 1, BACK: 2, NOW: 2, RETURN: 1, CHECK: 2}
BAD = 0x44
"""The block of an answer to a change that tells of an error."""


@dataclass(frozen=True, slots=True)
class Restores:
    """A scenario of a job that restores.

    ``state`` is the word in which the drive reports whether it runs: by default every bit is set that does not say so.
    ``causes`` are the results of which the job says that they were why.
    """

    state: int = 0xF7FB
    causes: tuple[int, ...] = (0,)


class Restoration:
    """A run of a job that restores: ``requests`` are those of its first three telegrams, ``given`` what it writes."""

    def __init__(
        self, job: DriveJob, drive: Drive, drive_object: int, requests: Sequence[bytes], given: Mapping[int, bytes]
    ) -> None:
        self.job, self.drive, self.drive_object = job, drive, drive_object
        self.requests, self.given = requests, given
        self.starts: dict[int, int] = {}
        """Where in the journal of the drive the exchanges of a telegram begin, as it was sent last."""
        self.begin = 0
        """Where those of the run begin, or of the last start in it."""
        self.saves = False
        """Whether it has come so far that it saves."""

    def shape(self, telegram: int) -> DriveTelegram:
        """The planned telegram that a telegram of the run is like."""
        return self.job.telegrams[self._place(telegram)]

    def _place(self, telegram: int) -> int:
        """Where the planned telegram is in the job, from 0; the last one asks again and again whether it has saved."""
        if self.saves and telegram > BACK:
            return min(telegram, len(self.job.telegrams)) - 1
        return _SHAPES[telegram]

    def hand_over(self, telegram: int) -> bytes:
        """A telegram is handed over: what it must be. Raises ScenarioError."""
        if telegram <= BACK:
            self.saves = False
        elif telegram == NOW:
            self.saves = self.job.guarded and self.right()
        if telegram not in _SHAPES and not self.saves:
            raise ScenarioError(f"a telegram {telegram} is handed over, a job that restores has {CHECK}")
        if telegram == OLD and set(self.starts) != {OLD}:
            self.starts.clear()
            self.begin = len(self.drive.journal)
        self.starts[telegram] = len(self.drive.journal)
        return self._returned() if telegram == RETURN and not self.saves else self.requests[self._place(telegram)]

    def answer(self, telegram: int) -> bytes:
        """The last answer to a telegram; none if nothing came that belongs to it."""
        if telegram not in self.starts:
            return b""
        end = self.starts.get(telegram + 1, len(self.drive.journal))
        sent = found = b""
        for exchange in self.drive.journal[self.starts[telegram] : end]:
            if exchange.direction == "write":
                sent, found = (b"" if exchange.status else exchange.data), b""
            else:
                found = exchange.data if not exchange.status and sent[:1] == exchange.data[:1] else b""
        return found

    def values(self, telegram: int) -> dict[int, bytes]:
        """What came for the parameters of a question, by their places from 0."""
        return dict(told(self.shape(telegram), self.answer(telegram)))

    def complete(self, telegram: int) -> bool:
        """Whether a telegram has a good answer."""
        answer, shape = self.answer(telegram), self.shape(telegram)
        if shape.writes:
            return answer[1:2] == b"\x02"
        return answer[1:2] == b"\x01" and len(self.values(telegram)) == len(shape.parts)

    def right(self) -> bool:
        """Whether all was written, and is what the job has sent."""
        return self.complete(WRITE) and self.complete(BACK) and not any(error for error, _ in self.read_back())

    @property
    def written(self) -> tuple[Use, ...]:
        """What the job writes; old values and what is read back have the same places."""
        return tuple(part.use for part in self.job.telegrams[1].parts)

    def refused(self) -> set[int]:
        """Places that the drive has refused to write: all, if it has refused the request."""
        answer, count = self.answer(WRITE), len(self.written)
        if answer[1:2] != b"\x82" or answer[3] != count:
            return set()
        found, at = [], 4
        while at < len(answer):
            found.append(answer[at] == BAD)
            at += 2 + (2 * answer[at + 1] if answer[at] == BAD else 0)
        if len(found) == 1:
            return set(range(count)) if found[0] else set()
        return {place for place, bad in enumerate(found) if bad}

    def unlike(self, telegram: int) -> set[int]:
        """Places that have not their old value in an answer."""
        old, now = self.values(OLD), self.values(telegram)
        return {place for place in range(len(self.written)) if now[place] != old[place]}

    def returning(self) -> set[int]:
        """Places that are written back: they have another value than before, and it is what this job has made."""
        back, now, refused = self.values(BACK), self.values(NOW), self.refused()
        made = {place: back.get(place, self.given[use.position]) for place, use in enumerate(self.written)}
        return {place for place in self.unlike(NOW) if place not in refused and now[place] == made[place]}

    def _returned(self) -> bytes:
        """The request that writes the old values back, with reference 0."""
        places, old = sorted(self.returning()), self.values(OLD)
        uses = [self.written[place] for place in places]
        data = bytearray((0, 2, self.requests[1][2], len(places)))
        for use in uses:
            data += bytes((0x10, use.elements)) + use.parameter.pnu.to_bytes(2) + use.subindex.to_bytes(2)
        for place, use in zip(places, uses, strict=True):
            data += bytes((use.format.code, use.count)) + old[place] + bytes(len(old[place]) % 2)
        return bytes(data)

    def outcome(self) -> tuple[int, int]:
        """How a run must end whose write or read-back was not well, and with which telegram."""
        if not self.complete(NOW):
            return WORDS["NOT_RESTORED"], NOW
        returning = self.returning()
        left = WORDS["LEFT" if self.unlike(NOW) - returning else "RESTORED"]
        if not returning:
            return left, NOW
        state = next((n for n, part in enumerate(self.shape(NOW).parts) if part.use.as_(Running)), None)
        if state is not None and int.from_bytes(self.values(NOW)[state]) & RUNS:
            return WORDS["RUNS"], NOW
        if not self.complete(RETURN):
            return WORDS["NOT_RESTORED"], RETURN
        if not self.complete(CHECK) or self.unlike(CHECK) & returning:
            return WORDS["NOT_RESTORED"], CHECK
        return left, CHECK

    def check(self, scenario: DriveScenario, status: int, cause: int) -> None:
        """The job ends as it must, and says why. Raises ScenarioError."""
        tells = status in OUTCOMES or (status == NOT_SAVED and self.job.guarded)
        if (tells and not cause) or (not tells and cause != status):
            raise ScenarioError(f"cause is 16#{cause:04X} with status 16#{status:04X}")
        last = max(self.starts, default=0)
        if not tells and status != DONE and last >= WRITE:
            raise ScenarioError(f"status 16#{status:04X} does not tell that telegram {last} may have changed the drive")
        if not scenario.checked:
            return
        if self.saves:
            wanted = DONE if status == DONE else NOT_SAVED, last
        elif status == DONE:
            wanted = DONE, BACK
        elif last < WRITE:
            wanted = status, last
        else:
            wanted = self.outcome()
        if (status, last) != wanted:
            shown = f"16#{status:04X} after telegram {last}"
            raise ScenarioError(f"it ends with {shown} instead of 16#{wanted[0]:04X} after telegram {wanted[1]}")
        if tells and cause not in scenario.of(Restores).causes:
            shown = " or ".join(f"16#{word:04X}" for word in scenario.of(Restores).causes)
            raise ScenarioError(f"cause is 16#{cause:04X} instead of {shown}")
        if status == WORDS["RESTORED"]:
            for place, use in enumerate(self.written):
                if held(self.drive, self.drive_object, use) != self.values(OLD)[place]:
                    raise ScenarioError(f"the drive does not have the old value of {use.label}")

    def remembered(self, results: list[list[tuple[int, int]]]) -> list[list[tuple[int, int]]]:
        """What the job says of the old values: whether the drive has them, as far as it has answered."""
        if NOW not in self.starts or self.saves:
            return results
        last = CHECK if CHECK in self.starts and self.complete(CHECK) else NOW
        if not self.complete(last):
            found = [(NO_ANSWER, 0)] * len(self.written)
        else:
            found = [(DEVIATES if place in self.unlike(last) else 0, 0) for place in range(len(self.written))]
        return [found + results[0][len(found) :], *results[1:]]

    def read_back(self) -> list[tuple[int, int]]:
        """What the job says of values that are read back, with a good answer."""
        came = self.values(BACK)
        found = []
        for place, part in enumerate(self.shape(BACK).parts):
            other = None
            if back := part.use.as_(Verify):
                other = first_other(part.use, self.given[back.of.position], came[place])
            found.append((0, 0) if other is None else (DEVIATES, other))
        return found

    def came(self, wanted: list[list[bytes]]) -> list[list[bytes]]:
        """The outputs that were read back are what came."""
        found = self.values(BACK)
        back = [found.get(place, data) for place, data in enumerate(wanted[2])]
        return [*wanted[:2], back, *wanted[3:]]


def first_other(use: Use, sent: bytes, came: bytes) -> int | None:
    """Index of the first value that is not the one that was sent; one unit of the last place is forgiven."""
    size, floating = use.format.size, use.format.kind is FormatKind.FLOAT
    magnitude = (1 << (8 * size - 1)) - 1
    for number in range(use.count):
        wanted, found = (int.from_bytes(data[number * size : (number + 1) * size]) for data in (sent, came))
        if floating and (abs(wanted - found) <= 1 or not (wanted | found) & magnitude):
            continue
        if wanted != found:
            return use.subindex + number
    return None
