"""SCL -> SimaticML -> SCL gives the same text or tokens; SimaticML -> SCL -> SimaticML the same document."""

from __future__ import annotations

import re
import tempfile
from dataclasses import replace
from pathlib import Path

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from plcgen import api
from plcgen.base.diagnostics import Severity
from plcgen.s7.layout.image import image
from plcgen.s7.layout.layout import layout_block
from plcgen.s7.scl.declarations import blocks
from plcgen.s7.scl.lexer import ERROR, tokenize
from plcgen.s7.scl.parser import parse
from plcgen.s7.types.data_types import ELEMENTARY
from plcgen.s7.xml.reading.documents import read_simaticml
from plcgen.s7.xml.reading.source import source
from plcgen.s7.xml.spelling import VERSIONS
from plcgen.s7.xml.writing.documents import Setting, document
from plcgen.s7.xml.writing.elements import BlockScope
from plcgen.s7.xml.writing.structured_text import elements, numbered
from tests.projects import ROOT, SPECS, TARGETS, every_type, per_block
from tests.s7.xml.codes import SETTING, back, exact, meant, network, read_code, wrapped
from tests.s7.xml.test_structured_text import CASES
from tests.yaml_files import read_yaml


def cases(name: str) -> list:
    return list(read_yaml((ROOT / f"tests/s7/scl/cases/{name}.yaml").read_text("utf-8")))


def block_of(text: str):
    found, diagnostics = blocks(parse(text, "x"))
    assert [d for d in diagnostics if d.severity is Severity.ERROR] == []
    return found[0]


@pytest.fixture(scope="module")
def generated(tmp_path_factory: pytest.TempPathFactory) -> dict[str, tuple[Path, bool]]:
    """Output folders of all specs and of every data type, and whether the CPU is an S7-300/400."""
    base = tmp_path_factory.mktemp("round")
    specs = {spec.stem: spec.read_text("utf-8") for spec in SPECS if "step7" not in spec.read_text("utf-8")}
    specs |= {target: every_type(target) for target in ("t3", "t15", "t12")}
    assert {TARGETS[t][0] for t in ("t3", "t15", "t12")} == {"s7-400", "s7-1500", "s7-1200"}
    for name, text in specs.items():
        (base / f"{name}.yaml").write_text(per_block(text), "utf-8")
        assert api.generate(base / f"{name}.yaml", base / name).ok
    return {name: (base / name, re.search("family: s7-[34]00", text) is not None) for name, text in specs.items()}


def without_begin_comments(text: str) -> str:
    """A document has no place for comments behind BEGIN of a data block."""
    if not text.startswith("DATA_BLOCK"):
        return text
    head, begin, tail = text.partition("\nBEGIN\n")
    return head + begin + re.sub(r"  // .*", "", tail)


@pytest.mark.slow
def test_every_generated_source_comes_back_as_the_same_text(generated: dict[str, tuple[Path, bool]]) -> None:
    """UDT, DB, instance DB, FB, OB of all targets: text -> document -> text is the identity."""
    seen = 0
    for folder, classic in generated.values():
        files = [p for name in ("udt", "db", "scl") for p in sorted((folder / name).iterdir())]
        texts = [path.read_text("utf-8-sig") for path in files]
        read = [block_of(text) for text in texts]
        known = {block.name.upper(): block for block in read}
        for text, block in zip(texts, read, strict=True):
            code = network(block.code, BlockScope.of(block, read)) if block.code is not None else ""
            written, lost = document(block, Setting(VERSIONS["V17"], classic), code, known)
            again, diagnostics = read_simaticml(written.encode(), classic=classic)
            assert (lost, diagnostics) == ([], [])
            assert source(again[0], known) == without_begin_comments(text)
            seen += 1
    assert seen > 150


@pytest.mark.slow
def test_every_generated_code_document_comes_back_as_its_source(generated: dict[str, tuple[Path, bool]]) -> None:
    """The documents on disk say what the text sources on disk say, and give the same document again."""
    for folder, classic in generated.values():
        read = [block_of(path.read_text("utf-8-sig")) for path in (folder / "db").glob("*.db")]
        for path in (folder / "scl").glob("*.scl"):
            data = (folder / "xml" / f"{path.stem}.xml").read_bytes()
            found, diagnostics = read_simaticml(data, classic=classic)
            assert diagnostics == []
            assert source(found[0]) == path.read_text("utf-8-sig")
            old = data.decode("utf-8-sig")
            begin, stop = old.index("<StructuredText"), old.index("</StructuredText>")
            setting = Setting(VERSIONS[re.findall('Engineering version="([^"]+)"', old)[0]], classic)
            written = network(found[0].code or "", BlockScope.of(found[0], read), setting)
            assert written == old[begin:stop].partition(">\n")[2]


