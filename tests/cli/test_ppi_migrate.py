"""plcgen ppi migrate: files, exit codes, what is shown; the sources pass check and have their layout."""

import json

import pytest

TABLE = 'Symbol,Address,Comment\nSpeed,VW100,INT rpm\nLevel,VD105,"REAL, bar"\nPump,Q0.1,\nDelay,T37,\n'


@pytest.fixture
def table(tmp_path):
    """A table with a symbol of each kind."""
    (tmp_path / "press.csv").write_text(TABLE, "utf-8")
    return "press.csv"


def test_the_files_are_a_program(plcgen, table):
    """They pass check --program, and the layout has VW100 at 100 and the bytes of VD105 from 104 on."""
    assert plcgen("ppi", "migrate", table).code == 0
    checked = plcgen("check", "press_s7-1200", "--program", "--target", "tia-1500")
    assert (checked.code, checked.err) == (0, "no problems in 3 files (4 blocks)\n")
    (block,) = json.loads(plcgen("layout", "press_s7-1200", "--block", "V", "--json").out)["blocks"]
    places = {member["name"]: member["address"] for member in block["members"]}
    assert (places["Speed"], places["V104_bytes"]) == ("DBW100", "DBB104")


def test_json(plcgen, table, tmp_path):
    """Folder, files and every symbol with its way, for programs; --types wins over the comment."""
    (tmp_path / "types.csv").write_text("Speed,WORD\n", "utf-8")
    result = plcgen("ppi", "migrate", table, "--types", "types.csv", "--out", "x", "--json")
    assert (result.code, result.err) == (0, "")
    data = json.loads(result.out)
    assert (data["ok"], data["folder"], data["written"][:2]) == (True, "x", ["V_Layout.udt", "V.db"])
    ways = {each["symbol"]: (each["way"], each["type"]) for each in data["symbols"]}
    expected = {"Speed": ("member", "WORD"), "Level": ("bytes", "REAL"), "Pump": ("tag", "BOOL"), "Delay": ("none", "")}
    assert ways == expected


def test_nothing_is_overwritten_without_force(plcgen, table, tmp_path):
    """One file of the user keeps all others away, too; --force replaces it."""
    (tmp_path / "x").mkdir()
    (tmp_path / "x" / "MIGRATION.csv").write_text("mine")
    refused = plcgen("ppi", "migrate", table, "--out", "x")
    assert (refused.code, [path.name for path in (tmp_path / "x").iterdir()]) == (1, ["MIGRATION.csv"])
    assert "PG501" in refused.err
    assert (tmp_path / "x" / "MIGRATION.csv").read_text() == "mine"
    assert plcgen("ppi", "migrate", table, "--out", "x", "--force").code == 0


def test_wrong_input(plcgen, table, tmp_path):
    """A wrong address, a wrong type, a missing file: told with the place, nothing is written."""
    (tmp_path / "bad.csv").write_text("A,VB1,\nB,Q0.9,\n", "utf-8")
    (tmp_path / "types.csv").write_text("Speed,REAL\n", "utf-8")
    before = sorted(tmp_path.iterdir())
    for words, told in (
        (("bad.csv",), " --> bad.csv:2:3"),
        ((table, "--types", "types.csv"), " --> types.csv:1:1"),
        (("none.csv",), "none.csv"),
    ):
        result = plcgen("ppi", "migrate", *words)
        assert (result.code, result.out.strip()) == (1, "")
        assert told in result.err
    assert sorted(tmp_path.iterdir()) == before
