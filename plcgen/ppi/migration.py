"""Programs of an S7-200 on their way to an S7-1200: symbols and V memory, and the files of a migration.

Offsets are those of standard access: a byte lies anywhere, words, double words and arrays at even addresses, bits are
packed, and nothing lies upon something else (S7-1200 system manual, "Data block"). What of V cannot be a member of its
own is part of a bit string that is one, or lies in an array of bytes whose indexes are the V addresses.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from plcgen.base.diagnostics import Diagnostic, DiagnosticError, Report, Span
from plcgen.base.display.cells import clean
from plcgen.base.display.table import csv_table
from plcgen.base.files.files import read_bounded
from plcgen.base.files.text import decoded_list
from plcgen.build.environment import RenderedFile
from plcgen.build.nouns import TagRow
from plcgen.build.tables import WORKBOOK_NOTE, tag_sheet, tag_workbook
from plcgen.ppi.symbols import MAX_BYTES, PpiSymbol, SymbolTable
from plcgen.ppi.wire.address import address_text
from plcgen.ppi.wire.areas import Area, TransportSize
from plcgen.s7.types.names import check_name

MAX_SYMBOLS = 20_000
"""Micro/WIN has some thousand at most."""
MAX_DB = 65534
"""Bytes of a data block with standard access."""
MAX_TAG = {Area.M: 8192, Area.I: 1024, Area.Q: 1024}
"""Bytes of the areas in an S7-1200 (CPU 1214C and larger; 1211C and 1212C have 4096 bytes of M)."""

TYPES = {0: ("BOOL",), 1: ("BYTE",), 2: ("WORD", "INT"), 4: ("DWORD", "DINT", "REAL")}
"""Types by size in bytes, 0 for a bit, the bit string first."""
BIT_STRINGS = {type_: types[0] for types in TYPES.values() for type_ in types}
TITLES = {"DWORD": "DWord", "DINT": "DInt"}
"""Types as the TIA Portal writes them, where that is not one capital letter."""
SIZES = {type_: size for size, types in TYPES.items() for type_ in types}
_STATED = re.compile(r"[\[(]?(BOOL|BYTE|WORD|INT|DWORD|DINT|REAL)\b")
_REWIRE = "the address is kept; inputs and outputs lie elsewhere: rewire it"
_GONE = {
    Area.T: "timers of an S7-1200 are instances of TON, TOF or TONR: use one of them",
    Area.C: "counters of an S7-1200 are instances of CTU, CTD or CTUD: use one of them",
    Area.HC: "high-speed counters of an S7-1200 are configured: their value is an input ID1000 and so on",
    Area.AI: "analog inputs have other addresses in an S7-1200: from its device configuration",
    Area.AQ: "analog outputs have other addresses in an S7-1200: from its device configuration",
    Area.SM: "an S7-1200 has no special memory: system and clock memory, or system blocks",
    Area.S: "an S7-1200 has no sequence control relays: GRAPH does not exist there, use a step number",
    Area.SYS: "an S7-1200 has no such area",
}


@dataclass(slots=True)
class Migrated:
    """Where a symbol is in the S7-1200: SCL that reads it and SCL that writes it, both empty if it is not there.

    ``way`` is member, part (of a bit string), bytes, tag or none; ``note`` why it is not simply a member or a tag, or
    what is to be done.
    """

    symbol: PpiSymbol
    name: str
    type: str
    note: str = ""
    way: str = "none"
    read: str = ""
    write: str = ""
    first: int = field(init=False)
    """First bit, counted from the begin of the area."""
    end: int = field(init=False)
    """The bit behind the last."""

    def __post_init__(self) -> None:
        item = self.symbol.item
        self.first = item.address
        self.end = self.first + (item.octets * 8 if self.type != "BOOL" else 1)

    @property
    def is_array(self) -> bool:
        """Whether the address has a count."""
        return self.symbol.item.count > 1

    @property
    def is_odd(self) -> bool:
        """Whether it would have to lie at an odd address, where only bytes and bits can."""
        return self.first % 16 >= 8 and (self.is_array or SIZES[self.type] > 1)

    def reached(self, where: str, way: str) -> None:
        """Note an operand that has this symbol, as a bit string or in its own type."""
        bits = BIT_STRINGS[self.type]
        plain = way in {"member", "tag"} or bits == self.type
        self.way = way
        self.read = where if plain else f"{bits}_TO_{self.type}({where})"
        self.write = f"{where} := {'#value' if plain else f'{self.type}_TO_{bits}(#value)'};"


@dataclass(slots=True)
class Room:
    """Bits of V that belong together: one symbol with a place of its own, or several and odd ones in bytes."""

    first: int
    end: int
    symbols: list[Migrated]
    name: str = ""
    """That of the array of bytes."""

    @property
    def is_bytes(self) -> bool:
        """Whether it is an array of bytes."""
        return len(self.symbols) > 1 or self.symbols[0].is_odd


def load_types(path: Path, table: SymbolTable) -> dict[str, str]:
    """Types by symbol in lower case, from rows of symbol and type.

    Raises:
        DiagnosticError: PG717 for every row that names no symbol of the table or no type of its size.
        OSError: if the file cannot be read.
    """
    data, report, found = read_bounded(path, MAX_BYTES), Report(), dict[str, str]()
    if len(data) > MAX_BYTES:
        raise DiagnosticError([Diagnostic("PG717", "the file is too large", Span(str(path)))])
    for number, line in enumerate(decoded_list(data).splitlines(), 1):
        name, *cells = (cell.strip().strip('"') for cell in re.split(r"[\t;,]", line))
        type_, symbol = (cells or [""])[0].upper(), table.find(name)
        if not line.strip() or (number == 1 and type_ in {"TYPE", "DATA TYPE"}):
            continue
        if symbol is None:
            report.add(Diagnostic("PG717", f'the symbol table has no "{name[:100]}"', Span(str(path), number, 1)))
        elif type_ not in _types(symbol):
            message = f'"{symbol.name}" is {address_text(symbol.item)}: its type is not {type_[:20]}'
            help_ = f"write {' or '.join(_types(symbol))}" if _types(symbol) else "remove the row"
            report.add(Diagnostic("PG717", message, Span(str(path), number, 1), help=help_))
        else:
            found[symbol.name.casefold()] = type_
    report.raise_on_errors()
    return found


def _types(symbol: PpiSymbol) -> tuple[str, ...]:
    item = symbol.item
    if Area(item.area) not in {Area.V, *MAX_TAG}:
        return ()
    return TYPES[0 if item.size == TransportSize.BIT else item.octets // item.count]


@dataclass(frozen=True, slots=True)
class Migration:
    """All symbols in the order of the table, the rooms of V in that of their addresses, and which names are taken."""

    symbols: Sequence[Migrated]
    rooms: Sequence[Room]
    taken: set[str]

    def free(self, name: str) -> str:
        """The name, or one like it that nobody has."""
        while name.casefold() in self.taken:
            name += "_"
        self.taken.add(name.casefold())
        return name


def migrate(table: SymbolTable, file: str, types: Mapping[str, str]) -> Migration:
    """Find a place for every symbol; a comment may begin with the type (``REAL, bar``).

    Raises DiagnosticError PG717 for more than MAX_SYMBOLS symbols.
    """
    if len(table.symbols) > MAX_SYMBOLS:
        message = f"the table has {len(table.symbols)} symbols, at most {MAX_SYMBOLS} are migrated"
        raise DiagnosticError([Diagnostic("PG717", message, Span(file), help="divide the table")])
    taken = {"v", "v_layout", *(f"v_{do}{type_.casefold()}" for do in ("get", "set") for type_ in BIT_STRINGS)}
    good = {s.line for s in table.symbols if not check_name(s.name, toolchain_is_v5=False, role="identifier")}
    good -= {s.line for s in table.symbols if s.name.casefold() in taken}
    taken |= {s.name.casefold() for s in table.symbols if s.line in good}
    plan = Migration([], [], taken)
    found: list[Migrated] = []
    for symbol in table.symbols:
        allowed, stated = _types(symbol), _STATED.match(symbol.comment)
        type_ = types.get(symbol.name.casefold()) or (stated[1] if stated else "")
        name = symbol.name if symbol.line in good or not allowed else plan.free(_plain(symbol))
        each = Migrated(symbol, name, type_ if type_ in allowed else (allowed or ("",))[0])
        found.append(each)
        if name != symbol.name:
            each.note = "renamed"
        if type_ and allowed and type_ not in allowed:
            each.note = _and(each.note, f"the comment says {type_}, which has another size")
    _place_tags(found)
    v = [each for each in found if each.symbol.item.area == Area.V]
    return Migration(found, _place_v(v, plan), taken)


def _plain(symbol: PpiSymbol) -> str:
    """A name that the TIA Portal takes, with the line of the table as its number."""
    return f"{re.sub(r'[^a-zA-Z0-9_ ]', '_', symbol.name)[:80].strip()}_{symbol.line}"


def _and(note: str, more: str) -> str:
    return f"{note}; {more}" if note else more


def _place_tags(found: Sequence[Migrated]) -> None:
    for each in found:
        area = Area(each.symbol.item.area)
        if area in _GONE:
            each.note = _GONE[area]
        elif area in MAX_TAG and each.is_array:
            each.note = _and(each.note, "a tag at an address is no array: make one tag per element")
        elif area in MAX_TAG and each.end > MAX_TAG[area] * 8:
            each.note = _and(each.note, f"{area.name} of an S7-1200 ends with byte {MAX_TAG[area] - 1}")
        elif area in MAX_TAG:
            each.reached(f'"{each.name}"', "tag")
            each.note = _and(each.note, _REWIRE) if area is not Area.M else each.note


def _place_v(v: Sequence[Migrated], plan: Migration) -> list[Room]:
    """Give the symbols of V their places: members, parts of members, bytes."""
    for each in v:
        if each.end > MAX_DB * 8:
            each.note = _and(each.note, f"a data block ends with byte {MAX_DB - 1}")
    parts: list[tuple[Migrated, Migrated]] = []
    kept: list[Migrated] = []
    top: Migrated | None = None
    inside = [each for each in v if each.end <= MAX_DB * 8]
    inside.sort(key=lambda each: (each.first, -each.end, BIT_STRINGS[each.type] != each.type))
    for each in inside:
        if top is not None and _is_part(each, top):
            parts.append((each, top))
            continue
        kept.append(each)
        if top is None or each.end > top.end:
            top = each
    rooms = _rooms(kept)
    arrays: dict[int, Room] = {}
    for room in rooms:
        if room.is_bytes:
            room.name = plan.free(f"V{room.first // 8}_bytes")
            arrays |= {id(each): room for each in room.symbols}
            _explain(room)
        else:
            room.symbols[0].reached(f'"V"."{room.symbols[0].name}"', "member")
    for each, whole in parts:
        each.note = _and(each.note, f"overlaps {whole.symbol.name}")
        if id(whole) in arrays:
            arrays[id(each)] = arrays[id(whole)]
        elif each.type == whole.type:
            each.way, each.read, each.write = "part", whole.read, whole.write
        else:
            each.reached(f'"V"."{whole.name}"{_slice(each, whole)}', "part")
    for each in inside:
        if id(each) in arrays:
            array = f'"V".{arrays[id(each)].name}'
            # how a symbol in an array of bytes is read and written
            each.way = "bytes"
            byte, last = each.first // 8, (each.end - 1) // 8
            size = SIZES[each.type]
            if each.is_array:
                each.note = _and(each.note, f"bytes {byte} to {last} of {array}")
            elif size < 2:
                each.reached(f"{array}[{byte}]" + (f".%X{each.first % 8}" if not size else ""), "bytes")
            else:
                name = TITLES.get(each.type, each.type.capitalize())
                cells = [f"{array}[{number}]" for number in range(byte, last + 1)]
                each.read = f'"V_Get{name}"({", ".join(f"b{n} := {cell}" for n, cell in enumerate(cells))})'
                each.write = (
                    f'"V_Set{name}"(in := #value, {", ".join(f"b{n} => {cell}" for n, cell in enumerate(cells))});'
                )
    return rooms


def _is_part(each: Migrated, whole: Migrated) -> bool:
    """Whether SCL can name a symbol as a part of another, or as the same."""
    if each.end > whole.end or each.is_array or whole.is_array or whole.is_odd:
        return False
    if each.type == whole.type:
        return True  # as large, and within: the same bits
    return BIT_STRINGS[whole.type] == whole.type and (SIZES[each.type] < 2 or (each.first - whole.first) % 16 == 0)


def _slice(each: Migrated, whole: Migrated) -> str:
    """The slice of a bit string: S7 has its first byte in the highest bits, and counts slices from the lowest."""
    size, place = SIZES[each.type], (each.first - whole.first) // 8
    behind = SIZES[whole.type] - place - max(size, 1)
    if size == SIZES[whole.type]:
        return ""
    if size == 0:
        return f".%X{behind * 8 + each.first % 8}"
    return f".%B{behind}" if size == 1 else f".%W{behind // 2}"


def _rooms(kept: Sequence[Migrated]) -> list[Room]:
    """Put together what cannot be apart; ``kept`` by address. An array of bytes begins and ends at even addresses."""
    rooms: list[Room] = []
    for each in kept:
        room = Room(each.first, each.end, [each])
        if each.is_odd or each.is_array:
            _round(room)
        while rooms and rooms[-1].end > room.first:
            last = rooms.pop()
            last.symbols += room.symbols
            room = Room(min(room.first, last.first), max(room.end, last.end), last.symbols)
            _round(room)
        rooms.append(room)
    return rooms


def _round(room: Room) -> None:
    room.first, room.end = room.first // 16 * 16, -(-room.end // 16) * 16


def _explain(room: Room) -> None:
    """Say of each symbol in bytes why it is there."""
    why: dict[int, str] = {}
    last = room.symbols[0]
    for each in room.symbols[1:]:
        if each.first < last.end:
            why[id(each)] = f"overlaps {last.symbol.name}"
            why.setdefault(id(last), f"overlaps {each.symbol.name}")
        if each.end > last.end:
            last = each
    for number, each in enumerate(room.symbols):
        beside = room.symbols[number - 1 if number else 1 % len(room.symbols)].symbol.name
        alone = "odd address" if each.is_odd else f"in one word with {beside}"
        each.note = _and(each.note, why.get(id(each), alone))


LIST = "MIGRATION.csv"
_HEADER = ("Symbol", "S7-200", "Type", "Way", "Read", "Write", "Note")
_DB = """\
DATA_BLOCK "V"
{ S7_Optimized_Access := 'FALSE' }
VERSION : 0.1
"V_Layout"
BEGIN
END_DATA_BLOCK
"""


def files(plan: Migration) -> Iterator[RenderedFile]:
    """All files of a migration; without symbols of V, M, I or Q those for them are left out."""
    if plan.rooms:
        members = "".join(f"    {line}\n" for line in _members(plan))
        yield _text("V_Layout.udt", f'TYPE "V_Layout"\nVERSION : 0.1\n  STRUCT\n{members}  END_STRUCT;\nEND_TYPE\n')
        yield _text("V.db", _DB)
    called = {each.type for each in plan.symbols if each.way == "bytes" and each.read and SIZES[each.type] > 1}
    if called:
        yield _text("V_bytes.scl", "\n".join(map(_functions, sorted(called))))
    tags = [
        TagRow(
            each.name,
            TITLES.get(each.type, each.type.capitalize()),
            address_text(each.symbol.item),
            clean(each.symbol.comment),
        )
        for each in plan.symbols
        if each.way == "tag"
    ]
    if tags:
        yield _text("tags.csv", tag_sheet(tags))
        yield RenderedFile("tags.xlsx", tag_workbook({"S7-200": tags}), WORKBOOK_NOTE)
    yield _text(LIST, csv_table(_HEADER, [row(each) for each in plan.symbols], ";"))


def row(each: Migrated) -> tuple[str, ...]:
    """A row of the list, as its header says."""
    address = address_text(each.symbol.item)
    return each.symbol.name, address, each.type, each.way, each.read, each.write, each.note


def _text(path: str, text: str) -> RenderedFile:
    """A source, or a table for a spreadsheet: both want a byte order mark."""
    return RenderedFile(path, text.encode("utf-8-sig", "replace"))


def _members(plan: Migration) -> Iterator[str]:
    """The lines of the type: every byte up to the last symbol is declared, so that no offset depends on packing."""
    place = 0
    for room in plan.rooms:
        yield from _gap(place, room.first, plan)
        if room.is_bytes:
            names = ", ".join(clean(each.symbol.name) for each in room.symbols[:5])
            more = ", ..." if len(room.symbols) > 5 else ""
            yield f"{_array(room.name, room.first, room.end)}  // {names}{more}"
        else:
            yield _member(room)
        place = room.end


def _member(room: Room) -> str:
    each = room.symbols[0]
    item = each.symbol.item
    type_ = f"ARRAY[0..{item.count - 1}] OF {each.type}" if each.is_array else each.type
    comment = clean(each.symbol.comment)
    return f'"{each.name}" : {type_};  // {address_text(item)}{", " if comment else ""}{comment}'


def _array(name: str, first: int, end: int) -> str:
    return f"{name} : ARRAY[{first // 8}..{end // 8 - 1}] OF BYTE;"


def _gap(place: int, end: int, plan: Migration) -> Iterator[str]:
    """Members without a symbol: bits up to a byte, a byte up to an even address, an array, a byte, bits."""
    while place < end:
        byte, whole = place // 8, (end - place) // 16 * 16
        name = f"V{byte}_{place % 8}" if place % 8 or end - place < 8 else f"V{byte}_free"
        name = plan.free(name)
        if place % 8 or end - place < 8:
            yield f"{name} : BOOL;"
            place += 1
        elif place % 16 or not whole:
            yield f"{name} : BYTE;"
            place += 8
        else:
            yield _array(name, place, place + whole)
            place += whole


def _functions(type_: str) -> str:
    """The two functions that make a value of bytes, the first one the highest, and bytes of a value."""
    bits, numbers = BIT_STRINGS[type_], range(SIZES[type_])
    name, pins = TITLES.get(type_, type_.capitalize()), "".join(f"    b{n} : BYTE;\n" for n in numbers)
    value, raw = ("#bits", "#in") if bits == type_ else (f"{bits}_TO_{type_}(#bits)", f"{type_}_TO_{bits}(#in)")
    temp = f"  VAR_TEMP\n    bits : {bits};\n  END_VAR\nBEGIN\n"
    slices: Sequence[tuple[int, int]] = [(n, len(numbers) - 1 - n) for n in numbers]
    joined = "".join(f"  #bits.%B{part} := #b{n};\n" for n, part in slices)
    split = "".join(f"  #b{n} := #bits.%B{part};\n" for n, part in slices)
    return (
        f'FUNCTION "V_Get{name}" : {type_}\n{_HEAD}  VAR_INPUT\n{pins}  END_VAR\n{temp}'
        f'  #bits := 0;\n{joined}  #"V_Get{name}" := {value};\nEND_FUNCTION\n\n'
        f'FUNCTION "V_Set{name}" : VOID\n{_HEAD}  VAR_INPUT\n    in : {type_};\n  END_VAR\n'
        f"  VAR_OUTPUT\n{pins}  END_VAR\n{temp}  #bits := {raw};\n{split}END_FUNCTION\n"
    )


_HEAD = "{ S7_Optimized_Access := 'TRUE' }\nVERSION : 0.1\n"
