"""The parameter server of a simulated drive: one request in, one response out, checks in the profile's order.

The order: request id (21h), drive object (19h), multi-parameter access (23h, 22h), then for each parameter
attribute/elements/PNU/subindex (16h), unknown PNU (00h), change of a description or text (07h, 20h, 0Fh),
array access (04h, 03h), read-only (01h), operating state (the condition's number), format (17h), number of
values (18h), type (05h), limits (02h, C8h, C9h), allowed values (14h), reset-only (06h). Chosen where the
documents are silent: array access before read-only, operating state behind it, and an array is written as a
whole or not at all.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

from plcgen.ds47.sim.behaviour import LOCAL_INDEX
from plcgen.ds47.sim.parameters import TEXT_SIZE
from plcgen.ds47.wire import formats
from plcgen.ds47.wire.codec import count_matches
from plcgen.ds47.wire.model import (
    ADDRESS_SIZE,
    HEADER_SIZE,
    Attribute,
    Block,
    ErrorBlock,
    ParameterAddress,
    RequestId,
    Response,
    ResponseId,
    ValueBlock,
    ZeroBlock,
    block_size,
)

if TYPE_CHECKING:
    from collections.abc import Mapping

    from plcgen.ds47.sim.behaviour import Behaviour
    from plcgen.ds47.sim.parameters import DriveObject, SimulatedParameter
    from plcgen.ds47.wire.formats import Takes, Value

WHOLE = 0
"""Position of an injected error that stands for the whole request."""


class _RefusedError(Exception):
    """One parameter access fails with an error number and its information word."""

    def __init__(self, number: int, info: int = 0) -> None:
        self.number = number
        self.info = info
        super().__init__(f"{number:02X}h")


@dataclass(slots=True)
class _Values:
    """Value blocks of a change, one per address: None where the record has none or an unreadable one."""

    blocks: list[ValueBlock | None] = field(default_factory=list)
    exact: bool = True


@dataclass(frozen=True, slots=True)
class ParameterWrite:
    """One parameter that a change has set."""

    drive_object: int
    pnu: int


@dataclass(slots=True)
class Server:
    """Serves requests against drive objects; ``frozen`` answers every change with 11h (a save is running)."""

    behaviour: Behaviour
    objects: Mapping[int, DriveObject]
    frozen: bool = False
    written: list[ParameterWrite] = field(default_factory=list)

    def answer(self, index: int, data: bytes, injected: Mapping[int, ErrorBlock]) -> Response:
        """Execute a request; ``injected`` fails parameters by position, 0 is all of them."""
        identifier, count = data[1], data[3]
        if identifier not in set(RequestId):
            return self._reply(data, ResponseId.NOT_SUPPORTED, (ErrorBlock(0x21),))
        negative = ResponseId(identifier | 0x80)
        if WHOLE in injected:
            return self._reply(data, negative, (injected[WHOLE],))
        target = self._object(index, data[2])
        if target is None:
            return self._reply(data, negative, (self._error(0x19),))
        if count > 1 and not self.behaviour.multi_supported:
            return self._reply(data, negative, (self._error(0x23),))
        if count > self.behaviour.max_parameters:
            return self._reply(data, negative, (self._error(0x22),))
        blocks = self._blocks(target, data, injected)
        if any(isinstance(block, ErrorBlock) for block in blocks):
            return self._reply(data, negative, tuple(blocks))
        change = identifier == RequestId.CHANGE
        return self._reply(data, ResponseId(identifier), () if change else tuple(blocks))

    def _reply(self, data: bytes, identifier: ResponseId, blocks: tuple[Block, ...]) -> Response:
        return Response(data[0], identifier, data[2], data[3], blocks)

    def _error(self, number: int, info: int = 0) -> ErrorBlock:
        return ErrorBlock(number, info if self.behaviour.error_words == 2 else None)

    def _object(self, index: int, number: int) -> DriveObject | None:
        if index == LOCAL_INDEX and self.behaviour.local_object is not None:
            return self.objects.get(self.behaviour.local_object)
        return self.objects.get(self.behaviour.aliases.get(number, number))

    def _blocks(self, target: DriveObject, data: bytes, injected: Mapping[int, ErrorBlock]) -> list[Block]:
        change, count = data[1] == RequestId.CHANGE, data[3]
        addresses = [_address(data, position) for position in range(count)]
        values = _values(data, count) if change else _Values([None] * count, exact=_read_exact(data))
        blocks: list[Block] = []
        used = HEADER_SIZE
        for position, address in enumerate(addresses, 1):
            if position in injected:
                block: Block = injected[position]
            else:
                block = self._access(target, address, values, position, change=change)
            size, rest = block_size(block), (count - position) * (2 + 2 * self.behaviour.error_words)
            if used + size + rest > self.behaviour.record_limit:
                block = self._error(0x15)
                size = block_size(block)
            blocks.append(block)
            used += size
        return blocks

    def _access(
        self, target: DriveObject, address: ParameterAddress, values: _Values, position: int, *, change: bool
    ) -> Block:
        exact = values.exact or not self.behaviour.strict_length
        try:
            if change:
                self._change(target, address, values.blocks[position - 1], exact=exact)
                return ZeroBlock()
            return self._read(target, address, exact=exact)
        except _RefusedError as refused:
            return self._error(refused.number, refused.info)

    def _parameter(self, target: DriveObject, address: ParameterAddress) -> SimulatedParameter:
        illegal = (
            address.attribute not in self.behaviour.attributes
            or address.elements > self.behaviour.max_elements
            or address.pnu == 0
            or address.subindex == 0xFFFF
        )
        if illegal:
            raise _RefusedError(0x16)
        parameter = target.parameters.get(address.pnu)
        if parameter is None:
            raise _RefusedError(0x00)
        return parameter

    def _read(self, target: DriveObject, address: ParameterAddress, *, exact: bool) -> ValueBlock:
        parameter = self._parameter(target, address)
        if address.attribute == Attribute.DESCRIPTION:
            block = _read_description(parameter, address)
        elif address.attribute == Attribute.TEXT:
            block = _read_text(parameter, address)
        else:
            block = self._read_value(parameter, address, target.state)
        if not exact:
            raise _RefusedError(0x18)
        return block

    def _read_value(self, parameter: SimulatedParameter, address: ParameterAddress, state: str) -> ValueBlock:
        start, count = _range(parameter, address)
        refusal = parameter.refusal(state, change=False)
        if refusal is not None:
            raise _RefusedError(refusal)
        if parameter.format.is_string:
            octets = formats.pack_values(parameter.format, parameter.values)[start : start + count]
            return ValueBlock(parameter.format.code, count, octets)
        block = ValueBlock.of(parameter.format, parameter.values[start : start + count])
        if self.behaviour.answer_format != "size":
            return block
        generic = formats.generic_of(parameter.format.size)
        return block if generic is None else replace(block, format=generic.code)

    def _change(self, target: DriveObject, address: ParameterAddress, block: ValueBlock | None, *, exact: bool) -> None:
        parameter = self._parameter(target, address)
        if address.attribute == Attribute.DESCRIPTION:
            raise _RefusedError(0x07, address.subindex)
        if address.attribute == Attribute.TEXT:
            raise _RefusedError(0x20 if parameter.texts else 0x0F, address.subindex if parameter.texts else 0)
        start, _ = _range(parameter, address)
        if parameter.read_only:
            raise _RefusedError(0x01, start)
        refusal = 0x11 if self.frozen else parameter.refusal(target.state, change=True)
        if refusal is not None:
            raise _RefusedError(refusal)
        values = _wire_values(parameter, address, block, self.behaviour.takes, exact=exact)
        start = 0 if parameter.format.is_string else start
        if block is not None and parameter.format.kind is formats.FormatKind.BOOLEAN:
            _true_or_false(block.data[: len(values)], start)
        for position, value in enumerate(values):
            self._check(parameter, value, target.state, start + position)
        if parameter.keeps is not None:
            values = [parameter.keeps(index, value) for index, value in enumerate(values, start)]
        parameter.values[start : start + len(values)] = values
        self.written.append(ParameterWrite(target.number, parameter.pnu))

    def _check(self, parameter: SimulatedParameter, value: Value, state: str, subindex: int) -> None:
        """Raise the error of a value that the parameter does not take now."""
        if isinstance(value, int | float):
            if not math.isfinite(value) or parameter.limits.below(value) or parameter.limits.above(value):
                raise _RefusedError(0x02, subindex)
            narrow = parameter.state_limits.get(state)
            sinamics = self.behaviour.error_table == "sinamics"
            if narrow is not None and narrow.below(value):
                raise _RefusedError(0xC8 if sinamics else 0x02, 0 if sinamics else subindex)
            if narrow is not None and narrow.above(value):
                raise _RefusedError(0xC9 if sinamics else 0x02, 0 if sinamics else subindex)
        if parameter.allowed and value not in parameter.allowed:
            raise _RefusedError(0x14, subindex)
        if parameter.reset_only and value:
            raise _RefusedError(0x06, subindex)


def _true_or_false(data: bytes, start: int) -> None:
    """Other bytes than 00 and 01 are beyond the limits, as in Siemens' PROFIdrive application example."""
    for position, byte in enumerate(data, start):
        if byte > 1:
            raise _RefusedError(0x02, position)


