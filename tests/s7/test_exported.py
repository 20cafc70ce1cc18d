"""Offsets that an export states of its members, against the layout."""

from __future__ import annotations

from pathlib import Path

import pytest

import plcgen

_OFFSET = (
    '<AttributeList><IntegerAttribute Name="Offset" Informative="true" SystemDefined="true">{}</IntegerAttribute>'
    "</AttributeList>"
)


def _export(folder: Path, offsets: tuple[int, ...], layout: str = "Standard") -> Path:
    """A data block as the TIA Portal exports it with read-only attributes; offsets in bits."""
    start, level, inner, low, high, flags, last = (_OFFSET.format(bits) for bits in offsets)
    path = folder / "Buffer.xml"
    path.write_text(
        '<Document><SW.Blocks.GlobalDB ID="0"><AttributeList><Interface><Sections '
        'xmlns="http://www.siemens.com/automation/Openness/SW/Interface/v5"><Section Name="Static">'
        f'<Member Name="start" Datatype="Bool">{start}</Member>\n'
        f'<Member Name="level" Datatype="Int">{level}</Member>\n'
        f'<Member Name="inner" Datatype="Struct">{inner}<Member Name="low" Datatype="Byte">{low}</Member>\n'
        f'<Member Name="a.b" Datatype="DInt">{high}</Member></Member>\n'
        f'<Member Name="flags" Datatype="Array[0..2] of Bool">{flags}</Member>\n'
        f'<Member Name="last" Datatype="Bool">{last}</Member>\n'
        f"</Section></Sections></Interface><MemoryLayout>{layout}</MemoryLayout><Name>Buffer</Name><Number>7</Number>"
        "<ProgrammingLanguage>DB</ProgrammingLanguage></AttributeList></SW.Blocks.GlobalDB></Document>",
        "utf-8",
    )
    return path


HAND = (0, 16, 32, 32, 48, 80, 96)
"""0.0; 2.0 (INT on a word); 4.0, the structure on a word, with 4.0 and 6.0 (DINT on a word); 10.0 behind it; 12.0."""


@pytest.mark.parametrize("inside", [(32, 48), (0, 16)], ids=["from the block", "from the structure"])
def test_offsets_of_an_export_are_counted(tmp_path: Path, inside: tuple[int, int]) -> None:
    """All seven agree with what the rules of standard access give, whichever way those inside are counted."""
    result = plcgen.layout(_export(tmp_path, (*HAND[:3], *inside, *HAND[5:])))
    assert (result.diagnostics, result.agreed) == ((), 7)


def test_another_offset_is_told_once_for_a_block(tmp_path: Path) -> None:
    """The first member that lies elsewhere, the others as notes."""
    result = plcgen.layout(_export(tmp_path, (0, 48, 32, 32, 48, 80, 112)))
    (told,) = result.diagnostics
    assert (told.code, told.severity.label, told.span.line) == ("PG838", "warning", 2)
    assert told.message == '"level" of Buffer lies at 6.0 in the export, at 2.0 here'
    assert [note.message for note in told.notes] == ['"last": 14.0, here 12.0']
    assert result.agreed == 5


def test_an_optimized_block_has_no_offsets_to_compare(tmp_path: Path) -> None:
    """Nobody knows its layout, so nothing is claimed."""
    result = plcgen.layout(_export(tmp_path, HAND, "Optimized"))
    assert (result.diagnostics, result.agreed) == ((), 0)
