"""plcgen layout on files, folders and things that are neither."""

from __future__ import annotations

import json
import struct

import pytest

DB = 'DATA_BLOCK "D"\nSTRUCT\n x : INT := 5;  // größer\n y : BOOL;\nEND_STRUCT;\nBEGIN\nEND_DATA_BLOCK\n'


@pytest.fixture
def source(tmp_path):
    (tmp_path / "d.db").write_text(DB, "utf-8")
    return "d.db"


def test_a_missing_type_with_a_number(plcgen, tmp_path):
    """UDT 5 is no UDINT: what helps is its source. An array without bounds has a star."""
    (tmp_path / "a.awl").write_text("DATA_BLOCK DB 1\nSTRUCT\n t : UDT 5;\nEND_STRUCT\nBEGIN\nEND_DATA_BLOCK\n")
    result = plcgen("layout", "a.awl")
    assert "did you mean" not in result.err
    assert "also name the file that declares it" in result.err
    block = 'FUNCTION_BLOCK "F"\nVAR_IN_OUT\n b : Array[*] of Byte;\nEND_VAR\nBEGIN\n;\nEND_FUNCTION_BLOCK\n'
    (tmp_path / "f.scl").write_text(block)
    assert "POINTER to ARRAY[*] OF BYTE" in plcgen("layout", "f.scl").out


def test_out_never_overwrites_without_force(plcgen, source, tmp_path):
    """A file of somebody else stays as it is, exit code 1; --force replaces it."""
    (tmp_path / "x.txt").write_text("mine")
    refused = plcgen("layout", source, "--format", "html", "--out", "x.txt")
    assert (refused.code, refused.out) == (1, "")
    assert "error[PG501]: the file exists, and plcgen did not write it" in refused.err
    assert (tmp_path / "x.txt").read_text() == "mine"
    assert plcgen("layout", source, "--format", "html", "--out", "x.txt", "--force").code == 0
    assert (tmp_path / "x.txt").read_bytes().startswith(b"<!DOCTYPE html>")


def test_csv_files_have_the_mark_that_excel_needs_and_stdout_has_not(plcgen, source, tmp_path):
    """UTF-8 with byte order mark and semicolons in a file; --separator for other sheets."""
    plcgen("layout", source, "-f", "csv", "-o", "x.csv")
    data = (tmp_path / "x.csv").read_bytes()
    assert data.startswith(b"\xef\xbb\xbfblock;byte;bit;")
    assert "größer" in data.decode("utf-8-sig")
    assert plcgen("layout", source, "-f", "csv", "--separator", ",").out.startswith("block,byte,bit,")
    assert plcgen("layout", source, "-f", "csv", "--separator", "ab").code == 2
    assert plcgen("layout", source, "-f", "csv", "--separator", '"').code == 2


def test_one_block_of_many(plcgen, tmp_path):
    """By name in any case, by number; a name nobody has is an error."""
    text = "DATA_BLOCK DB 3\nSTRUCT\n x : INT;\nEND_STRUCT;\nBEGIN\nEND_DATA_BLOCK\n"
    (tmp_path / "a.awl").write_text(text + DB, "utf-8")
    for wanted, title in (("d", 'DB "D"'), ('"D"', 'DB "D"'), ("db3", "DB3"), ("DB 3", "DB3")):
        assert plcgen("layout", "a.awl", "--block", wanted).out.splitlines()[0].startswith(title)
    missing = plcgen("layout", "a.awl", "--block", "DB4")
    assert (missing.code, missing.out) == (1, "")
    assert "error[PG806]" in missing.err


def test_a_folder_means_every_source_in_it(plcgen, tmp_path):
    (tmp_path / "p" / "inner").mkdir(parents=True)
    (tmp_path / "p" / "d.db").write_text(DB.replace("INT := 5", '"T"'), "utf-8")
    (tmp_path / "p" / "inner" / "t.udt").write_text('TYPE "T"\nSTRUCT\n a : REAL;\nEND_STRUCT\nEND_TYPE\n', "utf-8")
    result = plcgen("layout", "p", "--json")
    assert [block["size"] for block in json.loads(result.out)["blocks"]] == [6, 4]


