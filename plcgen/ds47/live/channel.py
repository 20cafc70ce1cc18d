"""The parameter channel of a drive over records: several parameters in a request, one request at a time.

A read is a request that is written as a record, and an answer that is read as one. The record is written until the
drive is no longer busy, and read until the answer is there; what to do after a refusal is what the status says. A
request to read may begin again, a change never: whoever does not know whether it was carried out has to read.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from typing import TypeVar

from plcgen.base.diagnostics import Diagnostic, DiagnosticError, Span
from plcgen.ds47.device import Device, Parameter
from plcgen.ds47.live.parameters import ElementReading, Wanted, element_value
from plcgen.ds47.live.profinet import PnConnection, RecordRefusedError
from plcgen.ds47.types import read_type
from plcgen.ds47.wire import formats
from plcgen.ds47.wire.codec import TelegramError, decode_response, encode_request
from plcgen.ds47.wire.errors import Table, error_text
from plcgen.ds47.wire.model import (
    ADDRESS_SIZE,
    HEADER_SIZE,
    MAX_ELEMENTS,
    MAX_PARAMETERS,
    RECORD_LIMIT,
    Block,
    ErrorBlock,
    ParameterAddress,
    Request,
    RequestId,
    ValueBlock,
    change_request,
    read_request,
    request_size,
)
from plcgen.ds47.wire.status import Retry, explain_status

T = TypeVar("T")

GLOBAL_INDEX = 0xB02F
_PAUSE = 0.2
"""Seconds between two tries, as Siemens' blocks wait."""
_BUSY = 40
"""Tries of a record, so 8 s: the same."""
_AGAIN = 3
"""So often a request to read begins again."""
_ERROR = 6
"""Octets of an error in an answer, with two words."""
_NO_OBJECT, _LENGTH = 0x19, 0xB1
"""Error of a request for a drive object that is not there; ErrorCode1 of a record that is too long for the drive."""
_UNKNOWN = 4
"""Octets that a value of unknown type is expected to have."""
_READ = 0xDE
"""ErrorCode of a read in a PNIO status."""
_PLACE = dict.fromkeys(
    (0xB0, 0xB2, 0xB4), "the drive object may be in another slot (pn://IP/2.1), record (--record) or API (--api)"
)
"""What helps if there is no such record (B0h), no such slot (B2h) or no such area (B4h)."""
_UNSURE = "the drive may have taken the values, or some of them: read them"


def record_index(device: Device | None) -> int:
    """The record of the channel on PROFINET: the device's usual one, or B02Fh, where the request names the object."""
    if device is None:
        return GLOBAL_INDEX
    names = (device.default_index, "profinet-global", "profinet-local")
    known = (device.record_index[one] for one in names if one.startswith("profinet") and one in device.record_index)
    return next(known, GLOBAL_INDEX)


