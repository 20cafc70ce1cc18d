"""Declarations of a source as blocks of the shared model."""

from __future__ import annotations

import pytest

from plcgen.s7.read.text import parse_source
from plcgen.s7.scl.constants import integer
from plcgen.s7.scl.parser import parse
from plcgen.s7.types.blocks import Assignment, Block, BlockKind, SectionKind
from plcgen.s7.types.data_types import ELEMENTARY, ArrayType, DataType, NamedType, StringType, StructType
from tests.s7.scl.support import source


def _blocks(text: str) -> list[Block]:
    blocks, diagnostics = parse_source(text, "t.scl")
    assert diagnostics == []
    return blocks


def _member_type(text: str) -> DataType:
    (block,) = _blocks(f"TYPE a STRUCT x : {text}; END_STRUCT; END_TYPE")
    return block.section(SectionKind.STATIC)[0].type


def test_the_read_request_of_the_example() -> None:
    """DB3 with number, header, start values as written, comments and the override behind BEGIN."""
    db3 = _blocks(source("faq_buffers.db"))[0]
    assert (db3.kind, db3.name, db3.number, db3.title) == (BlockKind.DB, "DB3", 3, "read request")
    assert (db3.optimized, db3.non_retain, db3.instance_of) == (False, True, None)
    assert db3.attributes == {"VERSION": "0.1"}
    members = db3.section(SectionKind.STATIC)
    assert [(m.name, m.type, m.start, m.comment) for m in members] == [
        ("Request_Ref", ELEMENTARY["BYTE"], "16#03", "mirrored by the drive"),
        ("Request_ID", ELEMENTARY["BYTE"], "B#16#01", ""),
        ("Axis", ELEMENTARY["BYTE"], "16#02", ""),
        ("Num_of_Para", ELEMENTARY["BYTE"], "16#01", ""),
        ("Para_Attribute", ELEMENTARY["BYTE"], "16#10", ""),
        ("Num_of_Element", ELEMENTARY["BYTE"], "16#01", ""),
        ("Para_No", ELEMENTARY["WORD"], "16#C47F", "P50303"),
        ("Subindex", ELEMENTARY["WORD"], None, ""),
    ]
    assert [(a.path, a.literal) for a in db3.assignments] == [("Request_Ref", "16#04")]
    span = members[0].span
    assert span is not None
    assert (span.line, span.column, span.end_column) == (8, 7, 18)


def test_the_other_buffers_of_the_example() -> None:
    """A VAR body, several names in one declaration, and an instance DB of an SFB."""
    _, db4, request, db53 = _blocks(source("faq_buffers.db"))
    assert db4.section(SectionKind.STATIC)[-1].type == ELEMENTARY["REAL"]
    assert [m.name for m in request.section(SectionKind.STATIC)[:4]] == [
        "Request_Ref", "Request_ID", "Axis", "Num_of_Para",
    ]  # fmt: skip
    assert request.number is None
    assert (db53.instance_of, db53.number, db53.sections) == ("SFB53", 53, ())


def test_the_job_for_step7_v5() -> None:
    """CONST gives typed constants and array bounds, AT stays with its member, LABEL is no section."""
    block, function = _blocks(source("job_v5.scl"))
    assert (block.kind, block.number, block.title, block.optimized) == (
        BlockKind.FB, 471, "Read one parameter", None,
    )  # fmt: skip
    assert block.attributes == {"VERSION": "1.0", "AUTHOR": "plcgen", "FAMILY": "ds47", "NAME": "ReadOne"}
    constants = block.section(SectionKind.CONSTANT)
    assert [(m.name, m.start) for m in constants] == [
        ("IDLE", "0"), ("WRITING", "1"), ("READING", "2"), ("HEADER", "4"), ("LAST", "HEADER + 6 - 1"),
    ]  # fmt: skip
    static = {m.name: m for m in block.section(SectionKind.STATIC)}
    assert static["answer"].type == ArrayType(((0, 9),), ELEMENTARY["BYTE"])
    assert static["answer"].start == "10(B#16#0)"
    assert static["bits"].at == "raw"
    assert (function.kind, function.number, function.section(SectionKind.RETURN)) == (BlockKind.FC, 471, ())


