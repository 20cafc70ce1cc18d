"""A telegram field by field, as a table or as data; a STATUS double word byte by byte."""

from __future__ import annotations

import math
import struct
from collections.abc import Sequence
from functools import partial
from typing import TYPE_CHECKING, Literal

from plcgen.base.diagnostics import Diagnostic, has_errors
from plcgen.base.display.cells import clean
from plcgen.base.display.data import diagnostic_data, head
from plcgen.base.display.results import Answer
from plcgen.base.display.view import View
from plcgen.base.telegrams.decoded import DecodedTelegram, TelegramField, telegram_data, telegram_text
from plcgen.base.telegrams.dissection import ByteField

if TYPE_CHECKING:
    from plcgen.ds47.wire.status import Status

_RETRY = {
    "none": "no error: nothing to repeat",
    "wait": "the job is running: call again with the same inputs",
    "temporary": "temporary: repeat the same call after a pause",
    "restart": "start the whole job again at WRREC",
    "permanent": "permanent: repeating does not help",
}


def real_note(data: bytes) -> str:
    """``as REAL 10.0`` for four bytes that are a plausible REAL, else an empty text."""
    (number,) = struct.unpack(">f", data)
    if number == 0 or not math.isfinite(number):
        return ""
    from plcgen.s7.types.literals import format_real

    return f"as REAL {format_real(number)}"


def dissect_telegram(
    data: bytes, kind: Literal["request", "response"] | None = None, request: bytes | None = None
) -> DecodedTelegram:
    """Name every field of a telegram; without ``kind`` its bytes tell request from response."""
    from plcgen.ds47.wire import codec
    from plcgen.ds47.wire.dissect import MAKERS, OF_A_MAKER, dissect_request, dissect_response, looks_like

    guess = kind or ("response" if request is not None else looks_like(data))
    if guess == "unknown":
        guess = "request"
    problems: list[tuple[int, str]] = []
    labels: dict[int, str] = {}
    asked = None
    try:
        if request is not None and request[1:2] not in MAKERS:
            asked = codec.decode_request(request)
            labels = {n: f"P{address.pnu}" for n, address in enumerate(asked.addresses, 1)}
    except codec.TelegramError as problem:
        problems = [(0, f"the request given as context is not valid: {problem}")]
    fields = dissect_request(data) if guess == "request" else dissect_response(data)
    if data[1:2] in MAKERS:  # PROFIdrive knows nothing of its form
        problems += [(one.offset, f"{one.name}: {one.note or one.value}") for one in fields if one.problem]
        return DecodedTelegram(guess, data, tuple(_field(f, data, labels) for f in fields), tuple(problems))
    named = {one.offset for one in fields if one.note == OF_A_MAKER and not one.problem}

    def found(*, strict: bool) -> list[codec.Problem]:
        try:
            if guess == "request":
                codec.decode_request(data, strict=strict)
            else:
                codec.decode_response(data, request=asked, strict=strict)
        except codec.TelegramError as problem:
            return [item for item in problem.problems if item.message != codec.RESERVED_REFERENCE]
        return []

    cut = found(strict=False)
    problems += [(one.offset, one.message) for one in found(strict=True) if one in cut or one.offset not in named]
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


def telegrams_answer(telegrams: Sequence[DecodedTelegram], diagnostics: Sequence[Diagnostic]) -> Answer:
    """Answer of ``decode``."""
    ok = all(t.ok for t in telegrams) and not has_errors(diagnostics)
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
