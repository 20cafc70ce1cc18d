"""S7 PDUs of PPI: bytes <-> frozen values, with every violation named.

``32 | ROSCTR | 00 00 | reference | parameter length | data length``, answers add error class and code. For every valid
PDU ``encode_pdu(decode_pdu(data)) == data`` and ``decode_pdu(encode_pdu(pdu)) == pdu``; forcing and writing of timers
and counters are part of the seed only: no capture shows them.
"""

from __future__ import annotations

from collections.abc import Callable

from plcgen.ppi.wire.areas import (
    ITEM_LIMIT,
    ITEM_SIZE,
    JOB_HEADER,
    PDU_LIMIT,
    REPLY_HEADER,
    VALUE_HEADER,
    Function,
    ReturnCode,
    Rosctr,
)
from plcgen.ppi.wire.errors import Kind, PpiError, Violation
from plcgen.ppi.wire.items import (
    ItemFindings,
    bare_item,
    check_against,
    check_item,
    encode_item,
    encode_results,
    encode_values,
    items_length,
    read_item,
    read_values,
    result_of,
)
from plcgen.ppi.wire.model import (
    AckReply,
    ErrorReply,
    ForceRequest,
    Item,
    ItemWrite,
    Pdu,
    ReadReply,
    ReadRequest,
    RunRequest,
    SetupReply,
    SetupRequest,
    StopRequest,
    UnknownJob,
    UnknownReply,
    Userdata,
    WriteReply,
    WriteRequest,
)

PROTOCOL = 0x32
PROGRAM = b"\x09P_PROGRAM"
RUN_PARAMETER = bytes((Function.PI_SERVICE, 0, 0, 0, 0, 0, 0, 0xFD, 0, 0)) + PROGRAM
STOP_PARAMETER = bytes((Function.STOP, 0, 0, 0, 0, 0)) + PROGRAM
FORCE_PARAMETER = bytes.fromhex("000112081248 0B00 0000 0000")
"""Userdata parameters of force and unforce as the seed document prints them."""

_KNOWN_CODES = frozenset(ReturnCode)
_REQUESTS = frozenset({int(Rosctr.JOB), int(Rosctr.USERDATA)})
_REPLIES = frozenset({int(Rosctr.ACK), int(Rosctr.ACK_DATA)})
_WITH_ITEMS = frozenset({int(Function.READ), int(Function.WRITE)})


def reply_size(items: tuple[Item, ...] | list[Item]) -> int:
    """Length of the fully positive reply PDU to a read."""
    sizes = [item.octets for item in items]
    return REPLY_HEADER + 2 + sum(VALUE_HEADER + size + size % 2 for size in sizes) - (sizes[-1] % 2 if sizes else 0)


# ---- Encoding -------------------------------------------------------------------------------------------------


def encode_pdu(pdu: Pdu) -> bytes:
    """Return the bytes of a PDU. PpiError if it, or the answer it asks for, is longer than ``PDU_LIMIT`` bytes, or if a
    value does not fit its field.
    """
    if not 0 <= pdu.reference <= 0xFFFF:
        raise PpiError.of(Kind.VALUE, f"the reference {pdu.reference} is outside 0..65535", 4)
    try:
        rosctr, error, parameter, data = _parts(pdu)
        sizes = len(parameter).to_bytes(2) + len(data).to_bytes(2)
    except PpiError:
        raise
    except (OverflowError, ValueError) as problem:
        raise PpiError.of(Kind.VALUE, f"a number does not fit its field: {problem}") from problem
    encoded = bytes((PROTOCOL, rosctr, 0, 0)) + pdu.reference.to_bytes(2) + sizes + error + parameter + data
    if isinstance(pdu, ReadRequest | WriteRequest) and len(pdu.items) > ITEM_LIMIT:
        raise PpiError.of(Kind.LIMIT, f"{len(pdu.items)} items; one telegram has at most {ITEM_LIMIT}")
    if len(encoded) > PDU_LIMIT:
        raise PpiError.of(Kind.LIMIT, f"the PDU has {len(encoded)} bytes; at most {PDU_LIMIT} are possible")
    if isinstance(pdu, ReadRequest) and reply_size(pdu.items) > PDU_LIMIT:
        text = f"the answer would have {reply_size(pdu.items)} bytes; at most {PDU_LIMIT} are possible"
        raise PpiError.of(Kind.LIMIT, text)
    return encoded


