"""TIA SCL rewritten for the older compilers: pairs written by hand, from the manuals of both."""

from __future__ import annotations

import pytest

from plcgen.s7.scl.classic import Spelling, respell

STEP7_V5: dict[str, tuple[str, str]] = {
    "local names carry no #": (
        'IF #statState = #STATE_IDLE AND NOT #"x".busy THEN\n  "Db".a[#i + 1] := #in.member;\nEND_IF;\n',
        'IF statState = STATE_IDLE AND NOT "x".busy THEN\n  "Db".a[i + 1] := in.member;\nEND_IF;\n',
    ),
    "comments and strings are no code": (
        "#a := 'Int #b';  // #c : Int of Array (see REGION)\n(* #d *) #e := 1;\n",
        "a := 'Int #b';  // #c : Int of Array (see REGION)\n(* #d *) e := 1;\n",
    ),
    "type words are upper case, names are not": (
        'VAR\n  word : Array[0..9] of DInt;  // Int\n  int : Time := T#5ms;\n  time : "Int";\nEND_VAR\n',
        'VAR\n  word : ARRAY[0..9] OF DINT;  // Int\n  int : TIME := T#5ms;\n  time : "Int";\nEND_VAR\n',
    ),
    "structures": (
        "  motor : Struct\n    on : Bool;\n  END_STRUCT;\n",
        "  motor : STRUCT\n    on : BOOL;\n  END_STRUCT;\n",
    ),
    "constants have no type": (
        "VAR CONSTANT\n  MAX : Int := 3;  // tries\n  LONG : DInt := L#2000;\nEND_VAR\nVAR\n  a : Int := 1;\nEND_VAR\n",
        "CONST\n  MAX := 3;  // tries\n  LONG := L#2000;\nEND_CONST\nVAR\n  a : INT := 1;\nEND_VAR\n",
    ),
    "the head of a block": (
        "TITLE = Pump of 3: Int\n{ S7_Optimized_Access := 'FALSE' }\nAUTHOR : me\nFAMILY : F\nVERSION : 0.1\n// #a\n",
        "TITLE = 'Pump of 3: Int'\nVERSION : '0.1'\nAUTHOR : me\nFAMILY : F\n// #a\n",
    ),
    "two heads in one file": (
        'TYPE "a"\nVERSION : 0.1\nEND_TYPE\nDATA_BLOCK "b"\nTITLE = t\nVERSION : 0.2\nNON_RETAIN\nBEGIN\n',
        "TYPE \"a\"\nEND_TYPE\nDATA_BLOCK \"b\"\nTITLE = 't'\nVERSION : '0.2'\nBEGIN\n",
    ),
    "system functions go by number, outputs of functions take :=": (
        "#now := TIME_TO_DINT(TIME_TCK());\n#move := BLKMOV(SRCBLK := P#DB3.DBX0.0 BYTE 20, DSTBLK => #buffer);\n",
        "now := TIME_TO_DINT(SFC64());\nmove := SFC20(SRCBLK := P#DB3.DBX0.0 BYTE 20, DSTBLK := buffer);\n",
    ),
    "a region becomes a comment": (
        "REGION End of a job, Int\n  #a := 1;\n  REGION Inner\n  END_REGION\nEND_REGION\n\n#b := 2;\n",
        "// ---- End of a job, Int ----\n  a := 1;\n  // ---- Inner ----\n\nb := 2;\n",
    ),
    "literals, labels and addresses stay": (
        "CASE #a OF\n  1, #TWO: // Two\n    #b := B#16#0F;\n    #c := DW#16#7FFFFFFF;\n    #d := %M5.0;\nEND_CASE;\n",
        "CASE a OF\n  1, TWO: // Two\n    b := B#16#0F;\n    c := DW#16#7FFFFFFF;\n    d := %M5.0;\nEND_CASE;\n",
    ),
}
NO_REGIONS: dict[str, tuple[str, str]] = {
    "only regions change": (
        "TITLE = t\nVERSION : 0.1\nREGION Start of all\n#a := TIME_TCK();  // REGION\nEND_REGION\n",
        "TITLE = t\nVERSION : 0.1\n// ---- Start of all ----\n#a := TIME_TCK();  // REGION\n",
    ),
}
CASES = [
    *((Spelling.STEP7_V5, *STEP7_V5[name]) for name in STEP7_V5),
    *((Spelling.NO_REGIONS, *NO_REGIONS[name]) for name in NO_REGIONS),
]


@pytest.mark.parametrize(("spelling", "tia", "older"), CASES, ids=[*STEP7_V5, *NO_REGIONS])
def test_spelling(spelling: Spelling, tia: str, older: str) -> None:
    """What the compiler of the older system wants, character by character."""
    assert respell(tia, spelling) == older


@pytest.mark.parametrize(("spelling", "older"), [(case[0], case[2]) for case in CASES], ids=[*STEP7_V5, *NO_REGIONS])
def test_a_text_already_rewritten_stays(spelling: Spelling, older: str) -> None:
    """Values of a view are spelled for the target already: rewriting them again changes nothing."""
    assert respell(older, spelling) == older


def test_tia_stays_as_it_is() -> None:
    """Templates are written for the TIA Portal and S7-1200/1500."""
    text = "REGION a\n#b := Int;\nEND_REGION\n"
    assert respell(text, Spelling.TIA) is text
