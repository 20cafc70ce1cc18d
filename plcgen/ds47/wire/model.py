"""Telegrams of data set 47 as frozen values; ``codec`` turns them into bytes and back."""

from __future__ import annotations

import enum
from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeAlias

from plcgen.ds47.wire import formats

if TYPE_CHECKING:
    from collections.abc import Sequence

    from plcgen.ds47.wire.formats import Format, Value

RECORD_LIMIT = 240
"""Longest request and longest response in bytes, on PROFIBUS and on PROFINET."""

HEADER_SIZE = 4
ADDRESS_SIZE = 6
MAX_PARAMETERS = 39
MAX_ELEMENTS = 234


class RequestId(enum.IntEnum):
    """Service a request asks for (byte 1)."""

    READ = 0x01
    CHANGE = 0x02


class ResponseId(enum.IntEnum):
    """Kind of a response (byte 1); the negative ones have bit 7 set."""

    READ = 0x01
    CHANGE = 0x02
    NOT_SUPPORTED = 0x80
    READ_NEGATIVE = 0x81
    CHANGE_NEGATIVE = 0x82


class Attribute(enum.IntEnum):
    """What of a parameter is accessed."""

    VALUE = 0x10
    DESCRIPTION = 0x20
    TEXT = 0x30


@dataclass(frozen=True, slots=True)
class ParameterAddress:
    """Address of one parameter; ``elements`` 0 is the single access to a non-indexed parameter."""

    pnu: int
    subindex: int = 0
    elements: int = 1
    attribute: int = Attribute.VALUE


@dataclass(frozen=True, slots=True)
class ValueBlock:
    """Values of one parameter: format code, number of values, their bytes without the pad."""

    format: int
    count: int
    data: bytes

    @classmethod
    def of(cls, fmt: Format, values: Sequence[Value]) -> ValueBlock:
        """Build a block from Python values; FormatValueError if one does not fit the format."""
        data = formats.pack_values(fmt, values)
        return cls(fmt.code, len(data) if fmt.is_string else len(values), data)

    @classmethod
    def text(cls, text: str) -> ValueBlock:
        """Build a VisibleString block, as attribute 30h answers it."""
        return cls.of(formats.by_code(formats.VISIBLE_STRING), [text])

    def values(self, declared: Format | None = None) -> list[Value]:
        """Return the Python values; a declared type reads what 41h..43h of its size carry.

        FormatValueError if the format is unknown, does not fit the declared type or the bytes are short.
        """
        wire = formats.find(self.format)
        if wire is None:
            raise formats.FormatValueError(f"the format {self.format:02X}h is unknown")
        if declared is not None and self.format not in formats.answers(declared):
            raise formats.FormatValueError(f"a {wire.name} block does not carry {declared.name}")
        return formats.unpack_values(declared or wire, self.count, self.data)


@dataclass(frozen=True, slots=True)
class ErrorBlock:
    """Error of one parameter; ``info`` is the second word, None if the drive sends one word only."""

    number: int
    info: int | None = None


@dataclass(frozen=True, slots=True)
class ZeroBlock:
    """``40 00``: this parameter of a partly failed multi-parameter change was written."""


Block: TypeAlias = ValueBlock | ErrorBlock | ZeroBlock


@dataclass(frozen=True, slots=True)
class Request:
    """A parameter request; a change has one value block per address, a read has none."""

    reference: int
    request_id: int
    drive_object: int
    addresses: tuple[ParameterAddress, ...]
    values: tuple[ValueBlock, ...] = ()


@dataclass(frozen=True, slots=True)
class Response:
    """A parameter response; ``count`` mirrors the request and may exceed the number of blocks."""

    reference: int
    response_id: int
    drive_object: int
    count: int
    blocks: tuple[Block, ...] = ()

    @property
    def negative(self) -> bool:
        """Whether at least one parameter failed (bit 7 of the response id)."""
        return bool(self.response_id & 0x80)


def read_request(reference: int, drive_object: int, addresses: Sequence[ParameterAddress]) -> Request:
    """Build a read request."""
    return Request(reference, RequestId.READ, drive_object, tuple(addresses))


def change_request(
    reference: int, drive_object: int, changes: Sequence[tuple[ParameterAddress, ValueBlock]]
) -> Request:
    """Build a change request from pairs of address and values."""
    addresses, values = tuple(a for a, _ in changes), tuple(v for _, v in changes)
    return Request(reference, RequestId.CHANGE, drive_object, addresses, values)


def block_size(block: Block) -> int:
    """Length of a block on the wire: format, count, values or error words, pad."""
    if isinstance(block, ValueBlock):
        return 2 + formats.padded(len(block.data))
    if isinstance(block, ErrorBlock):
        return 4 if block.info is None else 6
    return 2


def request_size(request: Request) -> int:
    """Length of a request in bytes: the LEN of the write-record job."""
    addresses = ADDRESS_SIZE * len(request.addresses)
    return HEADER_SIZE + addresses + sum(map(block_size, request.values))


def response_size(response: Response) -> int:
    """Length of a response in bytes."""
    return HEADER_SIZE + sum(map(block_size, response.blocks))


def negative_size(count: int, error_words: int = 2) -> int:
    """Longest negative answer to a change of ``count`` parameters: 4 + 6n bytes with two error words."""
    return HEADER_SIZE + count * (2 + 2 * error_words)
