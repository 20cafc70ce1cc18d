"""Record calls against the telegrams whose buffers they name: LEN, MLEN, RECORD, INDEX, ID."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

from plcgen.base.diagnostics import Note, Span
from plcgen.ds47.audit.model import FoundCall, Match
from plcgen.ds47.plan.nouns import DrivePlan
from plcgen.project.target import Target
from plcgen.proof.audited import AuditFindings
from plcgen.s7.read.calls import ConstantArgument, PointedArea

_RECORD_LIMIT = 240


@dataclass(slots=True)
class CallAudit:
    """One call with the buffer it names, if that is known, and what is wrong with it."""

    call: FoundCall
    match: Match | None
    findings: AuditFindings = field(default_factory=AuditFindings)


def check_calls(plan: DrivePlan, calls: Sequence[FoundCall], matches: Sequence[Match]) -> list[CallAudit]:
    """Every call, checked as far as its arguments are constants."""
    audits = []
    for call in calls:
        audit = CallAudit(call, _match(call.record, matches))
        _record(audit, matches)
        if audit.match is not None:
            _length(audit, audit.match)
            _index(audit, audit.match)
            _id(audit, audit.match, plan.target)
        else:
            _alone(audit, plan)
        audits.append(audit)
    _fetched_twice(audits)
    _never_fetched(audits, matches)
    return audits


def _fetched_twice(audits: Sequence[CallAudit]) -> None:
    """One response DB for each RDREC: the answer that comes later overwrites the other."""
    first: dict[int, CallAudit] = {}
    for audit in audits:
        if audit.call.writes or audit.match is None or audit.match.role != "response" or audit.call.record is None:
            continue
        other = first.setdefault(id(audit.match), audit)
        if other is not audit:
            message = f"{audit.call.title} fills {audit.call.record.text}, which {other.call.title} already fills"
            notes = (Note("the other call", other.call.span),)
            audit.findings.report(
                "PG659", message, audit.call.span, "give each RDREC a response DB of its own", notes=notes
            )


def _never_fetched(audits: Sequence[CallAudit], matches: Sequence[Match]) -> None:
    """A request that is sent has an answer; if every RDREC is known and none fetches it, nobody does.

    Sources without any RDREC are a part of a program.
    """
    reads = [audit.match for audit in audits if not audit.call.writes]
    if not reads or None in reads:
        return
    sent = {id(audit.match.telegram) for audit in audits if audit.match is not None and audit.call.writes}
    fetched = {id(audit.match.telegram) for audit in audits if audit.match is not None and not audit.call.writes}
    for match in matches:
        if match.role == "response" and match.buffer is not None and id(match.telegram) in sent - fetched:
            message = f"{match.buffer.title} is never filled: its request is sent, but no RDREC fetches the answer"
            match.findings.report("PG659", message, match.buffer.span, "call RDREC with this DB as RECORD after WRREC")


def _match(record: PointedArea | None, matches: Sequence[Match]) -> Match | None:
    if record is None or record.local:
        return None
    for match in matches:
        names = {match.ref.name.upper()}
        numbers = {match.ref.number}
        if match.buffer is not None:
            names = {match.buffer.block.name.upper()}
            numbers = {match.buffer.block.number} if match.buffer.block.number is not None else numbers
        if (record.db and record.db.upper() in names) or (record.number is not None and record.number in numbers):
            return match
    return None


def _record(audit: CallAudit, matches: Sequence[Match]) -> None:
    """RECORD names a request for WRREC, a response for RDREC, from its first byte, as long as it has to be."""
    call, match, record = audit.call, audit.match, audit.call.record
    if match is None or record is None:
        return
    role = "request" if call.writes else "response"
    if match.role != role:
        other = next(m for m in matches if m.telegram is match.telegram and m.role == role)
        wanted = other.buffer.title if other.buffer is not None else f'"{other.ref.name}"'
        message = f"RECORD of {call.title} is the {match.role} of {match.name}, {record.text}"
        help_ = f"the {role} is {wanted}"
        audit.findings.report("PG659", message, record.span, help_)
        audit.match = other
        return
    if record.start:
        message = f"RECORD of {call.title} begins at byte {record.start} of {record.text}, the telegram at byte 0"
        audit.findings.report("PG659", message, record.span, "let RECORD begin at the first byte of the DB")
    need = len(match.telegram.request.data) if call.writes else _longest(match)
    room = _room(record, match)
    if record.length is not None and record.length < need and (match.buffer is None or match.buffer.size >= need):
        what = "the request has" if call.writes else "an answer can have"
        message = f"RECORD of {call.title} covers {record.length} bytes, {what} {need}"
        audit.findings.report(
            "PG659", message, record.span, f"let RECORD cover {need} bytes: {_pointer(record, match, need)}"
        )
    elif match.buffer is not None and record.length is not None and room is not None and record.length > room >= need:
        message = f"RECORD of {call.title} covers {record.length} bytes, {match.buffer.title} has {match.buffer.size}"
        audit.findings.report(
            "PG659", message, record.span, f"let RECORD cover {need} bytes: {_pointer(record, match, need)}"
        )


def _pointer(record: PointedArea, match: Match, need: int) -> str:
    number = record.number if record.number is not None else match.ref.number
    return f"P#DB{number}.DBX0.0 BYTE {need}"


def _longest(match: Match) -> int:
    return max(match.telegram.positive_length, match.telegram.negative_length)


def _room(record: PointedArea, match: Match) -> int | None:
    return None if match.buffer is None else match.buffer.size - record.start


def _length(audit: CallAudit, match: Match) -> None:
    call = audit.call
    name = "LEN" if call.writes else "MLEN"
    argument = call.arguments.get(name)
    if argument is not None and argument.value is None:
        audit.findings.notes.append(f"{name} is {argument.text}: not checked")
        return
    value = argument.value if argument is not None else 0
    place = argument.span if argument is not None else call.span
    (_written if call.writes else _fetched)(audit, match, value or 0, place)


def _written(audit: CallAudit, match: Match, value: int, place: Span) -> None:
    """LEN is exactly the length of the telegram; without it the length of RECORD is sent."""
    need = len(match.telegram.request.data)
    record = audit.call.record
    sent = value
    how = f"LEN is {value}"
    if not value:
        sent = _sent(record, match)
        how = f"without LEN the {sent} bytes of RECORD are sent"
    if sent == need or not sent:
        return
    if sent > need:
        strict = match.job.drive.device.strict_length
        extra = sent - need
        what = "a strict drive answers error 18h" if not strict else f"{match.job.drive.device.title} answers error 18h"
        message = f"{how}, the request of {match.name} has {need} bytes: {extra} too many, {what}"
    else:
        message = f"{how}, the request of {match.name} has {need} bytes: its last {need - sent} are cut off"
    audit.findings.report("PG657", message, place, f"LEN := {need}", notes=_spec(match))


def _sent(record: PointedArea | None, match: Match) -> int:
    if record is not None and record.length is not None:
        return record.length
    return match.buffer.size if match.buffer is not None and record is not None and not record.path else 0


def _fetched(audit: CallAudit, match: Match, value: int, place: Span) -> None:
    """MLEN covers the longest answer and not more than RECORD has."""
    need = _longest(match)
    positive, negative = match.telegram.positive_length, match.telegram.negative_length
    if value and value < need:
        which = "the positive" if positive > value else "a negative"
        message = (
            f"MLEN is {value}, {which} answer of {match.name} has {need if which != 'the positive' else positive} bytes"
        )
        help_ = f"MLEN := {need} (positive {positive}, negative {negative}): a longer record is refused (80A1) or cut"
        audit.findings.report("PG658", message, place, help_, notes=_spec(match))
        return
    record = audit.call.record
    room = record.length if record is not None and record.length is not None else None
    if room is None and match.buffer is not None and record is not None and not record.path:
        room = match.buffer.size - record.start
    if value and room is not None and value > room:
        message = f"MLEN is {value}, RECORD has room for {room} bytes"
        audit.findings.report(
            "PG658", message, place, f"MLEN := {min(room, max(need, 1))}, or a larger buffer", notes=_spec(match)
        )


def _spec(match: Match) -> tuple[Note, ...]:
    if match.buffer is None:
        return ()
    return (Note(f"the {match.role} of {match.name}", match.buffer.span),)


def _index(audit: CallAudit, match: Match) -> None:
    argument = audit.call.arguments["INDEX"]
    wanted = match.job.drive.record_index
    if argument.value is None or argument.value & 0xFFFF == wanted:
        return
    message = f"INDEX is {argument.text}, {match.job.drive.device.title} expects {wanted} (16#{wanted:04X})"
    help_ = f"INDEX := {wanted}" if wanted < 0x8000 else f"INDEX := 16#{wanted:04X} (as an INT {wanted - 0x10000})"
    audit.findings.report("PG660", message, argument.span, help_)


def _id(audit: CallAudit, match: Match, target: Target) -> None:
    argument: ConstantArgument | None = audit.call.arguments.get("ID")
    wanted = match.job.drive.id_value
    if argument is None or argument.value is None:
        if argument is not None and argument.value is None:
            audit.findings.notes.append(f"ID is {argument.text}: not checked")
        return
    if argument.value == wanted:
        return
    message = f"ID is {argument.text} ({argument.value}), drive {match.job.drive.key} has {wanted} (16#{wanted:04X})"
    spelled = f"DW#16#{wanted:08X}" if target.classic else str(wanted)
    audit.findings.report("PG661", message, argument.span, f"ID := {spelled}, or correct the address in the spec")


def _alone(audit: CallAudit, plan: DrivePlan) -> None:
    """A call whose RECORD belongs to no job: its constants can still contradict themselves."""
    call, record = audit.call, audit.call.record
    name = "LEN" if call.writes else "MLEN"
    argument = call.arguments.get(name)
    value = None if argument is None else argument.value
    if argument is not None and value is not None and record is not None and record.length is not None:
        if value > record.length:
            code = "PG657" if call.writes else "PG658"
            message = f"{name} is {value}, RECORD covers {record.length} bytes"
            audit.findings.report(code, message, argument.span, f"{name} is at most the length of RECORD")
        elif value > _RECORD_LIMIT:
            audit.findings.notes.append(f"{name} is {value}, a parameter record has at most {_RECORD_LIMIT} bytes")
    known = {drive.record_index for drive in plan.drives}
    index = call.arguments["INDEX"]
    if index.value is not None and index.value & 0xFFFF not in known:
        audit.findings.notes.append(f"INDEX {index.text} is not that of a drive of the spec")
    what = (
        "is a variable: it is not known which job it is for" if record is None or record.local else "belongs to no job"
    )
    audit.findings.notes.append(f"RECORD {record.text if record is not None else ''} {what}")
