"""A device that writes down what it is told and asked, and answers from a statement.

Layout of requests and answers: S120 Function Manual Communication 12/2018, section 3.4; what cannot be decoded is
kept as a complaint.
"""

from __future__ import annotations

import struct
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

from plcgen.oracles.profidrive import CHANGE, ERROR, NEGATIVE, READ, SUBSTITUTES, VALUE_ATTRIBUTE
from plcgen.oracles.spec.ds47.types import OCTETS, base, code_of, size_of

Key = tuple[int, int, int]
"""Drive object, parameter number, subindex."""

NO_ANSWER_YET, NO_RECORD = 0xDE80B500, 0xDF80B000
"""STATUS of RDREC while there is no answer; of WRREC to a record that the device has not."""
WORDS_OF_ERROR = 2


@dataclass(frozen=True, slots=True)
class HeardAccess:
    """One parameter of a request; of a change with ``code`` and the values as bytes without fill byte."""

    number: int
    index: int
    elements: int
    attribute: int = VALUE_ATTRIBUTE
    code: int = 0
    count: int = 0
    data: bytes = b""

    @property
    def indexes(self) -> range:
        """The values that are meant."""
        return range(self.index, self.index + max(1, self.elements))


@dataclass(slots=True)
class HeardTelegram:
    """A request: when it came and where, what it wants, and the answer to each access (None: none was made).

    ``answered`` are the values of a read as bytes, ``refused`` error numbers by the position of the access.
    """

    at: int
    identifier: int
    record: int
    data: bytes
    write: bool
    drive_object: int
    accesses: tuple[HeardAccess, ...]
    answered: tuple[bytes, ...] = ()
    refused: Mapping[int, int] = field(default_factory=dict)
    fetched: int | None = None
    """When the answer was taken away."""

    def values(self, position: int, size: int) -> list[bytes]:
        """The values of an access of a change, one by one."""
        data = self.accesses[position].data
        return [data[at : at + size] for at in range(0, len(data), size)]


class UndecodedError(ValueError):
    """No parameter request."""


def decode(data: bytes, at: int, identifier: int, record: int) -> HeardTelegram:
    """Take a request apart. Raises UndecodedError."""
    try:
        return _decoded(data, at, identifier, record)
    except struct.error as problem:
        raise UndecodedError(f"{data.hex(' ').upper()} ends too early") from problem


def _decoded(data: bytes, at: int, identifier: int, record: int) -> HeardTelegram:
    reference, service, drive_object, count = struct.unpack_from("BBBB", data)
    if not reference or service not in {READ, CHANGE} or not count:
        raise UndecodedError(f"{data.hex(' ').upper()} has no header of a parameter request")
    addresses = [struct.unpack_from(">BBHH", data, 4 + 6 * position) for position in range(count)]
    place, accesses = 4 + 6 * count, []
    for attribute, elements, number, index in addresses:
        if service == READ:
            accesses.append(HeardAccess(number, index, elements, attribute))
            continue
        code, amount = struct.unpack_from("BB", data, place)
        length = amount * _size_of_code(code)
        values = data[place + 2 : place + 2 + length]
        accesses.append(HeardAccess(number, index, elements, attribute, code, amount, values))
        place += 2 + length + length % 2
    if place != len(data):
        raise UndecodedError(f"{data.hex(' ').upper()} has {len(data)} bytes instead of {place}")
    return HeardTelegram(at, identifier, record, data, service == CHANGE, drive_object, tuple(accesses))


def _size_of_code(code: int) -> int:
    from plcgen.oracles.profidrive import TYPES

    for name in (*TYPES, *OCTETS):
        if code_of(name) == code:
            return size_of(name)
    for size, known in SUBSTITUTES.items():
        if known == code:
            return size
    raise UndecodedError(f"no document names a format {code:02X}h")


Hears = Callable[[HeardTelegram], Mapping[Key, bytes]]
"""Who follows the conversation: values that a read is answered with instead of those that the device holds."""


