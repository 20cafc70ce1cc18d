"""SCL code as StructuredText: every construct has the elements of genuine exports, and no text is lost."""

from __future__ import annotations

import re

import pytest

from plcgen.s7.scl.declarations import blocks
from plcgen.s7.scl.parser import parse
from plcgen.s7.xml.spelling import VERSIONS
from plcgen.s7.xml.writing.documents import Setting
from plcgen.s7.xml.writing.elements import BlockScope
from plcgen.s7.xml.writing.structured_text import elements, numbered

DECLARATIONS = """
VAR_INPUT start : Bool; "my input" : Int; END_VAR
VAR
  list : Array[0..9] of Int;
  data : Struct inner : "typeX"; bits : Word; ton : "Motor"; END_STRUCT;
  timer {InstructionName := 'TON_TIME'; LibVersion := '1.0'} : TON_TIME;
  timers : Array[1..3] of IEC_TIMER;
  motor : "Motor";
  motors : Array[1..3] of "Motor";
END_VAR
VAR_TEMP i : Int; ref : REF_TO Int; END_VAR
VAR CONSTANT LIMIT : Int := 5; END_VAR
"""


def written(code: str, version: str = "V17") -> str:
    """Elements without UIds, where ``~`` is a Blank."""
    result = parse(f'FUNCTION_BLOCK "X"\n{DECLARATIONS}BEGIN\n{code}\nEND_FUNCTION_BLOCK\n', "x.scl")
    others = parse(
        'DATA_BLOCK "Drive1"\n"Motor"\nBEGIN\nEND_DATA_BLOCK\nDATA_BLOCK "T1"\nTON_TIME\nBEGIN\nEND_DATA_BLOCK', "y"
    )
    block, known = blocks(result)[0][0], blocks(others)[0]
    tokens = parse(code, "code").tokens
    text = numbered(
        elements(tokens, 0, len(code), BlockScope.of(block, known), Setting(VERSIONS[version], classic=False))
    )
    uids = [int(uid) for uid in re.findall(r'UId="(\d+)"', text)]
    assert uids == list(range(21, 21 + len(uids)))
    text = re.sub(r' UId="\d+"', "", text)
    return text.replace("<Blank />", "~").replace("\n", "")


def local(name: str) -> str:
    return f'<Access Scope="LocalVariable"><Symbol><Component Name="{name}" /></Symbol></Access>'


def number(text: str, scope: str = "LiteralConstant") -> str:
    return f'<Access Scope="{scope}"><Constant><ConstantValue>{text}</ConstantValue></Constant></Access>'


def token(text: str) -> str:
    return f'<Token Text="{text}" />'


