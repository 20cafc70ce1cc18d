"""What has drifted: two profiles against each other, a list of a drive against a spec."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from click.testing import CliRunner

from plcgen.cli.main import run

PROFILE = """\
title: Acme
source: manual
record_index: {profibus: 47, default: profibus}
drive_object: {default: 1}
parameters:
  P1: {title: One, type: Integer16, max: 9}
"""
SPEC = """\
plc: {name: A, family: s7-300, toolchain: tia-v16}
drives:
  fan: {device: sinamics-g120, address: 256}
jobs:
  ramps: {drive: fan, write: {P1120: 10.0, P1121: null, P1082: 1500.0, P1058: 100.0}, allow: {P1082: agreed}}
  look: {drive: fan, read: [r21]}
"""
ALLOW = "allow: {P840: agreed, P1083: agreed, P1300: agreed}"
LIST = """\
Parameter;Parameter text;Online value;Unit;Minimum;Maximum
p1120;Ramp-up;10,000;s;0,000;999999,000
p1121;Ramp-down;3,000;s;0,000;999999,000
p1082;Maximum speed;1500,000;rpm;0,000;1450,000
r21;Speed;0,0;rpm;;
"""


def plcgen(*words: str) -> tuple[int, str, str]:
    """Exit code, stdout, stderr."""
    with CliRunner().isolation() as streams:
        code = run([*words])
        return code, streams[0].getvalue().decode(), streams[1].getvalue().decode()


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """With a spec and a list."""
    monkeypatch.chdir(tmp_path)
    Path("job.yaml").write_text(SPEC, "utf-8")
    Path("list.csv").write_text(LIST, "utf-8")
    return tmp_path


@pytest.mark.usefixtures("folder")
def test_a_list_against_a_spec() -> None:
    """1500 is over the drive's 1450, P1058 is not there, an input and a display have nothing to deviate from."""
    code, out, err = plcgen("catalogue", "drift", "list.csv", "job.yaml", "--json")
    rows = {row["parameter"]: row["verdict"] for row in json.loads(out)["rows"]}
    wanted = {"P1120": "equal", "P1121": "equal", "P1082": "outside", "P1058": "not in the list", "r21": "equal"}
    assert (code, rows) == (1, wanted)
    assert err.count("PG707") == 0  # they are in the result
    Path("list.csv").write_text(LIST.replace("10,000", "10,500").replace("1450", "1600") + "p1058;;100;;;\n", "utf-8")
    code, out, _ = plcgen("catalogue", "drift", "list.csv", "job.yaml", "--json")
    assert (code, [d["message"] for d in json.loads(out)["diagnostics"]]) == (
        1, ["P1120 of ramps: deviates: 10.5 (0..999999), not 10"],
    )  # fmt: skip
    Path("list.csv").write_text(LIST.replace("1450", "1600") + "p1058;;100;;;\n", "utf-8")
    assert plcgen("catalogue", "drift", "list.csv", "job.yaml")[0] == 0


@pytest.mark.usefixtures("folder")
def test_which_drive() -> None:
    """One that the spec has."""
    assert plcgen("catalogue", "drift", "list.csv", "job.yaml", "--drive", "pump")[0] == 2


@pytest.mark.usefixtures("folder")
def test_two_versions_of_a_profile() -> None:
    """A limit, a grade, a parameter more; the same against itself is nothing."""
    Path("old.yaml").write_text(PROFILE, "utf-8")
    Path("new.yaml").write_text(
        PROFILE.replace("max: 9}", "max: 8, facts: {title: inferred}}") + "  P2: {title: Two, type: Integer16}\n",
        "utf-8",
    )
    code, out, _ = plcgen("catalogue", "diff", "./old.yaml", "./new.yaml", "--json")
    found = [(row["parameter"], row["fact"], row["old"], row["new"]) for row in json.loads(out)["changes"]]
    assert code == 0
    assert found == [
        ("P1", "title", "One (read)", "One (inferred)"),
        ("P1", "max", "9 (read)", "8 (read)"),
        ("P2", "parameter", "", "Two"),
    ]
    assert "0 facts differ" in plcgen("catalogue", "diff", "sinamics-g120", "sinamics-g120")[1]


