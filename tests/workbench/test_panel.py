"""What a panel is given: names and addresses of members, beside the hover of a source and as data of a spec."""

from __future__ import annotations

from pathlib import Path

import pytest

from plcgen import api
from plcgen.s7.tables.tables import PanelTag
from plcgen.workbench.service.panel import tags_of
from tests.projects import ROOT
from tests.workbench.desk import Desk

DB = """\
DATA_BLOCK "Plant"
{ S7_Optimized_Access := 'FALSE' }
   STRUCT
      on : Bool;
      off : Bool;
      levels : Array[1..3] of Real;
      "two words" : Struct
         count : Int;
         name : String[6];
         wide : LReal;
      END_STRUCT;
   END_STRUCT;
BEGIN
END_DATA_BLOCK
"""
NUMBERED = DB.replace('"Plant"', "DB 7")


@pytest.mark.parametrize(
    ("member", "symbolic", "absolute"),
    [
        ("o|ff : Bool", '"DB7".off', "%DB7.DBX0.1"),
        ("le|vels : Array", '"DB7".levels', "%DB7.DBB2"),
        ("co|unt : Int", '"DB7"."two words".count', "%DB7.DBW14"),
        ("wi|de : LReal", '"DB7"."two words".wide', "%DB7.DBB24"),
    ],
)
def test_hover_says_how_a_panel_reaches_a_member(member: str, symbolic: str, absolute: str, desk: Desk) -> None:
    """Standard access by hand: two Bools in byte 0, a Real array from byte 2 (12 bytes), a structure from byte 14 with
    an Int of 2 and a String[6] of 8 bytes in front of the LReal.
    """
    text = NUMBERED.replace(member.replace("|", ""), member)
    found = desk.hover(text, "plant.db")
    assert f"symbolic (S7-1200/1500): {symbolic}" in found
    assert f"absolute: {absolute}" in found


@pytest.mark.parametrize(
    ("text", "why"),
    [
        (DB, "gives the block no number"),
        (NUMBERED.replace("'FALSE'", "'TRUE'"), "optimized access"),
    ],
)
def test_what_has_no_address_says_why(text: str, why: str, desk: Desk) -> None:
    """The name is there all the same."""
    found = desk.hover(text.replace("count : Int", "co|unt : Int"), "plant.db")
    assert '"two words".count' in found
    assert f"absolute: none: {why}" in found or f"absolute: none: this source {why}" in found


def test_addresses_of_the_faq() -> None:
    """FAQ 109750712: the request is DB3 (axis in byte 2, parameter number in word 6, subindex in word 8), the answer
    DB4 with the value in double word 6; elementary members alone, each once.
    """
    spec = ROOT / "specs/s7-300_6ra80_dp_tia.yaml"
    folder = ROOT / "examples" / spec.stem / "expected"
    sources = [(path.name, path.read_text("utf-8-sig")) for path in sorted(folder.glob("*.scl"))]
    project = api.check(spec).project
    assert project is not None
    found = tags_of(project, sources)
    request = {tag.absolute: tag for tag in found["WR_DataBuffer"]}
    assert {"%DB3.DBB2", "%DB3.DBW6", "%DB3.DBW8"} <= request.keys()
    assert request["%DB3.DBW8"].symbolic == '"WR_DataBuffer".Subindex'
    answer = next(tag for tag in found["RD_DataBuffer"] if tag.absolute == "%DB4.DBD6")
    assert answer == PanelTag('"RD_DataBuffer".ParameterValue', "%DB4.DBD6", "REAL", answer.comment)
    assert "DriveJobs" in found
    assert "DriveCalls_DB" not in found


@pytest.fixture
def desk(tmp_path: Path) -> Desk:
    """An empty folder."""
    return Desk(tmp_path)