DOT = '<Token Text="." />'
CASES = {
    "#i := 1;": f"{local('i')}~{token(':=')}~{number('1')}{token(';')}",
    "#i := -1;": f"{local('i')}~{token(':=')}~{number('-1')}{token(';')}",
    "#i := - 1;": f"{local('i')}~{token(':=')}~{token('-')}~{number('1')}{token(';')}",
    "#i-1": f"{local('i')}{token('-')}{number('1')}",
    "(#i) -1": f"{token('(')}{local('i')}{token(')')}~{token('-')}{number('1')}",
    "#LIMIT": '<Access Scope="LocalConstant"><Constant Name="LIMIT" /></Access>',
    "T#10s": number("T#10s", "TypedConstant"),
    "W#16#FF": number("W#16#FF", "TypedConstant"),
    "16#FF 3.5E-3 TRUE 'it$'s'": "~".join(map(number, ["16#FF", "3.5E-3", "TRUE", "'it$'s'"])),
    "P#DB3.DBX0.0 BYTE 10": number("P#DB3.DBX0.0 BYTE 10"),
    '"tag"': '<Access Scope="GlobalVariable"><Symbol><Component Name="tag" /></Symbol></Access>',
    '#"my input"': local("my input"),
    '#"start"': '<Access Scope="LocalVariable"><Symbol><Component Name="start">'
    '<BooleanAttribute Name="HasQuotes">true</BooleanAttribute></Component></Symbol></Access>',
    '"DB"."a b".c': '<Access Scope="GlobalVariable"><Symbol><Component Name="DB" />'
    f'{DOT}<Component Name="a b" />{DOT}<Component Name="c" /></Symbol></Access>',
    "#list[#i + 1]": '<Access Scope="LocalVariable"><Symbol><Component Name="list">'
    f"{token('[')}{local('i')}~{token('+')}~{number('1')}{token(']')}</Component></Symbol></Access>",
    "#data.bits.%X3": '<Access Scope="LocalVariable"><Symbol><Component Name="data" />'
    f'{DOT}<Component Name="bits" />{DOT}<Token Text="%X3" /></Symbol></Access>',
    "#ref^": f'<Access Scope="LocalVariable"><Symbol><Component Name="ref" />{token("^")}</Symbol></Access>',
    '"in":P': '<Access Scope="GlobalVariable"><Symbol>'
    '<Component Name="in" SimpleAccessModifier="Periphery" /></Symbol></Access>',
    "%DB3.DBW6": '<Access Scope="Address"><Address Area="DB" Type="Word" BlockNumber="3" BitOffset="48" /></Access>',
    "%M50.1": '<Access Scope="Address"><Address Area="Memory" Type="Bool" BitOffset="401" /></Access>',
    "%IW256:P": '<Access Scope="Address"><Address Area="PeripheryInput" Type="Word" BitOffset="2048" /></Access>',
    "ENO": '<Access Scope="PredefinedVariable"><PredefinedVariable Name="ENO" /></Access>',
    "if #start then": f"{token('IF')}~{local('start')}~{token('THEN')}",
    "INT_TO_REAL(#i)": f'<Access Scope="Call"><Instruction Name="INT_TO_REAL">{token("(")}'
    f"<NamelessParameter>{local('i')}</NamelessParameter>{token(')')}</Instruction></Access>",
    "SHL(IN := #i, N := 8)": f'<Access Scope="Call"><Instruction Name="SHL">{token("(")}'
    f'<Parameter Name="IN">~{token(":=")}~{local("i")}</Parameter>{token(",")}~'
    f'<Parameter Name="N">~{token(":=")}~{number("8")}</Parameter>{token(")")}</Instruction></Access>',
    "#t.#start": '<Access Scope="LocalVariable"><Symbol><Component Name="t" />'
    f'{DOT}<Component Name="start"><BooleanAttribute Name="HasHash">true</BooleanAttribute></Component></Symbol>'
    "</Access>",
    "#data.VAR.Type": '<Access Scope="LocalVariable"><Symbol><Component Name="data" />'
    f'{DOT}<Component Name="VAR" />{DOT}<Component Name="Type" /></Symbol></Access>',
    "SHL_WORD(#i)": '<Access Scope="Call"><Instruction Name="SHL">'
    f'<TemplateValue Name="value_type" Type="Type">Word</TemplateValue>{token("(")}'
    f"<NamelessParameter>{local('i')}</NamelessParameter>{token(')')}</Instruction></Access>",
    "TRUNC_LINT(#i)": '<Access Scope="Call"><Instruction Name="TRUNC">'
    f'<TemplateValue Name="dest_type" Type="Type">LInt</TemplateValue>{token("(")}'
    f"<NamelessParameter>{local('i')}</NamelessParameter>{token(')')}</Instruction></Access>",
    'SHL("IN" := 1, "a b" := 2)': f'<Access Scope="Call"><Instruction Name="SHL">{token("(")}'
    '<Parameter Name="IN"><BooleanAttribute Name="HasQuotes">true</BooleanAttribute>'
    f'~{token(":=")}~{number("1")}</Parameter>{token(",")}~'
    f'<Parameter Name="a b">~{token(":=")}~{number("2")}</Parameter>{token(")")}</Instruction></Access>',
    "TIME_TCK()": f'<Access Scope="Call"><Instruction Name="TIME_TCK">{token("(")}{token(")")}</Instruction></Access>',
    '"Scale"(a := 1)': f'<Access Scope="Call"><CallInfo BlockType="FC"><Instance Scope="GlobalVariable">'
    f'<Component Name="Scale" /></Instance>{token("(")}'
    f'<Parameter Name="a">~{token(":=")}~{number("1")}</Parameter>{token(")")}</CallInfo></Access>',
    "#motor()": '<Access Scope="Call"><CallInfo Name="Motor" BlockType="FB"><Instance Scope="LocalVariable">'
    f'<Component Name="motor" /></Instance>{token("(")}{token(")")}</CallInfo></Access>',
    "#motors[1]()": '<Access Scope="Call"><CallInfo Name="Motor" BlockType="FB"><Instance Scope="LocalVariable">'
    f'<Component Name="motors">{token("[")}{number("1")}{token("]")}</Component></Instance>'
    f"{token('(')}{token(')')}</CallInfo></Access>",
    '"Drive1"()': '<Access Scope="Call"><CallInfo Name="Motor" BlockType="FB"><Instance Scope="GlobalVariable">'
    f'<Component Name="Drive1" /></Instance>{token("(")}{token(")")}</CallInfo></Access>',
    "#timer(IN := #start)": f'{local("timer")}<Access Scope="Call"><Instruction>{token("(")}'
    f'<Parameter Name="IN">~{token(":=")}~{local("start")}</Parameter>{token(")")}</Instruction></Access>',
    "#timer.TON(IN := #start)": f'{local("timer")}{DOT}<Access Scope="Call"><Instruction Name="TON">{token("(")}'
    f'<Parameter Name="IN">~{token(":=")}~{local("start")}</Parameter>{token(")")}</Instruction></Access>',
    '"T1" . TP()': '<Access Scope="GlobalVariable"><Symbol><Component Name="T1" /></Symbol></Access>'
    f'~{DOT}~<Access Scope="Call"><Instruction Name="TP">{token("(")}{token(")")}</Instruction></Access>',
    "#timers[1].TOF()": '<Access Scope="LocalVariable"><Symbol><Component Name="timers">'
    f'{token("[")}{number("1")}{token("]")}</Component></Symbol></Access>{DOT}<Access Scope="Call">'
    f'<Instruction Name="TOF">{token("(")}{token(")")}</Instruction></Access>',
    "#data.ton()": '<Access Scope="Call"><CallInfo Name="Motor" BlockType="FB"><Instance Scope="LocalVariable">'
    f'<Component Name="data" />{DOT}<Component Name="ton" /></Instance>{token("(")}{token(")")}</CallInfo></Access>',
    '"T1"(Q => #start)': '<Access Scope="GlobalVariable"><Symbol><Component Name="T1" /></Symbol></Access>'
    f'<Access Scope="Call"><Instruction>{token("(")}<Parameter Name="Q">~{token("=&gt;")}~{local("start")}</Parameter>'
    f"{token(')')}</Instruction></Access>",
    "// a <b>": "<LineComment><Text> a &lt;b&gt;</Text></LineComment>",
    "(* a *)": '<LineComment Inserted="true"><Text> a </Text></LineComment>',
    "/* a */": '<LineComment Inserted="true"><Text> a </Text></LineComment>',
    "(/* a */)": '<Comment Inserted="true"><MultiLanguageText Lang="en-US"> a </MultiLanguageText></Comment>',
    "REGION one; two // x\nEND_REGION": f"{token('REGION')}~<Text>one; two // x</Text><NewLine />{token('END_REGION')}",
    "REGION two blanks  \n END_REGION the end \n": f'{token("REGION")}~<Text>two blanks  </Text><NewLine />~'
    f'{token("END_REGION")}~<Text>the end </Text><NewLine />',
    "REGION a\nEND_REGION ;\n;": f"{token('REGION')}~<Text>a</Text><NewLine />{token('END_REGION')}~<Text>;</Text>"
    f"<NewLine />{token(';')}",
    "GOTO out;\nout: ;": f'{token("GOTO")}~<Access Scope="Label"><Label Name="out" /></Access>{token(";")}<NewLine />'
    f'<Access Scope="Label"><Label Name="out" /></Access>{token(":")}~{token(";")}',
    "EXIT;\n\n\n  EXIT;": f'{token("EXIT")}{token(";")}<NewLine Num="3" /><Blank Num="2" />{token("EXIT")}{token(";")}',
}  # fmt: skip


