"""Files to blocks: encodings, limits, kinds of files."""

from __future__ import annotations

import codecs
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from plcgen.base.diagnostics import Diagnostic, Severity
from plcgen.s7.read import text as reader
from plcgen.s7.read.text import decode_source, read_source
from plcgen.s7.scl.dialect import Dialect
from plcgen.s7.types.blocks import SectionKind

UDT = 'TYPE "größe"\nSTRUCT\n  x : INT;   // Länge\nEND_STRUCT;\nEND_TYPE\n'


@pytest.mark.parametrize(
    "data",
    [
        UDT.encode(),
        codecs.BOM_UTF8 + UDT.encode(),
        codecs.BOM_UTF16_LE + UDT.encode("utf-16-le"),
        codecs.BOM_UTF16_BE + UDT.encode("utf-16-be"),
        codecs.BOM_UTF32_LE + UDT.encode("utf-32-le"),
        codecs.BOM_UTF32_BE + UDT.encode("utf-32-be"),
        UDT.encode("utf-16-le"),
        UDT.encode("utf-16-be"),
        UDT.encode("cp1252"),
        UDT.replace("\n", "\r\n").encode("cp1252"),
    ],
    ids=[
        "utf-8",
        "utf-8 with BOM",
        "utf-16 le",
        "utf-16 be",
        "utf-32 le",
        "utf-32 be",
        "bare le",
        "bare be",
        "ansi",
        "ansi with CRLF",
    ],
)
def test_every_encoding_of_the_engineering_tools_is_read(tmp_path: Path, data: bytes) -> None:
    """Names and comments are the same whatever the encoding."""
    path = tmp_path / "a.udt"
    path.write_bytes(data)
    (block,), diagnostics = read_source(path)
    member = block.section(SectionKind.STATIC)[0]
    assert diagnostics == []
    assert (block.name, member.comment) == ("größe", "Länge")
    assert member.span is not None
    assert (member.span.file, member.span.line, member.span.column) == (str(path), 3, 3)


def test_another_code_page_can_be_named(tmp_path: Path) -> None:
    """An ANSI file from a Russian Windows is read with cp1251."""
    path = tmp_path / "a.udt"
    path.write_bytes(UDT.replace("größe", "размер").replace("Länge", "длина").encode("cp1251"))
    (block,), diagnostics = read_source(path, encoding="cp1251")
    assert (block.name, block.section(SectionKind.STATIC)[0].comment, diagnostics) == ("размер", "длина", [])


@pytest.mark.parametrize(
    ("data", "place"),
    [
        (b"TYPE a\n x\x00y", (2, 3)),
        (b"\xe4\n\n ab\x81", (3, 4)),
        (codecs.BOM_UTF8 + b"ab\n\xff", (2, 1)),
        ("TYPE a\nx\0y\n".encode("utf-16-le"), (1, 2)),
        (b"\0" * 100, (1, 1)),
        (codecs.BOM_UTF16_LE + "ä\nb".encode("utf-16-le") + b"\x00\xd8", (2, 2)),
    ],
    ids=["zero byte", "no cp1252", "no utf-8 behind a BOM", "zero in bare utf-16", "zeros", "half a surrogate"],
)
def test_bytes_that_are_no_text_are_pointed_at(data: bytes, place: tuple[int, int]) -> None:
    """PG804 with line and column of the first bad byte."""
    found = decode_source(data, "a.scl")
    assert isinstance(found, Diagnostic)
    assert (found.code, (found.span.line, found.span.column)) == ("PG804", place)


@pytest.mark.parametrize(
    ("name", "comment", "page"),
    [
        ("Größe", "Öl für die Übergrößen", "cp1252"),
        ("vitesse", "dépassé à gauche", "cp1252"),
        ("Насос", "скорость привода", "cp1251"),
        ("电机速度", "变频器的设定值", "gb18030"),
        ("otwórz", "Źródło prędkości", "cp1250"),
        ("rychlost", "zpět, teplota šťávy", "cp1250"),
    ],
)
def test_the_code_page_of_an_ansi_source_is_guessed(tmp_path: Path, name: str, comment: str, page: str) -> None:
    """Names and comments come out right without the code page being named, as the bytes tell it."""
    path = tmp_path / "a.udt"
    path.write_bytes(UDT.replace("größe", name).replace("Länge", comment).encode(page))
    (block,), diagnostics = read_source(path)
    assert (block.name, block.section(SectionKind.STATIC)[0].comment, diagnostics) == (name, comment, [])


def test_a_code_page_that_does_not_exist() -> None:
    """A typo in the name of a code page is a diagnostic."""
    found = decode_source(b"\xff", "a.scl", "cp9999")
    assert isinstance(found, Diagnostic)
    assert found.code == "PG804"


def test_a_file_that_cannot_be_read_is_a_diagnostic(tmp_path: Path) -> None:
    """Missing files and directories give PG804, no exception."""
    for path in (tmp_path / "missing.scl", tmp_path):
        blocks, (found,) = read_source(path)
        assert (blocks, found.code, found.span.line) == ([], "PG804", 0)


