"""Parameter lists of engineering tools: read as they may look, laid over the catalogue, written as a profile.

The lists are written by hand after the windows of the programs; no file of a program was at hand.
"""

from __future__ import annotations

import json
import zipfile
from dataclasses import replace
from pathlib import Path

import pytest
from click.testing import CliRunner

from plcgen.base.diagnostics import DiagnosticError
from plcgen.base.display.workbook import workbook_bytes
from plcgen.cli.main import cli
from plcgen.ds47.catalogue.lists import ListedParameter, load_list, parse_list
from plcgen.ds47.catalogue.merging import Merged, merge_list, profile_text
from plcgen.ds47.devices import device_names, find_device, read_profile

STARTER = """\
Expert list Pump
Parameter;Data;Parameter text;Online value Pump;Unit;Modifiable to;Access level;Minimum;Maximum
r0002;;Drive operating display;[31] Ready for switching on;;;1;;
p1120[0];D;Ramp-function generator ramp-up time;12,500;s;Operation;1;0,000;999999,000
p1120[1];D;Ramp-function generator ramp-up time;10,000;s;Operation;1;0,000;999999,000
r0722.0;;DI 0 (T. 5);0;;;1;;
p0840[0];C;BI: ON/OFF1;r2090.0;;Ready to run;3;;
p2940[0];D;Wobble generator amplitude;0,000;%;Operation;2;0,000;100,000
"""
STARTDRIVE = "Number\tParameter text\tValue\tUnit\np1082\tMaximum speed\t1500.000\trpm\nr21\tActual speed\t0.0\trpm\n"
GERMAN = "Parameter,Parametertext,Online-Wert,Einheit,Minimum,Maximum\np1135,AUS3 Rücklaufzeit,1.5,s,0.0,600.0\n"


def parsed(text: str) -> dict[int, ListedParameter]:
    return {one.pnu: one for one in parse_list(text, Path("list.csv")).parameters}


def merged(text: str, device: str = "sinamics-g120") -> Merged:
    return merge_list(find_device(device), parse_list(text, Path("list.csv")), "parameter list list.csv")


def test_expert_list() -> None:
    """Indexes are joined, bits left out; an enumeration is its number, a source is no value."""
    found = parsed(STARTER)
    assert set(found) == {2, 840, 1120, 2940}
    assert found[1120] == ListedParameter(
        1120, "p", line=4, title="Ramp-function generator ramp-up time", unit="s", changeable="Operation",
        minimum=0.0, maximum=999999.0, values={0: 12.5, 1: 10.0}, indexes=2,
    )  # fmt: skip
    assert (found[2].value, found[840].value, found[2].letter) == (31.0, None, "r")


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "utf-16-le", "cp1252"])
def test_encodings_separators_and_languages(encoding: str, tmp_path: Path) -> None:
    """Tabs, semicolons, commas; headings in two languages."""
    path = tmp_path / "list.csv"
    path.write_bytes(GERMAN.encode(encoding))
    (one,) = load_list(path).parameters
    assert (one.title, one.unit, one.value, one.maximum) == ("AUS3 Rücklaufzeit", "s", 1.5, 600.0)
    assert [one.pnu for one in parse_list(STARTDRIVE, path).parameters] == [21, 1082]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("a;b;c\n1;2;3\n", "no row with the headings"),
        ("Parameter;Parameter text\nhello;world\n", "there is no parameter in the list"),
        ("Parameter;Unit\n" + "p1;s\n" * 200_001, "more than 200000 lines"),
        ('Parameter;Unit\np1;"' + "x" * 200_000, "field larger than field limit"),
        ("", "no row with the headings"),
    ],
)
def test_what_is_no_list(text: str, message: str) -> None:
    """One diagnostic with a remedy."""
    with pytest.raises(DiagnosticError) as problem:
        parsed(text)
    (told,) = problem.value.diagnostics
    assert told.code == "PG704"
    assert message in told.message
    assert told.help
    assert told.span.column == min(told.span.line, 1)


def test_a_list_that_cannot_be_read(tmp_path: Path) -> None:
    """PG110 with the path, as of every other file."""
    with pytest.raises(DiagnosticError) as problem:
        load_list(tmp_path / "nothing.csv")
    (told,) = problem.value.diagnostics
    assert (told.code, told.span.file) == ("PG110", str(tmp_path / "nothing.csv"))


