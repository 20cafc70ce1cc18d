"""The part of IMPORT.md about PPI masters and the meaning of each byte, stated a second time.

Sources: frames captured between STEP 7-Micro/WIN and a CPU 226 (docs/ppi-master.md); areas and transport sizes of
libnodave. Addresses come from the bytes of the request.
"""

from __future__ import annotations

import re
import struct
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

from plcgen.ppi.plan.nouns import PlannedMaster, PpiPlan, PpiValue
from plcgen.ppi.proof.words import GAP_BITS, LONGEST
from plcgen.proof.folder import plain
from plcgen.proof.wording.model import GuideLine


@cache
def sentences() -> Mapping[str, Any]:
    """Texts by what a block is and the name of a member, and the lines of the guide."""
    return tomllib.loads((Path(__file__).parent / "sentences.toml").read_text("utf-8"))


SIGNED = frozenset({"INT", "DINT", "SINT"})
MODULES = {"cm1241": "CM 1241", "cb1241": "CB 1241", "cm-ptp": "CM PtP", "cp341": "CP 341"}
LEAST_GAP_MS = 4
"""Character delay time of a CP 341: at least so many milliseconds (manual of the CP 341)."""


def guide_before(plan: PpiPlan) -> list[GuideLine]:
    """Modules with their settings, numbers of data blocks, what is written."""
    where = "hardware identifier" if plan.target.t15 else "address"
    named = sentences()["guide"]["named"] if any(job.trigger.items() for job in plan.jobs) else ""
    found = [
        "## PPI masters",
        *(
            f"- `{one.block.name}`: {MODULES[one.module]} at {where} {one.port}, {one.baud} bit/s"
            for one in plan.masters
        ),
        *_module(plan),
        *(line + named for line in _said("jobs", controls=f"`{plan.control_db.name}`")),
        *([] if plan.target.v5 else _said("by_name")),
    ]
    writes = [line for master in plan.masters for line in _writes(master)]
    head = [GuideLine("## What these masters write"), GuideLine("| job | station | address | value |")]
    return [*map(GuideLine, found), *(head if writes else []), *writes]


def _module(plan: PpiPlan) -> Iterator[str]:
    """How the modules are set, and where their blocks come from; what differs is said of each master."""
    slowest, fastest = min(one.baud for one in plan.masters), max(one.baud for one in plan.masters)
    speed = f"{slowest} bit/s" if slowest == fastest else "the speed of its master above"
    if plan.target.t15:
        yield from _said("cm", speed=speed, gap=GAP_BITS, longest=LONGEST)
        return
    gap = max(LEAST_GAP_MS, -(-GAP_BITS * 1000 // slowest))
    yield from _said("cp", speed=speed, gap=gap, longest=LONGEST)
    yield from _said("v5" if plan.target.v5 else "tia")
    yield " ".join([*_said("buffers"), *([] if plan.target.v5 else _said("number"))])
    yield from _said("numbers")
    yield from (f"| {one.buffer.name} | DB{one.buffer.number} |" for one in plan.masters if one.buffer is not None)


def _said(part: str, **words: object) -> list[str]:
    return [line.format(**words) for line in sentences()["guide"][part]]


def _writes(master: PlannedMaster) -> Iterator[GuideLine]:
    for job in master.jobs:
        front = f"| {master.block.name}, job {job.key} | {job.station.key} ({job.telegrams[0].request.data[4]}) |"
        if job.kind in {"run", "stop"}:
            yield GuideLine(f"{front} CPU | {job.kind.upper()} |")
        for value in job.values if job.kind == "write" else ():
            yield _written(plain(f"{front} {value.label} |"), value)


def _written(front: str, value: PpiValue) -> GuideLine:
    def accepts(text: str) -> bool:
        said = text.removeprefix(front).removesuffix("|").strip()
        return text.startswith(front) and says_value(value, said)

    return GuideLine(f"{front} {_shown(value) if value.constant else 'block input'} |", accepts)


def _shown(value: PpiValue) -> str:
    """A constant as a person reads it."""
    data, name = value.data[: value.size], value.element.name
    if name == "REAL":
        text = f"{struct.unpack('>f', data)[0]:.7g}"
    elif name in SIGNED:
        text = str(int.from_bytes(data, signed=True))
    else:
        text = f"16#{data.hex().upper()}"
    return f"{value.count} times {text}" if value.count > 1 else text


def says_value(value: PpiValue, text: str) -> bool:
    """Whether a cell names what is written: a constant, or that an input says it."""
    if not value.constant:
        return text == "block input"
    data = value.data[: value.size]
    if value.count > 1:
        times, _, text = text.partition(" times ")
        if times != str(value.count) or value.data != data * value.count:
            return False
    if text in {"TRUE", "FALSE"}:
        return (text == "TRUE") == any(data)
    if (found := re.fullmatch(r"(?:[A-Z]+#)?16#([0-9A-F]+)", text)) is not None:
        return int(found[1], 16) == int.from_bytes(data)
    if text.startswith("'"):
        return text[1:-1].encode("latin-1", "replace").endswith(data)
    try:
        number = float(text.rpartition("#")[2])
    except ValueError:
        return False
    if value.element.name == "REAL":
        return struct.pack(">f", number) == data
    return int(number) == int.from_bytes(data, signed=value.element.name in SIGNED)


def listed_master(master: PlannedMaster) -> dict[str, object]:
    """A master in the manifest: its telegrams as they lie on disk."""
    telegrams = []
    for one in master.telegrams:
        found: dict[str, object] = {
            "request": one.request.data.hex(" ").upper(),
            "request_db": f"DB{one.request.home.number}",
        }
        if one.response is not None:
            found["response_db"] = f"DB{one.response.home.number}"
        telegrams.append(found)
    return {"master": master.key, "block": master.block.name, "telegrams": telegrams}


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
