"""A telegram field by field, for people: every byte belongs to exactly one field, wrong ones are marked.

Nothing here raises: it goes on as far as the lengths can be known and shows the rest as undecoded bytes.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal, TypeAlias

from plcgen.base.telegrams.dissection import ByteField, Walker
from plcgen.ds47.wire import formats
from plcgen.ds47.wire.bico import SELF, read_bico
from plcgen.ds47.wire.errors import error_text
from plcgen.ds47.wire.model import MAX_ELEMENTS, MAX_PARAMETERS, Attribute, RequestId, ResponseId

if TYPE_CHECKING:
    from collections.abc import Mapping

    from plcgen.ds47.wire.errors import Table

Guess: TypeAlias = Literal["request", "response", "unknown"]

MOVILINK, TRANSPORT = 0x40, 0x41
"""Request ids of SEW (DFE32B manual p. 73); with the first one the attribute is a service, and a value may follow."""
MAKERS = frozenset(bytes((one,)) for one in (MOVILINK, TRANSPORT, 0x80 | MOVILINK))
"""Second bytes of telegrams whose form is a maker's."""
OF_A_MAKER = "manufacturer-specific"
_REQUESTS = {
    0x01: "request parameter",
    0x02: "change parameter",
    MOVILINK: "SEW MOVILINK service",
    TRANSPORT: "SEW data transport",
}
_RESPONSES = {
    0x01: "request parameter (+)",
    0x02: "change parameter (+)",
    0x80: "service not supported",
    0x81: "request parameter (-)",
    0x82: "change parameter (-)",
    MOVILINK: "SEW MOVILINK service (+)",
    TRANSPORT: "SEW data transport",
    0x80 | MOVILINK: "SEW MOVILINK service (-)",
}
_ATTRIBUTES = {0x10: "value", 0x20: "description", 0x30: "text"}
_SERVICES = {
    0x00: "no service", 0x10: "read parameter", 0x20: "write parameter", 0x30: "write parameter, volatile",
    0x40: "read minimum", 0x50: "read maximum", 0x60: "read default", 0x80: "read attribute", 0x90: "read EEPROM",
}  # fmt: skip
"""Attributes with a MOVILINK service (DFE32B manual p. 73; 30h: MOVI-PLC DH.41B manual p. 66)."""


@dataclass(slots=True)
class _Walker(Walker):
    """``table`` says whose error numbers the telegram has."""

    table: Table = "profidrive"

    def number(self, size: int, name: str, *, bad: str = "") -> int:
        """Append a decimal number; ``bad`` says what is wrong with it."""
        return self.decimal(size, name, bad, problem=bool(bad))

    def rest(self, note: str) -> None:
        """Append what is left as undecoded."""
        if self.left:
            self.add(self.left, "undecoded bytes", note=note, problem=True)

    def missing(self, what: str) -> None:
        """Append an empty field at the end: the telegram promises more than it has."""
        self.fields.append(ByteField(len(self.data), 0, "missing", "", what, problem=True))


def _identifier(walker: _Walker, name: str, known: dict[int, str]) -> int:
    value = walker.peek(1)
    note = known.get(value, "")
    if not note:
        note = OF_A_MAKER if 0x40 <= value <= 0x7F else "reserved"
    return walker.add(1, name, f"{value:02X}h", note, problem=value not in known)


def _header(walker: _Walker, mirror: str, name: str, known: dict[int, str]) -> tuple[int, int]:
    reference = walker.peek(1)
    reserved = walker.left and reference == 0
    told = "reserved in PROFIdrive; some makers print it (ifm, RM30 p. 26)" if reserved else ""
    walker.add(1, f"request reference{mirror}", f"{reference:02X}h", told)
    identifier = _identifier(walker, name, known)
    walker.number(1, f"drive object{mirror}")
    count = walker.peek(1)
    bad = "" if 1 <= count <= MAX_PARAMETERS else f"outside 1 to {MAX_PARAMETERS}"
    return identifier, walker.number(1, f"number of parameters{mirror}", bad=bad)


def _address(walker: _Walker, at: str, names: Mapping[int, str]) -> None:
    attribute = walker.peek(1)
    note = names.get(attribute, OF_A_MAKER if attribute >= 0x80 else "reserved")
    walker.add(1, f"{at} attribute", f"{attribute:02X}h", note, problem=note == "reserved")
    elements = walker.peek(1)
    bad = f"over {MAX_ELEMENTS}" if elements > MAX_ELEMENTS else ""
    walker.number(1, f"{at} number of elements", bad=bad)
    pnu = walker.peek(2)
    walker.number(2, f"{at} parameter number", bad="" if pnu else "the parameter number 0 is reserved")
    subindex = walker.peek(2)
    walker.number(2, f"{at} subindex", bad="the subindex FFFFh is reserved" if subindex == 0xFFFF else "")


def _show(value: formats.Value) -> str:
    if isinstance(value, bytes):
        return value.hex(" ").upper()
    return repr(value) if isinstance(value, str) else str(value)


def _meaning(fmt: formats.Format, value: formats.Value) -> str:
    """Name of the format, and the source that a value names if it is a BICO value of the addressed drive object."""
    if fmt.name in {"Unsigned32", "DoubleWord"} and isinstance(value, int):
        source = read_bico(value)
        if source.drive_object == SELF and 0 < source.pnu < 0xFFFF:
            return f"{fmt.name}, as a BICO value {source}"
    return fmt.name


