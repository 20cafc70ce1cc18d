"""A telegram field by field, as a table or as data; a STATUS double word byte by byte."""

from __future__ import annotations

import math
import re
import struct
from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any, Literal

from plcgen.diagnostics import Diagnostic, Severity
from plcgen.output.cells import clean, cut
from plcgen.output.data import diagnostic_data, head
from plcgen.output.results import Answer
from plcgen.output.table import text_table
from plcgen.output.view import View

if TYPE_CHECKING:
    from plcgen.protocols.dissection import ByteField
    from plcgen.protocols.ds47.wire.status import Status

HEADER = ("offset", "bytes", "field", "value", "meaning")
_SHOWN = 8
_PARAMETER = re.compile(r"((?:parameter|item|value) [0-9]+(?: \([^)]*\))?) (.+)")
_RETRY = {
    "none": "no error: nothing to repeat",
    "wait": "the job is running: call again with the same inputs",
    "temporary": "temporary: repeat the same call after a pause",
    "restart": "start the whole job again at WRREC",
    "permanent": "permanent: repeating does not help",
}


@dataclass(frozen=True, slots=True)
class TelegramField:
    """One field: byte ``offset`` and bytes, name, value as text, meaning; ``problem`` marks a wrong one."""

    offset: int
    data: bytes
    name: str
    value: str
    note: str
    problem: bool


@dataclass(frozen=True, slots=True)
class DecodedTelegram:
    """A telegram taken apart: ``kind`` request or response, every field, what is wrong as (offset, message)."""

    kind: str
    data: bytes
    fields: tuple[TelegramField, ...]
    problems: tuple[tuple[int, str], ...]

    @property
    def ok(self) -> bool:
        """Whether the telegram is valid."""
        return not self.problems


def real_note(data: bytes) -> str:
    """``as REAL 10.0`` for four bytes that are a plausible REAL, else an empty text."""
    (number,) = struct.unpack(">f", data)
    if number == 0 or not math.isfinite(number):
        return ""
    from plcgen.s7.spelling import format_real

    return f"as REAL {format_real(number)}"


def dissect(
    data: bytes, kind: Literal["request", "response"] | None = None, request: bytes | None = None
) -> DecodedTelegram:
    """Name every field of a telegram; without ``kind`` its bytes tell request from response."""
    from plcgen.protocols.ds47.wire import codec
    from plcgen.protocols.ds47.wire.dissect import dissect_request, dissect_response, looks_like

    guess = kind or ("response" if request is not None else looks_like(data))
    if guess == "unknown":
        guess = "request"
    problems: list[tuple[int, str]] = []
    labels: dict[int, str] = {}
    try:
        asked = codec.decode_request(request) if request is not None else None
        if asked is not None:
            labels = {n: f"P{address.pnu}" for n, address in enumerate(asked.addresses, 1)}
    except codec.TelegramError as problem:
        asked = None
        problems = [(0, f"the request given as context is not valid: {problem}")]
    try:
        if guess == "request":
            codec.decode_request(data)
        else:
            codec.decode_response(data, request=asked)
    except codec.TelegramError as problem:
        problems += [(item.offset, item.message) for item in problem.problems]
    fields = dissect_request(data) if guess == "request" else dissect_response(data)
    return DecodedTelegram(guess, data, tuple(_field(f, data, labels) for f in fields), tuple(problems))


def _field(found: ByteField, data: bytes, labels: dict[int, str]) -> TelegramField:
    chunk = data[found.offset : found.offset + found.length]
    name, note = found.name, found.note
    first, number, *rest = [*name.split(" ", 2), "", ""]
    if first == "parameter" and number.isdigit() and int(number) in labels:
        name = f"parameter {number} ({labels[int(number)]}) {rest[0]}"
    if note == "DoubleWord" and len(chunk) == 4 and " value" in name:
        real = real_note(chunk)
        note = f"{note}, {real}" if real else note
    return TelegramField(found.offset, chunk, name, found.value, note, found.problem)


