"""The list of parameters that a drive keeps of itself: what a user takes out of a CPU or drive, against the catalogue.

The tables are written by hand after the windows of the programs; no export of a program was at hand.
"""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from click.testing import CliRunner

from plcgen.base.diagnostics import DiagnosticError
from plcgen.base.display.workbook import workbook_bytes
from plcgen.cli.main import cli, run
from plcgen.ds47.catalogue.lists import load_sheets
from plcgen.ds47.catalogue.own_list import OwnList, compare_own_list, read_own_list
from plcgen.ds47.devices import find_device, read_profile

WATCH = """\
Name;Address;Display format;Monitor value;Modify value
"DriveJobs".readList.done;%DB471.DBX0.2;Bool;TRUE;
"DriveJobs".readList.p980[0];%DB471.DBW20;DEC;922;
"DriveJobs".readList.p980[1];%DB471.DBW22;Hex;16#03B0;
"DriveJobs".readList.p980[2];%DB471.DBW24;DEC;61000;
"DriveJobs".readList.p980[3];%DB471.DBW26;DEC;0;
"DriveJobs".readList.diagnosis.errors[1];%DB471.DBW32;Hex;16#0000;
"""
"""944 is 16#03B0. Three parameters beside 980 and four elements: so AC4 fills r980 (pdrv_pardatabase_ac4.c)."""
SNAPSHOT = """\
Name\tDatentyp\tOffset\tStartwert\tMomentaufnahme\tKommentar
p980\tArray[0..3] of UInt\t20.0\t\t\tr980[0..3]
p980[0]\tUInt\t20.0\t0\t922\t
p980[1]\tUInt\t22.0\t0\t944\t
p980[2]\tUInt\t24.0\t0\t61000\t
p980[3]\tUInt\t26.0\t0\t0\t
"""
LIVE = """\
192.168.0.5, drive object 1
parameter  value  unit  bytes  type                   title
r980[0]    922          03 9A  Unsigned16 (recalled)  List of existing parameters 1
r980[1]    944          03 B0  Unsigned16 (recalled)  List of existing parameters 1
r980[2]    61000        EE 48  Unsigned16 (recalled)  List of existing parameters 1
r980[3]    0            00 00  Unsigned16 (recalled)  List of existing parameters 1
"""
BOTH = SNAPSHOT.replace("Kommentar", "Beobachtungswert")
"""The column that comes first is empty: nobody watches."""
STEP7 = "Symbol\tStatus value\n" + "".join(f"x.p980[{n}]\tW#16#{v:04X}\n" for n, v in enumerate((922, 944, 61000, 0)))
PROFILE = """\
title: Acme
source: manual
record_index: {profibus: 47, default: profibus}
drive_object: {default: 1}
parameters:
  R944: {title: Counter, type: Unsigned16}
  R980: {title: List, type: Unsigned16, array: n}
  P1120: {title: Ramp, type: FloatingPoint}
"""


def read(text: str, tmp_path: Path) -> OwnList | None:
    path = tmp_path / "list.csv"
    path.write_text(text, "utf-8")
    return read_own_list(load_sheets(path), path)


@pytest.mark.parametrize(
    "text",
    [
        WATCH,
        SNAPSHOT,
        BOTH,
        LIVE,
        STEP7,
        STEP7.replace("Symbol", "Name").replace("Status", "Actual"),
        "922 944 61000 0\n",
        "922\n944\n61000\n0\n",
        "922, 944,\n16#EE48,0\n",
    ],
)
def test_every_form_of_the_same_list(text: str, tmp_path: Path) -> None:
    """Watch table, snapshot of a data block, `live read`, STEP 7 V5, numbers alone."""
    found = read(text, tmp_path)
    assert found is not None
    assert (sorted(found.lines), found.continues, found.ended) == ([922, 944, 61000], None, True)


def test_a_workbook(tmp_path: Path) -> None:
    """The first sheet that has the list."""
    path = tmp_path / "list.xlsx"
    cells = [line.split("\t") for line in SNAPSHOT.splitlines()]
    path.write_bytes(workbook_bytes({"Data block": cells}))
    found = read_own_list(load_sheets(path), path)
    assert found is not None
    assert sorted(found.lines) == [922, 944, 61000]


def test_a_workbook_with_numbers_in_front_of_a_list(tmp_path: Path) -> None:
    """A sheet that begins with a number says nothing about the next one, the list of a tool."""
    path = tmp_path / "list.xlsx"
    path.write_bytes(workbook_bytes({"Info": [["2026"]], "List": [["Number", "Value"], ["p1082", "1500"]]}))
    assert read_own_list(load_sheets(path), path) is None


