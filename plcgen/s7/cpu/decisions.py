"""What conditions of several operands have shown: which operand decided, with TRUE and with FALSE."""

from __future__ import annotations

from dataclasses import dataclass

from plcgen.s7.scl.logic import Logic, deciding, outcome


@dataclass(frozen=True, slots=True)
class Decision:
    """A condition: how its operands are joined, and the counters of each for deciding with TRUE and with FALSE."""

    logic: Logic
    counters: tuple[tuple[int, int], ...]


class Table(dict[tuple[bool | None, ...], bool]):
    """Outcomes of a condition by the values that its operands had, negated; None was not looked at.

    The generated code looks the outcome up. What is not there yet is worked out, and counted for those that decide.
    """

    def __init__(self, decision: Decision, counts: list[int]) -> None:
        super().__init__()
        self.decision, self.counts = decision, counts

    def __missing__(self, negated: tuple[bool | None, ...]) -> bool:
        values = [None if value is None else not value for value in negated]
        for number in deciding(self.decision.logic, values):
            true, false = self.decision.counters[number]
            self.counts[true if values[number] else false] += 1
        found = bool(outcome(self.decision.logic, values))
        self[negated] = found
        return found
