"""What verification found: checks grouped by subject, each with an outcome a person and a machine can read."""

from __future__ import annotations

import enum
from collections.abc import Iterator
from dataclasses import dataclass

from plcgen.base.diagnostics import Diagnostic, has_errors
from plcgen.proof.ledger import Assumption


class Outcome(enum.StrEnum):
    """Result of one check. ``NOT_RUN`` is neither good nor bad: the check exists but was not executed."""

    OK = "ok"
    ERROR = "error"
    WARNING = "warning"
    NOT_RUN = "not run"


@dataclass(frozen=True, slots=True)
class Trial:
    """One scenario that a check ran: its name, the scans that it took with the plain run behind it, how it ended."""

    scenario: str
    scans: int
    ok: bool


@dataclass(frozen=True, slots=True)
class Check:
    """One statement that was tested.

    ``subject`` is what was looked at (``DB3 "WR_DataBuffer"``, ``telegram read_ramp_up``), ``text`` the figures,
    ``verdict`` the short ending of the line, ``diagnostic`` what is wrong (None if nothing is); ``trials`` are the
    scenarios of a check that ran several.
    """

    id: str
    subject: str
    text: str
    outcome: Outcome
    verdict: str
    diagnostic: Diagnostic | None = None
    trials: tuple[Trial, ...] = ()


def file_check(id_: str, subject: str, text: str, problems: list[Diagnostic], good: str) -> Check:
    """A check of the group ``files``: the first problem, and how many more."""
    if not problems:
        return Check(id_, subject, text, Outcome.OK, good)
    more = f" (+{len(problems) - 1} more)" if len(problems) > 1 else ""
    return Check(id_, subject, text, Outcome.ERROR, f"{problems[0].message}{more}", problems[0])


@dataclass(frozen=True, slots=True)
class CheckGroup:
    """Checks that belong together: ``files``, ``layout``, ``telegrams``, ``drive``, ``execution``."""

    name: str
    title: str
    checks: tuple[Check, ...]


@dataclass(frozen=True, slots=True)
class Verification:
    """The complete result for one spec and one output folder; ``verb`` is ``verify`` or ``audit``.

    ``ledger`` is what the result rests on.
    """

    spec: str
    folder: str
    project: str
    target: str
    groups: tuple[CheckGroup, ...]
    diagnostics: tuple[Diagnostic, ...]
    verb: str = "verify"
    ledger: tuple[Assumption, ...] = ()

    def checks(self) -> Iterator[Check]:
        """All checks in order."""
        for group in self.groups:
            yield from group.checks

    @property
    def problems(self) -> list[Diagnostic]:
        """Every diagnostic once, those of the checks first."""
        own = [check.diagnostic for check in self.checks() if check.diagnostic is not None]
        return list(dict.fromkeys([*own, *self.diagnostics]))

    @property
    def told(self) -> list[Diagnostic]:
        """All problems; if checks fail on files of another state of the spec, that alone and what is outside."""
        if self.ok or not any(one.code == "PG504" for one in self.problems):
            return self.problems
        return [one for one in self.problems if one.code == "PG504" or one in self.outside]

    @property
    def outside(self) -> list[Diagnostic]:
        """The diagnostics that belong to no check, each once."""
        own = {check.diagnostic for check in self.checks()}
        return [diagnostic for diagnostic in dict.fromkeys(self.diagnostics) if diagnostic not in own]

    @property
    def ok(self) -> bool:
        """Whether no check and no diagnostic is an error."""
        return not any(c.outcome is Outcome.ERROR for c in self.checks()) and not has_errors(self.diagnostics)
