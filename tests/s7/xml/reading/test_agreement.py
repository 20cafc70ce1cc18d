"""The same block read from text and from SimaticML lies in memory the same way."""

from __future__ import annotations

from plcgen.s7.layout.image import image
from plcgen.s7.layout.layout import layout_block
from plcgen.s7.read.text import parse_source
from plcgen.s7.xml.reading.documents import read_simaticml
from tests.s7.xml.reading.documents import FB_SECTIONS, document, function_block, global_db, sections

SOURCE = """
FUNCTION_BLOCK "Job"
{ S7_Optimized_Access := 'FALSE' }
VERSION : 0.1
VAR_INPUT
  execute : Bool;
END_VAR
VAR_IN_OUT
  request : Array[0..9] of Byte;
END_VAR
VAR
  phase : Byte := 16#5;
  wr {InstructionName := 'WRREC'; LibVersion := '1.1'} : WRREC;
  names : Array[1..2] of String[3] := ['ab', 'c'];
END_VAR
BEGIN
END_FUNCTION_BLOCK
DATA_BLOCK "Buffer"
{ S7_Optimized_Access := 'FALSE' }
VERSION : 0.1
STRUCT
  head : Struct
    ref : Byte := 16#1;
    flags : Array[0..9] of Bool;
  END_STRUCT;
  value : Real := 10.0;
END_STRUCT;
BEGIN
END_DATA_BLOCK
"""


def test_text_and_xml_give_the_same_offsets_and_bytes():
    """Job: IN 0, IN_OUT pointer 2..7, phase 8, wr 10..35, names 36 (stride 6), 48 bytes; Buffer: 0, 2, 4, 8 bytes."""
    static = (
        '<Member Name="phase" Datatype="Byte"><StartValue>16#5</StartValue></Member>'
        '<Member Name="wr" Datatype="WRREC" Version="1.1" />'
        '<Member Name="names" Datatype="Array[1..2] of String[3]">'
        "<Subelement Path=\"1\"><StartValue>'ab'</StartValue></Subelement>"
        "<Subelement Path=\"2\"><StartValue>'c'</StartValue></Subelement></Member>"
    )
    groups = FB_SECTIONS | {
        "Input": '<Member Name="execute" Datatype="Bool" />',
        "InOut": '<Member Name="request" Datatype="Array[0..9] of Byte" />',
        "Static": static,
    }
    buffer = (
        '<Member Name="head" Datatype="Struct"><Member Name="ref" Datatype="Byte"><StartValue>16#1</StartValue>'
        '</Member><Member Name="flags" Datatype="Array[0..9] of Bool" /></Member>'
        '<Member Name="value" Datatype="Real"><StartValue>10.0</StartValue></Member>'
    )
    from_text, diagnostics = parse_source(SOURCE, "x.scl")
    assert diagnostics == []
    documents = (document(function_block(sections(**groups))), document(global_db(buffer, name="Buffer")))
    from_xml = [read_simaticml(data)[0][0] for data in documents]
    expected = [
        {"execute": 0, "request": 2, "phase": 8, "wr": 10, "names": 36},
        {"head": 0, "value": 4},
    ]
    for text, xml, offsets, size in zip(from_text, from_xml, expected, (48, 8), strict=True):
        one, two = layout_block(text, {}), layout_block(xml, {})
        assert offsets == {e.path: e.byte for e in one.entries if e.depth == 0}
        assert size == one.size == two.size
        places = [[(e.path, e.offset, e.size, e.confirmed) for e in layout.entries] for layout in (one, two)]
        assert places[0] == places[1]
        assert image(text, {}) == image(xml, {})
    assert image(from_xml[1], {}).hex() == "0100000041200000"
