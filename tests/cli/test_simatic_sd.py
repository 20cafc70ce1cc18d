"""The verbs on SIMATIC SD documents, as on other sources."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from tests.s7.sd_documents import MOTOR, PAIRS, TEXTS

PROGRAM = ("--program", "--target", "tia-1500", "--json")


HALF = PAIRS["function in two networks, one of comments"]
"""A function that another block calls."""


@pytest.fixture
def folders(tmp_path, monkeypatch):
    """All documents, and all sources of the same blocks, each in a folder of its own that has what they call."""
    monkeypatch.chdir(tmp_path)
    for number, pair in enumerate(PAIRS.values()):
        for kind, suffix, text, called in zip(("sd", "scl"), ("s7dcl", "scl"), pair, HALF, strict=True):
            folder = tmp_path / kind / str(number)
            folder.mkdir(parents=True)
            (folder / f"b.{suffix}").write_text(text, encoding="utf-8-sig")
            if "Half(" in pair[0]:
                (folder / f"c.{suffix}").write_text(called, encoding="utf-8-sig")
    return list(enumerate(PAIRS))


@pytest.mark.parametrize("options", [(), PROGRAM])
def test_check_says_nothing_of_right_documents(plcgen, folders, options):
    """File by file, and as a program: names, types, start values, code."""
    for number, what in folders:
        result = plcgen("check", f"sd/{number}", *options)
        assert (result.code, "PG" in result.out + result.err) == (0, False), (what, result.out, result.err)


@pytest.mark.parametrize("verb", ["layout", "diff", "lock"])
def test_layout_diff_and_lock_work_on_documents(plcgen, folders, verb):
    """Offsets, no difference to the sources, and a lock that is green against them."""
    for number, what in folders:
        sd, scl = f"sd/{number}", f"scl/{number}"
        if verb == "layout":
            for name, said in ((f"{sd}/b.s7dcl", 'S7_Optimized := "TRUE"'), (f"{scl}/b.scl", "Access := 'TRUE'")):
                standard = Path(name).read_text("utf-8-sig").replace(said, said.replace("TRUE", "FALSE"))
                Path(name).write_text(standard, "utf-8-sig")
            shown = [json.loads(plcgen("layout", side, "--json").out)["blocks"] for side in (sd, scl)]
            for block in (block for side in shown for block in side):
                del block["file"], block["line"]
            assert shown[0] == shown[1], what
        elif verb == "diff":
            result = plcgen("diff", sd, scl)
            assert (result.code, result.out) == (0, "no semantic differences\n"), what
        else:
            assert plcgen("lock", sd, "--out", "lock.json").code == 0, what
            result = plcgen("lock", scl, "--check", "--out", "lock.json")
            assert (result.code, result.err.endswith("as in lock.json\n")) == (0, True), (what, result.out, result.err)


@pytest.mark.parametrize("to", ["scl", "xml"])
def test_documents_become_sources_and_simaticml(plcgen, folders, to):
    """What is written is the same block again; array data blocks become no SimaticML, as from SCL."""
    for number, what in folders:
        if to == "xml" and what == "array data block":
            continue
        assert plcgen("convert", f"sd/{number}", "--to", to, "--out", f"made/{number}").code == 0, what
        result = plcgen("diff", f"scl/{number}", f"made/{number}", "--fail-on", "any")
        assert (result.code, result.out) == (0, "no semantic differences\n"), (what, result.out, result.err)


def test_a_drawn_network_is_told_once_and_left_out_by_convert(plcgen, tmp_path):
    """Its interface counts for everything else; the program says which language it is."""
    (tmp_path / "Motor.s7dcl").write_text(MOTOR, encoding="utf-8-sig")
    (tmp_path / "Motor.s7res").write_text(TEXTS, encoding="utf-8-sig")
    assert "a network in LAD is not read" in plcgen("check", tmp_path).out
    assert plcgen("check", tmp_path, *PROGRAM).code == 0
    result = plcgen("convert", tmp_path, "--to", "scl", "--out", tmp_path / "made")
    assert 'FB "Motor" has no SCL code' in result.err
    layout = json.loads(plcgen("layout", tmp_path, "--json").out)
    assert [block["name"] for block in layout["blocks"]] == ["Motor"]


def test_the_iec_check_of_a_document_counts(plcgen, tmp_path):
    """Off unless it says that it is on, as in documents of SimaticML: ``--iec-check on`` overrides it."""
    text = (
        'FUNCTION "F" : Void\n    VAR_TEMP\n        w : Word;\n        i : Int;\n    END_VAR\n'
        '    { S7_Language := "SCL" }\n    NETWORK\n        #i := #w;\n    END_NETWORK\nEND_FUNCTION\n'
    )
    path = tmp_path / "F.s7dcl"
    for head, options, codes in [
        ("", (), []),
        ('{ S7_IECCheck := "TRUE" }\n', (), ["PG821"]),
        ("", ("--iec-check", "on"), ["PG821"]),
        ('{ S7_IECCheck := "TRUE" }\n', ("--iec-check", "off"), []),
    ]:
        path.write_text(head + text)
        found = json.loads(plcgen("check", path, *PROGRAM, *options).out)["diagnostics"]
        assert [one["code"] for one in found] == codes, (head, options)
