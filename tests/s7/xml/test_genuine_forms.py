"""What genuine exports have where Siemens' manuals are silent or plcgen once wrote something else, a case for each.

The fragments are written by hand from counts of public exports (docs/simaticml.md, "Evidence"), without IDs and without
the line breaks between elements. What is read besides is in reading/test_exports.py; that a default which an export
writes or not is no change, in tests/s7/compare.
"""

from __future__ import annotations

import re
from pathlib import Path

import pytest

import plcgen

HEAD = """FUNCTION_BLOCK "X"
{ S7_Optimized_Access := 'FALSE' }
VERSION : 0.1
VAR
  words : Array[0..3] of Word;
  bytes AT words : Array[0..7] of Byte;
  t {InstructionName := 'TON_TIME'; LibVersion := '1.0'} : TON_TIME;
  i : Int;
END_VAR
BEGIN
"""
OTHERS = """FUNCTION "Scale" : Void
VERSION : 0.1
BEGIN
;
END_FUNCTION
DATA_BLOCK "T1"
{InstructionName := 'TON_TIME'; LibVersion := '1.0'}
NON_RETAIN
TON_TIME
BEGIN
END_DATA_BLOCK
"""
NESTED = """DATA_BLOCK "X"
NON_RETAIN
STRUCT
  s : Array[0..1] of STRUCT
    a : Array[0..2] of Int;
    b : Array[0..1, 3..4] of Int;
  END_STRUCT;
END_STRUCT;
BEGIN
  s[0].a[1] := 5;
  s[1].b[0, 4] := 6;
END_DATA_BLOCK
"""
BRACKETS = '<Token Text="(" /><Token Text=")" />'
QUOTES = '<BooleanAttribute Name="HasQuotes">true</BooleanAttribute>'


def code(text: str) -> str:
    return f"{HEAD}{text}\nEND_FUNCTION_BLOCK\n"


def plain(path: Path) -> str:
    """A document without IDs and without what only lays it out."""
    return re.sub(r">\s+<", "><", re.sub(r' (?:UId|ID)="\w+"', "", path.read_text("utf-8-sig")))


WRITTEN = {
    "view (AT)": (code(";"), "V17", '<StringAttribute Name="At" SystemDefined="true">words</StringAttribute>'),
    "P# in code": (
        code("#i := F(P#I247.0 BYTE 20);"), "V20",
        '<Access Scope="LiteralConstant"><Constant><ConstantValue>P#I247.0 BYTE 20</ConstantValue></Constant></Access>',
    ),
    "start value in nested arrays": (
        NESTED, "V18",
        ('<Member Name="a" Datatype="Array[0..2] of Int"><Subelement Path="0,1"><StartValue>5</StartValue></Subelement>'
        '</Member><Member Name="b" Datatype="Array[0..1, 3..4] of Int"><Subelement Path="1,0,4">'
        "<StartValue>6</StartValue></Subelement></Member>"),
    ),
    "instruction of an instance": (
        code("#t.TON();"), "V18",
        ('<Access Scope="LocalVariable"><Symbol><Component Name="t" /></Symbol></Access><Token Text="." />'
        f'<Access Scope="Call"><Instruction Name="TON">{BRACKETS}</Instruction></Access>'),
    ),
    "instruction of an instance DB": (
        code('"T1".TON();'), "V17",
        ('<Access Scope="GlobalVariable"><Symbol><Component Name="T1" /></Symbol></Access><Token Text="." />'
        f'<Access Scope="Call"><Instruction Name="TON">{BRACKETS}</Instruction></Access>'),
    ),
    "call of an FC": (
        code('"Scale"();'), "V20",
        ('<Access Scope="Call"><CallInfo BlockType="FC"><Instance Scope="GlobalVariable"><Component Name="Scale" />'
        f"</Instance>{BRACKETS}</CallInfo></Access>"),
    ),
    "index": (
        code("#words[1] := 0;"), "V17",
        ('<Component Name="words"><Token Text="[" /><Access Scope="LiteralConstant"><Constant><ConstantValue>1'
        '</ConstantValue></Constant></Access><Token Text="]" /></Component>'),
    ),
    "global name up to V17": (
        code('"tag" := 1;'), "V17",
        '<Access Scope="GlobalVariable"><Symbol><Component Name="tag" /></Symbol></Access>',
    ),
    "global name from V18 on": (
        code('"tag" := 1;'), "V18",
        f'<Access Scope="GlobalVariable"><Symbol><Component Name="tag">{QUOTES}</Component></Symbol></Access>',
    ),
    "title of a REGION": (
        code("REGION Two words\n;\nEND_REGION"), "V19",
        '<Token Text="REGION" /><Blank /><Text>Two words</Text><NewLine />',
    ),
}  # fmt: skip


@pytest.mark.parametrize("row", WRITTEN)
def test_a_document_has_the_genuine_form(row: str, tmp_path: Path) -> None:
    """A source in, the elements of exports out."""
    text, version, fragment = WRITTEN[row]
    (tmp_path / "x.scl").write_text(OTHERS + text, "utf-8-sig")
    assert plcgen.convert(tmp_path / "x.scl", to="xml", out=tmp_path / "xml", version=version).diagnostics == ()
    assert fragment in plain(tmp_path / "xml" / "X.xml")


GENERATED = {
    "row of a watch table by name": (
        "Watch_Ramp.xml",
        (
            '<SW.WatchAndForceTables.PlcWatchTableEntry CompositionName="Entries"><AttributeList>'
            "<Name>&#34;DriveJobs&#34;.ramp.execute</Name></AttributeList></SW.WatchAndForceTables.PlcWatchTableEntry>"
        ),
    ),
    "access of an OB": ("Main.xml", "</Interface><MemoryLayout>Optimized</MemoryLayout><Name>Main</Name>"),
    "text in the languages of a project": (
        "Main.xml",
        (
            '<MultilingualText CompositionName="Title"><ObjectList><MultilingualTextItem CompositionName="Items">'
            "<AttributeList><Culture>de-DE</Culture><Text /></AttributeList></MultilingualTextItem>"
            '<MultilingualTextItem CompositionName="Items"><AttributeList><Culture>en-US</Culture><Text />'
            "</AttributeList></MultilingualTextItem></ObjectList></MultilingualText>"
        ),
    ),
}


@pytest.mark.parametrize("row", GENERATED)
def test_a_generated_document_has_the_genuine_form(row: str, tmp_path: Path) -> None:
    """A spec in: what no source can say."""
    spec = tmp_path / "job.yaml"
    spec.write_text(
        "plc: {name: P, family: s7-1500, toolchain: tia-v19, languages: [de-DE, en-US]}\n"
        "drives: {fan: {device: sinamics-g120, hardware_id: 270}}\n"
        "jobs: {ramp: {drive: fan, read: [P1120]}}\n",
        "utf-8",
    )
    assert plcgen.generate(spec, tmp_path / "out").ok
    name, fragment = GENERATED[row]
    assert fragment in plain(tmp_path / "out" / "xml" / name)
