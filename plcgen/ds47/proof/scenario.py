"""Scenarios of a job block: circumstances, and what must come out."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import Any, Literal, TypeVar

from plcgen.ds47.plan.nouns import DriveJob
from plcgen.ds47.sim.drive import Drive
from plcgen.ds47.sim.faults import Fault
from plcgen.ds47.sim.parameters import Keeps
from plcgen.proof.scenario import Scenario

_Part = TypeVar("_Part")
Edit = Callable[[bytes], bytes]
"""What becomes of the bytes of an answer on its way."""
Event = Callable[[Drive], None]
"""What happens to a drive."""
Contents = Literal["next", "factory", "low", "high", "odd"]
"""Which values drive and inputs have: others than in the run before, those of the spec, the ends of their ranges, and
those that arithmetic loses: -1, -0.0, 2**31."""


@dataclass(frozen=True, slots=True, kw_only=True)
class DriveScenario(Scenario):
    """One run of a job.

    ``writes`` and ``reads`` act on the n-th WRREC or RDREC (0: on every one): a STATUS, or for a read an edit of the
    answer. ``busy`` is how many calls of WRREC and RDREC answer BUSY, ``generic`` lets the drive answer 41h to 43h.
    ``twice``: the job is called twice for every call of its channel, as in an OB that is faster.
    ``meddle`` changes every input behind the first call, ``slot`` is another slot than the job's own, ``occupied`` for
    how many ms the job of another slot has the unit. ``output`` puts the drive at an address with bit 15, ``guarded``
    looks behind every call for bytes that are not the job's, not only at the end. ``at_once``: execute comes again in
    the call behind the end.

    ``saving`` is how many ms the drive saves or acknowledges, ``remaining`` how many faults are there again when they
    were acknowledged. ``sharp``: calls of a job that asks again and again fall where its times are over, and 1 ms
    before; a question so many ms behind its limit.

    ``keeps`` is what the drive makes of written values, by number of the parameter: it rounds, or clips without a word;
    ``meanwhile`` what somebody else makes of them before they are read back. ``matches``: the drive has what a job
    that compares wants, but for ``keeps``. ``events`` happen in front of the n-th WRREC.

    ``parts`` are what only one kind of job knows, each of another type; what is not there is as that type has it.

    ``telegram`` is the one that ends the job, 0 the last; ``answered`` says that it had an answer. ``errors`` are those
    stated by hand: (error, info) by number of the telegram and place in it, all others of an answered telegram are 0.
    ``delivers`` are wire bytes that ``reads`` puts in the place of the drive's values, likewise.
    ``checked`` False: only the result counts. ``again`` is how many requests were sent again, None is any number.
    """

    faults: tuple[Fault, ...] = ()
    writes: Mapping[int, int] = field(default_factory=dict)
    reads: Mapping[int, int | Edit] = field(default_factory=dict)
    busy: tuple[int, int] = (1, 1)
    generic: bool | None = None
    values: Contents = "next"
    meddle: bool = False
    slot: int | None = None
    occupied: int = 0
    output: bool = False
    twice: bool = False
    guarded: bool = False
    at_once: bool = False
    saving: int = 300
    remaining: int = 0
    sharp: int | None = None
    keeps: Mapping[int, Keeps] = field(default_factory=dict)
    meanwhile: Mapping[int, Keeps] = field(default_factory=dict)
    matches: bool = False
    events: Mapping[int, Event] = field(default_factory=dict)
    telegram: int = 0
    answered: bool = True
    errors: Mapping[tuple[int, int], tuple[int, int]] = field(default_factory=dict)
    delivers: Mapping[tuple[int, int], bytes] = field(default_factory=dict)
    checked: bool = True
    again: int | None = 0
    parts: tuple[Any, ...] = ()

    def of(self, part: type[_Part]) -> _Part:
        """The part of a type."""
        return next((one for one in self.parts if isinstance(one, part)), None) or part()

    def among(self, *parts: Any) -> DriveScenario:
        """The same scenario with more parts."""
        return replace(self, parts=(*self.parts, *parts))


@dataclass(frozen=True, slots=True)
class KindScenarios:
    """What is tried with a job of one kind, besides what is tried with every job; the lowest ``precedence`` first.

    ``make`` gets the scans of a good run. ``around`` changes what is tried with every job for one of this kind.
    """

    precedence: int
    has: Callable[[DriveJob], bool]
    make: Callable[[DriveJob, int], Iterator[DriveScenario]]
    around: Callable[[DriveJob, Iterable[DriveScenario]], Iterator[DriveScenario]] | None = None
