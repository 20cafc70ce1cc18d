"""The repeated parts of PDUs: item addresses and values, bytes <-> frozen values.

A value of odd length is followed by a pad byte 00, except the last one. A failed item of a reply is four bytes without
data, so the place of a value depends on every return code before it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

from plcgen.base.diagnostics.counting import quantity
from plcgen.ppi.wire.areas import (
    ELEMENT_SIZES,
    ITEM_SIZE,
    OCTETS,
    VALUE_HEADER,
    Area,
    ReturnCode,
    SizeCode,
    TransportSize,
)
from plcgen.ppi.wire.errors import Kind, PpiError, Violation
from plcgen.ppi.wire.model import Item, ItemResult, ItemWrite

ITEM_HEADER = bytes((0x12, 0x0A, 0x10))
_AREAS = frozenset(Area)
_CODES = frozenset(ReturnCode)
_OK = int(ReturnCode.OK)
_BIT, _WORDS = int(SizeCode.BIT), int(SizeCode.WORDS)
_MEASURED = frozenset({int(SizeCode.WORDS), int(SizeCode.OCTETS)})
_IN_BYTES = frozenset({0x06, 0x07, int(SizeCode.OCTETS)})


@dataclass(slots=True)
class ItemFindings:
    """Violations of one PDU; ``base`` is the offset of the PDU in what the caller decodes."""

    base: int = 0
    found: list[Violation] = field(default_factory=list)

    def add(self, kind: Kind, offset: int, message: str) -> None:
        """Note a violation at a byte of the PDU."""
        self.found.append(Violation(kind, self.base + offset, message))


# ---- Item addresses -------------------------------------------------------------------------------------------


def encode_item(item: Item) -> bytes:
    """Return the 12 bytes of an item; PpiError with everything about it that no S7-200 accepts."""
    try:
        data = b"".join((
            ITEM_HEADER,
            item.size.to_bytes(1),
            item.count.to_bytes(2),
            item.db.to_bytes(2),
            item.area.to_bytes(1),
            item.address.to_bytes(3),
        ))  # fmt: skip
    except OverflowError:
        raise PpiError.of(Kind.ADDRESS, f"a number of the item does not fit: {item}") from None
    findings = ItemFindings()
    check_item(findings, item, 0, "the item")
    if findings.found:
        raise PpiError(findings.found)
    return data


def read_item(findings: ItemFindings, data: bytes, at: int, position: int) -> Item:
    """Return the item in the 12 bytes at ``at``."""
    what = f"item {position}"
    if data[at : at + 3] != ITEM_HEADER:
        shown = data[at : at + 3].hex(" ").upper()
        findings.add(Kind.ITEM_HEADER, at, f"{what} starts with {shown} instead of 12 0A 10")
    item = bare_item(data, at + 3)
    check_item(findings, item, at, what)
    return item


def bare_item(data: bytes, at: int) -> Item:
    """Return the item whose nine bytes behind ``12 0A 10`` start at ``at``."""
    size, area = data[at], data[at + 5]
    count, db = data[at + 1] << 8 | data[at + 2], data[at + 3] << 8 | data[at + 4]
    address = data[at + 6] << 16 | data[at + 7] << 8 | data[at + 8]
    known = Area(area) if area in _AREAS else area
    return Item(known, TransportSize(size) if size in OCTETS else size, count, address, db)


def check_item(findings: ItemFindings, item: Item, at: int, what: str) -> None:
    """Note everything about an item that a CPU answers with a return code other than FFh."""
    area, size = item.area, item.size
    if size not in OCTETS:
        findings.add(Kind.TRANSPORT_SIZE, at + 3, f"{what}: the transport size {size:02X}h is unknown")
    if item.count == 0:
        findings.add(Kind.COUNT, at + 4, f"{what}: the count is 0")
    elif size == TransportSize.BIT and item.count != 1:
        findings.add(Kind.COUNT, at + 4, f"{what}: {item.count} bits; bits are accessed one at a time")
    if area not in _AREAS:
        findings.add(Kind.AREA, at + 8, f"{what}: the area {area:02X}h is unknown")
        return
    known = Area(area)
    if item.db != known.db:
        text = f"{what}: data block {item.db}; {known.name} is {known.db} (V is 1, all others 0)"
        findings.add(Kind.DATA_BLOCK, at + 6, text)
    if size not in OCTETS:
        return
    wanted = ELEMENT_SIZES.get(area)
    if wanted is not None and size != wanted:
        text = f"{what}: {known.title} have the transport size {wanted:02X}h, not {size:02X}h"
        findings.add(Kind.TRANSPORT_SIZE, at + 3, text)
    elif wanted is None and size in ELEMENT_SIZES.values():
        text = f"{what}: the transport size {size:02X}h does not suit {known.title}"
        findings.add(Kind.TRANSPORT_SIZE, at + 3, text)
    elif wanted is None and size != TransportSize.BIT and item.address & 7:
        text = f"{what}: bit {item.address & 7} of byte {item.address >> 3}, but the elements are whole bytes"
        findings.add(Kind.ADDRESS, at + 9, text)


# ---- Values ---------------------------------------------------------------------------------------------------


def _value_header(code: int, size_code: int, data: bytes) -> bytes:
    length = len(data)
    if size_code == SizeCode.BIT:
        length = 1
    elif size_code != SizeCode.OCTETS:
        length *= 8
    return bytes((code, size_code, length >> 8 & 0xFF, length & 0xFF))


def encode_results(results: Sequence[ItemResult]) -> bytes:
    """Return the data of a read reply; PpiError if a value does not fit its size code."""
    parts: list[bytes] = []
    for number, result in enumerate(results, 1):
        if not result.ok:
            if result.data or result.size_code:
                raise PpiError.of(Kind.VALUE_LENGTH, f"item {number} failed with {result.code:02X}h, but has a value")
            parts.append(bytes((result.code, 0, 0, 0)))
            continue
        if result.size_code not in {SizeCode.BIT, SizeCode.WORDS, SizeCode.OCTETS}:
            raise PpiError.of(Kind.SIZE_CODE, f"item {number}: the size code {result.size_code:02X}h is not 3, 4 or 9")
        if not result.data:
            raise PpiError.of(Kind.VALUE_LENGTH, f"item {number}: the value has no bytes")
        if result.size_code == SizeCode.BIT and result.data not in {b"\x00", b"\x01"}:
            raise PpiError.of(Kind.VALUE, f"item {number}: a bit is 00 or 01, not {result.data.hex(' ').upper()}")
        pad = b"\x00" if len(result.data) % 2 and number < len(results) else b""
        parts.append(_value_header(result.code, result.size_code, result.data) + result.data + pad)
    return b"".join(parts)


def encode_values(items: Sequence[ItemWrite], *, trailing_pad: bool) -> bytes:
    """Return the data of a write request; PpiError if a value does not fit its item."""
    parts: list[bytes] = []
    for number, (item, data) in enumerate(((entry.item, entry.data) for entry in items), 1):
        if len(data) != item.octets:
            text = f"item {number}: {len(data)} bytes for a value of {item.octets}"
            raise PpiError.of(Kind.VALUE_LENGTH, text)
        if item.size == TransportSize.BIT and data not in {b"\x00", b"\x01"}:
            raise PpiError.of(Kind.VALUE, f"item {number}: a bit is 00 or 01, not {data.hex(' ').upper()}")
        pad = b"\x00" if len(data) % 2 and (trailing_pad or number < len(items)) else b""
        parts.append(_value_header(0, item.size_code, data) + data + pad)
    return b"".join(parts)


class Value(NamedTuple):
    """One value as it lies in a PDU: offset of its header, return code, size code, stated length, bytes, pad or not."""

    at: int
    code: int
    size_code: int
    length: int
    data: bytes
    padded: bool

    @property
    def end(self) -> int:
        """Offset behind its bytes, where its pad is if it has one."""
        return self.at + VALUE_HEADER + len(self.data)


def octets_of(size_code: int, length: int) -> int:
    """Bytes of a value: the length counts bytes for size codes 06, 07 and 09, otherwise bits."""
    return length if size_code in _IN_BYTES else (length + 7) // 8


def walk_values(data: bytes, at: int, count: int, *, reply: bool, padded: bool = True) -> tuple[list[Value], int]:
    """Return up to ``count`` values from offset ``at`` on, and where the walk ended.

    It ends early where a value is cut short. ``padded`` False reads values without pads in between.
    """
    values: list[Value] = []
    for number in range(1, count + 1):
        if at + VALUE_HEADER > len(data):
            break
        code, size_code, length = data[at], data[at + 1], data[at + 2] << 8 | data[at + 3]
        octets = octets_of(size_code, length)
        if reply and code != _OK:
            octets = 0
        start = at + VALUE_HEADER
        if start + octets > len(data):
            break
        pad = padded and octets % 2 == 1 and number < count and start + octets < len(data)
        values.append(Value(at, code, size_code, length, data[start : start + octets], pad))
        at = start + octets + pad
    return values, at


def find_values(data: bytes, at: int, count: int, *, reply: bool) -> tuple[list[Value], int, bool]:
    """Return the values behind offset ``at``, where they end, and whether there are pads between odd ones.

    Values without pads are recognised if they use up the data exactly and the usual reading does not, or meets pads
    other than 00.
    """
    values, end = walk_values(data, at, count, reply=reply)
    doubtful = len(values) < count or end not in {len(data), len(data) - 1}
    if doubtful or any(value.padded and data[value.end] for value in values):
        bare, bare_end = walk_values(data, at, count, reply=reply, padded=False)
        if len(bare) == count and bare_end == len(data):
            return bare, bare_end, False
    return values, end, True


def read_values(findings: ItemFindings, data: bytes, at: int, count: int, *, reply: bool) -> tuple[list[Value], bool]:
    """Return the values behind offset ``at``, and whether the last one has a pad; everything wrong is noted."""
    values, end, padded = find_values(data, at, count, reply=reply)
    if not padded:
        findings.add(Kind.PAD, at, "values of odd length have no pad byte before the next one")
    for number, value in enumerate(values, 1):
        _check_value(findings, data, value, number, reply=reply)
    if len(values) < count:
        text = f"value {len(values) + 1} of {count} is cut short: {len(data) - end} bytes are left"
        findings.add(Kind.DATA_LENGTH, end, text)
        return values, False
    left = len(data) - end
    odd = bool(values) and len(values[-1].data) % 2 == 1
    if left == 1 and odd:
        if data[end]:
            findings.add(Kind.PAD, end, f"the pad byte after the last value is {data[end]:02X}h instead of 00h")
        elif reply:
            findings.add(Kind.PAD, end, "a pad byte after the last value")
    elif left:
        findings.add(Kind.DATA_LENGTH, end, f"{quantity(left, 'byte')} after the last value")
    return values, left == 1 and odd


def _check_value(findings: ItemFindings, data: bytes, value: Value, number: int, *, reply: bool) -> None:
    what, at = f"value {number}", value.at
    if reply and value.code != _OK:
        if value.code not in _CODES:
            findings.add(Kind.RETURN_CODE, at, f"{what}: the return code {value.code:02X}h is unknown")
        if value.size_code or value.length:
            findings.add(Kind.RESERVED, at + 1, f"{what} failed; its size code and length are 00 00 00")
        return
    if not reply and value.code:
        findings.add(Kind.RESERVED, at, f"{what}: the reserved byte is {value.code:02X}h instead of 00h")
    if value.size_code == _BIT:
        if value.length != 1:
            findings.add(Kind.COUNT, at + 2, f"{what}: {value.length} bits; bits are accessed one at a time")
        elif value.data[0] > 1:
            findings.add(Kind.VALUE, at + 4, f"{what}: a bit is 00 or 01, not {value.data[0]:02X}h")
    elif value.size_code not in _MEASURED:
        findings.add(Kind.SIZE_CODE, at + 1, f"{what}: the size code {value.size_code:02X}h is not 03h, 04h or 09h")
    elif value.size_code == _WORDS and value.length % 8:
        findings.add(Kind.VALUE_LENGTH, at + 2, f"{what}: {value.length} bits are not whole bytes")
    if not value.data:
        findings.add(Kind.VALUE_LENGTH, at + 2, f"{what} has no bytes")
    if value.padded and data[value.end]:
        findings.add(Kind.PAD, value.end, f"the pad byte after {what} is {data[value.end]:02X}h instead of 00h")


def result_of(value: Value) -> ItemResult:
    """Return the result in a value of a read reply."""
    return ItemResult(value.code, value.data, value.size_code) if value.code == _OK else ItemResult(value.code)


def check_against(findings: ItemFindings, value: Value, item: Item, number: int) -> None:
    """Check that a value of a write request suits its item."""
    if item.size not in OCTETS:
        return
    if value.size_code != item.size_code:
        text = f"value {number}: the size code {value.size_code:02X}h does not suit its item ({item.size_code:02X}h)"
        findings.add(Kind.SIZE_CODE, value.at + 1, text)
    elif len(value.data) != item.octets:
        text = f"value {number} has {len(value.data)} bytes, its item {item.octets}"
        findings.add(Kind.VALUE_LENGTH, value.at + 2, text)


def items_length(count: int) -> int:
    """Length of the parameters of a read or write: function, count and 12 bytes an item."""
    return 2 + ITEM_SIZE * count