def _parts(pdu: Pdu) -> tuple[int, bytes, bytes, bytes]:
    if isinstance(pdu, ReadRequest):
        return Rosctr.JOB, b"", _item_parameter(Function.READ, pdu.items), b""
    if isinstance(pdu, WriteRequest):
        parameter = _item_parameter(Function.WRITE, tuple(entry.item for entry in pdu.items))
        return Rosctr.JOB, b"", parameter, encode_values(pdu.items, trailing_pad=pdu.trailing_pad)
    if isinstance(pdu, RunRequest):
        return Rosctr.JOB, b"", RUN_PARAMETER, b""
    if isinstance(pdu, StopRequest):
        return Rosctr.JOB, b"", STOP_PARAMETER, b""
    if isinstance(pdu, SetupRequest):
        return Rosctr.JOB, b"", _setup_parameter(pdu), b""
    if isinstance(pdu, UnknownJob):
        return Rosctr.JOB, b"", pdu.parameter, pdu.data
    if isinstance(pdu, Userdata):
        return Rosctr.USERDATA, b"", pdu.parameter, pdu.data
    if isinstance(pdu, ForceRequest):
        value = b"" if pdu.data is None else pdu.data + bytes(len(pdu.data) % 2)
        block = b"\x00\x01" + encode_item(pdu.item)[2:] + value
        return Rosctr.USERDATA, b"", FORCE_PARAMETER, b"\xff\x09" + len(block).to_bytes(2) + block
    good = bytes(2)
    if isinstance(pdu, ReadReply):
        return Rosctr.ACK_DATA, good, bytes((Function.READ, len(pdu.results))), encode_results(pdu.results)
    if isinstance(pdu, WriteReply):
        return Rosctr.ACK_DATA, good, bytes((Function.WRITE, len(pdu.codes))), bytes(pdu.codes)
    if isinstance(pdu, SetupReply):
        return Rosctr.ACK_DATA, good, _setup_parameter(pdu), b""
    if isinstance(pdu, AckReply):
        if pdu.function is None:
            return Rosctr.ACK, good, b"", b""
        if pdu.function in {Function.READ, Function.WRITE, Function.SETUP}:
            raise PpiError.of(Kind.VALUE, f"the answer to function {pdu.function:02X}h has more than its function")
        return Rosctr.ACK_DATA, good, bytes((pdu.function,)), b""
    if isinstance(pdu, ErrorReply):
        if not pdu.code or pdu.rosctr not in {Rosctr.ACK, Rosctr.ACK_DATA}:
            raise PpiError.of(Kind.VALUE, "an error reply has a code other than 0000h and ROSCTR 2 or 3")
        return pdu.rosctr, pdu.code.to_bytes(2), pdu.parameter, pdu.data
    return pdu.rosctr, good, pdu.parameter, pdu.data


def _item_parameter(function: Function, items: tuple[Item, ...]) -> bytes:
    if not items:
        raise PpiError.of(Kind.ITEM_COUNT, "there are no items")
    if len(items) > 0xFF:
        raise PpiError.of(Kind.LIMIT, f"{len(items)} items; one telegram has at most {ITEM_LIMIT}")
    return bytes((function, len(items))) + b"".join(encode_item(item) for item in items)


def _setup_parameter(pdu: SetupRequest | SetupReply) -> bytes:
    return bytes((Function.SETUP, 0)) + b"".join(value.to_bytes(2) for value in (pdu.calling, pdu.called, pdu.pdu_size))


# ---- Decoding -------------------------------------------------------------------------------------------------


def decode_pdu(data: bytes) -> Pdu:
    """Return the PDU in ``data``; PpiError with every violation."""
    pdu, found = examine_pdu(data)
    if found or pdu is None:
        raise PpiError(found)
    return pdu


