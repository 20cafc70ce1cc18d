"""Load-memory images: start values at true offsets, assignments on top."""

from __future__ import annotations

import contextlib
import dataclasses

import pytest

from plcgen.s7.layout.image import StartValueError, image, read_member, write_member
from plcgen.s7.layout.layout import layout_block
from plcgen.s7.types.blocks import Assignment, Block, BlockKind, Section, SectionKind
from plcgen.s7.types.data_types import ELEMENTARY, ArrayType, Member, NamedType, StructType
from tests.layout_vectors import block, cases, db, members


def starts_of(case):
    """Literals that give the anchors of a compiled block, by declaration path (no index)."""
    literals = {"BOOL": lambda _: "TRUE", "INT": lambda h: str(int(h, 16)), "WORD": lambda h: f"W#16#{h}"}
    literals["REAL"] = lambda h: {"3f800000": "1.0"}[h]
    found = {}
    for anchor in case.get("anchors", ()):
        name, _, rest = anchor["path"].partition("[")
        path = name + rest.partition("]")[2]
        if not anchor["type"].startswith("STRING"):
            found[path] = literals[anchor["type"]](anchor["bytes"])
    return found


@pytest.mark.parametrize("name", [name for name, case in cases().items() if case.get("anchors")])
def test_start_values_lie_where_step7_compiled_them(name):
    """The declared start values give the bytes found in the compiled image; all else is zero."""
    case = cases()[name]
    starts = starts_of(case)
    if name == "c063":
        starts = {"m1": "3 (W#16#3)"}
    memory = image(*block(case, starts))
    assert case["size"] == len(memory)
    for anchor in case["anchors"]:
        byte = anchor["offset"] // 8
        if anchor["type"] == "BOOL":
            assert memory[byte] >> anchor["offset"] % 8 & 1
        else:
            data = bytes.fromhex(anchor["bytes"])
            assert data == memory[byte : byte + len(data)]


def test_the_read_request_of_the_faq():
    """DB3 of FAQ 109750712 with the watch-table values of its figure 5-1: 03 01 02 01 10 01 C4 7F 00 00."""
    built, types = block(cases()["DB3"])
    rows = {"Request_Ref": "16#03", "Request_ID": "16#01", "Axis": "16#02", "Num_of_Para": "16#01"}
    rows |= {"Para_Attribute": "16#10", "Num_of_Element": "16#01", "Para_No": "50303", "Subindex": "16#0000"}
    filled = dataclasses.replace(built, assignments=tuple(Assignment(*row) for row in rows.items()))
    memory = image(filled, types)
    assert memory.hex() == "030102011001c47f0000"
    assert read_member(memory, layout_block(built, types), "para_no") == 50303


@pytest.mark.parametrize(
    ("declaration", "data"),
    [
        ("a : ARRAY[1..3] OF INT := [1, 2, 3]", "000100020003"),
        ("a : ARRAY[1..3] OF INT := 1, 2", "000100020000"),
        ("a : ARRAY[1..3] OF INT := [2(7)]", "000700070000"),
        ("a : ARRAY[1..4] OF BYTE := 2(B#16#1, B#16#2)", "01020102"),
        ("a : ARRAY[1..3] OF INT := [, 5]", "000000050000"),
        ("a : ARRAY[1..2] OF REAL := 2 (0.5)", "3f0000003f000000"),
        ("a : ARRAY[0..8] OF BOOL := [TRUE, 7(FALSE), TRUE]", "0101"),
        ("a : ARRAY[1..2,1..3] OF BOOL := [2(FALSE, TRUE, TRUE)]", "0606"),
        ("a : ARRAY[1..2,1..2] OF BYTE := [[1, 2], [3, 4]]", "01020304"),
        ("a : ARRAY[1..2] OF STRING[2] := ['a,b', 'c']", None),
        ("a : ARRAY[1..2] OF STRING[2] := ['a', '(']", "020161000201" + "2800"),
        ("a : CHAR", "2000"),
        ("a : DATE_AND_TIME", "9001010000000002"),
        ("a : ARRAY[1..3] OF CHAR := 'a'", "61202000"),
        ("a : WORD := W#16#12", "0012"),
        ("a : INT := 1, 2", None),
        ("a : INT := [1]", None),
        ("a : ARRAY[1..3] OF INT := [4(0)]", None),
        ("a : ARRAY[1..3] OF INT := [99999999999(0)]", None),
        ("a : ARRAY[1..3] OF INT := [1, 2", None),
        ("a : ARRAY[1..2] OF INT := [1] 2", None),
    ],
)
def test_start_values_of_one_member(declaration, data):
    """Hand-written bytes; None where the value does not fit."""
    if data is None:
        with pytest.raises(StartValueError) as caught:
            image(db(declaration), {})
        assert caught.value.path == "a"
    else:
        assert data == image(db(declaration), {}).hex()