class PnParameters:
    """Parameters over a connection; ``device`` says how many of them, and how many elements, a request may have."""

    def __init__(self, connection: PnConnection, device: Device | None = None) -> None:
        self._connection, self._device = connection, device
        self._reference = 0
        self.most = min(device.max_parameters if device else MAX_PARAMETERS, MAX_PARAMETERS)
        self.elements = min(device.max_elements if device else MAX_ELEMENTS, MAX_ELEMENTS)
        self.limit = device.record_limit if device else RECORD_LIMIT
        self._table: Table = device.error_table if device else "sinamics"

    def read(self, wanted: Sequence[Wanted], drive_object: int) -> Iterator[ElementReading]:
        """As many elements in a request as request and answer have room for."""
        pieces = [piece for parameter, indexes in wanted for piece in self._pieces(parameter, indexes)]
        addresses = [address for _, address in pieces]
        blocks = self.ask(addresses, [_size(parameter) for parameter, _ in pieces], drive_object)
        for (parameter, address), block in zip(pieces, blocks, strict=True):
            single = isinstance(block, ValueBlock) or address.elements < 2 or _octets(parameter)
            if not single:  # which of them it was is not said: each one for itself
                each = [replace(address, subindex=address.subindex + at, elements=1) for at in range(address.elements)]
                answers = self.ask(each, [_size(parameter)] * len(each), drive_object)
                for one, answer in zip(each, answers, strict=True):
                    yield from self._readings(parameter, one, answer)
            else:
                yield from self._readings(parameter, address, block)

    def _pieces(self, parameter: Parameter, indexes: Sequence[int]) -> Iterator[tuple[Parameter, ParameterAddress]]:
        """Rows of indexes as addresses."""
        octets = _octets(parameter)
        if octets:
            yield from ((parameter, ParameterAddress(parameter.pnu, index, octets)) for index in indexes)
            return
        room = (self.limit - HEADER_SIZE - 2) // _size(parameter)
        at = 0
        while at < len(indexes):
            end = at + 1
            while end < len(indexes) and indexes[end] == indexes[end - 1] + 1 and end - at < min(room, self.elements):
                end += 1
            alone = end - at == len(indexes) == 1 and indexes[0] == 0
            elements = self._device.scalar_elements[0] if alone and self._device else end - at
            yield parameter, ParameterAddress(parameter.pnu, indexes[at], elements)
            at = end

    def _readings(self, parameter: Parameter, address: ParameterAddress, block: Block) -> Iterator[ElementReading]:
        indexes = [address.subindex + at for at in range(1 if _octets(parameter) else max(address.elements, 1))]
        if isinstance(block, ErrorBlock):
            doubt = f"refused: error {error_text(block.number, self._table).explain(block.info)}"
            yield from (ElementReading(parameter, index, b"", None, doubt) for index in indexes)
        elif isinstance(block, ValueBlock):
            yield from read_block(parameter, indexes, block)

    def ask(self, addresses: Sequence[ParameterAddress], sizes: Sequence[int], drive_object: int) -> list[Block]:
        """A block for each address, in as many requests as it takes; ``sizes`` are the octets of one value."""
        found: list[Block] = []
        at = 0
        while at < len(addresses):
            end, asked, answered = at, HEADER_SIZE, HEADER_SIZE
            while end < len(addresses) and end - at < self.most:
                values = formats.padded(sizes[end] * max(addresses[end].elements, 1))
                asked += ADDRESS_SIZE
                answered += max(2 + values, _ERROR)
                if end > at and max(asked, answered) > self.limit:
                    break
                end += 1
            found += self._ask(list(addresses[at:end]), drive_object)
            at = end
        return found

    def _ask(self, addresses: Sequence[ParameterAddress], drive_object: int) -> list[Block]:
        """One request; one that fails as a whole is asked in halves, unless there is no such drive object."""
        try:
            blocks = self._exchange(read_request(self._next(), drive_object, addresses))
        except RecordRefusedError as refused:
            if refused.status >> 8 & 0xFF != _LENGTH or len(addresses) < 2:
                raise self._refused(refused) from refused
            blocks = ()
        if len(blocks) == len(addresses):
            return list(blocks)
        first = blocks[0] if blocks else None
        if isinstance(first, ErrorBlock) and first.number == _NO_OBJECT:
            return [first] * len(addresses)
        half = len(addresses) // 2
        return [*self._ask(addresses[:half], drive_object), *self._ask(addresses[half:], drive_object)]

    def change(self, changes: Sequence[tuple[ParameterAddress, ValueBlock]], drive_object: int) -> list[Block]:
        """Write values in one request: an error for each that was refused, and zeros for the others; empty if all were
        taken. Raises DiagnosticError, PG709, if one request has no room for all of them.
        """
        request = change_request(self._next(), drive_object, changes)
        size = request_size(request)
        if size > self.limit or len(changes) > self.most:
            message = (
                f"{len(changes)} values make a request of {size} bytes; at most {self.most} in {self.limit} bytes go"
            )
            raise self._problem("PG709", message, "write them in two calls: nothing was written")
        try:
            return list(self._exchange(request))
        except RecordRefusedError as refused:
            raise self._refused(refused, _UNSURE if refused.status >> 24 == _READ else "") from refused
        except DiagnosticError as problem:
            found = problem.diagnostics
            lost = [replace(one, help=f"{_UNSURE}; {one.help}" if one.help else _UNSURE) for one in found]
            raise DiagnosticError(lost) from problem

    def _next(self) -> int:
        self._reference = self._reference % 255 + 1
        return self._reference

    def _exchange(self, request: Request) -> tuple[Block, ...]:
        """Write a request and read its answer. Raises RecordRefusedError; DiagnosticError, PG708, if it is none."""
        data = encode_request(request)
        rounds = 1 if request.request_id == RequestId.CHANGE else _AGAIN
        for left in reversed(range(rounds)):
            try:
                self._retried(lambda: self._connection.write(data))
                return self._decoded(self._retried(lambda: self._connection.read(self.limit)), request)
            except RecordRefusedError as refused:
                if not left or explain_status(refused.status).retry is not Retry.RESTART:
                    raise
        raise AssertionError("the last round ends in an answer or an error")

    def _refused(self, refused: RecordRefusedError, told: str = "") -> DiagnosticError:
        help_ = told or _PLACE.get(refused.status >> 8 & 0xFF, "")
        return self._problem("PG708", f"the drive refused the record: {refused}", help_)

    def _retried(self, call: Callable[[], T]) -> T:
        """The same call again while the drive is busy, with a pause."""
        for number in range(_BUSY):
            try:
                return call()
            except RecordRefusedError as refused:
                if explain_status(refused.status).retry is not Retry.TEMPORARY or number == _BUSY - 1:
                    raise
                self._connection.link.pause(_PAUSE)
        raise AssertionError("the last try returns or raises")

    def _decoded(self, answer: bytes, request: Request) -> tuple[Block, ...]:
        try:
            response = decode_response(answer, request=request)
        except TelegramError as problem:
            shown = answer.hex(" ").upper()
            raise self._problem(
                "PG708", f"the answer does not fit the request: {problem}", f"it was {shown}"
            ) from problem
        return response.blocks

    def _problem(self, code: str, message: str, help_: str = "") -> DiagnosticError:
        return DiagnosticError([Diagnostic(code, message, Span(str(self._connection.place)), help=help_)])


