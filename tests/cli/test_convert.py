"""plcgen convert on the command line: streams and exit codes."""

from __future__ import annotations

import json
from pathlib import Path

FB = 'FUNCTION_BLOCK "Motor"\nVERSION : 0.1\nVAR_INPUT\n  speed : Int;\nEND_VAR\nBEGIN\n;\nEND_FUNCTION_BLOCK\n'


def test_results_go_where_they_belong(plcgen):
    """Chatter on stderr, JSON on stdout; 0 good, 1 refused, 2 wrong use."""
    Path("a.scl").write_text(FB, "utf-8-sig")
    done = plcgen("convert", "a.scl", "--to", "xml", "--out", "x", "--tia", "v18")
    assert (done.code, done.out) == (0, "")
    assert done.err == "x: 1 file written\n"
    assert '<Engineering version="V18" />' in Path("x/Motor.xml").read_text("utf-8-sig")
    again = ("convert", "x", "--to", "scl", "--out", "s", "--json")
    assert json.loads(plcgen(*again).out)["written"] == ["Motor.scl"]
    Path("s/Motor.scl").write_text("changed")
    refused = plcgen(*again)
    assert (refused.code, [d["code"] for d in json.loads(refused.out)["diagnostics"]]) == (1, ["PG501"])
    assert plcgen(*again[:-1]).err.endswith("nothing was written\n")
    assert Path("s/Motor.scl").read_text() == "changed"
    assert plcgen(*again, "--force").code == 0


def test_wrong_use(plcgen):
    """What is missing or misspelt is said in one line."""
    Path("a.scl").write_text(FB, "utf-8-sig")
    assert plcgen("convert", "a.scl", "--to", "xml").code == 2
    assert plcgen("convert", "a.scl", "--to", "xml", "--out", "x", "--tia", "V13").code == 2
    wrong = plcgen("convert", "a.scl", "--to", "xml", "--out", "x", "--culture", "english")
    assert (wrong.code, "write it like en-US" in wrong.err) == (2, True)
    missing = plcgen("convert", "nothing.scl", "--to", "xml", "--out", "x")
    assert (missing.code, "PG804" in missing.err) == (1, True)
