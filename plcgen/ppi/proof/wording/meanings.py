"""What each byte of a PPI telegram means, stated a second time by its place.

Sources: frames captured between STEP 7-Micro/WIN and a CPU 226 (docs/ppi-master.md); areas and transport sizes of
libnodave. Addresses come from the bytes of the request.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

READ, WRITE, RUN, STOP = 0x04, 0x05, 0x28, 0x29
LEAD, SERVICE, ITEMS, ITEM = 1, 17, 19, 12
"""The length in front of a telegram in its table; the service and the first item in a telegram; bytes of an item."""
_FRAME = (
    "length of the telegram in bytes", "68h = start delimiter SD2", "LE: bytes from DA to the last of the PDU",
    "LEr: length repeated", "68h = start delimiter repeated", "DA: address of the station",
    "SA: address of this master", "FC: 6Ch first, then 5Ch, 7Ch in turn", "32h = S7 protocol", "01h = job",
    "reserved, 0", "", "PDU reference, new in every request", "", "length of the parameters: 2 + 12 per item", "",
    "length of the data", "", "04h = read, 05h = write, 28h = RUN, 29h = STOP", "number of items",
)  # fmt: skip
_ITEM = {
    0: "12h = address specification", 1: "0Ah = ten bytes follow", 2: "10h = S7 any pointer", 4: "number of elements",
    6: "1 for V, else 0", 9: "byte * 8 + bit, highest byte", 10: "byte * 8 + bit",
}  # fmt: skip
_SIZES = {
    0x01: "bit", 0x02: "byte", 0x03: "char", 0x04: "word", 0x05: "int", 0x06: "dword", 0x07: "dint", 0x08: "real",
    0x1E: "counter", 0x1F: "timer", 0x20: "high speed counter",
}  # fmt: skip
_OCTETS = {0x01: 1, 0x02: 1, 0x03: 1, 0x04: 2, 0x05: 2, 0x06: 4, 0x07: 4, 0x08: 4, 0x1E: 3, 0x1F: 5, 0x20: 5}
AREAS = {
    0x03: "SYS", 0x04: "S", 0x05: "SM", 0x06: "AI", 0x07: "AQ", 0x1E: "C", 0x1F: "T", 0x20: "HC", 0x81: "I", 0x82: "Q",
    0x83: "M", 0x84: "V",
}  # fmt: skip
_WORDS = {
    "SYS": "system information", "S": "sequence control relays", "SM": "special memory", "AI": "analog inputs",
    "AQ": "analog outputs", "C": "counters", "T": "timers", "HC": "high-speed counters", "I": "inputs", "Q": "outputs",
    "M": "bit memory", "V": "variable memory",
}  # fmt: skip
_ELEMENTS = frozenset({"C", "T", "HC"})
"""Areas that are counted in elements, not in bytes."""
_SERVICE = {
    RUN: {20: "reserved, 0", 24: "reserved, 0", 25: "FDh", 26: "no arguments", 28: "09h and the service P_PROGRAM"},
    STOP: {20: "reserved, 0", 24: "09h and the service P_PROGRAM"},
}
_SIZE_CODE = "03h = bit, 04h = length in bits, 09h = in bytes"
Labels = Sequence[Sequence[str]]
Texts = Sequence[frozenset[str]]
_LABEL = re.compile(r"(?:.* \()?(?P<area>SYS|SM|AI|AQ|HC|[SCTIQMV])[BWDX]?(?P<number>\d+)(?:\.(?P<bit>\d))?\b.*")


@dataclass(frozen=True, slots=True)
class RequestedItem:
    """An item of a request: where it begins in the telegram, area, first bit (or element), bytes of its value."""

    at: int
    area: str
    size: int
    first: int
    octets: int


def asked_items(request: bytes) -> list[RequestedItem]:
    """The items of a read or a write."""
    found = []
    for number in range(request[SERVICE + 1] if request[SERVICE] in {READ, WRITE} else 0):
        at = ITEMS + ITEM * number
        size, count = request[at + 3], int.from_bytes(request[at + 4 : at + 6])
        first = int.from_bytes(request[at + 9 : at + 12])
        found.append(RequestedItem(at, AREAS.get(request[at + 8], "?"), size, first, count * _OCTETS.get(size, 1)))
    return found


def holds(item: RequestedItem, label: str, start: int) -> bool:
    """Whether the bytes from ``start`` on of what a document calls a value lie in an item.

    A name without an address cannot be told.
    """
    found = _LABEL.fullmatch(label)
    if found is None:
        return True
    number = int(found["number"])
    if item.area in _ELEMENTS:
        return found["area"] == item.area and item.first <= number
    bit = 8 * (number + start) + int(found["bit"] or 0)
    return found["area"] == item.area and item.first <= bit < item.first + 8 * item.octets


def called(item: RequestedItem, labels: Sequence[str]) -> str:
    """What the members of an item begin with: its values, or its area."""
    return ", ".join(labels) or _WORDS.get(item.area, "")


def of_table(request: bytes, labels: Labels, values: Texts) -> dict[int, frozenset[str]]:
    """Texts of the members of a telegram table by their byte."""
    found = {at: frozenset({text}) for at, text in enumerate(_FRAME) if text}
    service, end = request[SERVICE], len(request) + LEAD
    if service not in {READ, WRITE}:
        found |= {at: frozenset({text}) for at, text in _SERVICE.get(service, {}).items()}
        found[LEAD + SERVICE + 1] = frozenset({"reserved, 0"})
    for number, item in enumerate(asked := asked_items(request)):
        name = called(item, labels[number])
        texts = {**_ITEM, 3: f"{item.size:02X}h = {_SIZES.get(item.size, '?')}"}
        texts[8] = f"{request[item.at + 8]:02X}h = {item.area}"
        found |= {LEAD + item.at + at: frozenset({f"{name}: {text}"}) for at, text in texts.items()}
    if service == WRITE:
        found |= _values(LEAD + ITEMS + ITEM * len(asked), asked, labels, values, padded=True)
    found[end - 2] = frozenset({"FCS: sum of all bytes from DA on, modulo 256"})
    found[end - 1] = frozenset({"16h = end delimiter"})
    return found


def of_answer(request: bytes, labels: Labels, values: Texts) -> dict[int, frozenset[str]]:
    """Texts of the members of a response DB: return codes alone for a write."""
    asked = asked_items(request)
    if request[SERVICE] == WRITE:
        texts = (f"{called(item, labels[at])}: return code: FFh = good" for at, item in enumerate(asked))
        return {at: frozenset({text}) for at, text in enumerate(texts)}
    return dict(_values(0, asked, labels, values, padded=False))


def _values(
    at: int, asked: Sequence[RequestedItem], labels: Labels, values: Texts, *, padded: bool
) -> Iterator[tuple[int, frozenset[str]]]:
    """Return code, size code, length, value, and a byte behind a value of odd length."""
    for number, item in enumerate(asked):
        name = called(item, labels[number])
        yield at, frozenset({f"{name}: return code: FFh = good"})
        yield at + 1, frozenset({f"{name}: {_SIZE_CODE}"})
        yield at + 2, frozenset({f"{name}: length of the value"})
        yield at + 4, values[number]
        if item.octets % 2 and (padded or number < len(asked) - 1):
            yield at + 4 + item.octets, frozenset({f"{name}: pad byte"})
        at += 4 + item.octets + item.octets % 2
