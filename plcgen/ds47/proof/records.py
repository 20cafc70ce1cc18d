"""Records of a recipe, stated by hand: where a job has them, what is taken from one and what one gets.

A record is a structure with a member for each parameter; a job with ``recordNumber`` 3 has to do with the third one
and with no other.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace

from plcgen.ds47.plan.access import Use, Verify
from plcgen.ds47.plan.nouns import DriveJob
from plcgen.ds47.proof.contents import ValueSet
from plcgen.proof.rig import Members, Spot

NUMBER = "recordNumber"
REFUSED = ("failedParameter", "failedIndex")
"""Which value of a record is not allowed: DINT each."""


@dataclass(frozen=True, slots=True)
class Record:
    """A scenario of a job with a recipe: the number that it gets, and values of its record that are not allowed.

    ``damaged`` are those by position of the use and place there, ``refused`` the parameter and index that it names.
    """

    record: int | None = None
    damaged: Mapping[tuple[int, int], bytes] = field(default_factory=dict)
    refused: tuple[int, int] = (0, 0)


def recipe_signals(job: DriveJob) -> tuple[str, ...]:
    """What a job with a recipe has at its block besides."""
    if job.recipe is None:
        return ()
    return (NUMBER, *REFUSED) if job.writes else (NUMBER,)


def members(job: DriveJob) -> list[Use]:
    """The parameters of its record."""
    return [use for use in job.uses if use.recorded]


class Records:
    """The records as an array ``name`` of a data block; ``number`` is the one that counts."""

    def __init__(self, job: DriveJob, db: Members, name: str, number: int) -> None:
        assert job.recipe is not None  # of such jobs only
        self.job, self.db, self.name, self.number = job, db, name, number
        self.count = job.recipe.count
        self.whole = Spot.of(db.layout, name)
        self.base = b""
        """All of them when the job started."""

    def _spots(self, number: int) -> Iterator[tuple[Use, Spot]]:
        for use in members(self.job):
            yield use, Spot.of(self.db.layout, f"{self.name}[{number}].{use.member}")

    def put(self, values: Mapping[int, bytes]) -> None:
        """Give the record that counts these wire bytes, by position of the use, the others something else."""
        self.change(values)
        for use, spot in self._spots(self.number):
            spot.put(self.db.memory, values[use.position])
        self.base = self.shown()

    def change(self, values: Mapping[int, bytes]) -> None:
        """Give all records something else than these wire bytes; of many the next, the first and the last one too."""
        for number in {self.number, self.number % self.count + 1, 1, self.count}:
            for use, spot in self._spots(number):
                spot.put(self.db.memory, bytes(byte ^ 0xFF for byte in values[use.position]))

    def shown(self) -> bytes:
        """All bytes of all records."""
        return self.whole.bytes(self.db.memory)

    def wanted(self, values: Mapping[int, bytes]) -> bytes:
        """All bytes, if the one that counts has got these, by position of the use, and no other one anything."""
        memory = bytearray(len(self.db.memory))
        at, size = self.whole.byte, self.whole.size
        memory[at : at + size] = self.base
        for use, spot in self._spots(self.number):
            spot.put(memory, values[use.position])
        return bytes(memory[at : at + size])

    def holds(self, values: Mapping[int, bytes]) -> bool:
        """Whether the one that counts has these wire bytes, by position of the use."""
        memory = self.db.memory
        return all(
            s.bytes(memory, len(values[use.position])) == values[use.position] for use, s in self._spots(self.number)
        )


def shared(values: ValueSet, job: DriveJob, record: Mapping[int, bytes]) -> ValueSet:
    """The values of a job that takes a record with these wire bytes, by position of the use."""
    given = {use.position: record[use.position] for use in members(job)}
    given |= {use.position: given[back.of.position] for use in job.uses if (back := use.as_(Verify))}
    return replace(values, given={**values.given, **given})
