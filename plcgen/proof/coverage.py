"""Which statements and branches of a block ran, which operands of its conditions decided, and which cannot."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from plcgen.proof.conditions import Premise
from plcgen.proof.reach import reachable
from plcgen.s7.cpu.linkage import Probe
from plcgen.s7.cpu.program import Program
from plcgen.s7.scl import ast
from plcgen.s7.scl.logic import DECIDES

Step = tuple[int, int]
NO_OTHER = "the selector has no other value"


@dataclass(frozen=True, slots=True)
class Coverage:
    """Counts of one block: ``missing`` never ran or decided although they should, ``explained`` cannot.

    ``steps`` are the ways from state to state that were never gone, None if nobody looked.
    """

    statements: int
    branches: int
    operands: int
    missing: tuple[Probe, ...]
    explained: tuple[tuple[Probe, str], ...]
    steps: frozenset[Step] | None = None

    @property
    def text(self) -> str:
        """``245 statements, 130 branches, 61 operands, every state transition``."""
        found = f"{self.statements} statements, {self.branches} branches, {self.operands} operands"
        if self.steps is None:
            return found
        end = "every state transition" if not self.steps else f"all but {len(self.steps)} state transitions"
        return f"{found}, {end}"

    @property
    def verdict(self) -> str:
        """``100 %``, or how many are left out and why."""
        if not self.explained:
            return "ok, 100 % executed" if not self.missing else "not complete"
        places: dict[str, list[int]] = {}
        for probe, why in self.explained:
            places.setdefault(why, []).append(probe.line)
        reasons = [f"{why} (line {', '.join(map(str, sorted(set(lines))))})" for why, lines in places.items()]
        return f"ok but {len(self.explained)} that cannot run: {'; '.join(reasons)}"


def cover(
    program: Program,
    block: str,
    counts: Sequence[int],
    premises: Sequence[Premise] = (),
    opened: Sequence[str] = (),
    steps: frozenset[Step] | None = None,
) -> Coverage:
    """Coverage of a block. A block may have been compiled twice: probes at one place are added up.

    A missing ELSE of a CASE is explained if the selector has no other value. Anything else is explained by the premise
    that excludes it; what the block alone excludes is dead code. ``opened`` are the names that premises may follow.
    """
    entry = program.link.find(block)
    if entry is None:
        return Coverage(0, 0, 0, (), (), steps)
    totals: dict[Probe, int] = {}
    for probe, count in zip(program.probes, counts, strict=True):
        if probe.block == entry.name:
            totals[probe] = totals.get(probe, 0) + count
    missing = [probe for probe, count in totals.items() if not count]
    position, tree = entry.result.tokens.position, entry.tree
    cases = {position(node.start) for node in ast.walk(tree) if isinstance(node, ast.Case)}

    def excluded(known: Sequence[Premise], open_names: Sequence[str]) -> frozenset[Probe]:
        reached = {(*position(offset), kind) for offset, kind in reachable(tree, known, open_names)}
        return frozenset(probe for probe in missing if (probe.line, probe.column, probe.kind) not in reached)

    others = {probe for probe in missing if probe.kind == "else" and (probe.line, probe.column) in cases}
    reasons = dict.fromkeys(excluded(premises, ()) & others, NO_OTHER) if others else {}
    missing = [probe for probe in missing if probe not in reasons]
    if missing:
        dead = excluded((), opened)
        if len(dead) < len(missing):
            reasons |= _attributed(premises, dead, lambda known: excluded(known, opened))
    explained = [
        (probe, why) for why in dict.fromkeys(reasons.values()) for probe in totals if reasons.get(probe) == why
    ]
    missing = [probe for probe in missing if probe not in reasons]
    statements = sum(probe.kind == "statement" for probe in totals)
    decided = sum(probe.kind in DECIDES.values() for probe in totals)
    branches = len(totals) - statements - decided
    return Coverage(statements, branches, decided // 2, tuple(missing), tuple(explained), steps)


def _attributed(
    premises: Sequence[Premise],
    dead: frozenset[Probe],
    excluded: Callable[[Sequence[Premise]], frozenset[Probe]],
) -> dict[Probe, str]:
    """The premise behind which a probe is excluded, taken in their order; ``dead`` is what none is needed for."""
    reasons: dict[Probe, str] = {}

    def between(first: int, last: int, before: frozenset[Probe], after: frozenset[Probe]) -> None:
        """Halve until there is one premise, or nothing between two of them."""
        if before >= after:
            return
        if last - first == 1:
            reasons.update(dict.fromkeys(after - before, premises[first].reason))
            return
        half = (first + last) // 2
        middle = excluded(premises[:half])
        between(first, half, before, middle)
        between(half, last, middle, after)

    if premises:
        between(0, len(premises), dead, excluded(premises))
    return reasons
