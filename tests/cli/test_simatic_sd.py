"""The verbs on SIMATIC SD documents, as on other sources."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from tests.projects import generated_example
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


UNSEEN = {
    "function block in one network": "constants of a block",
    "organization block with an empty rung": "an organization block in SCL",
}


def test_sources_become_documents_that_say_the_same(plcgen, folders):
    """What is written is the same block again; what no public document shows is left out, with the reason."""
    for number, what in folders:
        made = ("convert", f"scl/{number}", "--to", "sd", "--toolchain", "tia-v21", "--out", f"made/{number}")
        result = plcgen(*made)
        assert result.code == 0, (what, result.err)
        if what in UNSEEN:
            assert f"has {UNSEEN[what]}: no public SIMATIC SD document shows that" in result.err, what
            continue
        assert plcgen("check", f"made/{number}").code == 0, what
        compared = plcgen("diff", f"scl/{number}", f"made/{number}", "--fail-on", "any")
        assert (compared.code, compared.out) == (0, "no semantic differences\n"), (what, compared.out, compared.err)


@pytest.mark.parametrize("spec", ["s7-1500_g120_pn", "s7-1200_s7-200_ppi", "s7-1500_s120_messages"])
def test_generated_blocks_become_documents(plcgen, tmp_path, monkeypatch, spec):
    """Types, data blocks and what has nothing unseen: the same blocks again, comments and numbers included."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "out").mkdir()
    for path in sorted(generated_example(spec).glob("*.scl")):
        (tmp_path / "out" / path.name).write_bytes(path.read_bytes())
    made = ("convert", "out", "--toolchain", "tia-v21", "--to")
    assert plcgen(*made, "sd", "--out", "sd").code == 0
    written = {path.stem for path in (tmp_path / "sd").glob("*.s7dcl")}
    assert len(written) >= 8
    found = plcgen("diff", "out", "sd", "--json")
    assert [change for change in json.loads(found.out)["changes"] if change["id"] != "block-removed"] == []


@pytest.mark.parametrize(("toolchain", "code"), [("tia-v20", 0), ("tia-v21", 0), ("tia-v19", 2), ("tia-v16", 2)])
def test_documents_are_of_v20_and_v21(plcgen, folders, toolchain, code):
    """V20 has code in LAD only: functions in SCL are left out there."""
    number = next(number for number, what in folders if what.startswith("function in two"))
    result = plcgen("convert", f"scl/{number}", "--to", "sd", "--toolchain", toolchain, "--out", "made")
    assert result.code == code
    assert ("code in SCL, which SIMATIC SD has from V21 on" in result.err) == (toolchain == "tia-v20")


def test_a_document_is_written_as_exports_are(plcgen, tmp_path, monkeypatch):
    """Attributes in front in alphabetical order, the texts beside it, UTF-8 with mark, lines of Windows."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "a.scl").write_text(
        "FUNCTION \"Double\" : Int\nTITLE = Twice\n{ S7_Optimized_Access := 'TRUE' }\nVERSION : 0.1\nVAR_INPUT\n"
        "  x : Int;   // it's a number\nEND_VAR\nBEGIN\n#Double := #x * 2;\nEND_FUNCTION\n"
    )
    assert plcgen("convert", "a.scl", "--to", "sd", "--toolchain", "tia-v21", "--out", "sd").code == 0
    texts = [(tmp_path / "sd" / name).read_bytes() for name in ("Double.s7dcl", "Double.s7res")]
    assert [text.decode("utf-8-sig").replace("\r\n", "\n") for text in texts] == [WRITTEN, NAMED]
    assert all(text.startswith(b"\xef\xbb\xbf") and text.count(b"\n") == text.count(b"\r\n") for text in texts)


WRITTEN = """\
{
    S7_BlockTitle := "MLC_1";
    S7_EditorMode := "SCL";
    S7_Optimized := "TRUE";
    S7_Version := "0.1"
}
FUNCTION "Double" : Int
    VAR_INPUT
        { S7_MLC := "MLC_2" }
        x : Int;
    END_VAR

    { S7_Language := "SCL" }
    NETWORK
        #Double := #x * 2;
    END_NETWORK
END_FUNCTION
"""
NAMED = """\
MultiLingualTexts:
  - id: MLC_1
    en-US: 'Twice'
  - id: MLC_2
    en-US: 'it''s a number'
"""