def array(number: int, *values: int) -> str:
    return "".join(f"p{number}[{index}];{value}\n" for index, value in enumerate(values))


def test_a_list_goes_on_in_the_next_one(tmp_path: Path) -> None:
    """The last element of r980 is 981: numbers of both, and neither 980 nor 981 is a parameter of interest."""
    head = "Name;Value\n"
    both = read(head + array(980, 2, 10, 981) + array(981, 30, 0, 0), tmp_path)
    first = read(head + array(980, 2, 10, 981), tmp_path)
    alone = read("2 10 981\n", tmp_path)
    full = read("2 10 30", tmp_path)
    assert both is not None
    assert first is not None
    assert alone is not None
    assert full is not None
    assert (sorted(both.lines), both.continues, both.ended) == ([2, 10, 30], None, True)
    assert [(sorted(one.lines), one.continues, one.ended) for one in (first, alone)] == [([2, 10], 981, False)] * 2
    assert (full.continues, full.ended) == (None, False)


@pytest.mark.parametrize(
    ("text", "line", "message"),
    [
        ("Name;Value\np980[0];2\np980[1];abc\n", 3, 'r980[1] is "abc": a parameter number is 0 to 65535'),
        ("Name;Value\np980[0];\n", 2, "r980[0] has no value"),
        ("Name;Value\np980[0];70000\n", 2, "0 to 65535"),
        ("Name;Value\np980[0];2\np980[2];3\n", 3, "r980[1] is missing before this line"),
        ("Name;Value\np980[0];0\np980[1];3\n", 3, "3 comes after the 0"),
        ("2\n10\nx\n", 3, 'this is "x"'),
        ("Name;Value\np981[0];30\np981[1];0\n", 0, "r980 is missing: the list begins there"),
        ("0\n0\n", 0, "there is no number in the list"),
    ],
)
def test_what_is_wrong_with_a_list(text: str, line: int, message: str, tmp_path: Path) -> None:
    """One diagnostic with its line and a remedy."""
    with pytest.raises(DiagnosticError) as problem:
        read(text, tmp_path)
    (told,) = problem.value.diagnostics
    assert (told.code, told.span.line) == ("PG704", line)
    assert message in told.message
    assert told.help


@pytest.mark.parametrize(
    "text",
    [
        "Parameter;Parameter text;Online value\np1120[0];Ramp-up time;10,000\nr980[0];List;2\n",
        "Parameter;Parameter text;Value\nr0002;State;31\n",
        "a;b;c\n1;2;3\n",
        "",
    ],
)
def test_what_is_no_such_list(text: str, tmp_path: Path) -> None:
    """A list with other parameters is one of an engineering tool."""
    assert read(text, tmp_path) is None


def test_inventory(tmp_path: Path) -> None:
    """944 is known, 922 and 61000 are not, and the drive has no P1120; 980 itself is in no list."""
    own = read(WATCH, tmp_path)
    assert own is not None
    path = tmp_path / "acme.yaml"
    path.write_text(PROFILE, "utf-8")
    found = compare_own_list(read_profile(path, "acme"), own)
    assert [one.pnu for one in found.both] == [944]
    assert found.drive == [922, 61000]
    assert [one.pnu for one in found.catalogue] == [1120]


def test_import_shows_it(tmp_path: Path) -> None:
    """As text with what is missing, as JSON; there is nothing to write into a profile."""
    path = tmp_path / "list.csv"
    path.write_text("21 105 2941 981\n", "utf-8")
    words = ["catalogue", "import", str(path), "--device", "sinamics-s120"]
    text = CliRunner().invoke(cli, words).output
    assert (
        "3 parameters in the drive\n\nknown to sinamics-s120: 2\n  r21 P105\n\nonly in the drive: 1\n  2941\n" in text
    )
    assert text.endswith("the list continues in r981, which is not in the file: read it, too\n")
    with CliRunner().isolation() as streams:
        assert run([*words, "--json"]) == 0, streams[1].getvalue().decode()
        data = json.loads(streams[0].getvalue())
    assert (data["known"], data["unknown"], data["continues"], data["ended"]) == (["r21", "P105"], ["2941"], 981, False)
    assert "P1120" in data["missing"]
    refused = CliRunner().invoke(cli, [*words, "--profile", str(tmp_path / "own.yaml")])
    assert (refused.exit_code, (tmp_path / "own.yaml").exists()) == (2, False)
    path.write_text("21 105\n", "utf-8")
    assert CliRunner().invoke(cli, words).output.endswith("if the array has more elements, read them, too\n")
    assert (
        len(find_device("sinamics-s120").parameters) == len(data["known"]) + len(data["missing"]) + 3
    )  # r980, r981, r989