def test_a_file_that_is_too_large_is_not_read(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """PG802 by the size alone."""
    monkeypatch.setattr(reader, "MAX_BYTES", 10)
    path = tmp_path / "a.scl"
    path.write_bytes(b" " * 11)
    blocks, (found,) = read_source(path)
    assert (blocks, found.code) == ([], "PG802")


def test_an_stl_source_gives_its_declarations(tmp_path: Path) -> None:
    """The statement list behind BEGIN is skipped, its odd quotes included; data blocks are read in full."""
    path = tmp_path / "a.AWL"
    path.write_text(
        "FUNCTION_BLOCK FB 60\nTITLE =Ampel\n//Fußgänger\n{ S7_m_c := 'true' }\nVERSION : 1.3\n"
        "VAR_INPUT\n  number { S7_server := 'alarm_archiv' }: DWORD ;\t// Number of cars\nEND_VAR\n"
        "BEGIN\nNETWORK\nTITLE =it's \"open\n      A(    ; \n      L     P##number; \nERR:  L     'ab; \n"
        "END_FUNCTION_BLOCK\n"
        "DATA_BLOCK DB 10\n STRUCT \n  a : ARRAY  [1 .. 3 ] OF INT  := 1, 2, 3;\n END_STRUCT ;\n"
        "BEGIN\n   a[1] := 7; \nEND_DATA_BLOCK\n",
        encoding="cp1252",
    )
    (block, data), diagnostics = read_source(path)
    assert diagnostics == []
    assert (block.name, block.number, block.title, block.comment) == ("FB60", 60, "Ampel", "Fußgänger")
    assert block.section(SectionKind.INPUT)[0].comment == "Number of cars"
    assert data.section(SectionKind.STATIC)[0].start == "1, 2, 3"
    assert [(a.path, a.literal) for a in data.assignments] == [("a[1]", "7")]


def test_a_target_adds_its_refusals(tmp_path: Path) -> None:
    """Without a dialect a source is accepted, with one PG803 tells what its compiler refuses."""
    path = tmp_path / "a.scl"
    path.write_text("FUNCTION_BLOCK a\nBEGIN\n x := y DIV 2;\nEND_FUNCTION_BLOCK\n")
    assert read_source(path)[1] == []
    assert [d.code for d in read_source(path, Dialect.TIA_300_400)[1]] == ["PG803"]


@pytest.mark.parametrize(
    ("encoding", "refusing"),
    [
        ("utf-8", {Dialect.STEP7_V5, Dialect.TIA_300_400, Dialect.TIA_1200_1500}),
        ("utf-8-sig", {Dialect.STEP7_V5}),
        ("utf-16", {Dialect.STEP7_V5}),
        ("utf-16-le", {Dialect.STEP7_V5}),
        ("utf-32", {Dialect.STEP7_V5}),
        ("cp1252", set()),
    ],
)
def test_an_encoding_that_the_target_misreads_is_refused(tmp_path: Path, encoding: str, refusing: set[Dialect]) -> None:
    """TIA wants a byte order mark, STEP 7 V5 ANSI; pure ASCII is fine everywhere."""
    path = tmp_path / "a.udt"
    for text, expected in ((UDT, refusing), (UDT.replace("öß", "oss").replace("ä", "ae"), set())):
        path.write_bytes(text.encode("ascii" if text.isascii() else encoding))
        refused = {dialect for dialect in Dialect if read_source(path, dialect)[1]}
        assert expected == refused
    assert read_source(path)[1] == []


@pytest.mark.parametrize(
    ("source", "severity"),
    [
        ("TYPE a STRUCT\n x : INT; // Länge\nEND_STRUCT; END_TYPE\n", Severity.WARNING),
        ("TYPE a STRUCT\n x : INT; (* Länge *)\nEND_STRUCT; END_TYPE\n", Severity.WARNING),
        ("TYPE a STRUCT\n länge : INT;\nEND_STRUCT; END_TYPE\n", Severity.ERROR),
        ("TYPE a STRUCT\n x : CHAR := 'ä';\nEND_STRUCT; END_TYPE\n", Severity.ERROR),
    ],
)
def test_comments_alone_in_utf8_without_mark_are_a_warning(tmp_path: Path, source: str, severity: Severity) -> None:
    """TIA reads them as ANSI: a comment becomes unreadable, a name or a text becomes another one."""
    path = tmp_path / "a.udt"
    path.write_bytes(source.encode())
    found = [d for d in read_source(path, Dialect.TIA_1200_1500)[1] if d.code == "PG803"]
    assert [d.severity for d in found] == [severity]


@given(st.binary(max_size=200))
def test_any_bytes_are_text_or_a_diagnostic(data: bytes) -> None:
    """Decoding never raises."""
    assert isinstance(decode_source(data, "a.scl"), str | Diagnostic)