@pytest.mark.parametrize("code", CASES)
def test_constructs_come_back(code: str) -> None:
    """Every construct of the writer's table: tokens in the TIA Portal's dialect are the same."""
    again, diagnostics = back(code)
    assert diagnostics == []
    assert meant(again) == meant(code)
    assert wrapped(again) == wrapped(code)


CODES = [f"r := {case[1]};" for case in cases("expressions")] + [case[1] for case in cases("statements")]
CODES += [case["code"] for case in cases("idioms") if "code" in case]


@pytest.mark.parametrize("code", CODES)
def test_the_cases_of_the_front_end_come_back(code: str) -> None:
    """All expressions, statements and idioms that the parser's tests know, layout and comments included."""
    again, diagnostics = back(code)
    assert diagnostics == []
    assert meant(again) == meant(code)
    twice, _ = back(again)
    assert twice == again
    assert wrapped(twice) == wrapped(again)


FLAT = """(* block comment
   over lines *)
IF #start AND NOT ("DB".x[#i, 2].y > 3.5E-3) THEN   // why
    #data.inner."a b" := "F"(IN := -1, x => #i) + REAL_TO_INT(IN := #r);

    "DB"."z" := W#16#FF XOR #LIMIT;
ELSIF #data.bits.%X3 & (#list[#i + 1] <> -1) THEN
    CASE #i OF
        1, 3..5:   // labels
            #timer(IN := #start,
                   PT := T#1s_500ms,
                   Q => "out");
        #LIMIT: ;
    ELSE
        GOTO done;
    END_CASE;
END_IF;
REGION Title with (odd signs; and 'quotes
    FOR #i := 0 TO 10 BY 2 DO
        CONTINUE;
    END_FOR;
    WHILE TRUE DO EXIT; END_WHILE;
    REPEAT ; UNTIL #i >= 3 END_REPEAT;
END_REGION
%MW2 := %IW4:P;
%DB3.DBX2.7 := "tag":P;
done: ENO := FALSE;
#s := 'it$'s // no (* comment *)';
POKE(area := 16#84, dbNumber := 3, byteOffset := #i, value := B#16#1);
RETURN;
"""


@pytest.mark.parametrize("code", [FLAT, FLAT.replace("\n", "\n\n"), FLAT.replace("    ", " "), "", "\n", ";", "  ;  "])
def test_handwritten_code_comes_back_as_the_same_text(code: str) -> None:
    """Comments, blanks and line breaks are kept to the last."""
    text = f'FUNCTION_BLOCK "X"\nVERSION : 0.1\n\nBEGIN\n{code}\nEND_FUNCTION_BLOCK\n' if code.strip() else None
    block = block_of(text) if text else None
    again, diagnostics = back(code)
    assert diagnostics == []
    assert again == code
    if block is not None and text is not None:
        written, lost = document(block, SETTING, network(block.code or ""))
        assert lost == []
        found, _ = read_simaticml(written.encode())
        assert source(found[0]).replace("{ S7_Optimized_Access := 'TRUE' }\n", "") == text


names = st.sampled_from(
    ["#a", "#b", '"T"', '"DB".x', "#l[1]", "#s.%X0", '#"q r"', "#l[#a, -1].m", "%MW2", '"t":P', '#v."w x"']
)
numbers = st.sampled_from(["1", "-1", "16#FF", "3.5", "1E3", "TRUE", "'x$'y'", "T#1s", "W#16#1", "L#-3"])
gaps = st.sampled_from([" ", "  ", "\n", "\n\n  ", " (* c *) ", " // c\n", "\n\n\n"])