def test_structure_initialisers_positional_and_named():
    """Surprises of real sources: ``(32, (), TRUE)``."""
    inner = StructType(members("p : INT := 9"))
    outer = StructType((*members("n : INT"), Member("s", inner), *members("b : BOOL")))

    def data(start):
        return image(Block(BlockKind.DB, "d", (Section(SectionKind.STATIC, (Member("x", outer, start),)),)), {}).hex()

    assert data(None) == "000000090000"
    assert data("(32, (), TRUE)") == "002000090100"
    assert data("(b := TRUE, s := (p := 5))") == "000000050100"
    assert data("(, (7))") == "000000070000"
    with pytest.raises(StartValueError, match="no such member"):
        data("(q := 1)")
    with pytest.raises(StartValueError, match="more than 3"):
        data("(1, (2), TRUE, 4)")


def test_arrays_of_structures_take_the_defaults_of_their_type():
    """A UDT's own start values, then the array's, then the assignments."""
    udt = db("a : INT := 5", "b : BYTE := B#16#7", kind=BlockKind.UDT, name="U")
    member = Member("x", ArrayType(((1, 3),), NamedType("U", quoted=True)), "[(1, 2), 1((3))]")
    assignments = (Assignment("x[3].b", "B#16#FF"), Assignment("X[1].A", "-1"))
    built = Block(BlockKind.DB, "d", (Section(SectionKind.STATIC, (member,)),), assignments=assignments)
    assert image(built, {"u": udt}).hex() == "ffff0200" + "00030700" + "0005ff00"


def test_instance_db_has_its_fbs_start_values_and_its_own_assignments():
    fb = Block(
        BlockKind.FB,
        "F",
        (
            Section(SectionKind.IN_OUT, members("p : STRING[4]")),
            Section(SectionKind.STATIC, members("n : INT := 3", "m : INT")),
        ),
    )
    db_ = Block(BlockKind.DB, "i", (), instance_of="F", assignments=(Assignment("m", "4"),))
    assert image(db_, {"F": fb}).hex() == "000000000000" + "0003" + "0004"


def test_a_wrong_assignment_names_its_path():
    for path, literal in (("b", "1"), ("a[4]", "1"), ("a[1]", "x"), ("a[1]", "(1, 2)")):
        built = dataclasses.replace(db("a : ARRAY[1..3] OF INT"), assignments=(Assignment(path, literal),))
        with pytest.raises(StartValueError) as caught:
            image(built, {})
        assert path == caught.value.path


def test_members_read_back_as_values_lists_and_dicts():
    member = Member(
        "s",
        StructType(members("x : BOOL := TRUE", "t : STRING[4] := 'ab'", "a : ARRAY[0..1,0..1] OF INT := [1,2,3]")),
    )
    built = Block(BlockKind.DB, "d", (Section(SectionKind.STATIC, (*members("f : BOOL", "g : BOOL"), member)),))
    layout, memory = layout_block(built, {}), image(built, {})
    assert read_member(memory, layout, "s") == {"x": True, "t": "ab", "a": [1, 2, 3, 0]}
    assert read_member(memory, layout, "s.a[1,0]") == 3
    write_member(memory, layout, "g", True)
    write_member(memory, layout, "s.a[1,1]", -2)
    assert tuple(read_member(memory, layout, p) for p in ("f", "g", "s.a[1,1]")) == (False, True, -2)
    assert memory[0] == 2
    with pytest.raises(ValueError, match="outside"):
        write_member(memory, layout, "s.a[1,1]", 40000)


def test_views_write_no_defaults_over_their_target():
    """A view of CHARs would otherwise put blanks (16#20) over the start value of the WORD."""
    view = Member("v", ArrayType(((0, 1),), ELEMENTARY["CHAR"]), at="w")
    built = Block(BlockKind.FB, "F", (Section(SectionKind.STATIC, (*members("w : WORD := 16#1234"), view)),))
    assert image(built, {}).hex() == "1234"


def test_a_structured_in_out_keeps_no_start_value():
    """It is a pointer, zero until the first call, whatever the declaration says."""
    built = Block(BlockKind.FB, "F", (Section(SectionKind.IN_OUT, members("a : ARRAY[0..1] OF INT := [1, 2]")),))
    assert image(built, {}).hex() == "00" * 6


def test_a_pointer_parameter_keeps_its_start_value():
    """P#M50.0: DB 0, area 16#83, bit address 400 = 16#190."""
    assert image(db("p : POINTER := P#M50.0"), {}).hex() == "000083000190"


def test_repetition_bombs_end_at_once():
    """Nothing is written out beyond the size of the array."""
    for start in ("[1000000000(1)]", "[9999(9999(9999()))]", "[99999(99999(99999(1, 2)))]"):
        with contextlib.suppress(StartValueError):
            assert len(image(db(f"a : ARRAY[1..9999] OF INT := {start}"), {})) == 2 * 9999
