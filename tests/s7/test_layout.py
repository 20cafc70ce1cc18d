"""Offsets against blocks that STEP 7 compiled, against documents, and against hand calculation."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from plcgen.base.diagnostics import DiagnosticError, Span
from plcgen.s7.layout.layout import layout_block, layout_members, leaves, locate, split_path
from plcgen.s7.types.blocks import Block, BlockKind, Section, SectionKind
from plcgen.s7.types.data_types import ELEMENTARY, ArrayType, Elementary, Member, NamedType, StringType, StructType
from plcgen.s7.types.system import s7_1500_types
from tests.layout_vectors import block, cases, db, members, to_type
from tests.work import calls_of


def offsets(layout):
    return {entry.path: entry.offset for entry in layout.entries}


def codes(function, *args):
    with pytest.raises(DiagnosticError) as caught:
        function(*args)
    return [d.code for d in caught.value.diagnostics]


@pytest.mark.parametrize("name", cases())
def test_every_compiled_block_has_the_length_and_offsets_step7_gave_it(name):
    """Total length, every member offset, every stride and every nested offset of the vectors."""
    case = cases()[name]
    built, types = block(case)
    layout = layout_block(built, types)
    assert case["size"] == layout.size

    def check(data, prefix, base):
        path = prefix + data["name"]
        assert base + data["offset"] == locate(layout, path).offset, path
        for inner in data.get("members", ()):
            check(inner, path + ".", base)
        if "stride" in data:
            low, high = to_type(data["type"].replace("STRUCT", "BYTE")).bounds[0]
            first = locate(layout, f"{path}[{low}]").offset
            assert base + data["offset"] == first
            if high > low:
                assert first + data["stride"] == locate(layout, f"{path}[{low + 1}]").offset
            for inner in data.get("element", ()):
                check(inner, f"{path}[{low}].", first)
                check(inner, f"{path}[{high}].", first + (high - low) * data["stride"])

    for data in case["members"]:
        check(data, "", 0)


def test_there_are_all_33_compiled_blocks_and_the_four_of_the_faq():
    assert len(cases()) == 37


@pytest.mark.parametrize("name", cases())
def test_anchors_lie_where_the_compiled_image_has_them(name):
    for anchor in cases()[name].get("anchors", ()):
        built, types = block(cases()[name])
        entry = locate(layout_block(built, types), anchor["path"])
        assert anchor["offset"] == entry.offset
        assert to_type(anchor["type"]) == entry.type


SIZES = {
    "BOOL": 1,
    "BYTE": 8,
    "CHAR": 8,
    "SINT": 8,
    "USINT": 8,
    "WORD": 16,
    "INT": 16,
    "UINT": 16,
    "WCHAR": 16,
    "S5TIME": 16,
    "DATE": 16,
    "TIMER": 16,
    "COUNTER": 16,
    "BLOCK_DB": 16,
    "HW_IO": 16,
    "DWORD": 32,
    "DINT": 32,
    "UDINT": 32,
    "REAL": 32,
    "TIME": 32,
    "TIME_OF_DAY": 32,
    "LWORD": 64,
    "LINT": 64,
    "ULINT": 64,
    "LREAL": 64,
    "LTIME": 64,
    "LTIME_OF_DAY": 64,
    "LDT": 64,
    "DATE_AND_TIME": 64,
    "DTL": 96,
    "ANY": 80,
    "POINTER": 48,
}


@pytest.mark.parametrize(("name", "bits"), SIZES.items())
def test_elementary_types_follow_an_odd_byte_as_their_width_says(name, bits):
    """After one BYTE: single bits and bytes at byte 1, everything wider at byte 2, never 4- or 8-aligned."""
    layout = layout_block(db("a : BYTE", f"b : {name}"), {})
    entry = layout.entries[1]
    assert (8 if bits <= 8 else 16, bits) == (entry.offset, entry.size)


@pytest.mark.parametrize(
    ("declarations", "expected", "size"),
    [
        (["s : STRING[3]", "b : BYTE", "w : WORD"], {"s": 0, "b": 40, "w": 48}, 8),
        (["b : BYTE", "s : STRING", "x : BOOL"], {"b": 0, "s": 16, "x": 258 * 8}, 260),
        (["s : WSTRING[3]", "b : BYTE"], {"s": 0, "b": 80}, 12),
        (["x : BOOL", "b : BYTE", "y : BOOL"], {"x": 0, "b": 8, "y": 16}, 4),
        (["a : ARRAY[1..3] OF BYTE", "b : BYTE"], {"a": 0, "b": 32}, 6),
        (["b : BYTE", "a : ARRAY[1..3] OF BOOL", "x : BOOL"], {"b": 0, "a": 16, "x": 32}, 6),
        (["a : ARRAY[1..2,1..3] OF BOOL", "x : BOOL"], {"a": 0, "a[1,3]": 2, "a[2,1]": 8, "x": 16}, 4),
        (["a : ARRAY[1..2,0..8] OF BOOL", "x : BOOL"], {"a[2,0]": 16, "a[2,8]": 24, "x": 32}, 6),
        (["a : ARRAY[0..1,5..7] OF INT"], {"a[0,7]": 32, "a[1,5]": 48}, 12),
        (["a : ARRAY[1..2] OF STRING[3]", "b : BYTE"], {"a[2]": 48, "b": 96}, 14),
        (["a : ARRAY[-1..1] OF LREAL"], {"a[-1]": 0, "a[0]": 64, "a[1]": 128}, 24),
        (
            ["b : BYTE", "t : TON_TIME", "w : WORD"],
            {"t": 16, "t.PT": 48, "t.ET": 80, "t.Q": 114, "w": 144},
            20,
        ),
        (["d : DTL", "b : BOOL"], {"d": 0, "b": 96}, 14),
    ],
)
def test_hand_calculated_layouts(declarations, expected, size):
    """Worked out on paper from the rule table of the S7 manuals."""
    layout = layout_block(db(*declarations), {})
    assert expected == {path: locate(layout, path).offset for path in expected}
    assert size == layout.size


@pytest.mark.parametrize(
    ("name", "size", "expected"),
    [
        (
            "SFB53",
            26,
            {
                "REQ": 0,
                "ID": 16,
                "INDEX": 48,
                "LEN": 64,
                "DONE": 80,
                "ERROR": 82,
                "STATUS": 96,
                "RECORD": 128,
            },
        ),
        ("WRREC", 26, {"BUSY": 81}),
        ("SFB52", 28, {"REQ": 0, "MLEN": 64, "VALID": 80, "STATUS": 96, "LEN": 128, "RECORD": 144}),
        ("rdrec", 28, {"INDEX": 48}),
    ],
)
def test_record_function_blocks_are_26_and_28_bytes(name, size, expected):
    """As a multi-instance and as an instance DB; lengths from compiled multi-instances."""
    layout = layout_block(db("a : WORD", f"wr : {name}", "b : BOOL"), {})
    assert {f"wr.{k}": v + 16 for k, v in expected.items()} == {
        f"wr.{k}": locate(layout, f"wr.{k}").offset for k in expected
    }
    assert 16 + size * 8 == locate(layout, "b").offset
    assert locate(layout, "b").confirmed
    instance = layout_block(Block(BlockKind.DB, "DB53", (), instance_of=name), {})
    assert size == instance.size


def fb(name="Fb", **sections):
    kinds = {
        "i": SectionKind.INPUT,
        "o": SectionKind.OUTPUT,
        "io": SectionKind.IN_OUT,
        "s": SectionKind.STATIC,
    }
    kinds |= {"t": SectionKind.TEMP, "c": SectionKind.CONSTANT}
    return Block(BlockKind.FB, name, tuple(Section(kinds[k], members(*v)) for k, v in sections.items()))


def test_fb_sections_start_even_in_fixed_order_and_temp_takes_no_room():
    """Declared in another order; IN 1 bit, OUT 1 byte, IN_OUT 1 bit, STAT at 6."""
    block_ = fb(t=["t : DINT"], c=["k : INT"], s=["s : BYTE"], io=["q : BOOL"], o=["o : BYTE"], i=["i : BOOL"])
    layout = layout_block(block_, {})
    assert offsets(layout) == {"i": 0, "o": 16, "q": 32, "s": 48}
    assert layout.size == 8


def test_structured_in_out_is_a_six_byte_pointer_and_any_ten_bytes():
    udt = db("x : LREAL", kind=BlockKind.UDT, name="U")
    names = [
        "a : ARRAY[1..9] OF INT",
        "s : STRING",
        "u : U",
        "d : DATE_AND_TIME",
        "n : ANY",
        "i : INT",
        "v : VARIANT",
    ]
    layout = layout_block(fb(io=[*names, "e : BYTE"]), {"u": udt})
    expected = {"a": 0, "s": 48, "u": 96, "d": 144, "n": 192, "i": 272, "v": 288, "e": 288}
    assert expected == offsets(layout)
    assert ELEMENTARY["POINTER"] == layout.entries[0].type
    assert layout.entries[0].member.name == "a"
    assert to_type("ARRAY[1..9] OF INT") == layout.entries[0].member.type


def test_a_path_is_looked_up_once():
    """The second look-up of a path is one of a dictionary; a path that is not there is refused each time."""
    layout = layout_block(db("b : BYTE", "a : ARRAY[0..9] OF INT"), {})
    first, before = calls_of(lambda: locate(layout, "a[3]"))
    again, after = calls_of(lambda: locate(layout, "a[3]"))
    assert (first.offset, again, after < before / 5) == (16 + 3 * 16, first, True)
    for _ in range(2):
        with pytest.raises(KeyError):
            locate(layout, "a[10]")


def test_instance_db_and_udt_db_take_their_types_members():
    types = {
        "FB_A": fb("Fb_A", i=["x : BOOL"], s=["y : INT"]),
        "u": db("a : BYTE", kind=BlockKind.UDT, name="U"),
    }
    assert offsets(layout_block(Block(BlockKind.DB, "i", (), instance_of="fb_a"), types)) == {"x": 0, "y": 16}
    assert offsets(layout_block(Block(BlockKind.DB, "d", (), instance_of="U"), types)) == {"a": 0}


def test_user_types_win_over_system_types_and_letter_case_does_not_matter():
    types = {"Ton": db("a : BYTE", kind=BlockKind.UDT, name="TON")}
    assert layout_block(db("t : ton"), types).size == 2
    assert layout_block(db("t : ton"), {}).size == 16


def test_at_view_lies_on_its_target_and_takes_no_room():
    view = Member("v", to_type("ARRAY[0..3] OF BYTE"), at="w")
    block_ = Block(
        BlockKind.FB,
        "F",
        (Section(SectionKind.STATIC, (*members("b : BYTE", "w : DWORD"), view, *members("c : BYTE"))),),
    )
    layout = layout_block(block_, {})
    assert offsets(layout) == {"b": 0, "w": 16, "v": 16, "c": 48}
    assert locate(layout, "V[3]").offset == 40


@pytest.mark.parametrize(
    ("declarations", "path", "confirmed"),
    [
        (["x : BOOL", "w : WORD", "s : STRING[3]", "y : BOOL"], "y", True),
        (["b : BYTE", "a : ARRAY[1..3] OF WORD"], "a", True),  # a WORD starts even anyway
        (["b : BYTE", "a : ARRAY[1..2] OF BYTE"], "a", False),  # only literature moves it to byte 2
        (["a : ARRAY[1..3] OF BYTE", "w : WORD"], "w", True),  # the padding makes no difference
        (["a : ARRAY[1..3] OF BYTE", "b : BYTE"], "b", False),
        (["a : ARRAY[1..3] OF BYTE", "b : BYTE"], "a[3]", True),
        (["l : LREAL", "b : BYTE"], "l", True),
        (["l : LREAL", "b : BYTE"], "b", False),
        (["a : ARRAY[1..2] OF STRING[3]"], "a[1]", True),
        (["a : ARRAY[1..2] OF STRING[3]"], "a[2]", False),
        (["a : ARRAY[1..2,1..3] OF BOOL"], "a[2,1]", False),
        (["a : ARRAY[1..2,1..8] OF BOOL"], "a[2,1]", True),
        (["t : TON", "b : BYTE"], "b", False),
        (["p : POINTER", "b : BYTE"], "b", False),
    ],
)
def test_offsets_that_rest_on_literature_are_marked(declarations, path, confirmed):
    """A literature rule counts only where it changes the result."""
    assert confirmed is locate(layout_block(db(*declarations), {}), path).confirmed


def test_all_offsets_of_the_faq_blocks_are_confirmed():
    for name in ("DB3", "DB4", "DB5", "DB6"):
        built, types = block(cases()[name])
        assert all(entry.confirmed for entry in layout_block(built, types).entries)


def test_entries_follow_their_parent_and_leaves_take_arrays_apart():
    inner = Member("s", ArrayType(((1, 2),), StructType(members("x : BOOL", "t : STRING[2]"))))
    layout = layout_members((*members("a : ARRAY[0..1] OF BYTE"), inner), {})
    assert [e.path for e in layout.entries] == ["a", "s"]
    expected = [("a[0]", 0), ("a[1]", 8), ("s[1].x", 16), ("s[1].t", 32), ("s[2].x", 64), ("s[2].t", 80)]
    assert expected == [(e.path, e.offset) for e in leaves(layout)]
    udt = db("p : INT", "q : BOOL", kind=BlockKind.UDT, name="U")
    nested = layout_block(db("b : BYTE", "u : U"), {"U": udt})
    assert [(e.path, e.offset, e.depth) for e in nested.entries] == [
        ("b", 0, 0),
        ("u", 16, 0),
        ("u.p", 16, 1),
        ("u.q", 32, 1),
    ]


def test_quoted_names_and_bad_paths():
    layout = layout_members((Member("a.b", StructType(members("x y : INT"))), *members("v : ARRAY[1..2] OF INT")), {})
    assert [e.path for e in layout.entries] == ['"a.b"', '"a.b"."x y"', "v"]
    assert locate(layout, '#"A.B"."X Y"').offset == 0
    for path in ("", "w", "v[3]", "v[0]", "v[1,1]", "v.x", "[1]", "v[", "v..x", "v[1]x"):
        with pytest.raises(KeyError):
            locate(layout, path)
    assert split_path("a[1].b") == ["a", (1,), "b"]


def test_unknown_types_are_all_reported_with_place_and_suggestion():
    """Two faults in one block give two diagnostics; FCs are no types."""
    where = Span("x.scl", 3, 5)
    broken = (Member("a", NamedType("Motr"), span=where), Member("b", NamedType("F")))
    types = {"Motor": db("x : INT", kind=BlockKind.UDT), "F": Block(BlockKind.FC, "F", ())}
    with pytest.raises(DiagnosticError) as caught:
        layout_members(broken, types)
    first, second = caught.value.diagnostics
    assert ("PG806", where, 'did you mean "MOTOR"?') == (first.code, first.span, first.help)
    assert second.message == "F is FC, not a data type"


def test_other_refusals_have_their_codes():
    udt = Block(
        BlockKind.UDT,
        "A",
        (Section(SectionKind.STATIC, (Member("b", ArrayType(((0, 1),), NamedType("B"))),)),),
    )
    back = Block(BlockKind.UDT, "B", (Section(SectionKind.STATIC, (Member("a", NamedType("a")),)),))
    types = {"A": udt, "B": back}
    assert codes(layout_block, udt, types) == ["PG807"]
    assert codes(layout_block, db("x : A"), types) == ["PG807"]
    assert codes(layout_block, db("x : INT", "X : BOOL"), {}) == ["PG805"]
    assert codes(layout_block, fb(i=["x : INT"], t=["X : INT"]), {}) == ["PG805"]
    assert codes(layout_block, db("x : ARRAY[0..2147483647] OF LREAL"), {}) == ["PG808"]
    assert codes(layout_block, db("x : ARRAY[0..9] OF BYTE"), {}, 8) == ["PG808"]
    assert codes(layout_block, db("x : ARRAY[5..1] OF BYTE"), {}) == ["PG806"]
    assert codes(layout_block, db("x : STRING[255]"), {}) == ["PG806"]
    assert codes(layout_block, Block(BlockKind.DB, "d", (), instance_of="Nope"), {}) == ["PG806"]
    assert codes(layout_members, (Member("v", ELEMENTARY["BYTE"], at="w"),), {}) == ["PG806"]


def test_nesting_and_doubling_bombs_are_refused_at_once():
    deep = ELEMENTARY["INT"]
    for _ in range(500):
        deep = StructType((Member("s", deep),))
    assert codes(layout_members, (Member("d", deep),), {}) == ["PG808"]
    types = {"U0": db("x : VARIANT", kind=BlockKind.UDT)}
    for n in range(1, 50):
        types[f"U{n}"] = db(f"a : U{n - 1}", f"b : U{n - 1}", kind=BlockKind.UDT, name=f"U{n}")
    assert codes(layout_block, db("x : U49"), types) == ["PG808"]


@pytest.mark.slow
def test_layout_is_linear():
    """Four times the members take four times the work; arrays are not walked element by element."""
    works = []
    for count in (2_500, 10_000):
        block_ = db(*(f"m{n} : INT" for n in range(count)))
        layout, work = calls_of(lambda found=block_: layout_block(found, {}))
        assert layout.size == 2 * count
        assert layout_members(block_.sections[0].members, {}).entries[-1].offset == (count - 1) * 16
        works.append(work)
    assert works[1] < 5 * works[0]
    big = layout_block(db("a : ARRAY[0..1000000] OF STRING[10]"), {})
    assert next(leaves(big)).path == "a[0]"


elementary_types = st.sampled_from(sorted(ELEMENTARY)).map(lambda name: ELEMENTARY[name])
string_types = st.builds(StringType, st.sampled_from(["STRING", "WSTRING"]), st.integers(0, 20))
bounds = st.lists(
    st.tuples(st.integers(-3, 3), st.integers(0, 3)).map(lambda t: (t[0], t[0] + t[1])),
    min_size=1,
    max_size=2,
)


def named(types):
    return tuple(Member(f"m{n}", type_) for n, type_ in enumerate(types))


any_type = st.recursive(
    elementary_types | string_types,
    lambda inner: (
        st.builds(lambda b, t: ArrayType(tuple(b), t), bounds, inner)
        | st.lists(inner, min_size=1, max_size=4).map(lambda types: StructType(named(types)))
    ),
    max_leaves=6,
)


@pytest.mark.slow
@given(st.lists(any_type, min_size=1, max_size=8))
def test_members_never_overlap_stay_inside_and_are_aligned(types):
    """For any declaration: offsets ascend, leaves are disjoint, wide and composite types start even."""
    layout = layout_members(named(types), {})
    end = 0
    for entry in leaves(layout):
        assert end <= entry.offset
        end = entry.offset + entry.size
        if isinstance(entry.type, Elementary) and entry.size <= 8:
            assert entry.size == 1 or entry.offset % 8 == 0
        else:
            assert entry.offset % 16 == 0
        assert entry.offset == locate(layout, entry.path).offset
        assert entry.confirmed == locate(layout, entry.path).confirmed
    assert end <= layout.size * 8
    assert layout.size * 8 - end < 16 + 8 * 16
    assert layout.size % 2 == 0
    tops = [e for e in layout.entries if e.depth == 0]
    assert [e.offset for e in tops] == sorted(e.offset for e in tops)
    for entry in tops:
        if isinstance(entry.type, ArrayType | StructType):
            assert (entry.offset % 16, entry.size % 16) == (0, 0)


def test_the_s7_1500_record_blocks_can_be_merged_in_and_are_never_confirmed():
    """INDEX is a DINT and RECORD a VARIANT there; REQ 0.0, ID 2, INDEX 4, LEN 8, DONE 10.0, STATUS 12."""
    layout = layout_block(db("w : WRREC", "b : BYTE"), s7_1500_types())
    expected = {"w.REQ": 0, "w.ID": 16, "w.INDEX": 32, "w.LEN": 64, "w.DONE": 80, "w.STATUS": 96}
    assert expected == {path: locate(layout, path).offset for path in expected}
    assert to_type("DINT") == locate(layout, "w.INDEX").type
    assert [e.path for e in layout.entries if e.confirmed] == ["w"]


def test_a_user_type_with_the_name_of_a_timer_is_an_ordinary_type():
    layout = layout_block(db("t : TON", "b : BYTE"), {"TON": db("a : WORD", kind=BlockKind.UDT, name="TON")})
    assert locate(layout, "b").confirmed
