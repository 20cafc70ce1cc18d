"""The files of a migration: UDT, DB, tags, functions for bytes, and the list of all symbols."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from plcgen.base.display.cells import clean
from plcgen.base.display.table import csv_table
from plcgen.build.environment import RenderedFile
from plcgen.build.nouns import TagRow
from plcgen.build.tables import WORKBOOK_NOTE, tag_sheet, tag_workbook
from plcgen.ppi.migration.places import BIT_STRINGS, SIZES, TITLES, Migrated, Migration, Room
from plcgen.ppi.wire.address import address_text

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
    tags = [_tag(each) for each in plan.symbols if each.way == "tag"]
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


def _tag(each: Migrated) -> TagRow:
    return TagRow(
        each.name,
        TITLES.get(each.type, each.type.capitalize()),
        address_text(each.symbol.item),
        clean(each.symbol.comment),
    )


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
