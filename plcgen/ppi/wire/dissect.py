"""A telegram field by field, for people, wrong ones marked, and in one line; every byte belongs to exactly one field.

Nothing here raises: it goes on as far as the lengths can be known and shows the rest as undecoded bytes.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace

from plcgen.base.diagnostics.counting import quantity
from plcgen.base.telegrams.dissection import ByteField, Walker
from plcgen.ppi.wire.address import address_text
from plcgen.ppi.wire.areas import (
    ITEM_SIZE,
    JOB_HEADER,
    REPLY_HEADER,
    Area,
    Function,
    ReturnCode,
    Rosctr,
    SizeCode,
    TransportSize,
)
from plcgen.ppi.wire.codes import function_text, header_error, return_code
from plcgen.ppi.wire.errors import Violation
from plcgen.ppi.wire.fdl import SD1, SD2, SD3, SD4
from plcgen.ppi.wire.items import bare_item, find_values, octets_of
from plcgen.ppi.wire.model import (
    ACKNOWLEDGE,
    CLIPPED,
    Acknowledgement,
    ErrorReply,
    FixedFrame,
    ForceRequest,
    Frame,
    Item,
    Pdu,
    ReadReply,
    ReadRequest,
    SetupReply,
    SetupRequest,
    VariableFrame,
    WriteReply,
    WriteRequest,
)
from plcgen.ppi.wire.pdu import FORCE_PARAMETER
from plcgen.ppi.wire.telegram import PDU_OFFSET

_FUNCTIONS = {
    Function.READ: "read", Function.WRITE: "write", Function.PI_SERVICE: "PI service (RUN)", Function.STOP: "STOP",
    Function.SETUP: "negotiation",
}  # fmt: skip
_KINDS: dict[int, str] = {
    Rosctr.JOB: "job",
    Rosctr.ACK: "answer without data",
    Rosctr.ACK_DATA: "answer",
    Rosctr.USERDATA: "userdata",
}
_CODES = {SizeCode.NONE: "none", SizeCode.BIT: "bit", SizeCode.WORDS: "bytes, length in bits",
          SizeCode.OCTETS: "bytes, length in bytes"}  # fmt: skip


def dissect(data: bytes, violations: Iterable[Violation] = (), asked: Sequence[Item] = ()) -> list[ByteField]:
    """Return the fields of a telegram, covering every byte exactly once.

    ``violations`` are those that ``telegram.examine`` found; ``asked`` are the items that a reply answers.
    """
    walker = Walker(bytes(data))
    start = walker.peek(1) if data else 0
    if start == SD2:
        walker.hexadecimal(1, "start", "SD2")
        length = walker.decimal(1, "length LE", "bytes from DA to the end of the PDU")
        walker.decimal(1, "length LEr")
        walker.hexadecimal(1, "start")
        _head(walker)
        end = min(len(walker.data), max(PDU_OFFSET, length + 4))
        if len(walker.data) > 2 and walker.data[2] != length and len(walker.data) == walker.data[2] + 6:
            end = len(walker.data) - 2
        inner = Walker(walker.data[:end], walker.fields, walker.offset)
        _pdu(inner, asked)
        walker.offset = inner.offset
        _tail(walker)
    elif start in {SD1, SD3} and data:
        walker.hexadecimal(1, "start", "SD1" if start == SD1 else "SD3")
        _head(walker)
        if start == SD3:
            walker.add(8, "data")
        _tail(walker)
    elif start == SD4:
        walker.hexadecimal(1, "start", "SD4, token")
        walker.decimal(1, "destination DA")
        walker.decimal(1, "source SA")
    elif start == ACKNOWLEDGE or start in CLIPPED:
        walker.hexadecimal(1, "acknowledgement SC", "" if start == ACKNOWLEDGE else "E5h with its first bits lost")
    if walker.left:
        walker.add(walker.left, "undecoded bytes")
    wrong = {violation.offset for violation in violations}
    for number, entry in enumerate(walker.fields):
        if entry.name == "undecoded bytes" or wrong & {*range(entry.offset, entry.offset + entry.length)}:
            walker.fields[number] = replace(entry, problem=True)
    return walker.fields


def _pdu(inner: Walker, asked: Sequence[Item]) -> None:
    if not inner.left:
        return
    inner.hexadecimal(1, "protocol")
    rosctr = inner.hexadecimal(1, "ROSCTR", _KINDS.get(inner.peek(1), "unknown") if inner.left else "unknown")
    inner.hexadecimal(2, "reserved")
    inner.hexadecimal(2, "reference")
    parameters = inner.decimal(2, "parameter length")
    size = inner.decimal(2, "data length")
    reply = rosctr in {Rosctr.ACK, Rosctr.ACK_DATA}
    error = 0
    if reply:
        code = inner.peek(2)
        error = inner.hexadecimal(2, "error class, code", "no error" if not code else header_error(code).text)
    if inner.left:
        if rosctr == Rosctr.USERDATA:
            _userdata(inner, parameters, size)
        elif error or rosctr not in set(Rosctr):
            _plain(inner, parameters)
        else:
            _function(inner, parameters, asked, reply=reply)
    if inner.left:
        inner.add(inner.left, "undecoded bytes")


def _head(walker: Walker) -> None:
    walker.decimal(1, "destination DA")
    walker.decimal(1, "source SA")
    walker.hexadecimal(1, "function code FC", function_text(walker.peek(1)) if walker.left else "")


def _tail(walker: Walker) -> None:
    walker.hexadecimal(1, "checksum FCS")
    walker.hexadecimal(1, "end")


def _plain(walker: Walker, parameters: int) -> None:
    walker.add(min(parameters, walker.left), "parameters")
    if walker.left:
        walker.add(walker.left, "data")


def _function(walker: Walker, parameters: int, asked: Sequence[Item], *, reply: bool) -> None:
    function = walker.peek(1)
    if function in {Function.READ, Function.WRITE}:
        walker.hexadecimal(1, "function", _FUNCTIONS[Function(function)])
        count = walker.decimal(1, "number of items")
        if reply and function == Function.WRITE:
            for number in range(1, count + 1):
                code = walker.peek(1)
                walker.hexadecimal(1, f"item {number}{_label(asked, number)} return code", return_code(code).text)
            return
        items = list(asked)
        if not reply:
            items = [_item(walker, number) for number in range(1, count + 1) if walker.left]
        if walker.left:
            _values(walker, count, items, reply=reply)
    elif function == Function.SETUP:
        walker.hexadecimal(1, "function", _FUNCTIONS[Function.SETUP])
        walker.hexadecimal(1, "reserved")
        walker.decimal(2, "jobs of the caller")
        walker.decimal(2, "jobs of the called")
        walker.decimal(2, "PDU size")
    elif function in {Function.PI_SERVICE, Function.STOP}:
        _service(walker, parameters, reply=reply)
    else:
        _plain(walker, parameters)


def _service(walker: Walker, parameters: int, *, reply: bool) -> None:
    function = Function(walker.peek(1))
    end = min(walker.offset + parameters, len(walker.data))
    walker.hexadecimal(1, "function", _FUNCTIONS[function])
    if reply:
        return
    walker.add(min(9 if function == Function.PI_SERVICE else 5, end - walker.offset), "reserved")
    if walker.offset >= end:
        return
    length = walker.decimal(1, "length of the name")
    name = walker.data[walker.offset : min(walker.offset + length, end)]
    if name:
        walker.add(len(name), "name", name.decode("ascii", "replace"))


def _label(items: Sequence[Item], number: int) -> str:
    return f" ({address_text(items[number - 1])})" if number <= len(items) else ""


def _item(walker: Walker, number: int) -> Item:
    data, at = walker.data, walker.offset
    complete = walker.left >= ITEM_SIZE
    item = bare_item(data, at + 3) if complete else Item(0, 0, 0, 0)
    label = f"item {number} ({address_text(item)})" if complete else f"item {number}"
    walker.hexadecimal(1, f"{label} specification")
    walker.decimal(1, f"{label} length of the address")
    walker.hexadecimal(1, f"{label} syntax")
    size = walker.peek(1)
    walker.hexadecimal(
        1, f"{label} transport size", TransportSize(size).name if size in set(TransportSize) else "unknown"
    )
    walker.decimal(2, f"{label} count")
    walker.decimal(2, f"{label} data block")
    area = walker.peek(1)
    walker.hexadecimal(1, f"{label} area", Area(area).title if area in set(Area) else "unknown")
    place = f"{item.byte}.{item.bit_number}" if not item.by_element else f"element {item.address}"
    walker.add(3, f"{label} address", f"{walker.peek(3):06X}h", place if complete else "")
    return item


def _values(walker: Walker, count: int, items: Sequence[Item], *, reply: bool) -> None:
    values, _, _ = find_values(walker.data, walker.offset, count, reply=reply)
    for number, value in enumerate(values, 1):
        label = f"value {number}{_label(items, number)}"
        if reply:
            walker.hexadecimal(1, f"{label} return code", return_code(value.code).text)
        else:
            walker.hexadecimal(1, f"{label} reserved")
        known = value.size_code in set(SizeCode)
        walker.hexadecimal(1, f"{label} size code", _CODES[SizeCode(value.size_code)] if known else "unknown")
        octets = octets_of(value.size_code, value.length)
        walker.decimal(2, f"{label} length", quantity(octets, "byte"))
        if value.data:
            walker.add(
                len(value.data), f"{label} data", _number(value.data), _meaning(value.code, value.data, reply=reply)
            )
        if value.padded:
            walker.hexadecimal(1, f"{label} pad")
    if values and walker.left == 1 and len(values[-1].data) % 2:
        walker.hexadecimal(1, f"value {len(values)}{_label(items, len(values))} pad")


def _number(data: bytes) -> str:
    return str(int.from_bytes(data, "big")) if len(data) in {1, 2, 4} else data.hex(" ").upper()


def _meaning(code: int, data: bytes, *, reply: bool) -> str:
    if reply and code != ReturnCode.OK:
        return ""
    if len(data) >= 4 and all(0x20 <= byte < 0x7F for byte in data):
        return f'as text "{data.decode("ascii")}"'
    signed = int.from_bytes(data, "big", signed=True)
    return f"signed {signed}" if len(data) in {1, 2, 4} and signed < 0 else ""


def _userdata(walker: Walker, parameters: int, size: int) -> None:
    chunk = walker.data[walker.offset : walker.offset + parameters]
    forcing = chunk == FORCE_PARAMETER
    note = "force or unforce, not confirmed by a capture" if forcing else ""
    if chunk:
        walker.add(len(chunk), "parameters", note=note)
    if not walker.left:
        return
    if not forcing or walker.left < 16:
        walker.add(min(size, walker.left) or walker.left, "data")
        return
    walker.hexadecimal(1, "return code")
    walker.hexadecimal(1, "size code")
    walker.decimal(2, "length")
    walker.decimal(2, "number of items")
    item = bare_item(walker.data, walker.offset + 1)
    walker.add(10, f"item 1 ({address_text(item)}) address")
    if walker.left:
        walker.add(walker.left, "value", note="without a value the forcing ends")


def title(data: bytes) -> str:
    """What a telegram is, in a few words: ``read request, station 0 to 2``."""
    start = data[0] if data else 0
    if start == ACKNOWLEDGE or start in CLIPPED:
        return "acknowledgement"
    if start == SD4 and len(data) >= 3:
        return f"token, station {data[2]} to {data[1]}"
    if start in {SD1, SD3} and len(data) > 3:
        kind = "poll" if start == SD1 and data[3] & 0x4F == 0x4C else "short frame" if start == SD1 else "data frame"
        return f"{kind}, station {data[2]} to {data[1]}"
    if start == SD2 and len(data) > PDU_OFFSET + JOB_HEADER:
        return f"{_content(data[PDU_OFFSET:])}, station {data[5]} to {data[4]}"
    return "frame" if start in {SD1, SD2, SD3, SD4} else "no frame"


def _content(pdu: bytes) -> str:
    reply = pdu[1] in {Rosctr.ACK, Rosctr.ACK_DATA}
    kind = "reply" if reply else "request"
    if pdu[1] == Rosctr.USERDATA:
        return "userdata"
    if reply and len(pdu) >= REPLY_HEADER and (pdu[10] or pdu[11]):
        return "error reply"
    at = REPLY_HEADER if reply else JOB_HEADER
    name = _FUNCTIONS.get(Function(pdu[at]), "") if len(pdu) > at and pdu[at] in set(Function) else ""
    if name.startswith("PI"):
        name = "RUN"
    return f"{name} {kind}".strip()


_VALUE = 16


class FrameText:
    """Turns the frames of a line into text; it remembers what was asked, so that answers can name their items."""

    def __init__(self) -> None:
        self._asked: dict[tuple[int, int], Sequence[Item]] = {}

    def line(self, data: bytes, frame: Frame | None, pdu: Pdu | None) -> str:
        """``read reply, station 2 to 0 (08): VB100 = 22``; ``pdu`` is what an SD2 frame carries."""
        words = title(data)
        if isinstance(frame, Acknowledgement) and frame.received != ACKNOWLEDGE:
            words += f" (received as {frame.received:02X})"
        if isinstance(frame, FixedFrame | VariableFrame):
            words += f" ({frame.function:02X})"
        more = self._contents(pdu, frame) if isinstance(frame, VariableFrame) and pdu is not None else ""
        return f"{words}{': ' * bool(more)}{more}"

    def _contents(self, pdu: Pdu, frame: VariableFrame) -> str:
        if isinstance(pdu, ReadRequest):
            self._asked[frame.source, frame.destination] = pdu.items
            return ", ".join(address_text(item) for item in pdu.items)
        if isinstance(pdu, WriteRequest):
            self._asked[frame.source, frame.destination] = [entry.item for entry in pdu.items]
            return ", ".join(f"{address_text(entry.item)} = {_hex(entry.data)}" for entry in pdu.items)
        if isinstance(pdu, ReadReply | WriteReply):
            if isinstance(pdu, ReadReply):
                texts = [_hex(result.data) if result.ok else _refused(result.code) for result in pdu.results]
            else:
                texts = ["ok" if code == ReturnCode.OK else _refused(code) for code in pdu.codes]
            names = [f"{address_text(item)} = " for item in self._asked.get((frame.destination, frame.source), ())]
            return ", ".join((names[n] if n < len(names) else "") + text for n, text in enumerate(texts))
        if isinstance(pdu, ErrorReply):
            return f"{pdu.code:04X}h {header_error(pdu.code).text}"
        if isinstance(pdu, SetupRequest | SetupReply):
            return f"PDU size {pdu.pdu_size}"
        if isinstance(pdu, ForceRequest):
            name = address_text(pdu.item)
            return f"unforce {name}" if pdu.data is None else f"force {name} = {_hex(pdu.data)}"
        return ""


def _hex(data: bytes) -> str:
    return data[:_VALUE].hex(" ").upper() + (f" .. {len(data)} bytes" if len(data) > _VALUE else "")


def _refused(code: int) -> str:
    return f"{code:02X}h {return_code(code).text}"