@pytest.mark.parametrize(("value", "verdict"), [("8", "equal"), ("24", "equal"), ("9", "deviates"), ("16", "deviates")])
@pytest.mark.usefixtures("folder")
def test_bits_that_are_written(value: str, verdict: str) -> None:
    """Bit 3 is 8, bit 0 is 1, bit 4 is 16: wanted are bit 3 and not bit 0; bit 4 is nobody's, bit 5 an input."""
    write = "{P1030.3: 1, P1030.0: 0, P1030.5: null}"
    Path("job.yaml").write_text(f"{SPEC.partition('jobs:')[0]}jobs: {{j: {{drive: fan, write: {write}}}}}\n", "utf-8")
    Path("list.csv").write_text(f"{LIST.partition('p1120')[0]}p1030;MOP;{value};;;\n", "utf-8")
    code, out, _ = plcgen("catalogue", "drift", "list.csv", "job.yaml", "--json")
    assert [row["verdict"] for row in json.loads(out)["rows"]] == [verdict]
    assert code == (verdict != "equal")


@pytest.mark.parametrize(
    ("cell", "verdict"),
    [
        ("Invalid", "not readable"),
        ("1.50,00", "not readable"),
        ("1.500,00", "deviates"),
        ("1.400,00", "equal"),
        ("1,400.0", "equal"),
        ("", "no value"),
    ],
)
@pytest.mark.usefixtures("folder")
def test_a_value_that_cannot_be_read_is_a_finding(cell: str, verdict: str) -> None:
    """What the list has and nobody can compare did not pass; only where it says nothing there is nothing to find."""
    job = f"{SPEC.partition('jobs:')[0]}jobs: {{j: {{drive: fan, write: {{P1083: 1400.0}}, {ALLOW}}}}}\n"
    Path("job.yaml").write_text(job, "utf-8")
    Path("list.csv").write_text(f"{LIST.partition('p1120')[0]}p1083;Limit;{cell};rpm;;\n", "utf-8")
    code, out, _ = plcgen("catalogue", "drift", "list.csv", "job.yaml", "--json")
    found = json.loads(out)
    assert [row["verdict"] for row in found["rows"]] == [verdict]
    wrong = verdict in {"not readable", "deviates"}
    assert (code, [one["code"] for one in found["diagnostics"]]) == (int(wrong), ["PG707"] * wrong)
    if cell == "Invalid":
        assert found["diagnostics"][0]["message"] == "P1083 of j: not readable: Invalid, wanted is 1400"


@pytest.mark.parametrize(("second", "verdict"), [("10,0", "equal"), ("11,0", "deviates"), ("Invalid", "not readable")])
@pytest.mark.usefixtures("folder")
def test_every_element_is_compared(second: str, verdict: str) -> None:
    """Of an array with two indexes both values are in the list."""
    write = "{P1120[0..1]: [12.5, 10.0]}"
    Path("job.yaml").write_text(f"{SPEC.partition('jobs:')[0]}jobs: {{j: {{drive: fan, write: {write}}}}}\n", "utf-8")
    rows = f"p1120[0];Ramp-up;12,5;s;;\np1120[1];Ramp-up;{second};s;;\n"
    Path("list.csv").write_text(LIST.partition("p1120")[0] + rows, "utf-8")
    _, out, _ = plcgen("catalogue", "drift", "list.csv", "job.yaml", "--json")
    assert [(row["wanted"], row["verdict"]) for row in json.loads(out)["rows"]] == [("12.5, 10", verdict)]


@pytest.mark.usefixtures("folder")
def test_an_enumeration_and_a_source() -> None:
    """The number in front of a text is its value; a source is not compared, and the result says so."""
    job = f"{{drive: fan, write: {{P1300: 20, P840: r722.2}}, {ALLOW}}}"
    Path("job.yaml").write_text(f"{SPEC.partition('jobs:')[0]}jobs: {{j: {job}}}\n", "utf-8")
    rows = "p1300;Mode;[0] V/f control;;;\np840;ON/OFF1;r722.3;;;\n"
    Path("list.csv").write_text(LIST.partition("p1120")[0] + rows, "utf-8")
    _, out, _ = plcgen("catalogue", "drift", "list.csv", "job.yaml", "--json")
    found = {row["parameter"]: row["verdict"] for row in json.loads(out)["rows"]}
    assert found == {"P1300": "deviates", "P840": "not compared"}