def calls(inner: st.SearchStrategy[str]) -> st.SearchStrategy[str]:
    argument = st.tuples(st.sampled_from(["", "IN := ", "Q => ", "IN:="]), inner).map("".join)
    arguments = st.lists(argument, max_size=3).flatmap(lambda a: gaps.map(lambda gap: f",{gap}".join(a)))
    return st.tuples(st.sampled_from(["SHL", "#f", '"F"', '"X_DB"', "ABS"]), arguments).map(lambda p: f"{p[0]}({p[1]})")


def operations(inner: st.SearchStrategy[str]) -> st.SearchStrategy[str]:
    signs = st.sampled_from(["+", "-", "*", "/", "AND", "or", "<>", ">=", "&", "MOD", "**"])
    parts = st.tuples(inner, gaps, signs, gaps, inner).map("".join)
    return st.one_of(parts, parts.map(lambda t: f"({t})"), inner.map(lambda t: f"NOT {t}"), calls(inner))


expressions = st.recursive(st.one_of(names, numbers), operations, max_leaves=8)
simple = st.tuples(names, gaps, st.just(":="), gaps, expressions, st.sampled_from([";", " ;"])).map("".join)
regions = st.tuples(st.sampled_from(["REGION a b\n", "REGION x := 'y;\n"]), simple, st.just("\nEND_REGION")).map(
    "".join
)
whens = st.tuples(expressions, simple).map(lambda p: f"IF {p[0]} THEN\n  {p[1]}\nELSE {p[1]} END_IF;")
statements = st.one_of(simple, regions, whens, calls(expressions).map(lambda c: f"{c};"))
codes = st.lists(st.tuples(statements, gaps).map("".join), max_size=5).map("\n".join)


@pytest.mark.slow
@given(codes)
def test_any_code_comes_back(code: str) -> None:
    """Random code: the same text but for tabs, and the same document again."""
    again, diagnostics = back(code)
    assert diagnostics == []
    assert exact(again) == exact(code)
    assert wrapped(again) == wrapped(code)


@example("_[D[")
@example('"a".')
@example("f(")
@example("#a[1")
@given(st.text(st.sampled_from("#ab\"'.[]()%X0:=;,-> \n\t/*{}^EIFND_TR1$<&"), max_size=40))
def test_any_text_becomes_a_document_that_can_be_read(code: str) -> None:
    """Whatever stands in a body: a well-formed document, no exception, and the tokens that are some come back."""
    again, _ = read_code(wrapped(code))
    if ERROR not in tokenize(code, "x").kinds and "REGION" not in code:
        assert [t.replace(" ", "") for t in meant(again)] == [t.replace(" ", "") for t in meant(code)]


DRAWN = """<?xml version="1.0" encoding="utf-8"?>
<Document><Engineering version="V18" /><SW.Blocks.FC ID="0"><AttributeList>
<Interface><Sections xmlns="http://www.siemens.com/automation/Openness/SW/Interface/v5">
<Section Name="Return"><Member Name="Ret_Val" Datatype="Void" /></Section></Sections></Interface>
<MemoryLayout>Optimized</MemoryLayout><Name>F</Name><Number>1</Number></AttributeList><ObjectList>
<SW.Blocks.CompileUnit ID="1" CompositionName="CompileUnits"><AttributeList><NetworkSource>
<StructuredText xmlns="http://www.siemens.com/automation/Openness/SW/NetworkSource/StructuredText/v4">{}</StructuredText>
</NetworkSource></AttributeList></SW.Blocks.CompileUnit></ObjectList></SW.Blocks.FC></Document>"""

