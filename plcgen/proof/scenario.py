"""What a scenario of any protocol has, and what becomes of one that fails."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from plcgen.base.diagnostics import Diagnostic, PlcgenError, Span

DONE, IDLE, STARTED, RUNNING = 0x0000, 0x7000, 0x7001, 0x7002
"""The status words that every job has, as in the blocks of Siemens."""


class ScenarioError(PlcgenError):
    """The block did not do what the scenario demands."""


class OtherTelegramError(ScenarioError):
    """A telegram is another one than is stated."""

    def __init__(self, what: str, found: bytes, stated: bytes) -> None:
        self.found, self.stated = found, stated
        super().__init__(f"{what} {found.hex(' ').upper()}, not {stated.hex(' ').upper()}")


@dataclass(frozen=True, slots=True, kw_only=True)
class Scenario:
    """One run of a job: circumstances, and what must come out.

    ``scan`` is the length of a scan in ms, ``jitter`` makes it any from 1 to 50. ``happens`` maps scans to what happens
    before them: ``drop`` takes execute away, ``cold`` and ``warm`` restart the CPU, a protocol may know more.
    ``clock`` is where the clock of the block begins. ``status`` are the permitted results, ``retries`` None is not
    checked, ``took`` bounds the time in ms. ``tolerate`` says that the block may do what the
    simulated CPU calls a misuse, ``follow`` runs a plain job behind this one.
    """

    name: str
    status: tuple[int, ...] = (DONE,)
    scan: int = 10
    jitter: bool = False
    happens: Mapping[int, str] = field(default_factory=dict)
    clock: int | None = None
    retries: int | None = 0
    took: tuple[int, int] | None = None
    tolerate: bool = False
    follow: bool = True


@dataclass(frozen=True, slots=True)
class Failure:
    """A scenario that failed: in which scan it was noticed, at which statement.

    ``stopped``: an exception that nobody expected ended it; without a scenario it ended the whole part.
    """

    scenario: str
    scan: int
    message: str
    file: str
    line: int
    stopped: bool = False

    def __str__(self) -> str:
        return f"{self.scenario}, scan {self.scan}: {self.message}" if self.scenario else self.message


@dataclass(slots=True)
class Statistics:
    """What the runs of a job took; ``transitions`` are the steps from state to state that were seen."""

    runs: int = 0
    scans: int = 0
    longest: int = 0
    hangs: int = 0
    transitions: set[tuple[int, int]] = field(default_factory=set)

    def __str__(self) -> str:
        return f"{self.runs:,} runs, {self.hangs} hangs, longest {self.longest:,} scans"


def diagnostic(code: str, key: str, failures: Sequence[Failure], page: str) -> Diagnostic:
    """One diagnostic for the failures of a job; ``page`` describes how the block works."""
    first = failures[0]
    more = f" (and {len(failures) - 1} more)" if len(failures) > 1 else ""
    line = f"; the statement is {Path(first.file).name}:{first.line}" if first.file and first.line else ""
    span = Span(first.file, first.line, min(first.line, 1))
    code = "PG627" if first.stopped else code
    help_ = f"compare this place with {page}" if first.file else f"{page} says how the blocks work"
    return Diagnostic(code, f"{key}: {first}{more}", span, help=f"{help_}{line}")
