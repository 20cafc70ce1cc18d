"""What a drive saw, in one sentence: a request, an answer, a refused call."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from plcgen.base.diagnostics.counting import shortlist
from plcgen.ds47.texts import real_note
from plcgen.ds47.wire import formats
from plcgen.ds47.wire.codec import TelegramError, decode_request, decode_response
from plcgen.ds47.wire.errors import error_text
from plcgen.ds47.wire.model import ErrorBlock, ParameterAddress, Request, RequestId, Response, ValueBlock
from plcgen.ds47.wire.status import Retry, explain_status
from plcgen.report.trace.spelling import SHOWN, value_text

if TYPE_CHECKING:
    from plcgen.report.trace.model import Contact

_RETRY = {
    Retry.TEMPORARY: "temporary",
    Retry.RESTART: "write the request again",
    Retry.PERMANENT: "permanent",
}


def contact_text(contact: Contact, letters: Mapping[int, str] | None = None) -> str:
    """What a finished record service means; ``letters`` gives the r or P of parameter numbers."""
    if contact.status:
        status = explain_status(contact.status, contact.direction)
        advice = _RETRY.get(status.retry, "")
        return f"{status.text}{f' ({advice})' if advice else ''}"
    known = letters or {}
    try:
        if contact.direction == "write":
            return _request(decode_request(contact.data), known)
        asked = decode_request(contact.request) if contact.request else None
    except TelegramError as problem:
        return f"not a valid request: {problem.problems[0].message}"
    try:
        return _response(decode_response(contact.data, request=asked), asked, known)
    except TelegramError as problem:
        return f"not a valid answer: {problem.problems[0].message}"


def _label(address: ParameterAddress, letters: Mapping[int, str]) -> str:
    name = f"{letters.get(address.pnu, 'P')}{address.pnu}"
    if address.elements > 1:
        return f"{name}[{address.subindex}..{address.subindex + address.elements - 1}]"
    return f"{name}[{address.subindex}]" if address.subindex else name


def _request(request: Request, letters: Mapping[int, str]) -> str:
    change = request.request_id == RequestId.CHANGE
    labels = [_label(address, letters) for address in request.addresses]
    if change:
        labels = [f"{label} := {_block(block)}" for label, block in zip(labels, request.values, strict=False)]
    head = f"reference {request.reference}, object {request.drive_object}, {'change' if change else 'read'}"
    return f"{head} {_listed(labels)}"


def _response(response: Response, request: Request | None, letters: Mapping[int, str]) -> str:
    head = f"reference {response.reference}"
    labels = [_label(address, letters) for address in request.addresses] if request else []
    if not response.blocks:
        return f"{head}, accepted: {_listed(labels)}" if response.response_id < 0x80 else f"{head}, refused"
    if len(response.blocks) == 1 and response.count > 1:
        labels = ["the whole request"]
    found = []
    for position, block in enumerate(response.blocks):
        label = labels[position] if position < len(labels) else f"parameter {position + 1}"
        if isinstance(block, ErrorBlock):
            found.append(f"{label}: error {error_text(block.number).explain(block.info)}")
        elif isinstance(block, ValueBlock):
            found.append(f"{label} = {_block(block)}")
        else:
            found.append(f"{label}: no error of its own")
    return f"{head}, {_listed(found)}"


def _block(block: ValueBlock) -> str:
    fmt = formats.find(block.format)
    if fmt is None:
        return block.data.hex(" ").upper()
    values = block.values()
    real = real_note(block.data) if fmt.name == "DoubleWord" and len(block.data) == 4 else ""
    bits = fmt.size * 8 if fmt.name in {"Byte", "Word", "DoubleWord"} else 0
    plain = [value if isinstance(value, bool | int | float | str) else bytes(value) for value in values]
    if len(plain) == 1:
        return value_text(plain[0], bits=bits) + (f" ({real})" if real else "")
    shown = ", ".join(value_text(value, bits=bits) for value in plain[:SHOWN])
    return f"[{shown}, .. {len(plain)} values]" if len(plain) > SHOWN else f"[{shown}]"


def _listed(items: list[str]) -> str:
    return shortlist(items, SHOWN, f", .. {len(items)} parameters")