def examine_pdu(data: bytes, base: int = 0) -> tuple[Pdu | None, list[Violation]]:
    """Return the PDU as far as its structure is known (else None), and everything that is wrong with it.

    ``base`` is added to the offsets: the place of the PDU in its frame.
    """
    findings = ItemFindings(base)
    if len(data) < JOB_HEADER:
        findings.add(Kind.SHORT, len(data), f"a PDU has at least {JOB_HEADER} bytes, not {len(data)}")
        return None, findings.found
    rosctr = data[1]
    if data[0] != PROTOCOL:
        findings.add(Kind.PROTOCOL, 0, f"the protocol identifier is {data[0]:02X}h instead of 32h")
    if data[2] or data[3]:
        findings.add(Kind.RESERVED, 2, f"the reserved bytes are {data[2]:02X} {data[3]:02X} instead of 00 00")
    if len(data) > PDU_LIMIT:
        findings.add(Kind.LIMIT, PDU_LIMIT, f"{len(data)} bytes exceed the PDU limit of {PDU_LIMIT}")
    if rosctr in _REQUESTS:
        read: _Read = _job if rosctr == Rosctr.JOB else _userdata
        return read(findings, data, JOB_HEADER), findings.found
    if rosctr not in _REPLIES:
        findings.add(Kind.ROSCTR, 1, f"ROSCTR {rosctr:02X}h is not 1 (job), 2, 3 (answer) or 7 (userdata)")
        return None, findings.found
    if len(data) < REPLY_HEADER:
        findings.add(Kind.SHORT, len(data), f"an answer has at least {REPLY_HEADER} bytes, not {len(data)}")
        return None, findings.found
    return _reply(findings, data, REPLY_HEADER), findings.found


_Read = Callable[[ItemFindings, bytes, int], Pdu | None]


def _number(data: bytes, at: int) -> int:
    return data[at] << 8 | data[at + 1]


def _split(findings: ItemFindings, data: bytes, start: int, expected: int | None = None) -> tuple[bytes, int]:
    """Return the parameters and the offset of the data behind them.

    ``expected`` is the length that the parameters must have; it is used if the stated one contradicts it.
    """
    stated, length = _number(data, 6), _number(data, 8)
    size = stated if expected is None else expected
    if size != stated:
        findings.add(Kind.PARAMETER_LENGTH, 6, f"the parameter length is {stated}; these parameters have {size} bytes")
    if start + size > len(data):
        text = f"the parameters need {size} bytes, {len(data) - start} are left"
        findings.add(Kind.PARAMETER_LENGTH, 6, text)
        size = len(data) - start
    left = len(data) - start - size
    if length != left:
        findings.add(Kind.DATA_LENGTH, 8, f"the data length is {length}; {left} bytes follow the parameters")
    return data[start : start + size], start + size


def _no_data(findings: ItemFindings, data: bytes, at: int, what: str) -> None:
    if at < len(data) and _number(data, 8):
        findings.add(Kind.DATA_LENGTH, 8, f"{what} has no data")


def _job(findings: ItemFindings, data: bytes, start: int) -> Pdu | None:
    reference = _number(data, 4)
    if start >= len(data):
        _split(findings, data, start)
        findings.add(Kind.PARAMETER_LENGTH, 6, "a job has at least the byte of its function")
        return None
    function = data[start]
    if function in _WITH_ITEMS:
        write = function == Function.WRITE
        if start + 2 > len(data):
            findings.add(Kind.PARAMETER_LENGTH, 6, "the number of items is missing")
            return None
        count = data[start + 1]
        _check_count(findings, count, start + 1)
        parameter, at = _split(findings, data, start, items_length(count))
        if len(parameter) < items_length(count):
            return None
        items = tuple(read_item(findings, data, start + 2 + ITEM_SIZE * n, n + 1) for n in range(count))
        if not write:
            _no_data(findings, data, at, "a read request")
            if items and reply_size(items) > PDU_LIMIT:
                text = f"the answer would have {reply_size(items)} bytes; at most {PDU_LIMIT} are possible"
                findings.add(Kind.LIMIT, start + 2, text)
            return ReadRequest(reference, items)
        values, trailing = read_values(findings, data, at, count, reply=False)
        if len(values) < count:
            return None
        for number, (value, item) in enumerate(zip(values, items, strict=True), 1):
            check_against(findings, value, item, number)
        pairs = tuple(ItemWrite(item, value.data) for item, value in zip(items, values, strict=True))
        return WriteRequest(reference, pairs, trailing)
    if function == Function.SETUP:
        return _setup(findings, data, start, reference, SetupRequest)
    if function in {Function.PI_SERVICE, Function.STOP}:
        # RUN and STOP: every byte is fixed
        run = data[start] == Function.PI_SERVICE
        wanted, name = (RUN_PARAMETER, "RUN") if run else (STOP_PARAMETER, "STOP")
        if run and PROGRAM not in data[start:]:
            parameter, at = _split(findings, data, start)
            return UnknownJob(reference, parameter, data[at:]) if parameter else None
        parameter, at = _split(findings, data, start, len(wanted))
        _no_data(findings, data, at, name)
        for offset, (byte, expected) in enumerate(zip(parameter, wanted, strict=False)):
            if byte != expected:
                text = f"byte {offset} of the parameters of {name} is {byte:02X}h instead of {expected:02X}h"
                findings.add(Kind.SERVICE, start + offset, text)
        if len(parameter) < len(wanted):
            return None
        return RunRequest(reference) if run else StopRequest(reference)
    parameter, at = _split(findings, data, start)
    if not parameter:
        findings.add(Kind.PARAMETER_LENGTH, 6, "a job has at least the byte of its function")
        return None
    return UnknownJob(reference, parameter, data[at:])