def book(*sheets: list[list[str]]) -> bytes:
    """A workbook of our own writer."""
    return workbook_bytes({f"Sheet {number}": rows for number, rows in enumerate(sheets)})


def test_a_workbook_is_read_like_a_table(tmp_path: Path) -> None:
    """The sheet with the headings, wherever it is; the file says the same as its CSV."""
    rows = [line.split("\t") for line in STARTDRIVE.splitlines()]
    path = tmp_path / "list.xlsx"
    path.write_bytes(book([["About", "this file"]], [["Pump"], [], *rows]))
    assert [replace(one, line=one.line - 2) for one in load_list(path).parameters] == parse_list(
        STARTDRIVE, path
    ).parameters


def test_cells_as_other_programs_write_them(tmp_path: Path) -> None:
    """Numbers, text inside the cell, rich text, reading aids, gaps, no places: ECMA-376, 18.3.1.4 and 18.4."""
    main = 'xmlns="http://schemas.openxmlformats.org/spreadsheetml/2006/main"'
    strings = f"<sst {main}><si><r><t>p1</t></r><r><t>120</t></r><rPh sb='0' eb='1'><t>aid</t></rPh></si></sst>"
    head = "".join(f'<c t="inlineStr"><is><t>{text}</t></is></c>' for text in ("Number", "Text", "Value", "Unit"))
    cells = '<c r="A2" t="s"><v>0</v></c><c r="C2"><v>12.500</v></c><c r="D2" t="str"><f>1+1</f><v>s</v></c>'
    sheet = f"<worksheet {main}><sheetData><row>{head}</row><row>{cells}</row></sheetData></worksheet>"
    path = tmp_path / "list.xlsx"
    with zipfile.ZipFile(path, "w") as file:
        file.writestr("xl/sharedStrings.xml", strings)
        file.writestr("xl/worksheets/sheet1.xml", sheet)
    (one,) = load_list(path).parameters
    assert (one.pnu, one.value, one.unit, one.title) == (1120, 12.5, "s", "")


@pytest.mark.parametrize(
    ("part", "told"),
    [
        ("<!DOCTYPE x [<!ENTITY a 'aaaa'>]><worksheet>&a;</worksheet>", "document type"),
        ("<worksheet><row><c t='s'><v>7</v></c></row></worksheet>", "not there"),
        ("<worksheet><row>", "not XML"),
        ("<worksheet>" + "<row/>" * 200_001 + "</worksheet>", "more than 200000 rows"),
        ("<worksheet><x>" + " " * (64 << 20) + "</x></worksheet>", "more than 64 MiB"),
        (None, "no sheet"),
    ],
)
def test_workbooks_that_nobody_needs(part: str | None, told: str, tmp_path: Path) -> None:
    """One line each; what is small when packed may be large."""
    path = tmp_path / "list.xlsx"
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as file:
        file.writestr("xl/worksheets/sheet1.xml" if part else "other", part or "")
    with pytest.raises(DiagnosticError, match=told):
        load_list(path)
    path.write_bytes(path.read_bytes()[:60])
    with pytest.raises(DiagnosticError, match="damaged"):
        load_list(path)


@pytest.mark.parametrize("name", ["list.xls", "list.ods"])
def test_other_spreadsheets_are_refused(name: str, tmp_path: Path) -> None:
    """With what to do about it."""
    with pytest.raises(DiagnosticError, match="files are not supported"):
        load_list(tmp_path / name)


def test_preview() -> None:
    """What is new, what was not read before; what agrees with a read fact is no change."""
    changes = {(one.parameter, one.fact): (one.known, one.grade, one.listed) for one in merged(STARTER).changes}
    assert changes == {
        ("P1120", "array"): ("n", "inferred", "2"),
        ("P1120", "min"): ("0", "recalled", "0"),
        ("P1120", "max"): ("999999", "recalled", "999999"),
        ("P2940", "new"): ("", "", "Wobble generator amplitude"),
    }


def test_values_are_observed_and_limits_are_read() -> None:
    """A list shows what the drive has: its limits decide, its values are no factory settings."""
    found = merged(STARTER).device.parameters
    assert (found[1120].maximum, found[1120].default, found[1120].observed) == (999999.0, 10.0, 12.5)
    assert (found[2940].type, found[2940].default, found[2940].observed) == ("", None, 0.0)
    assert found[1120].source.startswith("parameter list list.csv; TIA Portal")