@dataclass
class RecordingDevice:
    """One parameter server: values by drive object, number and subindex; ``types`` by drive object and number.

    ``by_size`` answers with bytes, words and double words. ``refuses`` are error numbers by what is refused, in a
    change or a read; ``turns`` change a written value. ``silent`` never has an answer. ``write_status`` and
    ``read_status`` are asked for the STATUS of a call that fails, 0 if it does not.
    """

    types: dict[tuple[int, int], str]
    clock: Callable[[], int]
    by_size: bool = False
    values: dict[Key, bytes] = field(default_factory=dict)
    heard: list[HeardTelegram] = field(default_factory=list)
    complaints: list[str] = field(default_factory=list)
    hears: Hears | None = None
    refuses: dict[tuple[bool, int, int], int] = field(default_factory=dict)
    turns: dict[Key, Callable[[bytes], bytes]] = field(default_factory=dict)
    silent: bool = False
    write_status: Callable[[], int] | None = None
    read_status: Callable[[], int] | None = None
    calls: list[tuple[int, str]] = field(default_factory=list)
    """When WRREC and RDREC came, whatever became of them."""
    overlaps: int = 0
    """Requests that came before the answer to the one before was taken away."""
    _answer: bytes = b""

    def reset(self) -> None:
        """Nothing was heard, nothing is wrong; the values stay."""
        self.heard, self.complaints, self.calls = [], [], []
        self.hears, self.write_status, self.read_status = None, None, None
        self.refuses, self.turns, self.silent, self._answer, self.overlaps = {}, {}, False, b"", 0

    def write(self, identifier: int, record: int, data: bytes, objects: Mapping[int, int], local: bool) -> int:  # noqa: FBT001
        """WRREC; ``objects`` are the drive objects of identifiers, which a ``local`` record goes by."""
        self.calls.append((self.clock(), "WRREC"))
        status = self.write_status() if self.write_status is not None else 0
        if status:
            return status
        try:
            telegram = decode(data, self.clock(), identifier, record)
        except UndecodedError as problem:
            self.complaints.append(str(problem))
            return NO_RECORD
        self.overlaps += bool(self._answer)
        self.heard.append(telegram)
        instead = self.hears(telegram) if self.hears is not None else {}
        owner = objects.get(identifier, telegram.drive_object) if local else telegram.drive_object
        self._answer = self._answered(telegram, owner, instead)
        return 0

    def read(self, record: int) -> tuple[int, bytes]:
        """RDREC: the answer, once, and only from the record that was written."""
        self.calls.append((self.clock(), "RDREC"))
        status = self.read_status() if self.read_status is not None else 0
        if status:
            return status, b""
        if self.silent or not self._answer or record != self.heard[-1].record:
            return NO_ANSWER_YET, b""
        answer, self._answer = self._answer, b""
        self.heard[-1].fetched = self.clock()
        return 0, answer

    def _answered(self, telegram: HeardTelegram, owner: int, instead: Mapping[Key, bytes]) -> bytes:
        parts, refused, answered = [], {}, []
        for position, access in enumerate(telegram.accesses):
            error = self._refusal(telegram.write, owner, access)
            if error is not None:
                refused[position] = error
                parts.append(struct.pack(">BBHH", ERROR, WORDS_OF_ERROR, error, 0))
                answered.append(b"")
            elif telegram.write:
                self._store(owner, access)
                parts.append(b"\x40\x00")
                answered.append(b"")
            else:
                keys = [(owner, access.number, index) for index in access.indexes]
                data = b"".join(instead.get(key, self.values.get(key, b"")) for key in keys)
                parts.append(self._block(owner, access, data))
                answered.append(data)
        telegram.answered, telegram.refused = tuple(answered), refused
        service = telegram.data[1] | (NEGATIVE if refused else 0)
        head = bytes((telegram.data[0], service, telegram.drive_object, len(telegram.accesses)))
        return head if telegram.write and not refused else head + b"".join(parts)

    def _refusal(self, write: bool, owner: int, access: HeardAccess) -> int | None:  # noqa: FBT001
        asked = self.refuses.get((write, owner, access.number))
        if asked is not None:
            return asked
        if (owner, access.number) not in self.types:
            return 0
        missing = [i for i in access.indexes if (owner, access.number, i) not in self.values]
        return 3 if missing and not write else None

    def _store(self, owner: int, access: HeardAccess) -> None:
        size = size_of(self.types[owner, access.number])
        for at, index in enumerate(access.indexes):
            key = (owner, access.number, index)
            data = access.data[at * size : at * size + size]
            self.values[key] = self.turns[key](data) if key in self.turns else data

    def _block(self, owner: int, access: HeardAccess, data: bytes) -> bytes:
        type_ = self.types[owner, access.number]
        by_size = self.by_size and not base(type_).endswith("String")  # several octets are no type of one byte
        code = SUBSTITUTES.get(size_of(type_), code_of(type_)) if by_size else code_of(type_)
        return bytes((code, len(access.indexes))) + data + bytes(len(data) % 2)
