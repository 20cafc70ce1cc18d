"""What the parts of an execution gave, in a form that does not depend on who ran them."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

from plcgen.proof.checks import Trial
from plcgen.proof.scenario import Failure, Statistics
from plcgen.s7.cpu.program import Program


@dataclass(slots=True)
class Result:
    """What the runs of one job, or of one procedure, gave; ``broken`` says that not even the nominal run worked.

    ``counts`` are the counters of coverage by block, in the order of its probes; blocks of which nothing ran are left
    out. ``made`` is when it was run, if that was not now.
    """

    run: str = ""
    values: str = ""
    matrix: str = ""
    failures: list[Failure] = field(default_factory=list)
    statistics: Statistics = field(default_factory=Statistics)
    trials: list[Trial] = field(default_factory=list)
    counts: dict[str, list[int]] = field(default_factory=dict)
    broken: bool = False
    made: str = ""

    def add(self, failure: Failure | None, program: Program, counts: Sequence[int]) -> None:
        """Add what one CPU did."""
        self.failures += [failure] if failure is not None else []
        self.count(counted(program, counts))

    def count(self, more: dict[str, list[int]]) -> None:
        """Add counters of coverage."""
        for source, counts in more.items():
            known = self.counts.get(source)
            self.counts[source] = [a + b for a, b in zip(known, counts, strict=True)] if known else counts


def counted(program: Program, counts: Sequence[int]) -> dict[str, list[int]]:
    """Counters by block, of the blocks of which anything ran."""
    found: dict[str, list[int]] = {}
    for source, begin, end in program.runs() if counts else ():
        found.setdefault(source, []).extend(counts[begin:end])
    return {source: own for source, own in found.items() if any(own)}


def added(program: Program, results: Iterable[Result]) -> list[int]:
    """Counters of coverage of several results, in the order of the program's probes."""
    total = Result()
    for result in results:
        total.count(result.counts)
    counts = [0] * len(program.probes)
    taken = dict.fromkeys(total.counts, 0)
    for source, begin, end in program.runs():
        own = total.counts.get(source)
        if own is not None:
            at = taken[source]
            counts[begin:end] = own[at : at + end - begin]
            taken[source] = at + end - begin
    return counts
