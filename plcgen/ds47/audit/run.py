"""The audit of drive jobs: buffers and record calls, as checks and findings."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from plcgen.base.diagnostics import Diagnostic
from plcgen.ds47.audit.buffers import expected_fields, match_buffers, stray_requests
from plcgen.ds47.audit.calls import record_calls
from plcgen.ds47.audit.members import check_members
from plcgen.ds47.audit.model import Match
from plcgen.ds47.audit.records import CallAudit, check_calls
from plcgen.ds47.audit.values import check_values
from plcgen.ds47.plan.nouns import DrivePlan
from plcgen.proof.audited import Audited, audited
from plcgen.proof.checks import Check, CheckGroup, Outcome
from plcgen.s7.read.blocks import Sources
from plcgen.s7.read.buffers import find_buffers


def audit(plan: DrivePlan, sources: Sources) -> Audited:
    """Audit hand-written buffers and calls; every finding is a diagnostic, the checks say what was looked at."""
    problems: list[Diagnostic] = []
    found = find_buffers(sources, problems)
    matches = match_buffers(plan, found)
    for match in matches:
        _buffer(match, plan)
    calls = check_calls(plan, list(record_calls(sources)), matches)
    problems += stray_requests(plan, found, matches)
    for findings in (*(match.findings for match in matches), *(call.findings for call in calls)):
        problems += findings.found
    groups = [CheckGroup("buffers", "Buffers", tuple(_buffer_check(match) for match in matches))]
    if calls or _has_code(sources):
        groups.append(CheckGroup("calls", "Calls", tuple(_call_checks(calls, matches))))
    return Audited(tuple(groups), tuple(problems))


def _has_code(sources: Sources) -> bool:
    return any(source.code.tokens for source in sources.blocks)


def _buffer(match: Match, plan: DrivePlan) -> None:
    """Everything about one DB."""
    buffer = match.buffer
    if buffer is None:
        return
    optimized = buffer.block.optimized
    if optimized or (optimized is None and plan.target.t15):
        message = f"{buffer.title} has optimized access: its members have no fixed offsets"
        match.findings.report("PG654", message, buffer.span, "{ S7_Optimized_Access := 'FALSE' }")
    pairs = check_members(match, expected_fields(match), buffer.slots)
    if match.role == "request":
        need = len(match.telegram.request.data)
        if buffer.size < need:
            message = f"request buffer {need - buffer.size} bytes too small: {_size(match)}, the telegram {need}"
            match.findings.report("PG651", message, buffer.span, f"declare all fields of the request: {need} bytes")
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
        match.findings.report("PG651", message, buffer.span, help_)


def _size(match: Match) -> str:
    number = (
        match.ref.number if match.buffer is None or match.buffer.block.number is None else match.buffer.block.number
    )
    return f"DB{number} has {match.buffer.size if match.buffer is not None else 0} bytes"


def _buffer_check(match: Match) -> Check:
    id_ = f"buffers.{match.ref.name}"
    text = _figures(match)
    if match.buffer is None:
        first = match.findings.found[0] if match.findings.found else None
        subject = f'DB{match.ref.number} "{match.ref.name}"'
        outcome = Outcome.WARNING if first is not None else Outcome.NOT_RUN
        return Check(id_, subject, text, outcome, "not in the sources", first)
    return audited(id_, match.buffer.title, text, match.findings, f"fits the {match.role} of {match.name}")


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
        if audit.match is None and not audit.findings.found:
            yield Check(id_, call.title, "  ".join(shown), Outcome.NOT_RUN, "; ".join(audit.findings.notes))
        else:
            yield audited(id_, call.title, "  ".join(shown), audit.findings, good)
    used = {id(audit.match) for audit in calls}
    for match in matches:
        if calls and match.buffer is not None and id(match) not in used:
            verb = "WRREC" if match.role == "request" else "RDREC"
            verdict = f"no {verb} call names it"
            yield Check(f"calls.{match.ref.name}", match.buffer.title, "", Outcome.NOT_RUN, verdict)