NESTED = "TYPE U\n" + "STRUCT\na : " * 10_000 + "INT;" + "END_STRUCT;" * 10_000 + "END_TYPE\n"
ALIASES = "".join(
    f'TYPE "U{n}"\nSTRUCT\n a : "U{n - 1}";\n b : "U{n - 1}";\nEND_STRUCT\nEND_TYPE\n' for n in range(1, 60)
)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("data", "code"),
    [
        (b"TYPE U\nSTRUCT\n a : ARRAY[0..2147483647] OF LREAL;\nEND_STRUCT\nEND_TYPE\n", "PG808"),
        (b"TYPE U\nSTRUCT\n a : ARRAY[0..2147483647, 0..2147483647] OF BOOL;\nEND_STRUCT\nEND_TYPE\n", "PG808"),
        (b"TYPE U\nSTRUCT\n a : U;\nEND_STRUCT\nEND_TYPE\n", "PG807"),
        (b"TYPE U\nSTRUCT\n a : INT;\n A : INT;\nEND_STRUCT\nEND_TYPE\n", "PG805"),
        (b'TYPE U\nSTRUCT\n a : "V";\nEND_STRUCT\nEND_TYPE\n', "PG806"),
        (NESTED.encode(), "PG802"),
        (ALIASES.encode() + b'TYPE "U0"\nSTRUCT\n x : INT;\nEND_STRUCT\nEND_TYPE\n', "PG808"),
        (struct.pack("<1000I", *range(1000)), "PG804"),
        (b"\x00" * 50_000_000, "PG802"),
        ("TYPE U\nSTRUCT\n größe : INT;\n".encode("utf-16")[:-1], "PG804"),
        (b"\xef\xbb\xbfTYPE U \xff\xfe", "PG804"),
    ],
    ids=[
        "huge array", "huge matrix", "recursive", "twice", "missing", "nested 10,000 deep", "doubling", "binary",
        "50 MB", "half a character", "no UTF-8",
    ],
)  # fmt: skip
def test_hostile_sources_are_diagnostics_and_the_output_is_bounded(plcgen, tmp_path, data, code):
    """A diagnostic with exit code 1, no traceback, and a bounded amount of text."""
    (tmp_path / "x.udt").write_bytes(data)
    result = plcgen("layout", "x.udt")
    assert result.code == 1
    assert f"error[{code}]" in result.err
    assert "PG902" not in result.err
    assert len(result.out) < 50_000_000


def test_hostile_text_on_a_terminal_stays_one_line(plcgen, tmp_path):
    (tmp_path / "x.db").write_text(DB.replace("größer", "a\x1b[31mred\u202e"), "utf-8")
    out = plcgen("layout", "x.db").out
    assert "\x1b" not in out
    assert "\u202e" not in out


UNSAID = 'DATA_BLOCK "D&quot;x"\nVERSION : 0.1\nSTRUCT\n  "a&quot;b" : Int;\nEND_STRUCT;\nBEGIN\nEND_DATA_BLOCK\n'
SAID = UNSAID.replace("VERSION", "{ S7_Optimized_Access := 'FALSE' }\nVERSION")
_FOOTNOTE = "the source has no S7_Optimized_Access: on S7-1200/1500 these offsets hold for standard access only"


@pytest.mark.parametrize("format_", ["text", "markdown", "html"])
def test_a_source_that_does_not_say_its_access(plcgen, tmp_path, format_):
    """A footnote, unless the source says it, the CPU has standard access only, or its number shows STEP 7 V5."""
    path = tmp_path / "a.db"
    for text, more, expected in (
        (UNSAID, (), True),
        (UNSAID, ("--family", "s7-1500"), True),
        (UNSAID, ("--family", "s7-300"), False),
        (SAID, (), False),
        (UNSAID.replace('"D&quot;x"', "DB 5"), (), False),
    ):
        path.write_text(text, "utf-8")
        assert (_FOOTNOTE in plcgen("layout", path, "-f", format_, *more).out) is expected, (text, more)
    (tmp_path / "a.udt").write_text('TYPE "T"\nVERSION : 0.1\nSTRUCT\n x : Int;\nEND_STRUCT;\nEND_TYPE\n', "utf-8")
    assert _FOOTNOTE not in plcgen("layout", tmp_path / "a.udt", "-f", format_).out