def test_the_job_for_s7_1500() -> None:
    """UDT, nested structures with comments, instances by library, RETAIN sections and attributes."""
    udt, block, main = _blocks(source("job_t15.scl"))
    value, status, errors = udt.section(SectionKind.STATIC)
    assert (value.comment, status.type, errors.comment) == (
        "as the drive sent it", ELEMENTARY["DWORD"], "one per parameter",
    )  # fmt: skip
    assert isinstance(errors.type, ArrayType)
    assert isinstance(errors.type.element, StructType)
    assert [(m.name, m.start) for m in errors.type.element.members] == [("number", "-1"), ("index", None)]
    assert (block.optimized, block.title) == (False, "Don't call it in OB100")
    assert block.comment == "One job at a time\nper drive"
    assert block.attributes == {"S7_m_c": "x", "AUTHOR": "plcgen", "FAMILY": "ds47", "VERSION": "1.2"}
    static = {m.name: m for m in block.section(SectionKind.STATIC)}
    assert list(static) == ["ref", "wr", "rd", "pause", "request", "view", "name", "state"]
    assert (static["wr"].type, static["rd"].type) == (NamedType("WRREC"), NamedType("RDREC"))
    assert static["request"].start == "[16#01, 16#01, 2(16#02), 6(16#00)]"
    assert static["view"].at == "request"
    assert static["name"].type == StringType("STRING", 14)
    assert block.section(SectionKind.IN_OUT)[0].type == NamedType("drive_result", quoted=True)
    assert main.section(SectionKind.TEMP)[0].name == "Drehzahl_größe"
    assert main.optimized is True


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("bool", ELEMENTARY["BOOL"]),
        ("Date_And_Time", ELEMENTARY["DATE_AND_TIME"]),
        ("TOD", ELEMENTARY["TIME_OF_DAY"]),
        ("STRING", StringType("STRING", 254)),
        ("WString[16]", StringType("WSTRING", 16)),
        ("ARRAY [ -2 .. 3 , 1..16#4] OF INT", ArrayType(((-2, 3), (1, 4)), ELEMENTARY["INT"])),
        ("ARRAY[*] OF INT", ArrayType((), ELEMENTARY["INT"])),
        (
            "ARRAY[0..1] OF ARRAY[0..2] OF CHAR",
            ArrayType(((0, 1),), ArrayType(((0, 2),), ELEMENTARY["CHAR"])),
        ),
        ("UDT 3", NamedType("UDT3")),
        ('"my type"', NamedType("my type", quoted=True)),
        ("STRUCT END_STRUCT", StructType(())),
        ('REF_TO "t"', NamedType('REF_TO "t"')),
    ],
)
def test_types(text: str, expected: DataType) -> None:
    """Types by any spelling become one value of the model."""
    assert expected == _member_type(text)


@pytest.mark.parametrize(
    "text", ["[2(0)]", "(1,2,3)", "1, 2(0), 3", "(32, (), TRUE)", "(a := 1, b := (c := 'x'))", "#MAX", "(1 + 2) * 3"]
)
def test_start_values_stay_as_written(text: str) -> None:
    """A start value is the text of the source, whatever its form."""
    (block,) = _blocks(f"TYPE a STRUCT x : INT := {text}; y : INT; END_STRUCT; END_TYPE")
    assert [m.start for m in block.section(SectionKind.STATIC)] == [text, None]


def test_assignments_behind_begin_keep_their_paths() -> None:
    """Indices, quotes and nested members stay as written."""
    text = 'DATA_BLOCK "d" { S7_Optimized_Access := \'TRUE\' } "t"\nBEGIN\n a[3]."b c".x := -1;\nEND_DATA_BLOCK'
    (block,) = _blocks(text)
    assert [(a.path, a.literal) for a in block.assignments] == [('a[3]."b c".x', "-1")]
    assert isinstance(block.assignments[0], Assignment)
    assert (block.instance_of, block.optimized) == ("t", True)


def test_a_data_block_has_one_static_section_for_each_retentivity() -> None:
    """Retentive and other variables of a global DB lie behind each other; neighbours of one kind are together."""
    text = (
        "DATA_BLOCK a VAR RETAIN x : INT; END_VAR VAR y : INT; END_VAR VAR z : INT; END_VAR VAR RETAIN END_VAR "
        "BEGIN END_DATA_BLOCK"
    )
    (block,) = _blocks(text)
    assert [(s.retain, [m.name for m in s.members]) for s in block.sections] == [("RETAIN", ["x"]), ("", ["y", "z"])]
    assert [m.name for m in block.section(SectionKind.STATIC)] == ["x", "y", "z"]


@pytest.mark.parametrize(
    ("text", "high"),
    [
        ("7 DIV 2", 3), ("-7 DIV 2 + 10", 7), ("-7 MOD 4 + 10", 7), ("7 / 2 * 2", 6), ("2 ** 3 - 1", 7),
        ("+(N + 1) * 2", 12), ("INT#3 + 16#10", 19),
    ],
)  # fmt: skip
def test_constant_expressions_divide_like_the_compiler(text: str, high: int) -> None:
    """DIV and MOD round towards zero, and names of CONST count whatever their case."""
    (block,) = _blocks(
        f"FUNCTION_BLOCK a CONST n := 5; LAST := {text}; END_CONST VAR x : ARRAY[0..last] OF INT; END_VAR "
        "END_FUNCTION_BLOCK"
    )
    (member,) = block.section(SectionKind.STATIC)
    assert member.type == ArrayType(((0, high),), ELEMENTARY["INT"])