def test_one_index_is_not_the_number_of_indexes() -> None:
    """A list that shows r945[0] alone says that there is one at least; r945 has 64 (lists of all families)."""
    text = "Parameter;Parameter text\nr945[0];Fault code\np1120[0];Ramp-up time\np29000[0];Own\np29001[3];Own\n"
    found = merged(text).device.parameters
    base = find_device("sinamics-g120").parameters
    assert (found[945].array, found[945].indexes) == (base[945].array, base[945].indexes)
    assert (found[1120].array, found[1120].indexes) == (base[1120].array, base[1120].indexes)
    assert found[29000].array is None
    assert found[29001].array == 4


def test_a_data_type_of_the_list_counts() -> None:
    """The list is of the drive itself; r948, which lists print as Unsigned32, is a TimeDifference on the wire."""
    text = "Parameter;Data type;Minimum\np1300;Integer32;-70000\nr948;Unsigned32;\np29000;FloatingPoint32;0.5\n"
    result = merged(text)
    assert not result.skipped
    found = result.device.parameters
    assert (found[1300].type, found[1300].minimum) == ("Integer32", -70000)
    assert found[948].type == "TimeDifference"
    assert (found[29000].type, found[29000].minimum) == ("FloatingPoint", 0.5)
    assert ("P1300", "type", "Integer32") in [(one.parameter, one.fact, one.listed) for one in result.changes]


def test_the_letter_c_is_a_parameter() -> None:
    """Lists of G220, S210 and S200 print sinks with a fixed value as c0840; they can be written."""
    result = merged(
        "Parameter;Parameter text;Data type\nc0840[0];ON / OFF (OFF1);Unsigned8\nc29000;Own;Unsigned8\n",
        "sinamics-g220",
    )
    assert not result.skipped
    assert result.device.parameters[29000].access == "rw"
    assert result.device.parameters[840].type == "Unsigned8"


def test_guards_are_not_lifted() -> None:
    """A list that writes 945 with p, and the brake without a warning."""
    device = merged("Parameter;Parameter text\np945;Fault code\np1215;Brake\n").device
    assert device.parameters[945].access == "r"
    assert device.danger(1215)


def test_limits_that_fit_no_type_are_told() -> None:
    """Lines and reasons; the rest is taken over."""
    text = "Parameter;Minimum;Maximum\np1300;0;99999\np1115;5;1\n"
    result = merged(text)
    assert result.skipped == [
        "line 3: P1115 has a minimum above its maximum",
        "line 2: max 99999 of P1300 is not a value of type Integer16",
    ]
    assert result.device.parameters[1300].minimum == 0


@pytest.mark.parametrize("name", device_names())
def test_a_profile_reads_back_as_the_same_device(name: str, tmp_path: Path) -> None:
    """Every shipped device, every fact and its grade."""
    device = find_device(name)
    path = tmp_path / "own.yaml"
    path.write_text(profile_text(device), "utf-8")
    again = read_profile(path, name)
    assert again == device
    for pnu, one in device.parameters.items():
        assert (again.parameters[pnu].grades, again.parameters[pnu].doubted) == (one.grades, one.doubted), pnu


def test_import_writes_a_profile(tmp_path: Path) -> None:
    """Preview on stdout, the profile where it was asked for, once."""
    (tmp_path / "list.csv").write_text(STARTER, "utf-8")
    own = tmp_path / "own.yaml"
    words = ["catalogue", "import", str(tmp_path / "list.csv"), "--device", "sinamics-g120"]
    first = CliRunner().invoke(cli, [*words, "--profile", str(own), "--json"])
    assert {
        "parameter": "P2940",
        "fact": "new",
        "catalogue": "",
        "known": "",
        "list": "Wobble generator amplitude",
    } in (json.loads(first.stdout)["changes"])
    assert find_device(str(own)).parameters[1120].array == 2
    same = [*words, "--force", "--profile", str(tmp_path / "list.csv")]
    assert CliRunner().invoke(cli, same).exit_code == 2
    assert CliRunner().invoke(cli, [*words, "--profile", str(own)]).exit_code != 0
    assert (
        CliRunner()
        .invoke(cli, [*words[:-1], str(own)])
        .stdout.endswith("0 new parameters, 0 facts differ or were not read before\n")
    )
