"""Start values of a request DB: do they ask the drive for what the spec says?"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

from plcgen.base.diagnostics import Severity
from plcgen.ds47.audit.members import Pair
from plcgen.ds47.audit.model import Expected, Match
from plcgen.ds47.wire import formats
from plcgen.ds47.wire.bico import read_bico
from plcgen.s7.read.buffers import Slot


def check_values(match: Match, pairs: Sequence[Pair]) -> None:
    """Report every field whose start value asks for something else; nothing if none is given at all.

    A DB that holds zeros only is filled by a watch table or by the program, as in FAQ 109750712.
    """
    buffer = match.buffer
    if buffer is None or buffer.memory is None:
        return
    covered = [slot for _, slots in pairs for slot in slots]
    if not any(buffer.memory[slot.offset : slot.end] != bytes(slot.size) for slot in covered):
        match.findings.notes.append("start values are zero: a watch table or the program fills them in")
        return
    swapped = _swapped(match, pairs, buffer.memory)
    for fields, slots in pairs:
        if len(fields) == 1 and fields[0].role in swapped:
            continue
        found = b"".join(buffer.memory[slot.offset : slot.end] for slot in slots)
        _compare(match, fields, slots, found)


def _swapped(match: Match, pairs: Sequence[Pair], memory: bytes) -> set[str]:
    """Parameter number and subindex exchanged: one finding instead of two."""
    words = [(fields[0], slots[0]) for fields, slots in pairs if len(fields) == len(slots) == 1]
    for (first, here), (second, there) in pairwise(words):
        if (first.role, second.role) != ("pnu", "subindex") or first.data == second.data:
            continue
        given = memory[here.offset : here.end], memory[there.offset : there.end]
        if given == (second.data, first.data):
            wanted = first.part.use.label if first.part is not None else ""
            message = (
                f"start values of {here.path} and {there.path} are swapped: they ask for "
                f"P{int.from_bytes(given[0])}[{int.from_bytes(given[1])}] instead of {wanted}"
            )
            match.findings.report("PG656", message, here.span, "swap the two values")
            return {"pnu", "subindex"}
    return set()


def _compare(match: Match, fields: Sequence[Expected], slots: Sequence[Slot], found: bytes) -> None:
    at = 0
    for field in fields:
        own = found[at : at + field.size]
        at += field.size
        if field.data is None or own == field.data or _accepted(field, own, match.job.drive.drive_object):
            continue
        slot = slots[0]
        where = slot.path if len(fields) == 1 else f"{slot.path} (byte {field.offset})"
        if not any(own) and not any(s.given for s in slots):
            message = f"{where} has no start value: the {field.label} is {_shown(field, field.data)}"
            help_ = "give it one, unless the program writes it before every request"
            match.findings.report("PG656", message, slot.span, help_, severity=Severity.WARNING)
            continue
        message = f"{where} holds {_shown(field, own)}, the {field.label} is {_shown(field, field.data)}"
        match.findings.report("PG656", message, slot.span, f"{slot.path} := {_literal(field.data)}")


def _accepted(field: Expected, own: bytes, drive_object: int) -> bool:
    """Other values that ask for the same thing."""
    if field.role == "reference":
        return own != b"\0" or field.data is None
    if field.part is None:
        return False
    if field.role == "elements" and field.part.use.first is None:
        return own in {b"\0", b"\1"}
    if field.role == "format":
        return formats.accepts(field.part.use.format, own[0])
    if field.role == "value" and field.part.use.sources and field.data is not None:
        given, wanted = (read_bico(int.from_bytes(data)).seen_from(drive_object) for data in (own, field.data))
        return given == wanted
    return False


def _shown(field: Expected, data: bytes) -> str:
    number = int.from_bytes(data)
    if field.role == "value" and field.format is not None and not field.format.is_string:
        try:
            (value,) = formats.unpack_values(field.format, 1, data)
        except (ValueError, formats.FormatValueError):
            return data.hex(" ").upper()
        if field.part is not None and field.part.use.sources and isinstance(value, int) and value >> 16:
            return f"{read_bico(value)} ({data.hex(' ').upper()})"
        return f"{value!r} ({data.hex(' ').upper()})"
    if field.role == "pnu":
        return f"{number} ({_literal(data)})"
    if field.role == "format":
        known = formats.find(number)
        return f"{_literal(data)} ({known.name if known else 'unknown format'})"
    if field.role == "request_id":
        return f"{_literal(data)} ({ {1: 'read', 2: 'change'}.get(number, 'no request') })"
    return _literal(data) if len(data) <= 8 else data.hex(" ").upper()


def _literal(data: bytes) -> str:
    return f"16#{data.hex().upper()}"
