"""A drive that answers parameter requests, written from public documents alone.

It shares no line, no table and no author's draft with the simulated drive of ``plcgen.protocols.ds47``: it was written
before that was read. Sources:

- SINAMICS S120 Function Manual Communication, 12/2018, 6SL3097-5BD00-0BP0, section 3.4 "Acyclic communication": header,
  parameter address, parameter value, word alignment, records 47, B02Eh and B02Fh;
- SINAMICS DCM Operating Instructions, 12/2018, A5E34763375A, section 10.3, table 10-31: error values and whether a
  subindex follows them;
- PROFIdrive profile, data types as Wireshark's dissector ``packet-pn-io`` names their codes.

What the documents leave open is not answered: :class:`Unanswered` says which sentence a request breaks.
"""

from __future__ import annotations

import struct
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

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
    "FloatingPoint32": (0x08, "f"),
    "VisibleString": (0x09, "B"),
    "OctetString": (0x0A, "B"),
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
}
# "Bytes, words and double words are also possible as a substitute" for types of that many bytes.
SUBSTITUTES: Mapping[int, int] = {1: 0x41, 2: 0x42, 4: 0x43}
ZERO, ERROR = 0x40, 0x44

READ, CHANGE, NEGATIVE = 0x01, 0x02, 0x80
VALUE_ATTRIBUTE = 0x10

NO_SUCH_NUMBER = 0x00
READ_ONLY = 0x01
OUTSIDE_LIMITS = 0x02
NO_SUCH_SUBINDEX = 0x03
NO_ARRAY = 0x04
WRONG_TYPE = 0x05
NO_DESCRIPTION = 0x09
NO_TEXT = 0x0F
TOO_LONG = 0x15
BAD_ADDRESS = 0x16
BAD_FORMAT = 0x17
BAD_COUNT = 0x18
NO_OBJECT = 0x19
# The column "additional info" of the table: these errors are followed by the subindex.
WITH_SUBINDEX = frozenset({READ_ONLY, OUTSIDE_LIMITS, NO_SUCH_SUBINDEX})

# DPV1 record 47; on PROFINET also "parameter access - local" and "- global" (IEC 61800-7-303).
RECORDS: Mapping[str, frozenset[int]] = {
    "profibus": frozenset({47}),
    "profinet": frozenset({47, 0xB02E, 0xB02F}),
}
MOST_PARAMETERS = 39
MOST_ELEMENTS = 234
LONGEST = 240


class Unanswered(ValueError):
    """The request is none: the documents define no answer to it."""


class _Refused(Exception):
    def __init__(self, error: int, subindex: int | None = None) -> None:
        self.words = (error,) if subindex is None or error not in WITH_SUBINDEX else (error, subindex)


