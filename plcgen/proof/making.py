"""Checks that are still to be made, and who makes them: whatever is unexpected on the way is a red check, no end.

Files from outside can be damaged in ways that no check foresees. The exception that one of them raises is then its
result, with the file that it looked at; every other check is made all the same.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import BrokenExecutor
from dataclasses import dataclass

from plcgen.base.diagnostics import Diagnostic, DiagnosticError, Span
from plcgen.proof.checks import Check, Outcome


@dataclass(frozen=True, slots=True)
class Pending:
    """Checks before they are made: their id and subject, the place that is named if that fails, and what makes them."""

    id: str
    subject: str
    place: Callable[[], Span]
    make: Callable[[], Check | Iterable[Check]]

    def checks(self) -> Iterator[Check]:
        """All of them, and behind an exception that it ended so."""
        try:
            found = self.make()
            yield from (found,) if isinstance(found, Check) else found
        except DiagnosticError as problem:
            yield stopped(self.id, self.subject, problem.diagnostics[0])
        except Exception as problem:  # noqa: BLE001 - it is the result
            yield stopped(self.id, self.subject, unexpected(problem, self.place()))


def make_checks(checks: Iterable[Check | Pending], group: str, place: Span) -> Iterator[Check]:
    """Make the checks of a group one after the other; what fails between two of them ends no more than the group.

    Raises DiagnosticError of what lies between: that is about the whole run.
    """
    try:
        for one in checks:
            yield from one.checks() if isinstance(one, Pending) else (one,)
    except DiagnosticError:
        raise
    except Exception as problem:  # noqa: BLE001 - it is the result
        yield stopped(group, group, unexpected(problem, place))


def stopped(id_: str, subject: str, problem: Diagnostic) -> Check:
    """A check that could not be made."""
    return Check(id_, subject, "", Outcome.ERROR, problem.message, problem)


def attempted(look: Callable[[], Iterable[Diagnostic]], place: Span) -> list[Diagnostic]:
    """What is found at one of several places of a check; an exception is a finding, too."""
    found: list[Diagnostic] = []
    try:
        found.extend(look())
    except DiagnosticError as problem:
        found += problem.diagnostics
    except Exception as problem:  # noqa: BLE001 - it is a finding
        found.append(unexpected(problem, place))
    return found


def unexpected(problem: Exception, place: Span) -> Diagnostic:
    """PG627: what a check does not expect of a file. Raises what no check can help: no memory, lost workers."""
    if isinstance(problem, MemoryError | BrokenExecutor):
        raise problem
    said = " ".join(str(problem).split())[:200]
    return Diagnostic(
        "PG627",
        f"stopped with {type(problem).__name__}{f': {said}' if said else ''}",
        place,
        help="run plcgen generate; if it stays, report it with the spec: it is a mistake of plcgen then",
    )