def read_block(parameter: Parameter, indexes: Sequence[int], block: ValueBlock) -> Iterator[ElementReading]:
    """Elements out of the values of an answer, which says its type; without a declared one that is theirs."""
    wire = formats.find(block.format)
    if wire is None or not wire.writable:
        doubt = f"the answer has the format {block.format:02X}h, which is unknown"
        yield from (ElementReading(parameter, index, block.data, None, doubt) for index in indexes)
        return
    if not parameter.type:
        named = GENERIC.get(wire.code, wire.name)
        parameter = replace(parameter, type=f"{named}[{block.count}]" if wire.is_string else named)
    declared, octets = read_type(parameter.type)
    if wire.code == declared.code:
        parameter = replace(parameter, grades={**parameter.grades, "type": "read"})
    for at, index in enumerate(indexes):
        data = block.data if octets else block.data[at * wire.size : (at + 1) * wire.size]
        if block.format not in formats.answers(declared):
            doubt = f"the drive answers {wire.name}, not {parameter.type}"
            yield ElementReading(parameter, index, data, None, doubt)
        else:
            yield element_value(parameter, index, data, typed=True)


GENERIC = {0x41: "Unsigned8", 0x42: "Unsigned16", 0x43: "Unsigned32"}
"""What is made of a value whose drive says its size alone."""


def _octets(parameter: Parameter) -> int:
    """Octets of a string; 0 for everything else, and for what nobody has given a type."""
    return read_type(parameter.type)[1] if parameter.type else 0


def _size(parameter: Parameter) -> int:
    """Octets of one counted value."""
    return read_type(parameter.type)[0].size if parameter.type else _UNKNOWN