def test_markdown_shows_an_ampersand(plcgen, tmp_path):
    """&quot; in a name is no quote: the & is written as an entity, in the heading too."""
    (tmp_path / "a.db").write_text(SAID, "utf-8")
    out = plcgen("layout", tmp_path / "a.db", "-f", "markdown").out
    assert '### DB "D&amp;quot;x"' in out
    assert "| a&amp;quot;b |" in out
    (tmp_path / "b.db").write_text(SAID.replace("Int", "Real"), "utf-8")
    changed = plcgen("diff", tmp_path / "a.db", tmp_path / "b.db", "-f", "markdown").out
    assert "a&amp;quot;b" in changed
    assert "&quot;" not in changed.replace("&amp;quot;", "")


def test_a_file_without_blocks_says_so(plcgen, tmp_path):
    """Exit code 0, the file by name, and that no result was written."""
    path = tmp_path / "a.scl"
    path.write_text("FUNCTION f : INT\nBEGIN\nf := 1;\nEND_FUNCTION\n", "utf-8")
    result = plcgen("layout", path, "--out", tmp_path / "x.txt")
    assert (result.code, result.out) == (0, "")
    assert "no data block, type or function block in" in result.err
    assert result.err.endswith("x.txt is not written\n")


def test_a_folder_of_data_blocks_finds_the_types_in_the_folders_beside_it(plcgen, tmp_path):
    """As its files do when they are named: ../udt and ../scl."""
    for name, text in (
        ("db/A_DB.db", 'DATA_BLOCK "A_DB"\nVERSION : 0.1\n"A"\nBEGIN\nEND_DATA_BLOCK\n'),
        ("scl/A.scl", 'FUNCTION_BLOCK "A"\nVAR\n  u : "U";\nEND_VAR\nBEGIN\nEND_FUNCTION_BLOCK\n'),
        ("udt/U.udt", 'TYPE "U"\nSTRUCT\n x : Int;\nEND_STRUCT;\nEND_TYPE\n'),
    ):
        (tmp_path / name).parent.mkdir()
        (tmp_path / name).write_text(text, "utf-8")
    assert plcgen("layout", tmp_path / "db").code == 0
    assert plcgen("layout", tmp_path / "db" / "A_DB.db").code == 0


def test_an_instance_is_not_suggested_for_its_unknown_block(plcgen, tmp_path):
    """What is no type helps nobody."""
    (tmp_path / "Motor_DB.db").write_text('DATA_BLOCK "Motor_DB"\n"Motor"\nBEGIN\nEND_DATA_BLOCK\n', "utf-8")
    result = plcgen("layout", tmp_path)
    assert result.code == 1
    assert "did you mean" not in result.err


OPEN = """FUNCTION_BLOCK "F"
VERSION : 0.1
VAR
  a : Array[*] of Int;
END_VAR
VAR_IN_OUT
  b : Array[*] of Int;
END_VAR
BEGIN
  ;
END_FUNCTION_BLOCK
"""


def test_an_array_without_bounds_is_no_memory(plcgen, tmp_path):
    """A static has a length; an in-out of an FB takes what it is given. One message in every verb."""
    (tmp_path / "f.scl").write_text(OPEN, "utf-8")
    calls = (["layout"], ["check", "--program", "--target", "tia-1500"])
    for arguments in calls:
        found = plcgen(*arguments, "f.scl")
        text = found.out + found.err
        assert found.code == 1
        assert text.count("error[") == 1
        assert "a: ARRAY[*] has no length where it is memory of its own" in text
        assert "f.scl:4:3" in text
        assert "write the bounds" in text


def test_a_compiler_without_open_arrays_says_so_once(plcgen, tmp_path):
    """STEP 7 V5 does not know ARRAY[*] (PG803): that it has no length there would be a second message."""
    (tmp_path / "f.scl").write_text(OPEN.replace("VERSION : 0.1\n", ""), "utf-8")
    found = plcgen("check", "--program", "--target", "v5", "f.scl")
    text = found.out + found.err
    assert [text.count(f"error[{code}]") for code in ("PG803", "PG806")] == [2, 0]
