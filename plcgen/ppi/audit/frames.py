"""Telegrams in memory, and what is wrong with their bytes.

A telegram is recognised by marks that one mistake does not wipe out: the start bytes of an SD2 frame, a request's
function code, the protocol identifier 32h. Its end is what most of its own lengths say. So one wrong byte is one
finding, not a telegram that nobody sees.
"""

from __future__ import annotations

from collections.abc import Iterator

from plcgen.ppi.audit.model import Bytes, FoundTelegram
from plcgen.ppi.wire.areas import JOB_HEADER, REPLY_HEADER
from plcgen.ppi.wire.errors import TOLERABLE, Kind, Violation
from plcgen.ppi.wire.fdl import END, SD1, SD2, checksum
from plcgen.ppi.wire.model import FCB, FCV, FIRST, REQUEST
from plcgen.ppi.wire.pdu import PROTOCOL
from plcgen.ppi.wire.telegram import PDU_OFFSET, examine

_FUNCTIONS = frozenset({FIRST, FIRST ^ FCB | FCV, FIRST | FCV})
"""6Ch, 5Ch, 7Ch: what a master sends."""
_HEAD, _TAIL = 4, 2
_POLL = 6
_LENGTHS = frozenset({
    Kind.LENGTH, Kind.REPEATED_LENGTH, Kind.SHORT, Kind.TRAILING, Kind.PARAMETER_LENGTH, Kind.DATA_LENGTH,
    Kind.ITEM_COUNT, Kind.VALUE_LENGTH, Kind.LIMIT,
})  # fmt: skip
_HELP = {
    "PG670": "count the bytes: LE from DA to the last one before FCS, the parameters 2 + 12 per item, the data",
    "PG672": "plcgen ppi decode shows what each byte is",
}


def telegrams(memory: Bytes) -> Iterator[FoundTelegram]:
    """Every telegram that memory states, in its order, with what is wrong with its bytes."""
    at = 0
    while at < len(memory.data):
        size = _size(memory.data, at) if at in memory.given else 0
        if size:
            found = FoundTelegram(memory, at, size)
            _check(found)
            yield found
        at += max(size, 1)


def _size(data: bytes, at: int) -> int:
    """Bytes of the telegram that begins here; 0 if none does."""
    if data[at] == SD2:
        return _variable(data, at)
    if data[at] != SD1:
        return 0
    for size in (_POLL, _POLL - 1):  # 10 DA SA FC FCS 16; a well-known article prints it without SA
        head = data[at + 1 : at + size - 2]
        if len(data) >= at + size and data[at + size - 1] == END and head[-1] in _FUNCTIONS:
            return size
    return 0


def _variable(data: bytes, at: int) -> int:
    """An SD2 frame has at least two of three marks; another protocol with 68 LE LE 68 has neither 6Ch nor 32h."""
    rest = data[at : at + PDU_OFFSET + 1]
    if len(rest) <= PDU_OFFSET:
        return 0
    marks = (rest[3] == SD2, rest[6] in _FUNCTIONS, rest[PDU_OFFSET] == PROTOCOL)
    if sum(marks) < 2:
        return 0
    stated = [rest[1] + _HEAD + _TAIL, rest[2] + _HEAD + _TAIL]
    pdu = _pdu_size(data, at + PDU_OFFSET)
    if pdu:
        stated.append(PDU_OFFSET + pdu + _TAIL)
    ended = [size for size in stated if at + size <= len(data) and data[at + size - 1] == END]
    summed = [size for size in ended if checksum(data[at + _HEAD : at + size - 2]) == data[at + size - 2]]
    best = (summed or ended or [_search(data, at)])[0]
    return min(best or stated[0], len(data) - at)


def _pdu_size(data: bytes, at: int) -> int:
    if at + REPLY_HEADER > len(data):
        return 0
    header = JOB_HEADER if data[at + 1] in {1, 7} else REPLY_HEADER
    return header + int.from_bytes(data[at + 6 : at + 8]) + int.from_bytes(data[at + 8 : at + 10])