GENUINE = {
    '<Access Scope="LocalVariable"><Symbol><Component Name="G" SliceAccessModifier="x1" /></Symbol></Access>': "#G.%X1",
    '<Access Scope="GlobalVariable"><Symbol><Component Name="PC" /><Component Name="T" AccessModifier="Array">'
    '<Access Scope="LiteralConstant"><Constant><ConstantType>DInt</ConstantType><ConstantValue>1</ConstantValue>'
    "</Constant></Access></Component></Symbol></Access>": '"PC".T[1]',
    '<Access Scope="Call"><CallInfo Name="FC_Init" BlockType="FC" UId="23" /></Access>': '"FC_Init"()',
    '<Access Scope="Call"><CallInfo BlockType="FC"><Instance Scope="GlobalVariable"><Component Name="Scale" />'
    '</Instance><Token Text="(" /><Token Text=")" /></CallInfo></Access>': '"Scale"()',
    '<Access Scope="LocalVariable"><Symbol><Component Name="t" /></Symbol></Access><Token Text="." />'
    '<Access Scope="Call"><Instruction Name="TON"><Token Text="(" /><Token Text=")" /></Instruction>'
    "</Access>": "#t.TON()",
    '<Access Scope="LiteralConstant"><Constant><ConstantValue>P# M10.0 WORD 4</ConstantValue></Constant>'
    "</Access>": "P#M10.0 WORD 4",
    '<Access Scope="AddressConstant"><Constant><ConstantValue>P#M10.0</ConstantValue></Constant></Access>': "P#M10.0",
    '<Access Scope="LocalConstant"><Constant Name="N"><BooleanAttribute Name="HasQuotes">true</BooleanAttribute>'
    "</Constant></Access>": '#"N"',
    '<Access Scope="Call"><CallInfo BlockType="FB"><Instance Scope="LocalVariable"><Component Name="m" /></Instance>'
    '<Parameter Name="a"><Access Scope="LocalVariable"><Symbol><Component Name="x" /></Symbol></Access></Parameter>'
    '<Parameter Name="b c"><Access Scope="GlobalConstant"><Constant Name="MAX" /></Access></Parameter></CallInfo>'
    "</Access>": '#m(a := #x, "b c" := "MAX")',
    '<LineComment Inserted="true" NoClosingBracket="true"><Text> a</Text></LineComment>': "(* a*)",
    "<LineComment><Text>a\nFALSE;</Text></LineComment>": "(*a\nFALSE;*)",
    '<LineComment Inserted="true"><Text>a *) evil (* b</Text></LineComment>': "(*a * ) evil ( * b*)",
    '<Comment><MultiLanguageText Lang="en-US">a</MultiLanguageText></Comment>': "//a",
    '<Comment Inserted="true"><MultiLanguageText Lang="en-US">a */) b</MultiLanguageText></Comment>': "(/*a * /) b*/)",
    '<Access Scope="Expression"><Expression><Token Text="(" /><Token Text=")" /></Expression></Access>': "()",
    '<Access Scope="Undef"><Symbol><Component Name="x" /></Symbol></Access>': '"x"',
    '<Access Scope="LocalVariable"><Symbol><Component Name="a&quot;; x := &quot;" />'
    "</Symbol></Access>": '#"a_; x := _"',
    '<Access Scope="LocalConstant"><Constant Name="for" /></Access>': '#"for"',
    '<Access Scope="LocalVariable"><Symbol><Component Name="Array" /></Symbol></Access>': "#Array",
    '<Access Scope="GlobalVariable"><Symbol><Component Name="a" /><Token Text="." /><Component Name="b">'
    '<BooleanAttribute Name="HasHash">true</BooleanAttribute></Component></Symbol></Access>': '"a".#b',
}


@pytest.mark.parametrize("xml", GENUINE)
def test_forms_that_the_writer_does_not_use(xml: str) -> None:
    """Other forms that documents have are understood; names and comments cannot become code."""
    found, diagnostics = read_simaticml(DRAWN.format(xml).encode())
    assert diagnostics == []
    assert found[0].code == GENUINE[xml]


def test_units_of_a_whole_source_keep_their_declarations() -> None:
    """Retentive sections, views, attributes, structures, arrays with start values, a function with a result."""
    text = """FUNCTION "Scale" : Real
{ S7_Optimized_Access := 'TRUE' }
VERSION : 1.2
// first line
// second line

VAR_INPUT
  x { S7_SetPoint := 'False'} : Int;  // in
END_VAR

BEGIN
#Scale := INT_TO_REAL(#x);
END_FUNCTION
"""
    block = block_of(text)
    written, lost = document(block, SETTING, network(block.code or "", BlockScope.of(block)))
    assert lost == []
    assert 'Datatype="Real"' in written
    found, diagnostics = read_simaticml(written.encode())
    assert diagnostics == []
    assert source(found[0]) == text.replace("{ S7_SetPoint := 'False'}", "{S7_SetPoint := 'False'}")
    fb = """FUNCTION_BLOCK "Keep"
{ S7_Optimized_Access := 'FALSE' }
VERSION : 0.1
VAR RETAIN
  words : Array[0..3] of Word := [1, 2, 0, 4];
  view AT words : Array[0..7] of Byte;
END_VAR

VAR
  data : STRUCT  // both
    flag : Bool := TRUE;
    lines : Array[1..2] of String[8] := ['a', 'b'];
    inner : Array[0..1] of STRUCT
      x : Int;
    END_STRUCT;
  END_STRUCT;
  "odd name" : "typeX";
  t {InstructionName := 'TON_TIME'; LibVersion := '1.0'} : TON_TIME;
END_VAR

BEGIN
;
END_FUNCTION_BLOCK
"""
    block = block_of(fb)
    written, lost = document(block, SETTING, network(block.code or ""))
    assert lost == []
    assert '<StringAttribute Name="At" SystemDefined="true">words</StringAttribute>' in written
    found, diagnostics = read_simaticml(written.encode())
    assert diagnostics == []
    assert source(found[0]) == fb


