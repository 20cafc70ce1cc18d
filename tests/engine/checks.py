"""The proof of the engine as checks: every scenario and procedure in pieces for workers, then coverage."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import cached_property, partial
from pathlib import Path
from typing import Literal

from plcgen.base.diagnostics import Diagnostic, Span
from plcgen.ds47.proof.words import TRANSITIONS, state_name
from plcgen.proof.checks import Check, Outcome
from plcgen.proof.conditions import STATE
from plcgen.proof.coverage import NO_OTHER, Coverage, Step, cover
from plcgen.proof.dependence import key_of
from plcgen.proof.execution import MAX_FAILURES, attempt, coverage_check, failed, made
from plcgen.proof.results import Result, added
from plcgen.proof.runner import Runner
from plcgen.proof.scenario import Statistics, diagnostic
from plcgen.proof.sharing import Sharing
from plcgen.proof.suite import CodeBlock, Procedure
from plcgen.s7.scl import ast
from tests.engine.answer_faults import answer_faults, error_matrix
from tests.engine.argued import ARGUED, argued
from tests.engine.conduct import EngineConduct
from tests.engine.copies import copies
from tests.engine.errands import (
    MATRIX,
    READ_OPEN,
    READ_PINNED,
    READ_SPLIT,
    TRIGGER,
    WRITE_PINNED,
    Errand,
    every_format,
    full,
)
from tests.engine.field import JobField
from tests.engine.formats import formats
from tests.engine.interrupts import interrupts
from tests.engine.mailboxes import mailboxes
from tests.engine.places import places
from tests.engine.record_faults import cpu_faults, record_faults
from tests.engine.restarts import restarts
from tests.engine.rig import EngineRig
from tests.engine.scenario import EngineScenario
from tests.engine.sources import BLOCKS, DriveEngine

PAGE = "docs/generated-code.md"
Effort = Literal["sizes", "ordinary", "recorded", "thorough"]
"""How much is run: what depends on sizes; everything; the same and 70,000 jobs in a row; the same with an interrupt at
every point and every set of loaded blocks."""
SIZES = frozenset({"formats", "units"})
"""Groups that run if an engine differs from a proven one in its sizes only."""
GROUPS = {
    "formats": "every format, 41h to 43h, pinned telegrams, jobs in a row",
    "faults": "every fault of WRREC, RDREC, answer and CPU",
    "edges": "the same of two jobs, where an edge of REQ starts WRREC and RDREC",
    "units": "jobs that share a unit: turns, slots, limits, silence",
    "places": "record jobs of the CPU: never too many, in turn",
    "restarts": "restart of the CPU, data blocks loaded again",
    "copies": "units of optimised access: what one organization block calls",
    "interrupts": "OB1 < OB35 < OB82, one comes at every point of another",
}


@dataclass(frozen=True, slots=True)
class Piece:
    """Something that one worker does: the faults of an errand, or a procedure."""

    group: str
    name: str
    errand: Errand | None = None
    run: Callable[[JobField], None] | None = None


class EngineWork:
    """All pieces of the proof of an engine; it is called with the number of one."""

    def __init__(self, engine: DriveEngine, effort: Effort = "ordinary") -> None:
        self.engine, self.effort = engine, effort

    def __reduce__(self) -> tuple[type[EngineWork], tuple[DriveEngine, Effort]]:
        """A worker makes the pieces again."""
        return EngineWork, (self.engine, self.effort)

    @cached_property
    def pieces(self) -> list[Piece]:
        """The long ones first."""
        thorough = self.effort == "thorough"
        classic = self.engine.dialect.classic
        last = self.engine.sizes.last
        found = [Piece("faults", errand.key, errand) for errand in MATRIX if errand.fits(last)]
        found += [Piece("edges", errand.key, errand) for errand in (READ_SPLIT, TRIGGER) if errand.fits(last)]
        if self.effort == "sizes":
            found = found[:1]
        for group, procedures in (
            ("formats", formats(classic=classic, many=self.effort in {"recorded", "thorough"})),
            ("interrupts", interrupts(thorough=thorough)),
            ("restarts", restarts(classic=classic, thorough=thorough)),
            ("places", places()),
            ("units", mailboxes()),
            ("copies", () if classic else copies()),
        ):
            if self.effort != "sizes" or group in SIZES:
                found += [Piece(group, name, run=run) for name, run in procedures]
        return found

    def __call__(self, index: int) -> Result:
        """One piece."""
        piece = self.pieces[index]
        if piece.errand is not None:
            return run_faults(self.engine, piece.errand, on_edge=piece.group == "edges")
        result = Result(statistics=Statistics(runs=1))
        errands = [*MATRIX, READ_OPEN, READ_PINNED, WRITE_PINNED]
        if piece.group == "formats":
            size = self.engine.sizes.last + 1
            errands += [*every_format(size), *full(size, self.engine.sizes.blocks)]
        made: list[JobField] = []

        def bed() -> JobField:
            made.append(JobField(self.engine, errands))
            return made[-1]

        assert piece.run is not None
        failure, counts = attempt(Procedure(piece.name, bed, piece.run))
        result.add(failure, self.engine.program, counts)
        result.statistics.scans = made[-1].scans
        return result


def run_faults(engine: DriveEngine, errand: Errand, most: int = MAX_FAILURES, *, on_edge: bool = False) -> Result:
    """Every fault of one job, after a failure on another CPU; ``on_edge``: REQ is an edge there."""
    statistics = Statistics()
    result = Result(statistics=statistics)

    def runner() -> Runner[EngineScenario]:
        rig = EngineRig(engine, MATRIX)
        rig.cpu.records.on_edge = on_edge
        return Runner(EngineConduct(rig, errand), statistics)

    now = runner()
    failure = now.try_run(EngineScenario(name="first run"))
    if failure is not None:
        result.add(failure, engine.program, now.conduct.rig.cpu.coverage)
        return result
    kinds = 0
    for scenario in _scenarios(engine, errand, statistics.longest):
        kinds += 1
        failure = now.try_run(scenario)
        if failure is not None:
            result.add(failure, engine.program, now.conduct.rig.cpu.coverage)
            if len(result.failures) >= most:
                return result
            now = runner()
    result.matrix = str(kinds)
    result.add(None, engine.program, now.conduct.rig.cpu.coverage)
    return result


def _scenarios(engine: DriveEngine, errand: Errand, scans: int) -> Iterator[EngineScenario]:
    """Every fault of one job; ``scans`` is how long a good run takes."""
    yield from record_faults(errand)
    yield from cpu_faults(errand, scans)
    yield from answer_faults(errand, engine.sizes.last + 1)
    yield from error_matrix(errand)


@dataclass(frozen=True, slots=True)
class EngineProof:
    """What the proof of an engine found; ``scenarios`` counts faults and procedures, ``runs`` jobs."""

    checks: tuple[Check, ...]
    scenarios: int
    runs: int
    scans: int

    @property
    def ok(self) -> bool:
        """Whether all of it holds."""
        return not any(check.outcome is Outcome.ERROR for check in self.checks)


def prove(engine: DriveEngine, effort: Effort = "ordinary", share: Sharing | None = None) -> EngineProof:
    """Run everything; ``share`` None uses every core. Raises DiagnosticError if the engine cannot be compiled."""
    work = EngineWork(engine, effort)
    program = engine.program

    def key(index: int) -> str:
        texts = [(Path(file).name, text) for file, text in engine.sources]
        return key_of("engine", engine.dialect, texts, engine.names, engine.mixed, effort, work.pieces[index])

    results = (share or Sharing()).results(work, len(work.pieces), key)
    checks: list[Check] = []
    kinds = 0
    for group in GROUPS:
        if not any(piece.group == group for piece in work.pieces):
            continue
        pairs = [(piece, result) for piece, result in zip(work.pieces, results, strict=True) if piece.group == group]
        count = sum(int(result.matrix or 1) for _, result in pairs)
        kinds += count
        checks.append(_group(group, [result for _, result in pairs], count))
    if effort != "sizes" and not any(result.failures for result in results):
        counts = added(program, results)
        seen = frozenset(step for result in results for step in result.statistics.transitions)
        checks += coverage_checks(engine, counts, seen)
    checks.append(Check("engine.rest", "engine rest", "", Outcome.NOT_RUN, f"not run: {'; '.join(_left_out(work))}"))
    runs, scans = (sum(getattr(result.statistics, name) for result in results) for name in ("runs", "scans"))
    return EngineProof(tuple(checks), kinds, runs, scans)


def _left_out(work: EngineWork) -> list[str]:
    """What is not run with this effort."""
    groups = {piece.group for piece in work.pieces}
    found = ["two instances with one slot, of which one interrupts the other in several scans"]
    if work.effort != "thorough":
        found = ["an interrupt at every point of every scan", "every set of blocks loaded after every scan", *found]
    if work.effort in {"sizes", "ordinary"}:
        found.insert(0, "70,000 jobs in a row on one instance")
    if work.effort == "sizes":
        found.insert(0, ", ".join(group for group in GROUPS if group not in groups and group != "copies"))
    return found


def coverage_checks(engine: DriveEngine, counts: list[int], seen: frozenset[Step]) -> Iterator[Check]:
    """Coverage of every block, and what is argued although it has decided; ``seen`` are the ways between states."""
    told: set[str] = set()
    for role in BLOCKS:
        name = engine.names[role]
        steps = TRANSITIONS - seen if role == "channel" else None
        block = CodeBlock(f"engine.{role}", name, name, (), partial(Span, ""), steps=steps, state=state_name)
        found = covered(engine, name, counts, steps)
        told.update(why for _, why in found.explained)
        yield coverage_check(block, found)
    for why in (one.why for one in ARGUED):
        if why not in told:
            message = f"an operand has decided although {why}: it is not to be argued"
            yield failed("engine.argued", "engine operands", "", Diagnostic("PG622", message, Span("")))


def covered(engine: DriveEngine, name: str, counts: list[int], steps: frozenset[Step] | None) -> Coverage:
    """Coverage of a block. Its state is one of STATES behind every call of every run, so that CASE has no other."""
    program = engine.program
    found = cover(program, name, counts, steps=steps)
    entry = program.link.find(name)
    nodes = ast.walk(entry.tree) if entry is not None else ()
    cases = [node for node in nodes if isinstance(node, ast.Case) and isinstance(node.selector, ast.Name)]
    position = entry.result.tokens.position if entry is not None else None
    places = {
        position(c.start) for c in cases if position and isinstance(c.selector, ast.Name) and c.selector.name == STATE
    }
    other = [(p, NO_OTHER) for p in found.missing if p.kind == "else" and (p.line, p.column) in places]
    explained = (*found.explained, *other, *argued(engine, found.missing))
    known = {probe for probe, _ in explained}
    missing = tuple(probe for probe in found.missing if probe not in known)
    return replace(found, missing=missing, explained=explained)


def _group(group: str, results: list[Result], count: int) -> Check:
    """The check of one group of scenarios."""
    name, subject = f"engine.{group}", f"engine {group}"
    failures = [failure for result in results for failure in result.failures]
    runs = sum(result.statistics.runs for result in results)
    text = (
        f"{count:,} scenarios, {runs:,} runs: {GROUPS[group]}"
        if runs > count
        else f"{count:,} scenarios: {GROUPS[group]}"
    )
    if failures:
        found = diagnostic("PG621", "engine", failures, PAGE)
        return failed(name, subject, text, found, str(failures[0]))
    cached = made(results, "parts")
    return Check(name, subject, f"{text}; {cached}" if cached else text, Outcome.OK, "ok")
