"""Symbols of an S7-200 in an S7-1200: offsets by hand, by plcgen's layout of the sources, and by running them."""

from __future__ import annotations

import math
import struct
import time

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from plcgen import api
from plcgen.base.diagnostics import DiagnosticError
from plcgen.ppi.migration import MAX_SYMBOLS, files, load_types, migrate
from plcgen.ppi.symbols import parse_symbols
from plcgen.s7.cpu.testing import load_scl

TABLE = """Symbol,Address,Comment
Speed,VW100,INT rpm
Level,VD104,"REAL, bar"
Ready,V110.3,real pressure
Flags,VB112,
FlagTwo,V112.2,
Odd,VW115,INT
Odd.Real,VD121,REAL
Near,VB125,
Total,VD130,
TotalLow,VW132,INT
Name,VB140[5],
AfterName,VB145,
Buffer,VW150[3],
Pump,Q0.1,main pump
Mem,MW3,INT
Words,MW10[2],
High,MB8192,
T_on,T37,
An,AIW0,
Beyond,VB65534,
"""


def made(text, types=None):
    """The migration of a table and its text files by name."""
    plan = migrate(parse_symbols(text), "s.csv", types or {})
    written = {file.path: file.data.decode("utf-8-sig") for file in files(plan) if not file.path.endswith("xlsx")}
    return {each.symbol.name: each for each in plan.symbols}, written


def offsets(written, tmp_path):
    """Member of V -> (byte, bit, type) in the layout that plcgen computes from the sources."""
    for name in ("V_Layout.udt", "V.db"):
        (tmp_path / name).write_text(written[name], "utf-8-sig")
    (block,) = api.layout(tmp_path / "V.db", tmp_path / "V_Layout.udt", block="V").blocks
    return {row.name: (*map(int, row.offset.split(".")), row.type) for row in block.rows if row.name}


def test_each_symbol_of_a_table():
    """Members at even addresses, bits, parts, bytes with functions, tags, and the reasons of the rest."""
    found, written = made(TABLE)
    ways = {name: (each.way, each.type, each.note) for name, each in found.items()}
    assert ways == {
        "Speed": ("member", "INT", ""),
        "Level": ("member", "REAL", ""),
        "Ready": ("member", "BOOL", ""),
        "Flags": ("member", "BYTE", ""),
        "FlagTwo": ("part", "BOOL", "overlaps Flags"),
        "Odd": ("bytes", "INT", "odd address"),
        "Odd.Real": ("bytes", "REAL", "renamed; odd address"),
        "Near": ("bytes", "BYTE", "in one word with Odd.Real"),
        "Total": ("member", "DWORD", ""),
        "TotalLow": ("part", "INT", "overlaps Total"),
        "Name": ("bytes", "BYTE", 'in one word with AfterName; bytes 140 to 144 of "V".V140_bytes'),
        "AfterName": ("bytes", "BYTE", "in one word with Name"),
        "Buffer": ("member", "WORD", ""),
        "Pump": ("tag", "BOOL", "the address is kept; inputs and outputs lie elsewhere: rewire it"),
        "Mem": ("tag", "INT", ""),
        "Words": ("none", "WORD", "a tag at an address is no array: make one tag per element"),
        "High": ("none", "BYTE", "M of an S7-1200 ends with byte 8191"),
        "T_on": ("none", "", "timers of an S7-1200 are instances of TON, TOF or TONR: use one of them"),
        "An": ("none", "", "analog inputs have other addresses in an S7-1200: from its device configuration"),
        "Beyond": ("none", "BYTE", "a data block ends with byte 65533"),
    }
    # VW132 are the last two bytes of VD130: the lower word, %W0. V112.2 is bit 2 of VB112
    assert found["TotalLow"].read == 'WORD_TO_INT("V"."Total".%W0)'
    assert found["FlagTwo"].write == '"V"."Flags".%X2 := #value;'
    assert found["Odd"].read == '"V_GetInt"(b0 := "V".V114_bytes[115], b1 := "V".V114_bytes[116])'
    assert "\nPump;Bool;%Q0.1;main pump\nMem;Int;%MW3;INT\n" in written["tags.csv"]
    assert sorted(written) == ["MIGRATION.csv", "V.db", "V_Layout.udt", "V_bytes.scl", "tags.csv"]


def test_offsets(tmp_path):
    """The layout of the sources has the members at the V addresses; VW115 begins in an array at 114, [115] is 115."""
    _, written = made(TABLE)
    found = offsets(written, tmp_path)
    assert {name: found[name] for name in ("Speed", "Level", "Ready", "Flags", "Total", "Buffer")} == {
        "Speed": (100, 0, "INT"),
        "Level": (104, 0, "REAL"),
        "Ready": (110, 3, "BOOL"),
        "Flags": (112, 0, "BYTE"),
        "Total": (130, 0, "DWORD"),
        "Buffer": (150, 0, "ARRAY[0..2] OF WORD"),
    }
    assert found["V114_bytes"] == (114, 0, "ARRAY[114..117] OF BYTE")


SIZES = {"BOOL": 0, "BYTE": 1, "WORD": 2, "INT": 2, "DWORD": 4, "DINT": 4, "REAL": 4}
LETTERS = {0: "V", 1: "VB", 2: "VW", 4: "VD"}