def _values(walker: _Walker, at: str, fmt: formats.Format, count: int) -> None:
    if fmt.is_string and count:
        (value,) = formats.unpack_values(fmt, walker.left, walker.data[walker.offset :])
        walker.add(count, f"{at} value", _show(value[:count]) if isinstance(value, str | bytes) else "")
    elif not fmt.is_string:
        for number in range(1, count + 1):
            chunk = walker.data[walker.offset : walker.offset + fmt.size]
            value = formats.unpack_values(fmt, 1, chunk)[0] if len(chunk) == fmt.size > 0 else ""
            walker.add(
                fmt.size, f"{at} value {number}" if count > 1 else f"{at} value", _show(value), _meaning(fmt, value)
            )
    if fmt.size * count % 2 and walker.left:
        pad = walker.peek(1)
        walker.add(1, f"{at} pad", f"{pad:02X}h", "" if not pad else "a pad is 00h", problem=pad != 0)


def _error(walker: _Walker, at: str, count: int) -> None:
    for number in range(1, count + 1):
        word = walker.peek(2)
        if number == 1:
            walker.add(2, f"{at} error number", f"{word:04X}h", error_text(word, walker.table).meaning)
        elif number == 2:
            walker.add(2, f"{at} information word", str(word))
        else:
            walker.add(2, f"{at} error word {number}", f"{word:04X}h", "over two words", problem=True)


def _block(walker: _Walker, at: str, *, response: bool) -> bool:
    """Append one value block; False if its length cannot be known."""
    code = walker.peek(1)
    fmt = formats.find(code)
    misplaced = fmt is not None and not fmt.writable and not response
    note = "unknown format" if fmt is None else fmt.name + (", in responses only" if misplaced else "")
    walker.add(1, f"{at} format", f"{code:02X}h", note, problem=fmt is None or misplaced)
    count = walker.number(1, f"{at} number of values")
    if fmt is None:
        return False
    if fmt.code == formats.ERROR:
        _error(walker, at, count)
    elif fmt.code != formats.ZERO:
        _values(walker, at, fmt, count)
    return True


def dissect_request(data: bytes) -> list[ByteField]:
    """Return the fields of a request, covering every byte exactly once."""
    walker = _Walker(bytes(data), table="sinamics")
    identifier, count = _header(walker, "", "request id", _REQUESTS)
    for position in range(1, count + 1):
        if walker.left == 0:
            walker.missing(f"the address of parameter {position}")
            return walker.fields
        _address(walker, f"parameter {position}", _SERVICES if identifier == MOVILINK else _ATTRIBUTES)
    if identifier == RequestId.CHANGE or (identifier in {MOVILINK, TRANSPORT} and walker.left):
        for position in range(1, count + 1):
            if walker.left == 0:
                walker.missing(f"the value of parameter {position}")
                break
            if not _block(walker, f"parameter {position}", response=False):
                break
    walker.rest("beyond the end of the request")
    return walker.fields


def dissect_response(data: bytes, table: Table = "sinamics") -> list[ByteField]:
    """Return the fields of a response, covering every byte exactly once."""
    walker = _Walker(bytes(data), table=table)
    identifier, count = _header(walker, " (mirrored)", "response id", _RESPONSES)
    promised: dict[int, int] = {ResponseId.CHANGE: 0, ResponseId.NOT_SUPPORTED: 1}
    expected = promised.get(identifier, count)
    for position in range(1, expected + 1):
        if walker.left == 0:
            if position != 2 or len(data) not in {8, 10} or data[4] != formats.ERROR:
                walker.missing(f"the answer of parameter {position}")
            break
        if not _block(walker, f"parameter {position}", response=True):
            break
    walker.rest("beyond the end of the response")
    return walker.fields


def looks_like(data: bytes) -> Guess:
    """Tell a request from a response.

    80h to 82h in byte 1 is a response. 01h and 02h occur in both: byte 4 decides, since the attributes of a
    request (10h, 20h, 30h) are no format codes. Four bytes with 02h are the positive response to a change,
    because a request has at least one address; they could also be a request that was cut short.
    Manufacturer-specific ids (40h to 7Fh) occur in requests, but for those of SEW, whose answers begin with a double
    word or an error. Anything else is ``unknown``.
    """
    if len(data) < 4:
        return "unknown"
    identifier, byte4 = data[1], data[4] if len(data) > 4 else None
    if identifier in {ResponseId.NOT_SUPPORTED, ResponseId.READ_NEGATIVE, ResponseId.CHANGE_NEGATIVE, 0x80 | MOVILINK}:
        return "response"
    if identifier in {MOVILINK, TRANSPORT} and byte4 in {formats.DOUBLE_WORD, formats.ERROR}:
        return "response"
    if byte4 is None:
        return "response" if identifier == ResponseId.CHANGE else "unknown"
    if byte4 in set(Attribute) and (identifier in set(RequestId) or 0x40 <= identifier <= 0x7F):
        return "request"
    if identifier == ResponseId.READ and formats.find(byte4) is not None:
        return "response"
    return "unknown"