@pytest.mark.parametrize("code", CASES)
def test_construct(code: str) -> None:
    """One construct, the elements of its document."""
    assert written(code) == CASES[code]


def quoted(name: str) -> str:
    return f'<Component Name="{name}"><BooleanAttribute Name="HasQuotes">true</BooleanAttribute></Component>'


QUOTED = {
    '"tag"': f'<Access Scope="GlobalVariable"><Symbol>{quoted("tag")}</Symbol></Access>',
    '"DB".a': f'<Access Scope="GlobalVariable"><Symbol>{quoted("DB")}{DOT}<Component Name="a" /></Symbol></Access>',
    '"Var".a': f'<Access Scope="GlobalVariable"><Symbol>{quoted("Var")}{DOT}<Component Name="a" /></Symbol></Access>',
    '"D B"': '<Access Scope="GlobalVariable"><Symbol><Component Name="D B" /></Symbol></Access>',
    '"Drive1"()': '<Access Scope="Call"><CallInfo Name="Motor" BlockType="FB"><Instance Scope="GlobalVariable">'
    f"{quoted('Drive1')}</Instance>{token('(')}{token(')')}</CallInfo></Access>",
    '"Scale"()': '<Access Scope="Call"><CallInfo BlockType="FC"><Instance Scope="GlobalVariable">'
    f'<Component Name="Scale" /></Instance>{token("(")}{token(")")}</CallInfo></Access>',
    '"T1".TON()': f'<Access Scope="GlobalVariable"><Symbol>{quoted("T1")}</Symbol></Access>{DOT}'
    f'<Access Scope="Call"><Instruction Name="TON">{token("(")}{token(")")}</Instruction></Access>',
    "#list": local("list"),
    '#"LIMIT"': '<Access Scope="LocalConstant"><Constant Name="LIMIT">'
    '<BooleanAttribute Name="HasQuotes">true</BooleanAttribute></Constant></Access>',
}


@pytest.mark.parametrize("code", QUOTED)
def test_global_names_say_from_v18_on_that_they_stand_in_quotes(code: str) -> None:
    """A name that needs its quotes does not say so, nor does that of an FC; V17 says it of local names only."""
    assert written(code, "V18") == written(code, "V21") == QUOTED[code]
    if code[0] == '"':
        assert "HasQuotes" not in written(code, "V17")


def test_a_comment_that_can_be_translated_is_in_the_language_of_its_document() -> None:
    """A project without English has no place for an English comment."""
    tokens = parse("(/* a */)", "code").tokens
    setting = Setting(VERSIONS["V19"], classic=False, cultures=("de-DE",))
    assert '<MultiLanguageText Lang="de-DE"' in elements(tokens, 0, 9, BlockScope(), setting)
