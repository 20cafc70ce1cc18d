"""Which statements and branches of a block ran, and which cannot."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass

from plcgen.cpu.linkage import Probe
from plcgen.cpu.program import Program
from plcgen.protocols.ds47.plan.nouns import DriveJob

Step = tuple[int, int]
NO_OTHER = "the selector has no other value"
ONE_ERROR = "a telegram of one parameter has one error"
NO_RETRY = "retries: 0"
NO_RETRIES = "MAX_RETRIES x RETRY_PAUSE is longer than TIMEOUT"


def explanation(job: DriveJob, probe: Probe, line: str) -> str:
    """Why a branch or statement of a generated block cannot run; empty if it should."""
    text = line.replace("#", "")
    if probe.kind == "else" and text.startswith(("CASE statTelegram OF", "CASE tempBlock OF")):
        return NO_OTHER
    if probe.kind == "else" and text == "IF statFailed = 0 THEN" and all(len(t.parts) == 1 for t in job.telegrams):
        return ONE_ERROR
    if not job.retries and _retries_only(probe, text):
        return NO_RETRY
    retries = ("IF statRetries < MAX_RETRIES THEN", "statResult := STATUS_RETRIES;", "statState := STATE_DRAIN;")
    if job.retries * (job.retry_pause + 4) >= job.timeout and text in retries and probe.kind != "branch":
        return NO_RETRIES
    return ""


def _retries_only(probe: Probe, text: str) -> bool:
    """Whether a place belongs to the pause before a retry."""
    statements = (
        "statRetries := statRetries + 1;",
        "statResume := tempResume;",
        "statState := STATE_WAIT;",
        "statState := statResume;",
        "IF tempPauseOver THEN",
    )
    return (
        text in statements
        or (probe.kind == "branch" and text == "IF statRetries < MAX_RETRIES THEN")
        or "STATE_WAIT" in text
    )


@dataclass(frozen=True, slots=True)
class Coverage:
    """Counts of one block: ``missing`` never ran although they should, ``explained`` cannot.

    ``steps`` are the ways from state to state that were never gone, None if nobody looked.
    """

    statements: int
    branches: int
    missing: tuple[Probe, ...]
    explained: tuple[tuple[Probe, str], ...]
    steps: frozenset[Step] | None = frozenset()

    @property
    def text(self) -> str:
        """``245 statements, 130 branches, every state transition``."""
        if self.steps is None:
            return f"{self.statements} statements, {self.branches} branches"
        end = "every state transition" if not self.steps else f"all but {len(self.steps)} state transitions"
        return f"{self.statements} statements, {self.branches} branches, {end}"

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


def measure(program: Program, name: str, counts: Sequence[int]) -> tuple[list[tuple[Probe, int]], list[str]]:
    """Probes of a block with their counts, and the lines of its source."""
    block = program.link.find(name)
    if block is None:
        return [], []
    file = block.result.tokens.file
    found = [(probe, count) for probe, count in zip(program.probes, counts, strict=True) if probe.file == file]
    return found, block.result.tokens.source.splitlines()


def merge(
    job: DriveJob, found: tuple[Iterable[tuple[Probe, int]], Sequence[str]], steps: frozenset[Step] = frozenset()
) -> Coverage:
    """Coverage of a job's block."""
    return cover(found, lambda probe, line: explanation(job, probe, line), steps)


def cover(
    found: tuple[Iterable[tuple[Probe, int]], Sequence[str]],
    explain: Callable[[Probe, str], str],
    steps: frozenset[Step] | None = None,
) -> Coverage:
    """Add up the probes that stand at one place: a block may have been compiled twice.

    ``explain`` says why a probe on a line cannot run, or nothing.
    """
    probes, lines = found
    totals: dict[Probe, int] = {}
    for probe, count in probes:
        totals[probe] = totals.get(probe, 0) + count
    missing: list[Probe] = []
    explained: list[tuple[Probe, str]] = []
    for probe in (probe for probe, count in totals.items() if not count):
        line = lines[probe.line - 1].strip() if probe.line <= len(lines) else ""
        reason = explain(probe, line)
        if reason:
            explained.append((probe, reason))
        else:
            missing.append(probe)
    statements = sum(probe.kind == "statement" for probe in totals)
    return Coverage(statements, len(totals) - statements, tuple(missing), tuple(explained), steps)