def _address(data: bytes, position: int) -> ParameterAddress:
    at = HEADER_SIZE + ADDRESS_SIZE * position
    pnu = int.from_bytes(data[at + 2 : at + 4], "big")
    subindex = int.from_bytes(data[at + 4 : at + 6], "big")
    return ParameterAddress(pnu, subindex, data[at + 1], data[at])


def _read_exact(data: bytes) -> bool:
    return len(data) == HEADER_SIZE + ADDRESS_SIZE * data[3]


def _values(data: bytes, count: int) -> _Values:
    """Take the value blocks apart; behind an unknown format nothing can be located."""
    found, at, lost = _Values(), HEADER_SIZE + ADDRESS_SIZE * count, False
    for _ in range(count):
        if lost or len(data) - at < 2:
            found.blocks.append(None)
            found.exact = found.exact and lost
            continue
        code, number = data[at], data[at + 1]
        fmt = formats.find(code)
        if fmt is None or not fmt.writable:
            found.blocks.append(ValueBlock(code, number, b""))
            lost = True
            continue
        size = fmt.size * number
        chunk = data[at + 2 : at + 2 + size]
        at += 2 + formats.padded(size)
        found.blocks.append(ValueBlock(code, number, chunk) if len(chunk) == size else None)
    found.exact = found.exact and (lost or at == len(data))
    return found