def _check_count(findings: ItemFindings, count: int, place: int) -> None:
    if count == 0:
        findings.add(Kind.ITEM_COUNT, place, "the number of items is 0")
    if count > ITEM_LIMIT:
        findings.add(Kind.LIMIT, place, f"{count} items; one telegram has at most {ITEM_LIMIT}")


def _setup(
    findings: ItemFindings, data: bytes, start: int, reference: int, kind: type[SetupRequest | SetupReply]
) -> Pdu | None:
    parameter, at = _split(findings, data, start, 8)
    if len(parameter) < 8:
        return None
    _no_data(findings, data, at, "a negotiation")
    if parameter[1]:
        findings.add(Kind.RESERVED, start + 1, f"the reserved byte is {parameter[1]:02X}h instead of 00h")
    calling, called, size = (_number(parameter, offset) for offset in (2, 4, 6))
    return kind(reference, size, calling, called)


def _userdata(findings: ItemFindings, data: bytes, start: int) -> Pdu | None:
    reference = _number(data, 4)
    parameter, at = _split(findings, data, start)
    force = _force(reference, parameter, data[at:])
    return force if force is not None else Userdata(reference, parameter, data[at:])


def _force(reference: int, parameter: bytes, data: bytes) -> ForceRequest | None:
    """Recognise a force or unforce of one item; its layout is unconfirmed, so anything else is plain userdata."""
    if parameter != FORCE_PARAMETER or len(data) < 16:
        return None
    if data[:2] != b"\xff\x09" or _number(data, 2) != len(data) - 4 or data[4:7] != b"\x00\x01\x10":
        return None
    findings = ItemFindings()
    item = bare_item(data, 7)
    check_item(findings, item, 0, "the item")
    value, octets = data[16:], item.octets
    if findings.found or len(value) not in {0, octets + octets % 2} or any(value[octets:]):
        return None
    return ForceRequest(reference, item, value[:octets] if value else None)


def _reply(findings: ItemFindings, data: bytes, start: int) -> Pdu | None:
    reference, rosctr = _number(data, 4), data[1]
    if data[10] or data[11]:
        parameter, at = _split(findings, data, start)
        return ErrorReply(reference, data[10], data[11], rosctr, parameter, data[at:])
    if rosctr == Rosctr.ACK_DATA and start < len(data):
        if data[start] in _WITH_ITEMS:
            parameter, at = _split(findings, data, start, 2)
            if len(parameter) < 2:
                return None
            count = parameter[1]
            _check_count(findings, count, start + 1)
            if parameter[0] == Function.READ:
                values, _ = read_values(findings, data, at, count, reply=True)
                return (
                    ReadReply(reference, tuple(result_of(value) for value in values)) if len(values) == count else None
                )
            codes = data[at:]
            if len(codes) != count:
                findings.add(
                    Kind.DATA_LENGTH, at, f"{count} items were written, but there are {len(codes)} return codes"
                )
            for offset, code in enumerate(codes[:count]):
                if code not in _KNOWN_CODES:
                    findings.add(
                        Kind.RETURN_CODE, at + offset, f"item {offset + 1}: the return code {code:02X}h is unknown"
                    )
            return WriteReply(reference, tuple(codes[:count])) if len(codes) >= count else None
        if data[start] == Function.SETUP:
            return _setup(findings, data, start, reference, SetupReply)
    parameter, at = _split(findings, data, start)
    if rosctr == Rosctr.ACK and not parameter and at == len(data):
        return AckReply(reference)
    if rosctr == Rosctr.ACK_DATA and len(parameter) == 1 and at == len(data):
        return AckReply(reference, parameter[0])
    if rosctr == Rosctr.ACK_DATA and not parameter:
        findings.add(Kind.PARAMETER_LENGTH, 6, "a positive answer has at least the byte of its function")
        return None
    return UnknownReply(reference, parameter, data[at:], rosctr)