@pytest.mark.parametrize("text", ["2 ** 1000000000", "1 DIV 0", "1 MOD 0", "2 ** 63 * 4", "1.5", "f(1)", "NOT 1"])
def test_what_is_no_integer_constant_is_no_bound(text: str) -> None:
    """Powers without end, divisions by zero and other values are refused, quickly."""
    _, diagnostics = parse_source(f"TYPE a STRUCT x : ARRAY[0..{text}] OF INT; END_STRUCT; END_TYPE", "t.scl")
    assert [d.code for d in diagnostics] == ["PG801"]


def test_a_function_returns_a_member_called_ret_val() -> None:
    """The return type is a section of its own; VAR of a function is temporary."""
    (block,) = _blocks('FUNCTION "f" : Int\nVAR t : Bool; END_VAR\nEND_FUNCTION')
    assert [(m.name, m.type) for m in block.section(SectionKind.RETURN)] == [("Ret_Val", ELEMENTARY["INT"])]
    assert [m.name for m in block.section(SectionKind.TEMP)] == ["t"]


def test_a_number_comes_from_an_unquoted_name_only() -> None:
    """``"DB3"`` is a symbol, ``DB 3`` and ``%DB3`` are numbers; FB3 is no number for a DB."""
    names = ['"DB3"', "DB3", "DB 3", "%DB3", "FB3"]
    text = "\n".join(f"DATA_BLOCK {n} STRUCT x : INT; END_STRUCT BEGIN END_DATA_BLOCK" for n in names)
    assert [(b.name, b.number) for b in _blocks(text)] == [
        ("DB3", None), ("DB3", 3), ("DB3", 3), ("DB3", 3), ("FB3", None),
    ]  # fmt: skip


def test_comments_at_the_end_of_a_line_belong_to_the_member() -> None:
    """Line comments and block comments count, comments on their own line do not."""
    text = "TYPE a STRUCT\n x : INT; // one\n // alone\n y : INT; (* two *)\n z : INT;\n END_STRUCT; END_TYPE"
    (block,) = _blocks(text)
    assert [m.comment for m in block.section(SectionKind.STATIC)] == ["one", "two", ""]


def test_members_named_like_keywords() -> None:
    """NAME, VERSION, TO and quoted words are fine as members; header words are properties only in the header."""
    (block,) = _blocks(
        "TYPE a\nNAME : x; // y\n"
        'STRUCT Begin : INT; Name : STRING[4]; Version : INT; To : INT; "END_IF" : INT; END_STRUCT; END_TYPE'
    )
    assert block.attributes == {"NAME": "x"}
    assert [m.name for m in block.section(SectionKind.STATIC)] == ["Begin", "Name", "Version", "To", "END_IF"]


def test_words_of_a_section_header_may_be_members() -> None:
    """RETAIN behind VAR is a modifier unless it is declared."""
    (block,) = _blocks("FUNCTION_BLOCK a\nVAR Retain : INT; END_VAR\nVAR RETAIN x : INT; END_VAR\nEND_FUNCTION_BLOCK")
    assert [m.name for m in block.section(SectionKind.STATIC)] == ["Retain", "x"]


def test_a_title_is_free_to_the_end_of_its_line() -> None:
    """Slashes belong to the title and not to the comment of the block."""
    (block,) = _blocks("FUNCTION_BLOCK a\nTITLE = x // y\n// z\nVERSION : 0.1\nEND_FUNCTION_BLOCK")
    assert (block.title, block.comment, block.attributes) == ("x // y", "z", {"VERSION": "0.1"})


def test_blocks_survive_errors_in_their_neighbourhood() -> None:
    """What could be read is there although other declarations are wrong."""
    blocks, diagnostics = parse_source("TYPE a STRUCT x : ; y : INT; END_STRUCT; END_TYPE", "t.scl")
    assert [m.name for m in blocks[0].section(SectionKind.STATIC)] == ["y"]
    assert [d.code for d in diagnostics] == ["PG801"]


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("10", 10), ("1_000", 1000), ("16#FF", 255), ("2#1010_0101", 165), ("8#17", 15), ("INT#-5", -5),
        ("W#16#B02E", 0xB02E), ("T#5s", None), ("16#G", None), ("", None), ("9" * 60, None),
    ],
)  # fmt: skip
def test_integer_literals(text: str, value: int | None) -> None:
    """The value of every spelling, None for what is no integer."""
    assert value == integer(text)


@pytest.mark.parametrize(
    "text", ["abc : INT := 16#5;", "abc : INT;", "abc, d : INT := 16#5;", "abc {S7_x := 'y'} : INT;"]
)
def test_a_declaration_ends_before_its_semicolon(text):
    """Whether it is read in one step or piece by piece."""
    (unit,) = parse(f"FUNCTION_BLOCK F\nVAR\n{text}\nEND_VAR\nBEGIN\nEND_FUNCTION_BLOCK\n", "x.scl").units
    (declaration,) = unit.sections[0].declarations
    whole = f"FUNCTION_BLOCK F\nVAR\n{text}"
    assert whole[declaration.start : declaration.end] == text[:-1]
