"""Telegrams of data set 47: frozen values <-> bytes, big-endian, each value block padded to a word.

``strict`` means "as the profile says": reserved references, ids, attributes, subindexes and formats, a pad
other than 00h, trailing bytes and records over 240 bytes are violations. Otherwise only the structure
counts, which is what a server needs to answer a wrong request with the right error number. For every valid
telegram ``encode(decode(data)) == data`` and ``decode(encode(value)) == value``.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from plcgen.base.diagnostics import PlcgenError
from plcgen.ds47.wire import formats
from plcgen.ds47.wire.model import (
    HEADER_SIZE,
    MAX_ELEMENTS,
    MAX_PARAMETERS,
    RECORD_LIMIT,
    Attribute,
    Block,
    ErrorBlock,
    ParameterAddress,
    Request,
    RequestId,
    Response,
    ResponseId,
    ValueBlock,
    ZeroBlock,
    block_size,
)

if TYPE_CHECKING:
    from collections.abc import Iterable

RESERVED_REFERENCE = "the request reference 00h is reserved"
"""What the profile says of it; some makers print requests with it all the same (ifm, RM30 p. 26)."""


@dataclass(frozen=True, slots=True)
class Problem:
    """One violation: byte offset in the telegram and what is wrong there."""

    offset: int
    message: str


class TelegramError(PlcgenError, ValueError):
    """Bytes that are no valid telegram, or a value that makes none: all violations in order."""

    def __init__(self, offset: int, message: str, problems: Iterable[Problem] = ()) -> None:
        self.offset = offset
        self.message = message
        self.problems: tuple[Problem, ...] = tuple(problems) or (Problem(offset, message),)
        super().__init__("; ".join(f"byte {p.offset}: {p.message}" for p in self.problems))

    @classmethod
    def of(cls, problems: Iterable[Problem]) -> TelegramError:
        """Build the error from at least one problem, in the order of the offsets."""
        ordered = tuple(sorted(problems, key=lambda p: p.offset))
        return cls(ordered[0].offset, ordered[0].message, ordered)


class _CutShortError(Exception):
    """The telegram ends inside a field, so nothing behind it can be read."""


@dataclass(slots=True)
class _Reader:
    """A cursor over the telegram that collects violations instead of stopping at the first one."""

    data: bytes
    strict: bool
    offset: int = 0
    problems: list[Problem] = field(default_factory=list)

    @property
    def left(self) -> int:
        return len(self.data) - self.offset

    def problem(self, offset: int, message: str) -> None:
        self.problems.append(Problem(offset, message))

    def violation(self, offset: int, message: str) -> None:
        if self.strict:
            self.problem(offset, message)

    def take(self, size: int, what: str) -> bytes:
        if self.left < size:
            start, left = self.offset, self.left
            self.problem(start, f"{what} needs {size} bytes, the telegram has {left} left")
            self.offset = len(self.data)
            raise _CutShortError
        chunk = self.data[self.offset : self.offset + size]
        self.offset += size
        return chunk

    def number(self, size: int, what: str) -> int:
        return int.from_bytes(self.take(size, what), "big")

    def pad(self, size: int, what: str) -> None:
        if size % 2:
            at = self.offset
            value = self.number(1, f"the pad byte of {what}")
            if value:
                self.violation(at, f"the pad byte of {what} is {value:02X}h instead of 00h")

    def end(self) -> None:
        if self.left:
            self.violation(self.offset, f"{self.left} bytes follow the end of the telegram")
        if len(self.data) > RECORD_LIMIT:
            self.violation(RECORD_LIMIT, f"{len(self.data)} bytes exceed the record limit of {RECORD_LIMIT}")

    def finish(self) -> None:
        if self.problems:
            raise TelegramError.of(self.problems)


def _header(reader: _Reader) -> tuple[int, int, int, int]:
    reference, identifier, drive_object, count = reader.take(HEADER_SIZE, "the header")
    if reference == 0:
        reader.violation(0, RESERVED_REFERENCE)
    if not 1 <= count <= MAX_PARAMETERS:
        reader.violation(3, f"{count} parameters; a telegram has 1 to {MAX_PARAMETERS}")
    return reference, identifier, drive_object, count


def _read_address(reader: _Reader, position: int) -> ParameterAddress:
    what = f"the address of parameter {position}"
    if reader.left < 6:
        reader.take(6, what)
    at = reader.offset
    attribute, elements = reader.number(1, what), reader.number(1, what)
    pnu, subindex = reader.number(2, what), reader.number(2, what)
    if attribute not in set(Attribute):
        reader.violation(at, f"{what}: the attribute {attribute:02X}h is not 10h, 20h or 30h")
    if elements > MAX_ELEMENTS:
        reader.violation(at + 1, f"{what}: {elements} elements; at most {MAX_ELEMENTS}")
    if pnu == 0:
        reader.violation(at + 2, f"{what}: the parameter number 0 is reserved")
    if subindex == 0xFFFF:
        reader.violation(at + 4, f"{what}: the subindex FFFFh is reserved")
    known = Attribute(attribute) if attribute in set(Attribute) else attribute
    return ParameterAddress(pnu, subindex, elements, known)


def _read_values(reader: _Reader, at: int, code: int, count: int, what: str) -> ValueBlock:
    fmt = formats.find(code)
    if fmt is None:
        reader.violation(at, f"{what}: the format {code:02X}h is unknown, so its length is too")
        return ValueBlock(code, count, reader.take(reader.left, what))
    if count > MAX_ELEMENTS:
        reader.violation(at + 1, f"{what}: {count} values; at most {MAX_ELEMENTS}")
    size = fmt.size * count
    data = reader.take(size, f"{what}: {count} x {fmt.name}")
    reader.pad(size, what)
    return ValueBlock(code, count, data)


def _read_request_block(reader: _Reader, position: int) -> ValueBlock:
    what = f"the value of parameter {position}"
    at = reader.offset
    code, count = reader.take(2, what)
    fmt = formats.find(code)
    if fmt is not None and not fmt.writable:
        reader.violation(at, f"{what}: the format {code:02X}h ({fmt.name}) occurs in responses only")
    return _read_values(reader, at, code, count, what)


def _read_response_block(reader: _Reader, position: int) -> Block:
    what = f"the answer of parameter {position}"
    at = reader.offset
    code, count = reader.take(2, what)
    if code == formats.ZERO and count == 0:
        return ZeroBlock()
    if code == formats.ZERO:
        reader.violation(at + 1, f"{what}: the format 40h (Zero) carries no values, the count is {count}")
    if code != formats.ERROR:
        return _read_values(reader, at, code, count, what)
    if count not in {1, 2}:
        reader.problem(at + 1, f"{what}: an error has 1 or 2 words, not {count}")
        raise _CutShortError
    number = reader.number(2, what)
    info = reader.number(2, what) if count == 2 else None
    if number > 0xFF:
        reader.violation(at + 2, f"{what}: the error number {number:04X}h is over 00FFh")
    return ErrorBlock(number, info)


def decode_request(data: bytes, *, strict: bool = True) -> Request:
    """Return the request in ``data``; TelegramError with every violation found.

    Without ``strict`` a change may carry fewer value blocks than addresses: a block of unknown format takes
    all bytes to the end, and trailing bytes are dropped.
    """
    reader = _Reader(bytes(data), strict)
    reference = identifier = drive_object = 0
    addresses: list[ParameterAddress] = []
    values: list[ValueBlock] = []
    try:
        reference, identifier, drive_object, count = _header(reader)
        if identifier not in set(RequestId):
            reader.violation(1, f"the request id {identifier:02X}h is {_request_id_meaning(identifier)}")
        addresses = [_read_address(reader, position) for position in range(1, count + 1)]
        if identifier == RequestId.CHANGE:
            for position in range(1, count + 1):
                if reader.left == 0 and not strict:
                    break
                values.append(_read_request_block(reader, position))
                _check_count(reader, addresses[position - 1], values[-1], position)
        reader.end()
    except _CutShortError:
        pass
    reader.finish()
    known = RequestId(identifier) if identifier in set(RequestId) else identifier
    return Request(reference, known, drive_object, tuple(addresses), tuple(values))


def _request_id_meaning(identifier: int) -> str:
    return "manufacturer-specific" if 0x40 <= identifier <= 0x7F else "reserved"


def count_matches(elements: int, count: int) -> bool:
    """Whether ``count`` values may follow an address with ``elements``: equal, or 0 with one value."""
    return elements == count or (elements == 0 and count == 1)


def _check_count(reader: _Reader, address: ParameterAddress, block: ValueBlock, position: int) -> None:
    if not count_matches(address.elements, block.count):
        at = HEADER_SIZE + 6 * (position - 1) + 1
        message = f"parameter {position}: {address.elements} elements, but {block.count} values follow"
        reader.violation(at, message)


def decode_response(data: bytes, *, request: Request | None = None, strict: bool = True) -> Response:
    """Return the response in ``data``; TelegramError with every violation found.

    With ``request`` the mirrored fields and the element counts are checked too. Fewer blocks than parameters
    are accepted in one case only: one single error block for a request that failed as a whole.
    """
    reader = _Reader(bytes(data), strict)
    reference = identifier = drive_object = count = 0
    blocks: list[Block] = []
    try:
        reference, identifier, drive_object, count = _header(reader)
        if request is not None:
            _check_mirror(reader, request, identifier)
        _read_blocks(reader, identifier, count, blocks)
        reader.end()
        _check_failed(reader, identifier, blocks)
    except _CutShortError:
        pass
    _check_blocks(reader, identifier, blocks, request)
    reader.finish()
    known = ResponseId(identifier) if identifier in set(ResponseId) else identifier
    return Response(reference, known, drive_object, count, tuple(blocks))


def _read_blocks(reader: _Reader, identifier: int, count: int, blocks: list[Block]) -> None:
    """Read as many blocks as the response id promises; a single error may stand for all of them."""
    if identifier not in set(ResponseId):
        reader.problem(1, f"the response id {identifier:02X}h is not 01h, 02h, 80h, 81h or 82h")
        raise _CutShortError
    expected = {ResponseId.CHANGE: 0, ResponseId.NOT_SUPPORTED: 1}.get(ResponseId(identifier), count)
    for position in range(1, expected + 1):
        if position == 2 and reader.left == 0 and isinstance(blocks[0], ErrorBlock):
            break
        blocks.append(_read_response_block(reader, position))


def _check_blocks(reader: _Reader, identifier: int, blocks: list[Block], request: Request | None) -> None:
    """Check that the kinds of the blocks suit the response id and the request."""
    at = HEADER_SIZE
    for position, block in enumerate(blocks, 1):
        if identifier == ResponseId.READ and not isinstance(block, ValueBlock):
            reader.violation(at, f"parameter {position} answers no values in a positive read response")
        elif identifier == ResponseId.READ_NEGATIVE and isinstance(block, ZeroBlock):
            reader.violation(at, f"parameter {position} answers 40 00 to a read")
        elif identifier == ResponseId.CHANGE_NEGATIVE and isinstance(block, ValueBlock):
            reader.violation(at, f"parameter {position} answers values to a change")
        elif request is not None and isinstance(block, ValueBlock):
            _check_elements(reader, request, position, block, at)
        at += block_size(block)


def _check_failed(reader: _Reader, identifier: int, blocks: list[Block]) -> None:
    if identifier & 0x80 and not any(isinstance(block, ErrorBlock) for block in blocks):
        reader.violation(1, f"the negative response id {identifier:02X}h, but no parameter has an error")


def _check_mirror(reader: _Reader, request: Request, identifier: int) -> None:
    expected = (request.reference, request.drive_object, len(request.addresses))
    actual = (reader.data[0], reader.data[2], reader.data[3])
    names = ("request reference", "drive object", "number of parameters")
    for offset, name, want, got in zip((0, 2, 3), names, expected, actual, strict=True):
        if want != got:
            reader.problem(offset, f"the {name} {got} does not mirror the request's {want}")
    if identifier in set(ResponseId) and identifier & 0x7F not in {0, request.request_id}:
        reader.problem(1, f"the response id {identifier:02X}h does not answer request id {request.request_id:02X}h")


def _check_elements(reader: _Reader, request: Request, position: int, block: ValueBlock, at: int) -> None:
    """Check the number of values against the address; strings and descriptions count octets."""
    if position > len(request.addresses):
        return
    address, fmt = request.addresses[position - 1], formats.find(block.format)
    plain = fmt is not None and not fmt.is_string and address.attribute == Attribute.VALUE
    if plain and not count_matches(address.elements, block.count):
        message = f"parameter {position} answers {block.count} values, {address.elements} elements were asked for"
        reader.problem(at + 1, message)


def _number(value: int, size: int, what: str) -> bytes:
    if not 0 <= value < 1 << 8 * size:
        raise TelegramError(0, f"{what} takes 0 to {(1 << 8 * size) - 1}, not {value}")
    return value.to_bytes(size, "big")


def _encode_address(address: ParameterAddress) -> bytes:
    return b"".join((
        _number(address.attribute, 1, "the attribute"),
        _number(address.elements, 1, "the number of elements"),
        _number(address.pnu, 2, "the parameter number"),
        _number(address.subindex, 2, "the subindex"),
    ))  # fmt: skip


def _encode_block(block: Block) -> bytes:
    if isinstance(block, ZeroBlock):
        return bytes((formats.ZERO, 0))
    if isinstance(block, ErrorBlock):
        words = [block.number] if block.info is None else [block.number, block.info]
        return bytes((formats.ERROR, len(words))) + b"".join(_number(word, 2, "an error word") for word in words)
    head = _number(block.format, 1, "the format") + _number(block.count, 1, "the number of values")
    return head + block.data + bytes(len(block.data) % 2)


def _encode_header(reference: int, identifier: int, drive_object: int, count: int) -> bytes:
    return b"".join((
        _number(reference, 1, "the request reference"),
        _number(identifier, 1, "the request or response id"),
        _number(drive_object, 1, "the drive object"),
        _number(count, 1, "the number of parameters"),
    ))  # fmt: skip


def encode_request(request: Request, *, strict: bool = True) -> bytes:
    """Return the bytes of a request; TelegramError if not valid (``strict``) or a field does not fit."""
    header = _encode_header(request.reference, request.request_id, request.drive_object, len(request.addresses))
    body = [_encode_address(address) for address in request.addresses]
    data = header + b"".join(body + [_encode_block(block) for block in request.values])
    if strict and decode_request(data) != request:
        raise TelegramError(0, "the values do not match the addresses, or a block's bytes not its format")
    return data


def encode_response(response: Response, *, strict: bool = True) -> bytes:
    """Return the bytes of a response; TelegramError if not valid (``strict``) or a field does not fit."""
    header = _encode_header(response.reference, response.response_id, response.drive_object, response.count)
    data = header + b"".join(_encode_block(block) for block in response.blocks)
    if strict and decode_response(data) != response:
        raise TelegramError(0, "the blocks do not match the header, or a block's bytes not its format")
    return data
