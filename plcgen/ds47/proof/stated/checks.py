"""The rows of a report about the statement: one for all jobs that keep it, one for each that does not."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from plcgen.base.diagnostics import Diagnostic, Note, Span
from plcgen.base.diagnostics.counting import quantity
from plcgen.ds47.proof.stated.keeping import jobs_kept
from plcgen.ds47.proof.stated.source import kinds_of_others, spec_source
from plcgen.oracles.spec.ds47.course import Difference
from plcgen.oracles.spec.ds47.state import state_jobs
from plcgen.oracles.spec.ds47.statement import StatedJob, Statement, Unstated
from plcgen.oracles.spec.place import NotStatedError, SpecPlace
from plcgen.project.spec import LoadedSpec
from plcgen.proof.checks import Check, Outcome
from plcgen.s7.cpu.program import Program

CODE = "PG641"
SHOWN = 3
PAGE = "docs/verify.md says what is compared with the spec"


def stated_checks(loaded: LoadedSpec, program: Program, constants: Mapping[str, int], family: str) -> Iterator[Check]:
    """Every job of the spec: what the files do against what it demands."""
    source = spec_source(loaded)
    try:
        statement = state_jobs(source, kinds_of_others())
    except (NotStatedError, LookupError, TypeError, ValueError) as problem:
        message = f"what the spec demands cannot be stated: {problem}"
        yield _failed("spec", "spec", Diagnostic(CODE, message, loaded.key_span(("drives",)), help=PAGE), message)
        return
    found = jobs_kept(program, statement, constants, family)
    yield from _rows(statement, found)


def _rows(statement: Statement, found: Mapping[str, Sequence[Difference]]) -> Iterator[Check]:
    jobs = list(dict.fromkeys(job.key for job in statement.jobs))
    wrong = [key for key in jobs if found.get(key)]
    total = len(jobs) + len(statement.unstated)
    text = f"{quantity(len(statement.jobs), 'instance')} on {quantity(len(statement.drives), 'drive')}"
    verdict = f"{len(jobs) - len(wrong)} of {total} jobs stated and kept"
    if len(wrong) + len(statement.unstated) < total or not total:
        yield Check("spec", "spec", text, Outcome.OK, verdict)
    for key in wrong:
        job = next(job for job in statement.jobs if job.key == key)
        yield _difference(job, found[key])
    for unstated in statement.unstated:
        yield _unstated(unstated)


def _difference(job: StatedJob, found: Sequence[Difference]) -> Check:
    first = found[0]
    others = {str(one): one for one in reversed(found[1:]) if str(one) != str(first)}
    notes = tuple(Note(f"also {text}", _span(one.place)) for text, one in list(others.items())[::-1][: SHOWN - 1])
    message = f"{job.key}: the spec demands {first.expected}, found {first.found}"
    problem = Diagnostic(CODE, message, _span(first.place), notes=notes, help=PAGE)
    return _failed(f"spec.{job.key}", f"spec {job.key}", problem, f"{first}")


def _unstated(job: Unstated) -> Check:
    message = f"{job.key}: not stated: {job.reason}"
    problem = Diagnostic(CODE, message, _span(job.place), help=PAGE)
    return _failed(f"spec.{job.key}", f"spec {job.key}", problem, "not stated")


def _failed(id_: str, subject: str, problem: Diagnostic, verdict: str) -> Check:
    return Check(id_, subject, "", Outcome.ERROR, verdict, problem)


def _span(place: SpecPlace) -> Span:
    return Span(place.file, place.line, place.column)
