"""Scenarios of a job block: circumstances, and what must come out."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Literal

from plcgen.ds47.plan.nouns import DriveJob
from plcgen.ds47.proof.clocked import Moment
from plcgen.ds47.sim.drive import Drive
from plcgen.ds47.sim.faults import Fault
from plcgen.ds47.sim.parameters import Keeps
from plcgen.proof.scenario import Scenario

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

    ``remaining`` is how many faults are there again when they were acknowledged. ``saving`` is how many ms the drive
    saves or acknowledges, ``since`` starts a job that saves so many ms behind the last save that
    was handed over; None: long behind it, ``left`` ms of the time that must pass in between are left.

    ``sharp``: calls of such a job fall where its times are over, and 1 ms before; a question so many ms behind its
    limit.

    ``keeps`` is what the drive makes of written values, by number of the parameter: it rounds, or clips without a word;
    ``meanwhile`` what somebody else makes of them before they are read back. ``matches``: the drive has what a job
    that compares wants, but for ``keeps``.

    ``state`` is the word in which the drive reports whether it runs: by default every bit is set that does not say so.
    ``causes`` are the results of which a job that restores says that they were why.

    ``messages`` is how many are in each group of a buffer; None: as the values are. ``events`` happen in front of the
    n-th WRREC, ``rounds`` is how often all telegrams are sent; what a round has not answered has the result of the one
    before.

    ``questions`` is how often a telegram of a sequence is asked that waits, by its number; once if it is not there.
    ``missed`` is the parameter for which a sequence has waited in vain; ``taken`` is for how many ms another job has
    the unit from the first time on that it is free while the sequence waits. Another job lives in the
    slot when the telegram ``robbed`` ends; 0: none does. The CPU stands still for 1 s when the telegram ``still`` ends.

    ``moment`` is the time at the input of a job that sets a clock, or bytes that are none; ``later`` what is there
    behind the first call.

    ``record`` is the number that a job with a recipe gets, ``damaged`` values of its record that are not allowed, by
    position of the use and place there; ``refused`` the parameter and index that it names for them.

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
    since: int | None = None
    left: int = 0
    sharp: int | None = None
    keeps: Mapping[int, Keeps] = field(default_factory=dict)
    meanwhile: Mapping[int, Keeps] = field(default_factory=dict)
    matches: bool = False
    state: int = 0xF7FB
    causes: tuple[int, ...] = (0,)
    messages: int | None = None
    events: Mapping[int, Event] = field(default_factory=dict)
    rounds: int = 1
    questions: Mapping[int, int] = field(default_factory=dict)
    missed: int = 0
    taken: int = 0
    robbed: int = 0
    still: int = 0
    moment: Moment | bytes | None = None
    later: Moment | bytes | None = None
    record: int | None = None
    damaged: Mapping[tuple[int, int], bytes] = field(default_factory=dict)
    refused: tuple[int, int] = (0, 0)
    telegram: int = 0
    answered: bool = True
    errors: Mapping[tuple[int, int], tuple[int, int]] = field(default_factory=dict)
    delivers: Mapping[tuple[int, int], bytes] = field(default_factory=dict)
    checked: bool = True
    again: int | None = 0


@dataclass(frozen=True, slots=True)
class KindScenarios:
    """What is tried with a job of one kind, besides what is tried with every job; the lowest ``precedence`` first.

    ``make`` gets the scans of a good run. ``around`` changes what is tried with every job for one of this kind.
    """

    precedence: int
    has: Callable[[DriveJob], bool]
    make: Callable[[DriveJob, int], Iterator[DriveScenario]]
    around: Callable[[DriveJob, Iterable[DriveScenario]], Iterator[DriveScenario]] | None = None
