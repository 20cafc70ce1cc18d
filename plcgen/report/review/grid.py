"""What was tried with which job, as grids: jobs by kinds of checks, and scenarios by jobs."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass

from plcgen.base.diagnostics.counting import quantity
from plcgen.base.display.cells import clean
from plcgen.proof.checks import Check, Outcome, Verification

_COLUMNS = {
    "telegram": "telegram", "drive": "answer", "answer": "answer", "negative": "bad answers", "run": "run",
    "faults": "faults", "coverage": "coverage",
}  # fmt: skip
"""Kinds of checks that belong to one job, by the beginning of their id."""


@dataclass(frozen=True, slots=True)
class FaultGrid:
    """``rows`` are jobs and their telegrams, with a cell for each of the ``columns`` (None: there is no such check).

    ``rest`` are all other checks.
    """

    columns: tuple[str, ...]
    rows: tuple[tuple[str, tuple[tuple[str, str] | None, ...]], ...]
    rest: tuple[tuple[str, str, str, str], ...]


JOBS = 6
"""Jobs beside each other in a grid of scenarios: so many fit a sheet of A4."""
MAX_SCENARIOS = 1000
"""Scenarios of a grid; the check of the job has their number."""


@dataclass(frozen=True, slots=True)
class ScenarioGrid:
    """Scenarios of some ``jobs``: a row each, with the outcome and the scans for each job (None: not a fault of it)."""

    jobs: tuple[str, ...]
    rows: tuple[tuple[str, tuple[tuple[str, str] | None, ...]], ...]
    more: int


def scenario_grids(verification: Verification) -> Iterator[ScenarioGrid]:
    """Grids of what every job ran through, a few jobs in each."""
    faults = [check for check in verification.checks() if check.id.startswith("faults.") and check.trials]
    tried = [(check.subject.split(" ")[-1], check.trials) for check in faults]
    for start in range(0, len(tried), JOBS):
        chosen = tried[start : start + JOBS]
        cells: dict[str, list[tuple[str, str] | None]] = {}
        for place, (_, trials) in enumerate(chosen):
            for trial in trials:
                row = cells.setdefault(trial.scenario, [None] * len(chosen))
                row[place] = ("ok" if trial.ok else "error", quantity(trial.scans, "scan"))
        rows = tuple((clean(name), tuple(row)) for name, row in cells.items())
        more = max(0, len(rows) - MAX_SCENARIOS)
        yield ScenarioGrid(tuple(clean(job) for job, _ in chosen), rows[:MAX_SCENARIOS], more)


def matrix(verification: Verification) -> FaultGrid:
    """Arrange the checks; a cell is its outcome and its figures, and no check takes the cell of another."""
    cells: dict[tuple[str, int], dict[str, Check]] = {}
    seen: Counter[tuple[str, str]] = Counter()
    rest: list[Check] = []
    for group in verification.groups:
        for check in group.checks:
            kind = check.id.partition(".")[0]
            column = _COLUMNS.get(kind, "")
            if column:
                # a telegram is its own subject, all others begin with what was done with it
                job = check.subject if kind == "telegram" else check.subject.partition(" ")[2]
                cells.setdefault((job, seen[column, job]), {})[column] = check
                seen[column, job] += 1  # two masters may have jobs of one name
            else:
                rest.append(check)
    columns = tuple(name for name in dict.fromkeys(_COLUMNS.values()) if any(name in row for row in cells.values()))
    rows = tuple((clean(job), tuple(_cell(row.get(name)) for name in columns)) for (job, _), row in cells.items())
    return FaultGrid(columns, rows, tuple(_line(check) for check in rest))


def _cell(check: Check | None) -> tuple[str, str] | None:
    if check is None:
        return None
    text = check.text or check.verdict
    return check.outcome.value, clean(check.verdict if check.outcome is Outcome.ERROR else text)


def _line(check: Check) -> tuple[str, str, str, str]:
    verdict = "" if check.verdict == check.outcome.value else check.verdict
    return clean(check.subject), clean(check.text), check.outcome.value, clean(verdict)