def _range(parameter: SimulatedParameter, address: ParameterAddress) -> tuple[int, int]:
    """First element and number of elements of an access, octets of a string; elements 0 means the first one alone.

    An OctetString is read whole then, as by Siemens' PROFIdrive application example.
    """
    octets = parameter.format.is_string
    there = len(formats.pack_values(parameter.format, parameter.values)) if octets else len(parameter.values)
    whole = there if parameter.format.code == formats.OCTET_STRING else 1
    start, count = (address.subindex, address.elements) if address.elements else (0, whole)
    if not parameter.array and not octets and (start > 0 or count > 1):
        raise _RefusedError(0x04)
    if start + count > there:
        raise _RefusedError(0x03, max(start, there))
    return start, count


def _wire_values(
    parameter: SimulatedParameter, address: ParameterAddress, block: ValueBlock | None, takes: Takes, *, exact: bool
) -> list[Value]:
    """Return the values of a change in the parameter's own type."""
    if block is not None:
        fmt = formats.find(block.format)
        if fmt is None or not fmt.writable:
            raise _RefusedError(0x17)
    if block is None or not exact or not count_matches(address.elements, block.count):
        raise _RefusedError(0x18)
    if not formats.accepts(parameter.format, block.format, takes):
        raise _RefusedError(0x05)
    if not parameter.format.is_string:
        return block.values(parameter.format)
    octets = formats.pack_values(parameter.format, parameter.values)
    end = address.subindex + block.count
    changed = octets[: address.subindex] + block.data + octets[end:]
    return ValueBlock(block.format, len(octets), changed).values()


def _read_description(parameter: SimulatedParameter, address: ParameterAddress) -> ValueBlock:
    if not parameter.described:
        raise _RefusedError(0x09)
    subindex = address.subindex if address.elements else 0
    if subindex and address.elements > 1:
        raise _RefusedError(0x16)
    try:
        return parameter.description().block(subindex)
    except IndexError:
        raise _RefusedError(0x03, subindex) from None


def _read_text(parameter: SimulatedParameter, address: ParameterAddress) -> ValueBlock:
    """Return texts of 16 characters each, one behind the other."""
    if not parameter.texts:
        raise _RefusedError(0x0F)
    start, count = (address.subindex, address.elements) if address.elements else (0, 1)
    if start + count > len(parameter.texts):
        raise _RefusedError(0x03, max(start, len(parameter.texts)))
    chosen = parameter.texts[start : start + count]
    return ValueBlock.text("".join(text[:TEXT_SIZE].ljust(TEXT_SIZE) for text in chosen))