@dataclass
class Parameter:
    """One parameter: its type as the list manual prints it, its values by subindex, and limits if it has any.

    Attributes:
        array: False if the list manual prints the number without an index.
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
class Address:
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
class Drive:
    """The drive objects of one device: parameters by number, by number of the object."""

    objects: Mapping[int, Mapping[int, Parameter]]
    network: str = "profinet"
    longest: int = LONGEST
    heard: list[Address] = field(default_factory=list)

    def answer(self, record: int, request: bytes) -> bytes:
        """What is read from ``record`` after ``request`` has been written there.

        Raises:
            Unanswered: no parameter request, or not to the record of one.
        """
        if record not in RECORDS[self.network]:
            raise Unanswered(f"record {record:04X}h is none for parameters on {self.network}")
        reader = _Reader(request)
        reference, service, drive_object, count = reader.take("BBBB", "header")
        if reference == 0:
            raise Unanswered("request reference 0: 01h to FFh are defined")
        if service not in (READ, CHANGE):
            raise Unanswered(f"request ID {service:02X}h: 01h and 02h are defined")
        if not 1 <= count <= MOST_PARAMETERS:
            raise Unanswered(f"{count} parameters: 1 to {MOST_PARAMETERS} are defined")
        addresses = [Address(*reader.take("BBHH", "parameter address")) for _ in range(count)]
        written = [reader.value() for _ in range(count)] if service == CHANGE else []
        reader.end()
        self.heard += addresses
        parts, good = self._parts(drive_object, addresses, written)
        head = struct.pack("BBBB", reference, service | (0 if good else NEGATIVE), drive_object, count)
        return head if good and service == CHANGE else head + b"".join(parts)

    def _parts(
        self, drive_object: int, addresses: list[Address], written: list[tuple[int, int, bytes]]
    ) -> tuple[list[bytes], bool]:
        parts, good, used = [], True, 4
        for position, address in enumerate(addresses):
            try:
                parameter = self._parameter(drive_object, address)
                if written:
                    part = _change(parameter, address, *written[position])
                else:
                    part = _read(parameter, address)
                    if used + len(part) > self.longest:
                        raise _Refused(TOO_LONG)
            except _Refused as refused:
                good = False
                part = struct.pack(f">BB{len(refused.words)}H", ERROR, len(refused.words), *refused.words)
            used += len(part)
            parts.append(part)
        return parts, good

    def _parameter(self, drive_object: int, address: Address) -> Parameter:
        if drive_object not in self.objects:
            raise _Refused(NO_OBJECT)
        parameter = self.objects[drive_object].get(address.number)
        if parameter is None:
            raise _Refused(NO_SUCH_NUMBER)
        if address.attribute != VALUE_ATTRIBUTE:
            raise _Refused({0x20: NO_DESCRIPTION, 0x30: NO_TEXT}.get(address.attribute, BAD_ADDRESS))
        if address.elements > MOST_ELEMENTS:
            raise _Refused(BAD_ADDRESS)
        if not parameter.array and (address.subindex or address.elements > 1) and len(parameter.values) == 1:
            raise _Refused(NO_ARRAY)
        for subindex in address.subindices:
            if subindex not in parameter.values:
                raise _Refused(NO_SUCH_SUBINDEX, subindex)
        return parameter


def _read(parameter: Parameter, address: Address) -> bytes:
    values = parameter.packed(address.subindices)
    return bytes((TYPES[parameter.type][0], len(address.subindices))) + values + bytes(len(values) % 2)


def _change(parameter: Parameter, address: Address, code: int, count: int, data: bytes) -> bytes:
    if parameter.read_only:
        raise _Refused(READ_ONLY, address.subindex)
    if code not in (TYPES[parameter.type][0], SUBSTITUTES.get(parameter.size)):
        raise _Refused(WRONG_TYPE)
    if count != len(address.subindices):
        raise _Refused(BAD_COUNT)
    values = parameter.unpacked(data)
    for subindex, value in zip(address.subindices, values, strict=True):
        low, high = parameter.minimum, parameter.maximum
        if (low is not None and not value >= low) or (high is not None and not value <= high):
            raise _Refused(OUTSIDE_LIMITS, subindex)
    parameter.values.update(zip(address.subindices, values, strict=True))
    return bytes((ZERO, 0))


class _Reader:
    """The fields of a telegram in their order."""

    def __init__(self, data: bytes) -> None:
        self.data, self.at = data, 0

    def take(self, layout: str, what: str) -> tuple[int, ...]:
        size = struct.calcsize(">" + layout)
        if self.at + size > len(self.data):
            raise Unanswered(f"ends at byte {len(self.data)}, in the {what}")
        self.at += size
        return struct.unpack(">" + layout, self.data[self.at - size : self.at])

    def value(self) -> tuple[int, int, bytes]:
        """Format, number of values, bytes of the values without the fill byte."""
        code, count = self.take("BB", "format")
        size = next(_sizes(code), None)
        if size is None:
            raise Unanswered(f"format {code:02X}h has no size in the documents: what follows cannot be found")
        data = bytes(self.take(f"{count * size}B", "values"))
        if len(data) % 2:
            self.take("B", "fill byte")
        return code, count, data

    def end(self) -> None:
        if self.at != len(self.data):
            raise Unanswered(f"{len(self.data) - self.at} bytes too many behind byte {self.at}")


def _sizes(code: int) -> Iterator[int]:
    yield from (struct.calcsize(">" + layout) for known, layout in TYPES.values() if known == code)
    yield from (size for size, known in SUBSTITUTES.items() if known == code)
