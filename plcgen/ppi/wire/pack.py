"""Plans: many items in few telegrams, and the way back from the answers to what was asked.

Overlapping and neighbouring items are read as one, gaps included where that saves telegrams or bytes on the line. The
value of one asked item always comes in one telegram, so its bytes belong together; only what is longer than a telegram
is cut, between elements. Writes never touch a byte that was not asked for, and nothing is written twice.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from typing import NamedTuple

from plcgen.ppi.wire.address import address_text
from plcgen.ppi.wire.areas import (
    ITEM_LIMIT,
    ITEM_SIZE,
    JOB_HEADER,
    OCTETS,
    PDU_LIMIT,
    REPLY_HEADER,
    VALUE_HEADER,
    Area,
    ReturnCode,
    TransportSize,
)
from plcgen.ppi.wire.errors import Kind, PpiError, Violation
from plcgen.ppi.wire.items import ItemFindings, check_item
from plcgen.ppi.wire.model import Item, ItemResult, ItemWrite, ReadReply, ReadRequest, WriteReply, WriteRequest

_BARE = 4
"""Bytes of a high-speed counter without a status byte: no capture says whether there is one, so both are good."""
_OPEN = 20
"""Telegrams that are looked at for room: more hardly find any, and many items would take long."""


@dataclass(frozen=True, slots=True)
class PackingRules:
    """What a telegram may hold: bytes of its header, of an item besides the value, both limits.

    ``gaps`` are the widest gaps that are bridged, tried in this order: what needs the fewest telegrams is taken.
    """

    header: int
    item: int
    gaps: tuple[int, ...] = (0,)
    limit: int = PDU_LIMIT
    most: int = ITEM_LIMIT

    @property
    def room(self) -> int:
        """Longest value of a telegram with one item."""
        return self.limit - self.header - self.item


READING = PackingRules(REPLY_HEADER + 2, VALUE_HEADER, gaps=(ITEM_SIZE + VALUE_HEADER - 1, VALUE_HEADER, 0, 32, 64))
"""The answer is the longer telegram: 12 + 2, then 4 and the value for each item. A gap of fewer than 16 bytes costs
less on the line than another item in request and answer, one of more than 4 makes the answer longer."""

WRITING = PackingRules(JOB_HEADER + 2, ITEM_SIZE + VALUE_HEADER)
"""The request is the longer telegram: 10 + 2, then 12 + 4 and the value for each item."""


@dataclass(frozen=True, slots=True)
class PackedPart:
    """Where bytes of an asked item lie: ``length`` bytes at ``at`` of the value are bytes ``start`` on of ``asked``.

    ``bit`` is the bit of the byte if the asked item is a bit that is read with its byte.
    """

    asked: int
    start: int
    at: int
    length: int
    bit: int | None = None


@dataclass(frozen=True, slots=True)
class PlannedItem:
    """One item of a telegram, the asked items it serves, and what is written."""

    item: Item
    parts: tuple[PackedPart, ...]
    data: bytes = b""

    @property
    def first(self) -> int:
        """The first asked item it serves."""
        return min(part.asked for part in self.parts)


Telegrams = tuple[tuple[PlannedItem, ...], ...]


@dataclass(frozen=True, slots=True)
class ReadPlan:
    """What was asked, and the telegrams that bring it."""

    asked: tuple[Item, ...]
    telegrams: Telegrams

    def requests(self, reference: int = 0) -> tuple[ReadRequest, ...]:
        """Return the requests, with references from ``reference`` on."""
        return tuple(
            ReadRequest((reference + number) & 0xFFFF, tuple(planned.item for planned in telegram))
            for number, telegram in enumerate(self.telegrams)
        )

    def shared(self, asked: int) -> bool:
        """Whether an asked item is read in one item with others, so that its return code may not be its own."""
        serving = ({part.asked for part in planned.parts} for telegram in self.telegrams for planned in telegram)
        return any(asked in served and len(served) > 1 for served in serving)

    def collect(self, replies: Sequence[ReadReply]) -> tuple[ItemResult, ...]:
        """Return one result per asked item from one reply per telegram.

        An asked item of which a part failed has the return code of that part. Raises PpiError if a reply has another
        number of results or a value another length than asked.
        """
        asked = self.asked
        results: list[ItemResult | None] = [None] * len(asked)
        for telegram, reply in zip(self.telegrams, replies, strict=True):
            wrong = _unlike([planned.item for planned in telegram], reply)
            if wrong:
                raise PpiError(Violation(Kind.MISMATCH, 0, text) for text in wrong)
            for planned, result in zip(telegram, reply.results, strict=True):
                for part in planned.parts:
                    before, item = results[part.asked], asked[part.asked]
                    if planned.item is item or not result.ok:
                        results[part.asked] = before if before is not None and not before.ok else result
                    elif before is None or before.ok:
                        value = b"" if before is None else before.data
                        results[part.asked] = ItemResult.of(item, _placed(value, item, part, result.data))
        return tuple(result for result in results if result is not None)


@dataclass(frozen=True, slots=True)
class WritePlan:
    """What is to be written, and the telegrams that do it."""

    asked: tuple[ItemWrite, ...]
    telegrams: Telegrams

    def requests(self, reference: int = 0) -> tuple[WriteRequest, ...]:
        """Return the requests, with references from ``reference`` on."""
        return tuple(
            WriteRequest.padded(
                (reference + number) & 0xFFFF, tuple(ItemWrite(planned.item, planned.data) for planned in telegram)
            )
            for number, telegram in enumerate(self.telegrams)
        )

    def collect(self, replies: Sequence[WriteReply]) -> tuple[int, ...]:
        """Return one return code per asked item from one reply per telegram. Raises PpiError as ReadPlan does."""
        codes = [int(ReturnCode.OK)] * len(self.asked)
        for telegram, request, reply in zip(self.telegrams, self.requests(), replies, strict=True):
            found = mismatches(WriteRequest(reply.reference, request.items), reply)
            if found:
                raise PpiError(found)
            for planned, code in zip(telegram, reply.codes, strict=True):
                for part in planned.parts:
                    if codes[part.asked] == ReturnCode.OK:
                        codes[part.asked] = code
        return tuple(codes)


def mismatches(request: ReadRequest | WriteRequest, reply: ReadReply | WriteReply) -> list[Violation]:
    """Return what shows that a reply is not the answer to this request: reference, kind, number and length of values.

    Offsets are 0: the reply is a value, no longer bytes.
    """
    wrong: list[str] = []
    if request.reference != reply.reference:
        wrong.append(f"the reference is {reply.reference:04X}h, the request has {request.reference:04X}h")
    if isinstance(request, ReadRequest) != isinstance(reply, ReadReply):
        wrong.append("a read is answered as a write" if isinstance(request, ReadRequest) else "a write as a read")
    elif isinstance(request, ReadRequest) and isinstance(reply, ReadReply):
        wrong += _unlike(request.items, reply)
    elif isinstance(reply, WriteReply) and len(reply.codes) != len(request.items):
        wrong.append(f"{len(reply.codes)} items are answered, {len(request.items)} were asked for")
    return [Violation(Kind.MISMATCH, 0, text) for text in wrong]


def _unlike(items: Sequence[Item], reply: ReadReply) -> list[str]:
    """Return what shows that results are not those of these items: their number and the lengths of the values."""
    if len(items) != len(reply.results):
        return [f"{len(reply.results)} items are answered, {len(items)} were asked for"]
    return [
        f"{address_text(item)} has {len(result.data)} bytes instead of {item.octets}"
        for item, result in zip(items, reply.results, strict=True)
        if result.ok
        and len(result.data) != item.octets
        and not (item.area == Area.HC and len(result.data) == _BARE * item.count)
    ]


def _placed(value: bytes, item: Item, part: PackedPart, data: bytes) -> bytes:
    chunk = data[part.at : part.at + part.length]
    if part.bit is not None:
        return bytes((chunk[0] >> part.bit & 1,))
    value = value or bytes(item.octets)
    return value[: part.start] + chunk + value[part.start + part.length :]


# ---- Packing --------------------------------------------------------------------------------------------------


def pack_read(items: Sequence[Item], *, merge: bool = True, rules: PackingRules = READING) -> ReadPlan:
    """Plan few telegrams that read ``items``; PpiError if one of them is no valid item.

    ``merge`` False keeps every item as it was asked for, so that each one gets a return code of its own.
    """
    asked = tuple(items)
    _require_valid(asked)
    return ReadPlan(asked, _telegrams(asked, rules, merge=merge))


def pack_write(items: Sequence[ItemWrite], *, merge: bool = True, rules: PackingRules = WRITING) -> WritePlan:
    """Plan few telegrams that write ``items``, touching blocks as one.

    PpiError if an item is not valid, a value has the wrong length, or a byte would be written twice.
    """
    asked = tuple(items)
    places = tuple(entry.item for entry in asked)
    _require_valid(places)
    for number, entry in enumerate(asked, 1):
        if len(entry.data) != entry.item.octets:
            text = f"item {number}: {len(entry.data)} bytes for a value of {entry.item.octets}"
            raise PpiError.of(Kind.VALUE_LENGTH, text)
    require_apart(places)

    def filled(planned: PlannedItem) -> PlannedItem:
        value = bytearray(planned.item.octets)
        for part in planned.parts:
            value[part.at : part.at + part.length] = asked[part.asked].data[part.start : part.start + part.length]
        return PlannedItem(planned.item, planned.parts, bytes(value))

    telegrams = _telegrams(places, rules, merge=merge, bits=False)
    return WritePlan(asked, tuple(tuple(filled(planned) for planned in telegram) for telegram in telegrams))


def _require_valid(items: Sequence[Item]) -> None:
    findings = ItemFindings()
    for number, item in enumerate(items, 1):
        check_item(findings, item, 0, f"item {number}")
    if findings.found:
        raise PpiError(findings.found)


def require_apart(items: Sequence[Item]) -> None:
    """Refuse items that overlap: which value would stay is not defined. Raises PpiError with every pair."""
    placed = []
    for number, item in enumerate(items):
        size = item.count if item.by_element else 1 if item.size == TransportSize.BIT else 8 * item.octets
        placed.append(((item.area, item.address, item.address + size), number))
    found = [
        Violation(
            Kind.ADDRESS, 0, f"{address_text(items[first])} and {address_text(items[second])} overlap: written twice"
        )
        for ((area, _, end), first), ((other, start, _), second) in pairwise(sorted(placed))
        if area == other and start < end
    ]
    if found:
        raise PpiError(found)


class _Piece(NamedTuple):
    """Bytes ``first`` to ``end`` of an area: those of asked item ``number`` from its byte ``start`` on.

    What is ``alone`` is never joined with others, but with equal ones of its ``group``: timers, counters, and bits that
    are written, each of them a group of its own.
    """

    alone: bool
    group: int
    area: int
    first: int
    end: int
    number: int
    start: int


@dataclass(slots=True)
class _Load:
    """One telegram that is being filled: its items and its length."""

    length: int
    items: list[PlannedItem] = field(default_factory=list)


def _telegrams(asked: Sequence[Item], rules: PackingRules, *, merge: bool, bits: bool = True) -> Telegrams:
    """The telegrams of the first way of joining and filling that needs the fewest."""
    pieces = sorted(_pieces(asked, rules.room, merge=merge, bits=bits))
    best: list[_Load] = []
    for gap in rules.gaps if merge else (0,):
        items = [_planned(joined, asked) for joined in _joined(pieces, gap, rules.room)]
        for order in (sorted(items, key=lambda each: each.first), sorted(items, key=lambda each: -each.item.octets)):
            loads = _filled(order, rules)
            if not best or len(loads) < len(best):
                best = loads
    telegrams = [tuple(sorted(load.items, key=lambda each: each.first)) for load in best]
    return tuple(sorted(telegrams, key=lambda telegram: telegram[0].first))


def _pieces(asked: Sequence[Item], room: int, *, merge: bool, bits: bool) -> Iterator[_Piece]:
    """Every asked item, those that are longer than a telegram in parts, cut between elements."""
    for number, item in enumerate(asked):
        own = not merge or (item.size == TransportSize.BIT and not bits)
        alone, group = own or item.by_element, number if own else 0
        begin = item.address if item.by_element else item.byte
        most = room - room % OCTETS[item.size]
        for start in range(0, item.octets, most):
            end = min(start + most, item.octets)
            yield _Piece(alone, group, item.area, begin + start, begin + end, number, start)


def _joined(pieces: Sequence[_Piece], gap: int, room: int) -> Iterator[list[_Piece]]:
    """What is read as one: equal pieces, and those that overlap or lie at most ``gap`` bytes apart, in their order."""
    joined: list[_Piece] = []
    end = 0
    for piece in pieces:
        if joined and piece[:3] == joined[0][:3]:
            first, last = joined[0].first, max(end, piece.end)
            near = piece.first <= end + gap and last - first <= room
            if piece[:5] == joined[0][:5] or (near and not piece.alone):
                joined.append(piece)
                end = last
                continue
        if joined:
            yield joined
        joined, end = [piece], piece.end
    if joined:
        yield joined


def _planned(pieces: Sequence[_Piece], asked: Sequence[Item]) -> PlannedItem:
    """One item: as it was asked for if it serves one only, a part of that, otherwise bytes (words for AI, AQ)."""
    first, length = pieces[0].first, max(piece.end for piece in pieces) - pieces[0].first
    item, start = asked[pieces[0].number], pieces[0].start
    same = all(asked[piece.number] == item and piece.start == start for piece in pieces)
    if same and length < item.octets:
        unit = OCTETS[item.size]
        step = start // unit if item.by_element else 8 * start
        item = Item(item.area, item.size, length // unit, item.address + step, item.db)
    elif not same and item.area in {Area.AI, Area.AQ}:
        item = Item.memory(Area(item.area), first, length // 2, TransportSize.WORD)
    elif not same:
        item = Item.memory(Area(item.area), first, length)
    return PlannedItem(item, tuple(_part(piece, first, asked[piece.number], alone=same) for piece in pieces))


def _part(piece: _Piece, first: int, item: Item, *, alone: bool) -> PackedPart:
    bit = item.bit_number if item.size == TransportSize.BIT and not alone else None
    return PackedPart(piece.number, piece.start, piece.first - first, piece.end - piece.first, bit)


def _filled(items: Sequence[PlannedItem], rules: PackingRules) -> list[_Load]:
    """Items into telegrams, each into the first of the last ones with room; every value is padded to even length."""
    loads: list[_Load] = []
    for planned in items:
        size = rules.item + planned.item.octets + planned.item.octets % 2
        for load in loads[-_OPEN:]:
            if load.length + size <= rules.limit and len(load.items) < rules.most:
                break
        else:
            load = _Load(rules.header)
            loads.append(load)
        load.items.append(planned)
        load.length += size
    return loads