def test_start_values_of_data_blocks() -> None:
    """Values of arrays, structures and user types, declared and assigned, are those of the text."""
    types = 'TYPE "U"\nVERSION : 0.1\n  STRUCT\n    a : Int;\n    b : Array[1..2] of Real;\n  END_STRUCT;\nEND_TYPE\n'
    text = """DATA_BLOCK "D"
{ S7_Optimized_Access := 'FALSE' }
VERSION : 0.1
NON_RETAIN
  STRUCT
    u : "U";
    us : Array[0..1] of "U";
    s : STRUCT
      p : Array[0..2, 1..2] of Int := [1, 2, 3(7)];
      q : Char := 'x';
    END_STRUCT;
  END_STRUCT;

BEGIN
  u.a := 5;
  u.b[2] := 1.5;
  us[1].a := 6;
  s.q := 'y';
END_DATA_BLOCK
"""
    udt, db = block_of(types), block_of(text)
    written, lost = document(db, SETTING, "", {"U": udt})
    assert lost == []
    found, diagnostics = read_simaticml(written.encode())
    assert diagnostics == []
    assert image(found[0], {"U": udt}) == image(db, {"U": udt})
    again = block_of(source(found[0]))
    assert image(again, {"U": udt}) == image(db, {"U": udt})


LISTS = """  us : Array[0..1] of STRUCT
    q : Array[0..2] of Int := [1, 2, 3];
    one : Int := 7;
    r : STRUCT
      z : Array[4..5, 0..0] of Int := [2(4)];
    END_STRUCT;
  END_STRUCT;
"""


def test_a_list_inside_an_array_is_written_for_each_of_its_elements() -> None:
    """Exports name the indices of all arrays: us[0] and us[1] have three values of q and two of z, one value of one."""
    block = block_of(f'DATA_BLOCK "D"\nNON_RETAIN\nVAR\n{LISTS}END_VAR\nBEGIN\n  us[1].q[2] := 9;\nEND_DATA_BLOCK\n')
    written, lost = document(block, SETTING)
    assert lost == []
    assert re.findall(r'Path="([^"]*)">\s*<StartValue>(\d)', written) == [
        ("0,0", "1"), ("0,1", "2"), ("0,2", "3"), ("1,0", "1"), ("1,1", "2"), ("1,2", "9"),
        ("0,4,0", "4"), ("0,5,0", "4"), ("1,4,0", "4"), ("1,5,0", "4"),
    ]  # fmt: skip
    assert re.findall(r'Name="one" [^>]*>\s*<StartValue>(.*)</StartValue>', written) == ["7"]
    found, diagnostics = read_simaticml(written.encode())
    assert diagnostics == []
    assert image(found[0], {}) == image(block, {})


def test_lists_inside_an_array_of_a_function_block_and_of_its_instance_come_back() -> None:
    """An FB has no lines behind BEGIN: what all elements have is a list again; the instance adds what differs."""
    fb = """FUNCTION_BLOCK "F"\n{ S7_Optimized_Access := 'FALSE' }\nVERSION : 0.1\n"""
    fb += f"VAR\n{LISTS}END_VAR\n\nBEGIN\n;\n"
    block = block_of(f"{fb}END_FUNCTION_BLOCK\n")
    written, lost = document(block, SETTING, network(";"))
    again, diagnostics = read_simaticml(written.encode())
    assert (lost, diagnostics) == ([], [])
    assert source(again[0]) == f"{fb}END_FUNCTION_BLOCK\n"
    db = 'DATA_BLOCK "D"\n{ S7_Optimized_Access := \'FALSE\' }\nVERSION : 0.1\nNON_RETAIN\n"F"\nBEGIN\n'
    db += "  us[0].q[1] := 8;\n  us[1].one := 3;\nEND_DATA_BLOCK\n"
    instance = replace(block_of(db), sections=block.sections)
    written, lost = document(instance, SETTING, types={"F": block})
    again, diagnostics = read_simaticml(written.encode(), classic=True)
    assert (lost, diagnostics) == ([], [])
    assert source(again[0], {"F": block}) == db


