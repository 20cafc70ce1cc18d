"""Calls of serial modules against the telegrams and buffers they name.

A call is known by its parameters: DB_NO with DBB_NO (P_SND_RK and P_RCV_RK of a CP 341, P_SEND and P_RCV of a CP 340),
or PORT with BUFFER (Send_P2P and Receive_P2P of CM 1241, CB 1241 and CM PtP, SEND_PTP and RCV_PTP). LENGTH 0 sends the
whole BUFFER (S7-1200 system manual, "LENGTH and BUFFER parameters").
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

from plcgen.base.diagnostics import Note
from plcgen.ppi.audit.model import CallMemory, FoundTelegram, ModuleCall
from plcgen.ppi.wire.model import ReadRequest
from plcgen.ppi.wire.pdu import reply_size
from plcgen.ppi.wire.telegram import PDU_OFFSET
from plcgen.s7.read.blocks import Sources
from plcgen.s7.read.buffers import FoundBuffer
from plcgen.s7.read.calls import ConstantArgument, PointedArea, SourceCall, find_calls

_BY_NUMBER = frozenset({"DB_NO", "DBB_NO"})
_BY_POINTER = frozenset({"PORT", "BUFFER"})
_SENDS = frozenset({"REQ", "DONE", "SF"})
_FRAME = PDU_OFFSET + 2


def module_calls(sources: Sources, buffers: Sequence[FoundBuffer]) -> Iterator[ModuleCall]:
    """Every call that sends or receives."""
    for call in find_calls(sources, _BY_NUMBER):
        sends = bool(_SENDS & call.arguments.keys())
        found = ModuleCall(call, sends, "P_SND_RK" if sends else "P_RCV_RK")
        _numbered(found, buffers)
        yield found
    for call in find_calls(sources, _BY_POINTER, "BUFFER"):
        sends = bool(_SENDS & call.arguments.keys())
        found = ModuleCall(call, sends, "Send_P2P" if sends else "Receive_P2P")
        _pointed(found, call.area, buffers)
        yield found


def _numbered(found: ModuleCall, buffers: Sequence[FoundBuffer]) -> None:
    """DB and byte by number."""
    number, byte = (found.call.arguments[name] for name in ("DB_NO", "DBB_NO"))
    for name, argument in (("DB_NO", number), ("DBB_NO", byte)):
        if argument.value is None:
            found.findings.notes.append(f"{name} is {argument.text}: not checked")
            return
    buffer = next((one for one in buffers if one.block.number == number.value), None)
    if buffer is None:
        found.findings.notes.append(f"DB{number.value} is not in the sources")
        return
    start = byte.value or 0
    if not 0 <= start < buffer.size:
        message = f"DBB_NO of {found.title} is {start}, {buffer.title} has {buffer.size} bytes"
        found.findings.report("PG674", message, byte.span, "point into the data block", notes=_where(buffer))
        return
    text = f"{buffer.title} byte {start}"
    found.room = CallMemory(text, byte.span, buffer.size - start, start, buffer)


def _pointed(found: ModuleCall, area: PointedArea | None, buffers: Sequence[FoundBuffer]) -> None:
    """BUFFER: a DB or a part of one, a pointer, or a variable of the block."""
    if area is None:
        return
    if area.local:
        found.room = CallMemory(area.text, area.span, area.length)
        return
    buffer = next((one for one in buffers if _is(one, area)), None)
    if buffer is None:
        found.findings.notes.append(f"BUFFER {area.text}: its DB is not in the sources")
        return
    start, size = area.start, area.length if area.length is not None else buffer.size - area.start
    if area.path:
        path = area.path.upper()
        own = [slot for slot in buffer.slots if f"{slot.path.upper()}.".startswith((f"{path}.", f"{path}["))]
        if not own:
            found.findings.notes.append(f"BUFFER {area.text}: not checked")
            return
        start, size = own[0].offset, own[-1].end - own[0].offset
    if start + size > buffer.size:
        message = f"BUFFER of {found.title} ends at byte {start + size}, {buffer.title} has {buffer.size}"
        found.findings.report("PG674", message, area.span, "point into the data block", notes=_where(buffer))
        return
    found.room = CallMemory(area.text, area.span, size, start, buffer)


def _is(buffer: FoundBuffer, area: PointedArea) -> bool:
    if area.number is not None:
        return buffer.block.number == area.number
    return buffer.block.name.upper() == area.db.upper()


def _where(buffer: FoundBuffer) -> tuple[Note, ...]:
    return (Note("the data block", buffer.span),)


def check_sending(found: ModuleCall, telegrams: Iterable[FoundTelegram]) -> None:
    """What is sent begins with a telegram, and is as long."""
    room = found.room
    if room is None or not found.sends:
        return
    own = [telegram for telegram in telegrams if _lies_in(found, telegram, room)]
    begun = [telegram for telegram in own if telegram.start == (room.start if room.buffer is not None else 0)]
    if own and not begun:
        first = own[0]
        message = f"{found.title} sends from {room.text}, the telegram begins at byte {first.start}"
        notes = (Note("the telegram", first.span(0)),)
        found.findings.report(
            "PG674", message, room.span, "let the call begin at the first byte of the telegram", notes=notes
        )
        return
    argument = found.call.arguments.get("LEN") or found.call.arguments.get("LENGTH")
    if argument is not None and argument.value is None:
        found.findings.notes.append(f"length {argument.text}: not checked")
        return
    if argument is None:
        found.findings.notes.append("no length: not checked")
        return
    _length(found, room, argument, begun)


def _lies_in(found: ModuleCall, telegram: FoundTelegram, room: CallMemory) -> bool:
    if room.buffer is not None:
        end = room.start + (room.size or 0)
        return telegram.memory.buffer is room.buffer and room.start - 1 <= telegram.start < max(end, room.start + 1)
    name = f"{room.text.lstrip('#')} in {found.call.block}"
    return telegram.memory.buffer is None and telegram.memory.title.lstrip("#").upper() == name.upper()


def _length(found: ModuleCall, room: CallMemory, argument: ConstantArgument, begun: Sequence[FoundTelegram]) -> None:
    """One buffer may hold several telegrams, one after the other: the length is that of one of them."""
    value = argument.value or 0
    numbered = room.buffer is not None and "DBB_NO" in found.call.arguments
    sent = value if value or numbered else room.size
    how = f"the length is {argument.text}" if sent == value else f"length 0 sends the {sent} bytes of {room.text}"
    if sent is None:
        return
    telegram = next((one for one in begun if one.size == sent), begun[0] if begun else None)
    found.telegram = telegram
    if telegram is not None and telegram.uncertain:
        return
    if telegram is not None and sent != telegram.size:
        less = telegram.size - sent
        what = f"{less} too few" if less > 0 else f"{-less} too many"
        message = f"{found.title}: {how}, the telegram has {telegram.size}: {what}"
        notes = (Note("the telegram", telegram.span(0)),)
        found.findings.report("PG673", message, argument.span, f"{telegram.size}", notes=notes)
    elif room.size is not None and sent > room.size:
        message = f"{found.title}: {how}, {room.text} has {room.size} bytes"
        found.findings.report("PG674", message, argument.span, "send no more than there is")


def check_receiving(found: ModuleCall, needed: int, whose: str) -> None:
    """The longest answer fits."""
    room = found.room
    if room is None or found.sends or room.size is None or room.size >= needed:
        return
    message = f"{found.title} receives into {room.text}: {room.size} bytes, {whose} has {needed}"
    notes = () if room.buffer is None else _where(room.buffer)
    help_ = f"at least {needed} bytes; 255 hold every PPI telegram"
    found.findings.report("PG675", message, room.span, help_, notes=notes)


def answer_size(request: object) -> int:
    """Bytes of the frame that answers a request in full: 23 and more for a read, at least 22 for a write."""
    if isinstance(request, ReadRequest):
        return _FRAME + reply_size(request.items)
    items = getattr(request, "items", ())
    return _FRAME + 12 + (2 + len(items) if items else 1)


def shown(call: SourceCall) -> str:
    """The arguments that matter, as written."""
    names = ("PORT", "LADDR", "DB_NO", "DBB_NO", "LEN", "BUFFER", "LENGTH")
    return "  ".join(f"{name} {call.arguments[name].text}" for name in names if name in call.arguments)
