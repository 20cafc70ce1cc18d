"""Every byte of a PPI telegram gets a member: the telegram tables and the response DBs.

A table is the length of the telegram in one byte, then the telegram: so every word of the frame and every value lies at
an even offset. The last value of a write is padded to even length too, as STEP 7-Micro/WIN sends it. A response DB
holds the data part of the reply as it is when every item is good.
"""

from __future__ import annotations

from dataclasses import dataclass, field

from plcgen.ppi.plan.nouns import Placed, PpiField, WireItem
from plcgen.ppi.wire.areas import JOB_HEADER, Function, SizeCode
from plcgen.s7.types.data_types import ELEMENTARY, ArrayType, DataType

BYTE, WORD, DWORD = ELEMENTARY["BYTE"], ELEMENTARY["WORD"], ELEMENTARY["DWORD"]
FRAME_HEADER = 7
_HEADER = (
    ("telegramLength", "length", BYTE), ("startDelimiter", "start", BYTE), ("frameLength", "frame_length", BYTE),
    ("frameLengthRepeated", "frame_length_2", BYTE), ("startDelimiterRepeated", "start_2", BYTE),
    ("destination", "destination", BYTE), ("source", "source", BYTE), ("functionCode", "function_code", BYTE),
    ("protocolId", "protocol", BYTE), ("messageType", "rosctr", BYTE), ("reserved", "reserved", WORD),
    ("pduReference", "reference", WORD), ("parameterLength", "parameter_length", WORD),
    ("dataLength", "data_length", WORD), ("service", "service", BYTE),
)  # fmt: skip
_ITEM = (
    ("specification", "specification", BYTE), ("addressLength", "address_length", BYTE),
    ("syntaxId", "syntax", BYTE), ("transportSize", "transport_size", BYTE), ("elementCount", "count", WORD),
    ("dbNumber", "db", WORD), ("area", "area", BYTE), ("bitAddressHigh", "address_high", BYTE),
    ("bitAddress", "address", WORD),
)  # fmt: skip
_RUN = (
    ("reservedByte", "reserved", BYTE), ("reservedDword", "reserved", DWORD), ("reservedLast", "reserved", BYTE),
    ("serviceMark", "service_mark", BYTE), ("argumentLength", "argument_length", WORD),
)  # fmt: skip
_STOP = (("reservedByte", "reserved", BYTE), ("reservedDword", "reserved", DWORD))
_PROGRAM = ArrayType(((0, 9),), BYTE)


@dataclass(slots=True)
class _Layout:
    image: bytes
    single: bool
    fields: list[PpiField] = field(default_factory=list)
    offset: int = 0

    def add(
        self, name: str, role: str, type_: DataType, size: int = 0, item: int = 0, placed: tuple[Placed, ...] = ()
    ) -> None:
        size = size or type_.bits // 8  # type: ignore[union-attr]
        if item and not self.single and role != "value":
            name += str(item)
        data = self.image[self.offset : self.offset + size].ljust(size, b"\0")
        self.fields.append(PpiField(name, role, type_, self.offset, size, data, item, placed))
        self.offset += size

    def rows(self, rows: tuple[tuple[str, str, DataType], ...], item: int = 0) -> None:
        for name, role, type_ in rows:
            self.add(name, role, type_, 0, item)

    def value(self, wire: WireItem, item: int, *, last: bool) -> None:
        """A value and the pad behind it; with several values in one item, their bytes."""
        octets = wire.item.octets
        name, type_ = f"data{'' if self.single else item}", None
        single = wire.single
        if single is not None:
            name = single.member
            type_ = single.type if not single.bit else BYTE
            if isinstance(type_, ArrayType) and octets % 2:
                type_ = None
        if type_ is None:
            type_ = BYTE if octets == 1 else ArrayType(((0, octets + octets % 2 - 1),), BYTE)
        array = isinstance(type_, ArrayType)
        size = octets + octets % 2 if array else octets
        self.add(name, "value", type_, size, item, wire.values)
        if not array and octets % 2 and not last:
            self.add("padding", "pad", BYTE, 0, item)


def request_fields(request: bytes, items: tuple[WireItem, ...]) -> tuple[PpiField, ...]:
    """Members of the telegram table of one frame."""
    layout = _Layout(bytes((len(request),)) + request, len(items) == 1)
    layout.rows(_HEADER)
    service = request[FRAME_HEADER + JOB_HEADER]
    if service in {Function.READ, Function.WRITE}:
        layout.rows((("itemCount", "item_count", BYTE),))
        for number in range(1, len(items) + 1):
            layout.rows(_ITEM, number)
        if service == Function.WRITE:
            for number, wire in enumerate(items, 1):
                layout.rows((("returnCode", "return_code", BYTE), ("sizeCode", "size_code", BYTE)), number)
                layout.rows((("valueLength", "value_length", WORD),), number)
                layout.value(wire, number, last=False)
    else:
        layout.rows(_RUN if service == Function.PI_SERVICE else _STOP)
        layout.add("programName", "program", _PROGRAM, 10)
    layout.rows((("frameCheck", "fcs", BYTE), ("endDelimiter", "end", BYTE)))
    return tuple(layout.fields)


def response_fields(items: tuple[WireItem, ...], *, write: bool) -> tuple[PpiField, ...]:
    """Members of the response DB: the data part of the reply when every item is good."""
    layout = _Layout(b"", len(items) == 1)
    for number, wire in enumerate(items, 1):
        layout.rows((("returnCode", "return_code", BYTE),), number)
        if write:
            continue
        layout.rows((("sizeCode", "size_code", BYTE), ("valueLength", "value_length", WORD)), number)
        layout.value(wire, number, last=number == len(items))
    return tuple(layout.fields)


def value_length(wire: WireItem) -> int:
    """Length of a value as its item's length field says it: in bits, or in bytes for size code 09."""
    octets = wire.item.octets
    code = wire.item.size_code
    return 1 if code == SizeCode.BIT else octets if code == SizeCode.OCTETS else 8 * octets