@pytest.mark.slow
def test_lists_inside_absurd_arrays_are_bounded() -> None:
    """Start values of more elements than 100,000 are left out, with a word; it takes no time."""
    for bounds in ("0..1999999999", "0..40000, 0..40000"):
        inner = f"q : Array[{bounds}] of Int := [1, 2, 3]; "
        text = (
            f'DATA_BLOCK "D"\nVAR\n us : Array[{bounds}] of STRUCT {inner}END_STRUCT;\nEND_VAR\nBEGIN\nEND_DATA_BLOCK\n'
        )
        written, lost = document(blocks(parse(text, "x"))[0][0], SETTING)
        assert lost == ["start values: the block has more than 100000"]
        assert written.count("<Subelement") == 100_000


values = st.integers(0, 2).map(str)
lists = st.lists(values, min_size=1, max_size=3).map(", ".join)
declared = st.recursive(
    st.one_of(
        values.map(lambda value: f"Int := {value};"),
        lists.map(lambda listed: f"Array[1..3] of Int := [{listed}];"),
        st.tuples(lists, values).map(lambda p: f"Array[0..1, 4..6] of Int := [3({p[1]}), {p[0]}];"),
        st.just("Array[0..1] of Bool;"),
    ),
    lambda inner: st.tuples(
        st.sampled_from(["", "Array[0..1] of ", "Array[-1..0, 1..2] of "]), st.lists(inner, min_size=1, max_size=3)
    ).map(lambda p: f"{p[0]}STRUCT {' '.join(f'm{n} : {m}' for n, m in enumerate(p[1]))} END_STRUCT;"),
    max_leaves=8,
)


@pytest.mark.slow
@given(st.lists(declared, min_size=1, max_size=3), st.data())
def test_any_start_values_come_back(members: list[str], data: st.DataObject) -> None:
    """Lists in structures in arrays, with other values behind BEGIN: the same bytes, and nothing that differs."""
    head = "DATA_BLOCK \"D\"\n{ S7_Optimized_Access := 'FALSE' }\nVAR\n"
    head += "".join(f"m{n} : {member}\n" for n, member in enumerate(members)) + "END_VAR\nBEGIN\n"
    places = [
        e.path for e in layout_block(block_of(f"{head}END_DATA_BLOCK\n"), {}).entries if e.type == ELEMENTARY["INT"]
    ]
    chosen = data.draw(st.lists(st.tuples(st.sampled_from(places), values), max_size=4)) if places else []
    text = head + "".join(f"{path} := {value};\n" for path, value in chosen) + "END_DATA_BLOCK\n"
    block = block_of(text)
    written, lost = document(block, SETTING)
    found, diagnostics = read_simaticml(written.encode())
    assert (lost, diagnostics) == ([], [])
    again = block_of(source(found[0]))
    assert image(found[0], {}) == image(again, {}) == image(block, {})
    with tempfile.TemporaryDirectory() as folder:
        for name, content in (("old.db", text), ("new.xml", written), ("again.db", source(found[0]))):
            (Path(folder) / name).write_text(content, "utf-8-sig")
        for new in ("new.xml", "again.db"):
            changes = api.diff(Path(folder) / "old.db", Path(folder) / new).changes
            assert [c for c in changes if c.kind == "start-value"] == []


def test_the_whole_of_a_code_is_written_by_elements_of_offsets() -> None:
    """A part of a source is written by its offsets, with the trivia at both ends."""
    text = "#a := 1; // x\n"
    assert numbered(elements(tokenize(text, "x"), 8, 13, BlockScope(), SETTING)) == (
        '<Blank UId="21" /><LineComment UId="22"><Text UId="23"> x</Text></LineComment>'
    )