def _search(data: bytes, at: int) -> int:
    """The first end byte behind a right sum; 0 if there is none."""
    total = checksum(data[at + _HEAD : at + PDU_OFFSET + JOB_HEADER])
    for end in range(at + PDU_OFFSET + JOB_HEADER, min(len(data) - 1, at + 255)):
        if data[end] == total and data[end + 1] == END:
            return end + 2 - at
        total = (total + data[end]) & 0xFF
    return 0


def _check(found: FoundTelegram) -> None:
    """Report what is wrong, once for each byte; what comes at run time is taken for right."""
    memory, start, size = found.memory, found.start, found.size
    data = bytearray(memory.data[start : start + size])
    open_ = {n for n in range(size) if start + n not in memory.given}
    if not examine(bytes(data)).violations:
        open_.clear()  # what the source does not state is 0, and that is right
    if data[0] == SD1 and size == _POLL - 1:
        message = f"{found.place(0)}: 5 bytes, a poll is 10 DA SA FC FCS 16: one of the stations is missing"
        found.findings.report("PG670", message, found.span(2), "insert SA, the address of the master")
        return
    stated = data[1] + _HEAD + _TAIL if data[0] == SD2 else size
    if data[-1] != END and start + stated > len(memory.data):
        message = f"{found.place(1)}: LE makes a telegram of {stated} bytes, {size} are left here"
        found.findings.report("PG670", message, found.span(1), f"{stated} bytes from here on, or another LE")
        return
    if data[0] == SD2:
        _lengths(found, data, open_)
    function = 6 if data[0] == SD2 else 3
    if function in open_:
        data[function] = FIRST
    wrong = _sum(data, open_)
    found.data = bytes(data)
    seen = examine(found.data)
    found.frame, found.pdu = seen.frame, seen.pdu
    for violation in seen.violations:
        if violation.offset not in open_ and violation.kind not in TOLERABLE:
            _report(found, violation)
    if wrong is not None:
        _report_sum(found, wrong, data[-_TAIL])
    if data[0] == SD2 and data[function] & REQUEST and data[function] != FIRST and function not in open_:
        found.findings.notes.append(
            f"function code {data[function]:02X}h: the program must change the frame count bit, a station executes "
            "a frame with the same bit once"
        )
    if open_:
        found.findings.notes.append(f"{len(open_)} of its bytes come at run time")


def _lengths(found: FoundTelegram, data: bytearray, open_: set[int]) -> None:
    """LE twice: corrected for what follows, so that nothing else is reported because of it."""
    wanted = len(data) - _HEAD - _TAIL
    wrong = [at for at in (1, 2) if data[at] != wanted and at not in open_]
    both = len(wrong) == 2 and data[1] == data[2]
    for at in wrong[:1] if both else wrong:
        which = "the length LE, twice," if both else "the length LE" if at == 1 else "the repeated length"
        message = f"{found.place(at)}: {which} is {data[at]}, from DA to the last byte before FCS are {wanted}"
        found.findings.report("PG670", message, found.span(at), f"16#{wanted:02X}")
    data[1] = data[2] = wanted & 0xFF


def _sum(data: bytearray, open_: set[int]) -> int | None:
    """Put the right FCS in; return the one that was there if it is wrong and nothing in it comes at run time."""
    at, first = len(data) - _TAIL, _HEAD if data[0] == SD2 else 1
    had, data[at] = data[at], checksum(bytes(data[first:at]))
    if at + 1 in open_:
        data[at + 1] = END
    return had if had != data[at] and not any(n in open_ for n in range(first, at + 1)) else None


def _report_sum(found: FoundTelegram, had: int, wanted: int) -> None:
    at = len(found.data) - _TAIL
    message = f"{found.place(at)}: the checksum FCS is {had:02X}h, the bytes from DA on add up to {wanted:02X}h"
    more = bool(found.findings.found)
    help_ = "add up the bytes again when the other bytes are right" if more else f"16#{wanted:02X}"
    found.findings.report("PG671", message, found.span(at), help_)


def _report(found: FoundTelegram, violation: Violation) -> None:
    code = "PG670" if violation.kind in _LENGTHS else "PG672"
    message = f"{found.place(violation.offset)}: {violation.message}"
    found.findings.report(code, message, found.span(violation.offset), _HELP[code])
