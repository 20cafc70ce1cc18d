"""A drive that answers parameter requests, written from public documents alone.

It shares no line and no table with the simulated drive of the product and was written before that was read. Sources:

- SINAMICS S120 Function Manual Communication, 12/2018, 6SL3097-5BD00-0BP0, section 3.4 "Acyclic communication": header,
  parameter address, parameter value, word alignment, records 47, B02Eh and B02Fh;
- SINAMICS DCM Operating Instructions, 12/2018, A5E34763375A, section 10.3, table 10-31: error values and whether a
  subindex follows them;
- SINAMICS G120X Operating Instructions, 06/2019, A5E44751209B AC, page 221: formats 0Dh, 34h and 36h; MICROMASTER 4
  over PROFIBUS, part 3, table 2-2: a TimeDifference has 32 bits;
- codes of the other types as Wireshark's PROFINET dissector names them.

What the documents leave open is not answered: :class:`UnansweredError` says which sentence a request breaks.
"""

from __future__ import annotations

import struct
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

Number = int | float

# Name of the type in the list manuals: code in the telegram, layout of one value (big-endian).
TYPES: Mapping[str, tuple[int, str]] = {
    "Boolean": (0x01, "B"),
    "Integer8": (0x02, "b"),
    "Integer16": (0x03, "h"),
    "Integer32": (0x04, "i"),
    "Unsigned8": (0x05, "B"),
    "Unsigned16": (0x06, "H"),
    "Unsigned32": (0x07, "I"),
    "FloatingPoint": (0x08, "f"),
    "VisibleString": (0x09, "B"),
    "OctetString": (0x0A, "B"),
    "TimeDifference": (0x0D, "I"),
    "Float64": (0x0F, "d"),
    "TimeOfDayWithoutDate": (0x34, "I"),
    "TimeDifferenceWithoutDate": (0x36, "I"),
    "Integer64": (0x37, "q"),
    "Unsigned64": (0x38, "Q"),
    "N2": (0x71, "h"),
    "N4": (0x72, "i"),
    "V2": (0x73, "H"),
    "L2": (0x74, "H"),
    "R2": (0x75, "H"),
    "T2": (0x76, "H"),
    "T4": (0x77, "I"),
    "D2": (0x78, "H"),
    "E2": (0x79, "h"),
    "C4": (0x7A, "i"),
    "X2": (0x7B, "h"),
    "X4": (0x7C, "i"),
} | {"Byte": (0x41, "B"), "Word": (0x42, "H"), "DoubleWord": (0x43, "I")}
# "Bytes, words and double words are also possible as a substitute" for types of that many bytes.
SUBSTITUTES: Mapping[int, int] = {1: 0x41, 2: 0x42, 4: 0x43}
ZERO, ERROR = 0x40, 0x44

READ, CHANGE, NEGATIVE = 0x01, 0x02, 0x80
VALUE_ATTRIBUTE = 0x10

NO_SUCH_NUMBER, READ_ONLY, OUTSIDE_LIMITS, NO_SUCH_SUBINDEX, NO_ARRAY, WRONG_TYPE = range(6)
NO_DESCRIPTION, NO_TEXT, TOO_LONG, BAD_ADDRESS, BAD_COUNT, NO_OBJECT = 0x09, 0x0F, 0x15, 0x16, 0x18, 0x19
# The column "additional info" of the table: these errors are followed by the subindex.
WITH_SUBINDEX = frozenset({READ_ONLY, OUTSIDE_LIMITS, NO_SUCH_SUBINDEX})

# DPV1 record 47; "parameter access - local" and "- global" on PROFINET.
RECORDS = frozenset({47, 0xB02E, 0xB02F})
MOST_PARAMETERS, MOST_ELEMENTS, LONGEST = 39, 234, 240


class UnansweredError(ValueError):
    """The request is none: the documents define no answer to it."""


class _RefusedError(Exception):
    def __init__(self, error: int, subindex: int | None = None) -> None:
        self.words = (error,) if subindex is None or error not in WITH_SUBINDEX else (error, subindex)


@dataclass
class HeldParameter:
    """One parameter: its type as the list manual prints it, its values by subindex, and limits if it has any.

    ``array`` is whether the list manual prints the number with an index.
    """

    type: str
    values: dict[int, Number]
    array: bool = False
    read_only: bool = False
    minimum: Number | None = None
    maximum: Number | None = None

    @property
    def size(self) -> int:
        """Bytes of one value."""
        return struct.calcsize(">" + TYPES[self.type][1])

    def packed(self, subindices: range) -> bytes:
        """The values as they stand in a telegram, without the fill byte."""
        return b"".join(struct.pack(">" + TYPES[self.type][1], self.values[index]) for index in subindices)

    def unpacked(self, data: bytes) -> list[Number]:
        """The values of a telegram."""
        return [value for (value,) in struct.iter_unpack(">" + TYPES[self.type][1], data)]


@dataclass(frozen=True)
class AskedParameter:
    """Six bytes: attribute, number of elements, parameter number, subindex."""

    attribute: int
    elements: int
    number: int
    subindex: int

    @property
    def subindices(self) -> range:
        """The values that are meant; no element ("special function") stands for the one without index."""
        return range(self.subindex, self.subindex + max(1, self.elements))


