"""``audit``: sources and a spec in, checks out, in the shape of a verification so that every report can show them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path

from plcgen.diagnostics import Diagnostic, DiagnosticError, Report, Severity
from plcgen.proof.checks import Check, CheckGroup, Outcome, Verification
from plcgen.protocols.ds47.audit.buffers import buffers, expected_fields, match_buffers, stray_requests
from plcgen.protocols.ds47.audit.calls import record_calls
from plcgen.protocols.ds47.audit.members import check_members
from plcgen.protocols.ds47.audit.model import Match
from plcgen.protocols.ds47.audit.records import CallAudit, check_calls
from plcgen.protocols.ds47.audit.values import check_values
from plcgen.protocols.ds47.plan.nouns import DrivePlan
from plcgen.sources.blocks import Sources, read_sources


def audit(paths: Sequence[Path], spec: Path) -> Verification:
    """Audit hand-written buffers and calls; every finding is a diagnostic, the checks say what was looked at."""
    label = ", ".join(path.as_posix() for path in paths[:3]) + (f" (+{len(paths) - 3})" if len(paths) > 3 else "")
    report = Report()
    try:
        return _audit(paths, spec, label, report)
    except DiagnosticError as problem:
        report.extend(problem.diagnostics)
    return Verification(str(spec), label, "", "", (), tuple(report), "audit")


def _audit(paths: Sequence[Path], spec: Path, label: str, report: Report) -> Verification:
    from plcgen.project.opening import open_spec

    opened = open_spec(spec)
    project = opened.sound()
    report.extend(opened.diagnostics)
    target = f"{project.target.family} / {project.target.toolchain}"
    sources = read_sources(paths, classic=project.target.classic)
    report.extend(sources.diagnostics)
    plan = project.plan(DrivePlan)
    if plan is None:
        return Verification(str(spec), label, project.name, target, (), tuple(report), "audit")
    problems: list[Diagnostic] = []
    found = buffers(sources, problems)
    matches = match_buffers(plan, found)
    for match in matches:
        _buffer(match, plan)
    calls = check_calls(plan, list(record_calls(sources)), matches)
    report.extend(problems)
    report.extend(stray_requests(plan, found, matches))
    for match in matches:
        report.extend(match.findings)
    for call in calls:
        report.extend(call.findings)
    groups = [CheckGroup("buffers", "Buffers", tuple(_buffer_check(match) for match in matches))]
    if calls or _has_code(sources):
        groups.append(CheckGroup("calls", "Calls", tuple(_call_checks(calls, matches))))
    return Verification(str(spec), label, project.name, target, tuple(groups), tuple(report), "audit")


def _has_code(sources: Sources) -> bool:
    return any(source.code.tokens for source in sources.blocks)


def _buffer(match: Match, plan: DrivePlan) -> None:
    """Everything about one DB."""
    buffer = match.buffer
    if buffer is None:
        return
    optimized = buffer.block.optimized
    if optimized or (optimized is None and plan.target.t15):
        message = f"{buffer.title} has optimized access: its members have no fixed places"
        match.report("PG654", message, buffer.span, "{ S7_Optimized_Access := 'FALSE' }")
    pairs = check_members(match, expected_fields(match), buffer.slots)
    if match.role == "request":
        need = len(match.telegram.request.data)
        if buffer.size < need:
            message = f"request buffer {need - buffer.size} bytes too small: {_size(match)}, the telegram {need}"
            match.report("PG651", message, buffer.span, f"declare all fields of the request: {need} bytes")
        check_values(match, pairs)
        return
    positive, negative = match.telegram.positive_length, match.telegram.negative_length
    need = max(positive, negative)
    if buffer.size < need:
        which = "the positive answer" if buffer.size < positive >= negative else "a negative answer"
        message = f"response buffer {need - buffer.size} bytes too small: {_size(match)}, {which} needs {need}"
        refused = which == "a negative answer" and match.telegram.writes
        formula = f"4 + 6 x {len(match.telegram.parts)}" if refused else need
        example = f"Reserve : Array[0..{need - buffer.size - 1}] of Byte;"
        help_ = f"add members up to {need} bytes ({formula}), for example {example}"
        match.report("PG651", message, buffer.span, help_)


def _size(match: Match) -> str:
    number = (
        match.ref.number if match.buffer is None or match.buffer.block.number is None else match.buffer.block.number
    )
    return f"DB{number} has {match.buffer.size if match.buffer is not None else 0} bytes"


def _buffer_check(match: Match) -> Check:
    id_ = f"buffers.{match.ref.name}"
    text = _figures(match)
    if match.buffer is None:
        first = match.findings[0] if match.findings else None
        subject = f'DB{match.ref.number} "{match.ref.name}"'
        outcome = Outcome.WARNING if first is not None else Outcome.NOT_RUN
        return Check(id_, subject, text, outcome, "not in the sources", first)
    return _check(id_, match.buffer.title, text, match.findings, match.notes, f"fits the {match.role} of {match.name}")


def _figures(match: Match) -> str:
    telegram = match.telegram
    if match.role == "request":
        text = f"{telegram.request.data.hex(' ').upper()}  LEN {len(telegram.request.data)}"
        text = text if len(text) < 90 else f"LEN {len(telegram.request.data)}"
    else:
        text = f"positive {telegram.positive_length} / negative {telegram.negative_length}"
    have = "" if match.buffer is None else f"{match.buffer.size} B, found by {match.how}"
    return f"{have}  {match.role} of {match.name}  {text}".strip()


def _call_checks(calls: Sequence[CallAudit], matches: Sequence[Match]) -> Iterator[Check]:
    for number, audit in enumerate(calls, 1):
        call = audit.call
        shown = [
            f"{name} {call.arguments[name].text}"
            for name in ("ID", "INDEX", "LEN", "MLEN", "RECORD")
            if name in call.arguments
        ]
        job = "" if audit.match is None else f"{audit.match.role} of {audit.match.name}"
        good = f"fits the {job}" if job else "not checked"
        id_ = f"calls.{number}.{call.block}"
        if audit.match is None and not audit.findings:
            yield Check(id_, call.title, "  ".join(shown), Outcome.NOT_RUN, "; ".join(audit.notes))
        else:
            yield _check(id_, call.title, "  ".join(shown), audit.findings, audit.notes, good)
    used = {id(audit.match) for audit in calls}
    for match in matches:
        if calls and match.buffer is not None and id(match) not in used:
            verb = "WRREC" if match.role == "request" else "RDREC"
            verdict = f"no {verb} call names it"
            yield Check(f"calls.{match.ref.name}", match.buffer.title, "", Outcome.NOT_RUN, verdict)


def _check(id_: str, subject: str, text: str, findings: Sequence[Diagnostic], notes: Sequence[str], good: str) -> Check:
    errors = [d for d in findings if d.severity is Severity.ERROR]
    if findings:
        first = (errors or list(findings))[0]
        more = f" (+{len(findings) - 1} more)" if len(findings) > 1 else ""
        outcome = Outcome.ERROR if errors else Outcome.WARNING
        return Check(id_, subject, text, outcome, f"{first.message}{more}", first)
    return Check(id_, subject, text, Outcome.OK, "; ".join([good, *notes]))