@st.composite
def tables(draw, *, apart):
    """Rows of name, address, type and place in bits; ``apart``: at even addresses, and nothing upon something else."""
    rows, bit = [], 0
    for number in range(draw(st.integers(1, 12))):
        type_ = draw(st.sampled_from(list(SIZES)))
        size = SIZES[type_]
        if apart:
            unit = (1, 8, 16, 16, 16)[size]
            bit = -(-(bit + draw(st.integers(0, 40))) // unit) * unit
        else:
            bit = draw(st.integers(0, 11)) * 8 + (draw(st.integers(0, 7)) if not size else 0)
        rows.append((f"s{number}", f"{LETTERS[size]}{bit // 8}" + (f".{bit % 8}" if not size else ""), type_, bit))
        bit += size * 8 or 1
    return rows


def text_of(rows):
    return "Symbol,Address,Comment\n" + "".join(f"{name},{address},{type_}\n" for name, address, type_, _ in rows)


@settings(deadline=None, max_examples=60)
@given(rows=tables(apart=True))
def test_what_can_keep_its_offset_does(tmp_path_factory, rows):
    """Even addresses without overlaps: every symbol is a member of its own type at its own address."""
    found, written = made(text_of(rows))
    places = offsets(written, tmp_path_factory.mktemp("v"))
    assert {name: places[name] for name in found} == {name: (b // 8, b % 8, type_) for name, _, type_, b in rows}
    assert "V_bytes.scl" not in written


FORMS = {"BYTE": ">B", "WORD": ">H", "INT": ">h", "DWORD": ">I", "DINT": ">i", "REAL": ">f"}


@settings(deadline=None, max_examples=40)
@given(rows=tables(apart=False), data=st.data())
def test_symbols_share_memory_as_in_the_s7_200(rows, data):
    """Any addresses: after a write through one symbol, every symbol reads what the bytes of V would be, highest first.

    The expected bytes are packed by ``struct`` into a plain memory; the SCL of the list runs in the soft CPU.
    """
    found, written = made(text_of(rows))
    name, _, type_, bit = data.draw(st.sampled_from(rows))
    memory = bytearray(20)
    if type_ == "BOOL":
        value = True
        memory[bit // 8] |= 1 << bit % 8
    else:
        value = 1.5 if type_ == "REAL" else data.draw(st.integers(1, 2 ** (SIZES[type_] * 8 - 1) - 1))
        struct.pack_into(FORMS[type_], memory, bit // 8, value)
    members = "".join(f"  r{n} : {row[2]};\n" for n, row in enumerate(rows))
    reads = "".join(f'"R".r{n} := {found[row[0]].read};\n' for n, row in enumerate(rows))
    write = found[name].write.replace("#value", '"R".in')
    bench = load_scl(
        *(written[path] for path in ("V_Layout.udt", "V.db", "V_bytes.scl") if path in written),
        f'DATA_BLOCK "R"\nSTRUCT\n  in : {type_};\n{members}END_STRUCT;\nBEGIN\nEND_DATA_BLOCK\n',
        f'ORGANIZATION_BLOCK "Main"\nBEGIN\n{write}\n{reads}END_ORGANIZATION_BLOCK\n',
    )
    bench.cpu["R.in"] = value
    bench.scan()
    for number, (_, _, read, place) in enumerate(rows):
        if read == "BOOL":
            expected = bool(memory[place // 8] >> place % 8 & 1)
        else:
            (expected,) = struct.unpack_from(FORMS[read], memory, place // 8)
        got = bench.cpu[f"R.r{number}"]
        if read == "REAL" and math.isnan(expected):  # its payload may change on the way
            assert math.isnan(got)
            continue
        assert struct.pack(FORMS.get(read, "?"), got) == struct.pack(FORMS.get(read, "?"), expected)


HOSTILE = (
    'Symbol;Address;Comment\n"a""b";VB1;x\nEND_STRUCT;VW2;*) END_TYPE\u2028END_STRUCT;\nV;VB9;\nV0_free;VB11;\n'
    "v_getint;MB0;\n"
)


def test_names_that_no_source_takes(tmp_path):
    """Quotes, reserved words, names of plcgen's own blocks and members, ends of lines in comments."""
    found, written = made(HOSTILE)
    assert [each.name for each in found.values() if each.note == "renamed"] == [
        "a_b_2",
        "END_STRUCT_3",
        "V_4",
        "v_getint_6",
    ]
    assert {"a_b_2", "END_STRUCT_3", "V_4", "V0_free", "V0_free_"} <= offsets(written, tmp_path).keys()
    load_scl(written["V_Layout.udt"], written["V.db"])  # raises if the compiler would refuse them


def test_types(tmp_path):
    """A list states types by symbol; a comment of another size is told, a row of another size is an error."""
    table = parse_symbols("Speed,VW0,REAL\nLevel,VD4,\n")
    path = tmp_path / "types.csv"
    path.write_text("Symbol;Type\nlevel;real\n", "utf-8")
    types = load_types(path, table)
    notes = [(each.type, each.note) for each in migrate(table, "s.csv", types).symbols]
    assert notes == [("WORD", "the comment says REAL, which has another size"), ("REAL", "")]
    path.write_text("Speed;REAL\nNobody;INT\n\nLevel\n", "utf-8")
    with pytest.raises(DiagnosticError) as caught:
        load_types(path, table)
    assert [(d.code, d.span.line) for d in caught.value.diagnostics] == [("PG717", 1), ("PG717", 2), ("PG717", 4)]


def test_large_tables():
    """MAX_SYMBOLS symbols that all overlap take seconds at most; one more is refused."""
    rows = [f"s{number},VB{number % 60000}[{5000 + number % 7}]\n" for number in range(MAX_SYMBOLS)]
    begin = time.monotonic()
    found, written = made("".join(rows))
    assert time.monotonic() - begin < 20
    assert {each.way for each in found.values()} == {"bytes"}
    assert len(written["V_Layout.udt"]) < 1000
    with pytest.raises(DiagnosticError, match="at most 20000"):
        made("".join([*rows, "more,VB0\n"]))