@dataclass
class DocumentedDrive:
    """The drive objects of one device: parameters by number, by number of the object.

    ``by_size``: values are answered as byte, word or double word, as a MICROMASTER 4 does (part 3, figure 3-5).
    """

    objects: Mapping[int, Mapping[int, HeldParameter]]
    by_size: bool = False
    longest: int = LONGEST

    def answer(self, record: int, request: bytes) -> bytes:
        """What is read from ``record`` after ``request`` has been written there.

        Raises:
            UnansweredError: no parameter request, or not to the record of one.
        """
        if record not in RECORDS:
            raise UnansweredError(f"record {record:04X}h is not a parameter record")
        reader = _Reader(request)
        reference, service, drive_object, count = reader.take("BBBB", "header")
        if reference == 0:
            raise UnansweredError("request reference 0: 01h to FFh are defined")
        if service not in (READ, CHANGE):
            raise UnansweredError(f"request ID {service:02X}h: 01h and 02h are defined")
        if not 1 <= count <= MOST_PARAMETERS:
            raise UnansweredError(f"{count} parameters: 1 to {MOST_PARAMETERS} are defined")
        addresses = [AskedParameter(*reader.take("BBHH", "parameter address")) for _ in range(count)]
        written = [reader.value() for _ in range(count)] if service == CHANGE else []
        reader.end()
        parts, good = self._parts(drive_object, addresses, written)
        head = struct.pack("BBBB", reference, service | (0 if good else NEGATIVE), drive_object, count)
        return head if good and service == CHANGE else head + b"".join(parts)

    def _parts(
        self, drive_object: int, addresses: list[AskedParameter], written: list[tuple[int, int, bytes]]
    ) -> tuple[list[bytes], bool]:
        parts: list[bytes] = []
        good, used = True, 4
        for position, address in enumerate(addresses):
            try:
                parameter = self._parameter(drive_object, address)
                if written:
                    part = _change(parameter, address, *written[position])
                else:
                    part = self._read(parameter, address, self.longest - used)
            except _RefusedError as refused:
                good = False
                part = struct.pack(f">BB{len(refused.words)}H", ERROR, len(refused.words), *refused.words)
            used += len(part)
            parts.append(part)
        return parts, good

    def _parameter(self, drive_object: int, address: AskedParameter) -> HeldParameter:
        if drive_object not in self.objects:
            raise _RefusedError(NO_OBJECT)
        parameter = self.objects[drive_object].get(address.number)
        if parameter is None:
            raise _RefusedError(NO_SUCH_NUMBER)
        if address.attribute != VALUE_ATTRIBUTE:
            raise _RefusedError({0x20: NO_DESCRIPTION, 0x30: NO_TEXT}.get(address.attribute, BAD_ADDRESS))
        if address.elements > MOST_ELEMENTS:
            raise _RefusedError(BAD_ADDRESS)
        if not parameter.array and (address.subindex or address.elements > 1) and len(parameter.values) == 1:
            raise _RefusedError(NO_ARRAY)
        for subindex in address.subindices:
            if subindex not in parameter.values:
                raise _RefusedError(NO_SUCH_SUBINDEX, subindex)
        return parameter

    def _read(self, parameter: HeldParameter, address: AskedParameter, room: int) -> bytes:
        values = parameter.packed(address.subindices)
        if 2 + len(values) > room:
            raise _RefusedError(TOO_LONG)
        own = TYPES[parameter.type][0]
        code = SUBSTITUTES.get(parameter.size, own) if self.by_size and not parameter.type.endswith("String") else own
        return bytes((code, len(address.subindices))) + values + bytes(len(values) % 2)


def _change(parameter: HeldParameter, address: AskedParameter, code: int, count: int, data: bytes) -> bytes:
    if parameter.read_only:
        raise _RefusedError(READ_ONLY, address.subindex)
    if code not in (TYPES[parameter.type][0], SUBSTITUTES.get(parameter.size)):
        raise _RefusedError(WRONG_TYPE)
    if count != len(address.subindices):
        raise _RefusedError(BAD_COUNT)
    values = parameter.unpacked(data)
    for subindex, value in zip(address.subindices, values, strict=True):
        low, high = parameter.minimum, parameter.maximum
        if (low is not None and not value >= low) or (high is not None and not value <= high):
            raise _RefusedError(OUTSIDE_LIMITS, subindex)
    parameter.values.update(zip(address.subindices, values, strict=True))
    return bytes((ZERO, 0))


class _Reader:
    """The fields of a telegram in their order."""

    def __init__(self, data: bytes) -> None:
        self.data, self.at = data, 0

    def take(self, layout: str, what: str) -> tuple[int, ...]:
        size = struct.calcsize(">" + layout)
        if self.at + size > len(self.data):
            raise UnansweredError(f"ends at byte {len(self.data)}, in the {what}")
        self.at += size
        return struct.unpack(">" + layout, self.data[self.at - size : self.at])

    def value(self) -> tuple[int, int, bytes]:
        """Format, number of values, bytes of the values without the fill byte."""
        code, count = self.take("BB", "format")
        size = next(_sizes(code), None)
        if size is None:
            raise UnansweredError(f"format {code:02X}h has no size in the documents: what follows cannot be found")
        data = bytes(self.take(f"{count * size}B", "values"))
        if len(data) % 2:
            self.take("B", "fill byte")
        return code, count, data

    def end(self) -> None:
        if self.at != len(self.data):
            raise UnansweredError(f"{len(self.data) - self.at} bytes too many after byte {self.at}")


def _sizes(code: int) -> Iterator[int]:
    yield from (struct.calcsize(">" + layout) for known, layout in TYPES.values() if known == code)
    yield from (size for size, known in SUBSTITUTES.items() if known == code)
