"""Plans: many items in the fewest telegrams, and the way back from the answers to what was asked.

Overlapping and neighbouring items are read as one, small gaps included where that is shorter. The value of one asked
item always comes in one telegram, so its bytes belong together; only what is longer than a telegram is cut, between
elements. Writes never touch a byte that was not asked for, and nothing is written twice.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

from plcgen.ppi.wire.address import address_text
from plcgen.ppi.wire.areas import OCTETS, Area, ReturnCode, TransportSize
from plcgen.ppi.wire.errors import Kind, PpiError, Violation
from plcgen.ppi.wire.items import ItemFindings, check_item
from plcgen.ppi.wire.load import READING, WRITING, Load, MemoryPiece, PackingRules, Span, distribute
from plcgen.ppi.wire.model import Item, ItemResult, ItemWrite, ReadReply, ReadRequest, WriteReply, WriteRequest


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
    """One item of a telegram and the asked items it serves."""

    item: Item
    parts: tuple[PackedPart, ...]


@dataclass(frozen=True, slots=True)
class ReadPlan:
    """What was asked, and the telegrams that bring it."""

    asked: tuple[Item, ...]
    telegrams: tuple[tuple[PlannedItem, ...], ...]

    @property
    def items(self) -> tuple[tuple[Item, ...], ...]:
        """Items of each telegram."""
        return tuple(tuple(planned.item for planned in telegram) for telegram in self.telegrams)

    def requests(self, reference: int = 0) -> tuple[ReadRequest, ...]:
        """Return the requests, with references from ``reference`` on."""
        return tuple(ReadRequest((reference + number) & 0xFFFF, items) for number, items in enumerate(self.items))

    def shared(self, asked: int) -> bool:
        """Whether an asked item is read in one item with others, so that its return code may not be its own."""
        return any(
            len({part.asked for part in planned.parts}) > 1
            for telegram in self.telegrams
            for planned in telegram
            if any(part.asked == asked for part in planned.parts)
        )

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
    """What is to be written, and the telegrams that do it, each with the asked items of its items."""

    asked: tuple[ItemWrite, ...]
    telegrams: tuple[tuple[ItemWrite, ...], ...]
    serves: tuple[tuple[tuple[int, ...], ...], ...]

    def requests(self, reference: int = 0) -> tuple[WriteRequest, ...]:
        """Return the requests, with references from ``reference`` on."""
        return tuple(
            WriteRequest.padded((reference + number) & 0xFFFF, telegram)
            for number, telegram in enumerate(self.telegrams)
        )

    def collect(self, replies: Sequence[WriteReply]) -> tuple[int, ...]:
        """Return one return code per asked item from one reply per telegram. Raises PpiError as ReadPlan does."""
        codes = [int(ReturnCode.OK)] * len(self.asked)
        for telegram, served, reply in zip(self.telegrams, self.serves, replies, strict=True):
            found = mismatches(WriteRequest(reply.reference, telegram), reply)
            if found:
                raise PpiError(found)
            for numbers, code in zip(served, reply.codes, strict=True):
                for number in numbers:
                    if codes[number] == ReturnCode.OK:
                        codes[number] = code
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
        return [Violation(Kind.MISMATCH, 0, text) for text in wrong]
    if isinstance(request, ReadRequest) and isinstance(reply, ReadReply):
        wrong += _unlike(request.items, reply)
    elif isinstance(reply, WriteReply) and len(reply.codes) != len(request.items):
        wrong.append(f"{len(reply.codes)} items are answered, {len(request.items)} were asked for")
    return [Violation(Kind.MISMATCH, 0, text) for text in wrong]


_BARE = 4
"""Bytes of a high-speed counter without a status byte: no capture says whether there is one, so both are good."""


def _unlike(items: Sequence[Item], reply: ReadReply) -> list[str]:
    """Return what shows that results are not those of these items: their number and the lengths of the values."""
    if len(items) != len(reply.results):
        return [f"{len(reply.results)} items are answered, {len(items)} were asked for"]
    return [
        f"{address_text(item)} has {len(result.data)} bytes instead of {item.octets}"
        for item, result in zip(items, reply.results, strict=True)
        if result.ok and not _fits(item, len(result.data))
    ]


def _fits(item: Item, length: int) -> bool:
    return length == item.octets or (item.area == Area.HC and length == _BARE * item.count)


def _placed(value: bytes, item: Item, part: PackedPart, data: bytes) -> bytes:
    """Return the value of an asked item with one more part of it in place."""
    chunk = data[part.at : part.at + part.length]
    if part.bit is not None:
        return bytes((chunk[0] >> part.bit & 1,))
    if part.length == item.octets:
        return chunk
    value = value or bytes(item.octets)
    return value[: part.start] + chunk + value[part.start + part.length :]


# ---- Reading --------------------------------------------------------------------------------------------------


def pack_read(items: Sequence[Item], *, merge: bool = True, rules: PackingRules = READING) -> ReadPlan:
    """Plan the fewest telegrams that read ``items``; PpiError if one of them is no valid item.

    ``merge`` False keeps every item as it was asked for, so that each one gets a return code of its own.
    """
    asked = tuple(items)
    _require_valid(asked)
    if not merge:
        pieces, large = [_own_piece(number, item) for number, item in enumerate(asked)], []
        large = [piece for piece in pieces if piece.size > rules.room]
        pieces = [piece for piece in pieces if piece.size <= rules.room]
    else:
        pieces, large = _read_pieces(asked, rules)
    loads = _pour(distribute(pieces, rules), large, asked, rules)
    telegrams = [_planned(load.settled() if merge else load, asked) for load in loads]
    telegrams.sort(key=lambda telegram: min(part.asked for planned in telegram for part in planned.parts))
    return ReadPlan(asked, tuple(telegrams))


def _require_valid(items: Sequence[Item]) -> None:
    findings = ItemFindings()
    for number, item in enumerate(items, 1):
        check_item(findings, item, 0, f"item {number}")
    if findings.found:
        raise PpiError(findings.found)


def _span(item: Item) -> Span:
    if item.by_element:
        return item.address, item.address + item.octets
    return item.byte, item.byte + item.octets


def _own_piece(number: int, item: Item) -> MemoryPiece:
    return MemoryPiece(item.area, _span(item), ((number, 0),), joins=False)


def _read_pieces(asked: Sequence[Item], rules: PackingRules) -> tuple[list[MemoryPiece], list[MemoryPiece]]:
    """Make pieces: equal and contained items share one, long ones are kept apart, elements stay alone."""
    shared: dict[tuple[int, int, int, bool], list[int]] = {}
    large: list[MemoryPiece] = []
    for number, item in enumerate(asked):
        joins = not item.by_element
        if item.octets > rules.room:
            large.append(MemoryPiece(item.area, _span(item), ((number, 0),), joins))
            continue
        span = _span(item)
        first, size = (item.address, item.octets) if item.by_element else (span[0], span[1] - span[0])
        shared.setdefault((item.area, first, -size, joins), []).append(number)
    pieces: list[MemoryPiece] = []
    for (area, start, negative, joins), numbers in sorted(shared.items()):
        serves = tuple((number, 0) for number in numbers)
        span = (start, start - negative)
        outer = pieces[-1] if pieces and joins else None
        if outer is not None and outer.area == area and outer.span[1] >= span[1] and outer.joins:
            pieces[-1] = MemoryPiece(area, outer.span, outer.serves + serves)
        else:
            pieces.append(MemoryPiece(area, span, serves, joins))
    return pieces, large


def _pour(loads: list[Load], large: Sequence[MemoryPiece], asked: Sequence[Item], rules: PackingRules) -> list[Load]:
    """Fill what is longer than a telegram into the room left, cut between elements, then into further telegrams."""
    loads = list(loads)
    for piece in large:
        number = piece.serves[0][0]
        unit = OCTETS[asked[number].size]
        start, end = piece.span
        done = start
        index = 0
        while done < end:
            load = loads[index] if index < len(loads) else Load(rules)
            more, size = _portion(load, piece, done, unit)
            if more is not None:
                done += size
                loads[index : index + 1] = [more]
            index += 1
    return loads


def _portion(load: Load, piece: MemoryPiece, done: int, unit: int) -> tuple[Load | None, int]:
    """Return the load with as much of the piece as fits from byte ``done`` on, and how much that is."""
    start, end = piece.span
    free = load.rules.limit - load.length() + 1
    size = min(end - done, load.rules.room, max(free, 0))
    size -= size % unit
    while size > 0:
        part = MemoryPiece(piece.area, (done, done + size), ((piece.serves[0][0], done - start),), piece.joins)
        more = load.adding(part)
        if more is not None:
            return more, size
        size -= unit
    return None, 0


def _planned(load: Load, asked: Sequence[Item]) -> tuple[PlannedItem, ...]:
    """Write the items of a telegram, in the order asked, one of odd length last if the room is short."""
    planned = [PlannedItem(*_single(piece, asked)) for piece in load.pieces if not piece.joins]
    for area, spans in load.spans:
        for span in spans:
            inside = [
                piece
                for piece in load.pieces
                if piece.joins and piece.area == area and span[0] <= piece.span[0] < span[1]
            ]
            planned.append(_joined(Area(area), span, inside, asked))
    planned.sort(key=lambda entry: min(part.asked for part in entry.parts))
    return tuple(_odd_last(planned, [entry.item.octets for entry in planned], load.rules))


def _odd_last(entries: list[PlannedItem], sizes: list[int], rules: PackingRules) -> list[PlannedItem]:
    """Move one entry of odd length to the end if the telegram would otherwise be one pad too long."""
    length = rules.header + sum(rules.item + size + size % 2 for size in sizes) - sizes[-1] % 2
    if length <= rules.limit:
        return entries
    at = max(index for index, size in enumerate(sizes) if size % 2)
    return [*entries[:at], *entries[at + 1 :], entries[at]]


def _single(piece: MemoryPiece, asked: Sequence[Item]) -> tuple[Item, tuple[PackedPart, ...]]:
    """One asked item as it is, or a part of one."""
    number, offset = piece.serves[0]
    item = asked[number]
    parts = tuple(PackedPart(entry, start, 0, piece.size) for entry, start in piece.serves)
    if piece.size == item.octets:
        return item, parts
    unit = OCTETS[item.size]
    step = 1 if item.by_element else 8 * unit
    return Item(item.area, item.size, piece.size // unit, item.address + offset // unit * step, item.db), parts


def _joined(area: Area, span: Span, pieces: Sequence[MemoryPiece], asked: Sequence[Item]) -> PlannedItem:
    """One item over a span: as it was asked for if it serves one item only, otherwise bytes (words for AI, AQ)."""
    numbers = [(number, start, piece) for piece in pieces for number, start in piece.serves]
    if len({(asked[number], start) for number, start, _ in numbers}) == 1:
        item, parts = _single(pieces[0], asked)
        if item.octets == span[1] - span[0]:
            return PlannedItem(item, tuple(PackedPart(number, start, 0, item.octets) for number, start, _ in numbers))
    parts = tuple(_part(asked[number], number, start, piece, span) for number, start, piece in numbers)
    length = span[1] - span[0]
    if area in {Area.AI, Area.AQ}:
        return PlannedItem(Item.memory(area, span[0], length // 2, TransportSize.WORD), parts)
    return PlannedItem(Item.memory(area, span[0], length), parts)


def _part(item: Item, number: int, start: int, piece: MemoryPiece, span: Span) -> PackedPart:
    bit = item.bit_number if item.size == TransportSize.BIT else None
    if start or piece.size < item.octets:
        return PackedPart(number, start, piece.span[0] - span[0], piece.size, bit)
    return PackedPart(number, 0, item.byte - span[0], item.octets, bit)


# ---- Writing --------------------------------------------------------------------------------------------------


def pack_write(items: Sequence[ItemWrite], *, merge: bool = True, rules: PackingRules = WRITING) -> WritePlan:
    """Plan few telegrams that write ``items``: touching blocks are joined first, which may cost one telegram.

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
    pieces = [_write_piece(number, item, merge=merge) for number, item in enumerate(places)]
    large = [piece for piece in pieces if piece.size > rules.room]
    loads = distribute([piece for piece in pieces if piece.size <= rules.room], rules)
    telegrams = [_planned(load, places) for load in _pour(loads, large, places, rules)]
    telegrams.sort(key=lambda telegram: min(part.asked for planned in telegram for part in planned.parts))
    return WritePlan(
        asked,
        tuple(tuple(ItemWrite(planned.item, _data(planned, asked)) for planned in telegram) for telegram in telegrams),
        tuple(tuple(tuple(part.asked for part in planned.parts) for planned in telegram) for telegram in telegrams),
    )


def _write_piece(number: int, item: Item, *, merge: bool) -> MemoryPiece:
    joins = merge and not item.by_element and item.size != TransportSize.BIT
    return MemoryPiece(item.area, _span(item), ((number, 0),), joins)


def _data(planned: PlannedItem, asked: Sequence[ItemWrite]) -> bytes:
    value = bytearray(planned.item.octets)
    for part in planned.parts:
        value[part.at : part.at + part.length] = asked[part.asked].data[part.start : part.start + part.length]
    return bytes(value)


def require_apart(items: Sequence[Item]) -> None:
    """Refuse items that overlap: which value would stay is not defined. Raises PpiError with every pair."""
    placed = sorted(((item.area, *_bits(item)), number) for number, item in enumerate(items))
    found = [
        Violation(
            Kind.ADDRESS, 0, f"{address_text(items[first])} and {address_text(items[second])} overlap: written twice"
        )
        for ((area, _, end), first), ((other, start, _), second) in pairwise(placed)
        if area == other and start < end
    ]
    if found:
        raise PpiError(found)


def _bits(item: Item) -> Span:
    if item.by_element:
        return item.address, item.address + item.count
    size = 1 if item.size == TransportSize.BIT else 8 * item.octets
    return item.address, item.address + size