def telegram_text(telegram: DecodedTelegram, view: View) -> str:
    """Table of all fields; ``!`` marks the wrong ones."""
    rows: list[tuple[str, ...]] = []
    wrong: list[bool] = []
    section = ""
    for field in telegram.fields:
        found = _PARAMETER.match(field.name)
        if found and found[1] != section:
            section = found[1]
            rows.append(("", "", section, "", ""))
            wrong.append(False)
        name = f"  {found[2]}" if found else field.name
        offset = f"{'! ' if field.problem else ''}{field.offset}"
        rows.append((offset, _bytes(field.data), name, cut(clean(field.value), 40), field.note))
        wrong.append(field.problem)
    header, *lines = text_table(HEADER, rows, right=frozenset({0}), limit=view.width)
    shown = [view.paint(line, "error" if bad else "") for line, bad in zip(lines, wrong, strict=True)]
    count = len(telegram.data)
    title = f"{view.paint(telegram.kind, 'bold')}, {count} byte{'' if count == 1 else 's'}"
    return "\n".join([title, view.paint(header, "dim"), *shown]) + "\n"


def _bytes(data: bytes) -> str:
    text = data[:_SHOWN].hex(" ").upper()
    return f"{text} ..." if len(data) > _SHOWN else text


def telegram_data(telegram: DecodedTelegram) -> dict[str, Any]:
    """One telegram as plain data."""
    return {
        "kind": telegram.kind,
        "ok": telegram.ok,
        "hex": telegram.data.hex().upper(),
        "length": len(telegram.data),
        "fields": [
            {
                "offset": f.offset,
                "length": len(f.data),
                "hex": f.data.hex().upper(),
                "name": f.name,
                "value": f.value,
                "meaning": f.note,
                "problem": f.problem,
            }
            for f in telegram.fields
        ],
        "problems": [{"offset": offset, "message": message} for offset, message in telegram.problems],
    }


def telegrams_answer(telegrams: Sequence[DecodedTelegram], diagnostics: Sequence[Diagnostic]) -> Answer:
    """Answer of ``decode``."""
    ok = all(t.ok for t in telegrams) and not any(d.severity is Severity.ERROR for d in diagnostics)
    found = {"telegrams": list(map(telegram_data, telegrams)), "diagnostics": list(map(diagnostic_data, diagnostics))}
    text = partial(_telegrams_text, telegrams)
    return Answer({**head("telegrams", ok=ok), **found}, text, diagnostics)


def _telegrams_text(telegrams: Sequence[DecodedTelegram], view: View) -> str:
    return "\n".join(telegram_text(telegram, view) for telegram in telegrams)


def status_text(status: Status, view: View) -> str:
    """STATUS byte by byte, its meaning, and what to do next."""
    style = "error" if status.error else "ok"
    rows = [
        ("Function_Num", f"{status.function_num:02X}h"),
        ("Error_Decode", f"{status.error_decode:02X}h"),
        ("Error_Code_1", f"{status.code1:02X}h"),
        ("Error_Code_2", f"{status.code2:02X}h"),
        ("retry", _RETRY[status.retry.value]),
    ]
    title = f"STATUS {status.value:08X}h  {view.paint(clean(status.text), style)}"
    return "\n".join([title, *(f"  {name:<12}  {text}" for name, text in rows)]) + "\n"


def status_answer(status: Status) -> Answer:
    """Answer of ``decode --status``."""
    data = {
        **head("status", ok=not status.error),
        "status": f"{status.value:08X}",
        "function_num": status.function_num,
        "error_decode": status.error_decode,
        "error_code_1": status.code1,
        "error_code_2": status.code2,
        "meaning": status.text,
        "error": status.error,
        "retry": status.retry.value,
        "advice": _RETRY[status.retry.value],
    }
    return Answer(data, partial(status_text, status))
