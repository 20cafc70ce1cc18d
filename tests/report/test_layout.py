"""Layouts as pictures and tables: cells against hand calculation, pages as parsers see them, hostile names."""

from __future__ import annotations

import csv
import html.parser
import io
import json
import re
from pathlib import Path

import pytest
from lxml import etree

from plcgen import api
from plcgen.base.display.view import PLAIN, View
from plcgen.report.diff.planned_layout import project_tables
from plcgen.report.registry import output_format
from plcgen.s7.layout.evidence import RULES
from plcgen.s7.read.text import parse_source
from plcgen.s7.tables.declared import block_tables
from plcgen.s7.tables.pictures import cell_title, grid
from plcgen.s7.tables.tables import LayoutResult, letter, size_text
from tests.projects import FAQ

HEAD = "DATA_BLOCK DB 3\n{ S7_Optimized_Access := 'FALSE' }\nSTRUCT\n"
TAIL = "END_STRUCT;\nBEGIN\nEND_DATA_BLOCK\n"


def show(format_, blocks, view=PLAIN):
    """Blocks in a format."""
    return output_format(format_).render("layout", LayoutResult(tuple(blocks), ()), view)


def tables(members: str, *, head: str = HEAD, tail: str = TAIL, expand: bool = False):
    blocks, problems = parse_source(head + members + tail, "x.db")
    assert problems == []
    found, problems = block_tables(blocks, {b.name.upper(): b for b in blocks}, expand=expand)
    assert problems == []
    return found


def cells(members: str, **options):
    """(first byte of the row, x, width, name) of every cell."""
    picture = grid(tables(members)[0], **options)
    return [(row.byte, cell.x, cell.width, cell.run.name) for row in picture.rows for cell in row.cells]


def test_a_row_has_two_bytes_and_bit_seven_stands_left():
    """X 0.0, y 0.1 -> unused bits 2..7 at x 0, y at x 6, x at x 7; byte 1 unused; b 2, w 4."""
    assert cells("x : BOOL;\ny : BOOL;\nw0 : WORD;\nb : BYTE;\n") == [
        (0, 7, 1, "x"),
        (0, 6, 1, "y"),
        (0, 0, 6, ""),
        (0, 8, 8, ""),
        (2, 0, 16, "w0"),
        (4, 0, 8, "b"),
        (4, 8, 8, ""),
    ]


def test_a_member_over_several_rows_has_a_cell_in_each():
    """BYTE 0, unused 1, REAL 2..5, BOOL array of 10 bits 6.0..7.1: 8 bits, then 2 bits at the right of byte 7."""
    assert cells("b : BYTE;\nr : REAL;\na : ARRAY[1..10] OF BOOL;\n") == [
        (0, 0, 8, "b"),
        (0, 8, 8, ""),
        (2, 0, 16, "r"),
        (4, 0, 16, "r"),
        (6, 0, 8, "a"),
        (6, 14, 2, "a"),
        (6, 8, 6, ""),
    ]


def test_long_members_are_folded_and_tell_how_much_was_left_out():
    """3,000 bytes at 16 a row are rows 0 to 187: the first two and the last one are drawn, 185 rows are not."""
    picture = grid(tables("a : ARRAY[1..3000] OF BYTE;\n")[0])
    assert [(row.byte, row.skipped) for row in picture.rows] == [(0, 0), (16, 0), (2992, 185 * 16)]
    assert (picture.columns, picture.drawn) == (16, 3000)


def test_a_picture_ends_at_its_limit_and_says_where():
    picture = grid(tables("".join(f"m{n} : INT;\n" for n in range(1000)))[0], limit=100)
    assert len(picture.rows) == 13  # 8 cells in a row of 16 bytes: the row with the 101st cell is the last one
    assert (picture.drawn, picture.size) == (208, 2000)


def test_every_bit_of_a_block_is_in_exactly_one_cell():
    """Structures, arrays of structures, strings, views: the cells cover the block without overlap."""
    block = tables(
        "x : BOOL;\ns : STRUCT\n a : ARRAY[0..2] OF STRUCT\n  c : CHAR;\n  t : STRING[3];\n  f : BOOL;\n END_STRUCT;\n"
        "END_STRUCT;\nn : ARRAY[1..2,1..5] OF BOOL;\nl : BYTE;\n"
    )[0]
    picture = grid(block)
    taken = sorted((8 * row.byte + cell.x, cell.width) for row in picture.rows for cell in row.cells)
    at = 0
    for start, width in taken:
        assert start == at
        at += width
    assert at == 8 * (block.size or 0)


def test_titles_name_the_address_type_value_and_comment():
    block = tables("x : BOOL;\nw : WORD := W#16#FF;  // Länge\ns : STRING[4];\n")[0]
    runs = [cell.run for row in grid(block).rows for cell in row.cells if cell.first]
    texts = [cell_title(run, 3, in_db=True) for run in runs]
    assert texts == [
        "DB3.DBX0.0  x : BOOL, 1 bit",
        "0.1  unused, 1 B 7 bit",
        "DB3.DBW2  w : WORD := W#16#FF, 2 B  // Länge",
        "DB3.DBB4  s : STRING[4], 6 B",
    ]


HOSTILE = """DATA_BLOCK "<script>alert('x')</script> & größer"
TITLE = <b>"x" & 'y'</b> ]]> 主轴电机
{ S7_Optimized_Access := 'FALSE' }
STRUCT
  "电机速度" : Real := 10.0;   // 变频器的设定值 <img src=x onerror=alert(1)>
  "</svg><script>" : Bool;
  "=1+1" : String[12] := '=HYPERLINK("x")';  // =cmd|' /C calc'!A0
  "a|b;c,d" : Array[0..300] of Byte;  // +1;"x"
END_STRUCT;
BEGIN
END_DATA_BLOCK
"""


class _Tags(html.parser.HTMLParser):
    """Tags and attributes of a page as a browser sees them."""

    def __init__(self) -> None:
        super().__init__()
        self.tags: set[str] = set()
        self.names: set[str] = set()
        self.texts: list[str] = []

    def handle_starttag(self, tag, attrs):
        self.tags.add(tag)
        self.names.update(name for name, _ in attrs)

    def handle_data(self, data):
        self.texts.append(data)


def hostile():
    blocks, problems = parse_source(HOSTILE, "x.db")
    assert problems == []
    return block_tables(blocks, {})[0]


def test_hostile_names_stay_text_in_the_page():
    """No tag, attribute or script comes from a name; the page loads nothing and asks nobody."""
    page = show("html", hostile())
    tags = _Tags()
    tags.feed(page)
    assert not tags.tags & {"img", "b", "link", "iframe", "object"}
    assert page.count("<script") == 1  # its own, permitted by the hash in the policy
    assert not [name for name in tags.names if name.startswith("on") or name == "src"]
    assert "<script>alert('x')</script> & größer" in "".join(tags.texts)
    assert "default-src 'none'" in page
    assert not re.search(r"https?://(?!www\.w3\.org/)", page)


def test_the_picture_is_well_formed_and_stands_alone():
    document = etree.fromstring(show("svg", hostile()).encode())
    names = {etree.QName(element).localname for element in document.iter()}
    assert names == {"svg", "style", "defs", "pattern", "path", "rect", "g", "text", "title"}
    texts = [element.text for element in document.iter("{http://www.w3.org/2000/svg}text")]
    assert "电机速度" in texts
    assert "... 288 more bytes of it ..." in texts  # bytes 20 to 320: rows 16, 24, then 36 rows of 8, row 320


def test_control_characters_never_reach_the_xml():
    head = 'DATA_BLOCK "a\x01\x02b\uffffc"\nSTRUCT\n'
    blocks, _ = parse_source(f'{head} "\x07x" : INT;\n{TAIL}', "x.db")
    found, _ = block_tables(blocks, {})
    etree.fromstring(show("svg", found).encode())
    assert not re.search("[\x00-\x08\uffff]", show("html", found))


def test_csv_is_safe_in_a_spreadsheet_and_keeps_its_columns():
    """Cells that a sheet would compute get an apostrophe; byte and bit are numbers of their own."""
    rows = list(csv.reader(io.StringIO(show("csv", hostile(), View(separator=";"))), delimiter=";"))
    assert {len(row) for row in rows} == {12}
    assert rows[0][:4] == ["block", "byte", "bit", "address"]
    cells_ = [cell for row in rows[1:] for cell in row]
    assert not [cell for cell in cells_ if cell[:1] in "=+@" and cell]
    assert "'=1+1" in cells_
    assert ["6", "1"] not in [row[1:3] for row in rows]
    assert rows[2][1:4] == ["4", "0", "DBX4.0"]


def test_folded_and_expanded_arrays():
    """Folded: the first element and how many are the same; expanded: all of them, gaps between strings shown."""
    text = "a : ARRAY[1..3] OF STRUCT\n w : WORD;\n b : BYTE;\nEND_STRUCT;\ns : ARRAY[0..1] OF STRING[3];\n"
    folded = [(r.offset, r.name, r.size) for r in tables(text)[0].rows]
    assert folded == [
        ("0.0", "a", "12 B"),
        ("0.0", "[1]", "4 B"),
        ("0.0", "w", "2 B"),
        ("2.0", "b", "1 B"),
        ("3.0", "(unused)", "1 B"),
        ("4.0", "[2] to [3]", "8 B"),
        ("12.0", "s", "11 B"),
        ("12.0", "[0]", "5 B"),
        ("18.0", "[1]", "5 B"),
        ("23.0", "(unused)", "1 B"),
    ]
    expanded = [(r.offset, r.name) for r in tables(text, expand=True)[0].rows]
    assert expanded[-4:] == [("12.0", "[0]"), ("17.0", "(unused)"), ("18.0", "[1]"), ("23.0", "(unused)")]
    assert len([name for _, name in expanded if name == "w"]) == 3


def test_programs_get_whole_names_and_markdown_keeps_the_indentation():
    """Gaps and folds have no name of their own."""
    found = tables(
        "a : ARRAY[1..2] OF STRUCT\n x : BYTE;\n s : STRUCT\n  y : INT;\n END_STRUCT;\nEND_STRUCT;\n b : INT;\n"
    )
    members = json.loads(show("json", found))["blocks"][0]["members"]
    assert [m["path"] for m in members] == ["a", "a[1]", "a[1].x", "", "a[1].s", "a[1].s.y", "", "b"]
    indent = "\N{NO-BREAK SPACE}" * 4
    assert f"| {indent}x | BYTE |" in show("markdown", found)


@pytest.mark.slow
def test_expanding_a_huge_array_stops_at_a_bound():
    head = "DATA_BLOCK DB 3\nSTRUCT\n"  # with standard access stated, bounds end at 32767
    rows = tables("a : ARRAY[0..999999] OF BYTE;\n", head=head, expand=True)[0].rows
    assert len(rows) == 200_001
    assert (rows[-1].kind, rows[-1].name) == ("more", "[199999] to [999999]")


def test_values_behind_begin_win_also_inside_arrays():
    """In the table and in the picture."""
    text = "p : ARRAY[-1..0] OF STRUCT\n x : INT := 5;\nEND_STRUCT;\n"
    block = tables(text, tail="END_STRUCT;\nBEGIN\n p[-1].x := 7;\nEND_DATA_BLOCK\n", expand=True)[0]
    assert [row.start for row in block.rows if row.name == "x"] == ["7", "5"]
    assert [cell.run.value for row in grid(block).rows for cell in row.cells] == ["7", "5"]


def test_folded_elements_with_start_values_of_their_own_are_not_called_the_same():
    """An array of structures says it; an array of values shows them."""
    members = (
        "p : ARRAY[1..3] OF STRUCT\n x : INT := 5;\nEND_STRUCT;\n"
        "r : ARRAY[1..3] OF STRUCT\n x : INT := 2;\nEND_STRUCT;\n"
        "u : ARRAY[0..9] OF INT := 1, 9(2);\n v : ARRAY[0..9] OF INT;\n w : ARRAY[0..9] OF BYTE;\n"
    )
    # STEP 7 V5 repeats every value behind BEGIN: those of r and u change nothing.
    begin = "p[2].x := 7;\n r[2].x := 2;\n v[3] := 4;\n u[0] := 1;\n" + "".join(f"w[{n}] := {n};\n" for n in range(5))
    rows = tables(members, tail=f"END_STRUCT;\nBEGIN\n {begin}END_DATA_BLOCK\n")[0].rows
    assert [row.type for row in rows if row.kind == "more"] == [
        "the same, one every 2 B, other start values",
        "the same, one every 2 B",
    ]
    assert [row.start for row in rows if row.name in "uvw"] == [
        "1, 9(2)",
        "[3] := 4",
        "[0] := 0, [1] := 1, [2] := 2, ..",
    ]


@pytest.mark.parametrize(
    ("line", "words"),
    [
        ("a[99] := 5;", "a[99]"),
        ("nosuch := 5;", "nosuch"),
        ("i := 40000;", "i: 40000 is not a valid INT constant"),
        ("i := MAX_SPEED;", None),
    ],
)
def test_a_line_behind_begin_that_does_not_fit_is_a_warning(line, words):
    """The layout is right all the same; a constant from elsewhere is no mistake."""
    blocks, _ = parse_source(
        f"{HEAD}a : ARRAY[0..9] OF INT;\n i : INT;\nEND_STRUCT;\nBEGIN\n {line}\nEND_DATA_BLOCK\n", "x.db"
    )
    found, problems = block_tables(blocks, {})
    assert found[0].size == 22
    if words is None:
        assert problems == []
    else:
        assert [(p.code, p.severity.label, p.span.line) for p in problems] == [("PG809", "warning", 8)]
        assert words in problems[0].message


def test_optimized_blocks_have_no_offsets_in_any_format():
    text = "a : ARRAY[1..2] OF STRUCT\n w : WORD;\n b : BYTE;\nEND_STRUCT;\n"
    block = tables(text, head=HEAD.replace("FALSE", "TRUE"))[0]
    assert (block.size, block.shape, {row.offset for row in block.rows}) == (None, None, {""})
    assert show("text", [block]).startswith("DB3  optimized access: no offsets\n  name")
    assert "| offset" not in show("markdown", [block])
    data = json.loads(show("json", [block]))["blocks"][0]
    assert (data["optimized"], data["size"], data["members"][0]["byte"]) == (True, None, None)
    assert "DBB" not in show("csv", [block]) + show("html", [block]) + show("svg", [block])


def test_unconfirmed_places_have_footnotes_in_every_format():
    """B lies at 4 because an array is padded to an even byte: literature; a alone is sure."""
    blocks = tables("a : ARRAY[1..3] OF BYTE;\nb : BYTE;\n")
    sentence = "an ARRAY is padded to an even byte at its end"
    lines = show("text", blocks).splitlines()
    assert "rule" in lines[1]
    assert lines[-1] == f"  a  {sentence}: literature, no compiled block"
    assert f"- a: {sentence}" in show("markdown", blocks)
    assert sentence in show("csv", blocks)
    assert sentence in show("html", blocks)
    data = json.loads(show("json", blocks))["blocks"][0]
    assert data["unconfirmed_rules"] == {"array-end": sentence}
    marked = {m["name"]: m["unconfirmed"] for m in data["members"] if m["kind"] == "member"}
    assert marked == {"a": [], "b": ["array-end"]}


def test_a_row_with_many_footnotes_names_the_first_five():
    """The last member comes behind six types whose sizes no compiled block confirms."""
    types = ("LREAL", "LINT", "LWORD", "LTIME", "DTL", "POINTER")
    text = "".join(f"m{n} : {name};\n" for n, name in enumerate(types)) + "last : BYTE;\n"
    block = tables(text)[0]
    assert [block.mark(row) for row in block.rows if row.name in {"m0", "m4", "last"}] == [
        "c",
        "a b c d e",
        "a b c d e +1",
    ]


def test_telegrams_of_a_spec_are_drawn_with_their_bytes(tmp_path):
    spec = tmp_path / "x.yaml"
    spec.write_text(
        "plc: {name: P, family: s7-300, toolchain: tia-v16}\ndrives:\n  d: {device: sinamics-dcm, address: 256}\n"
        "jobs:\n  j: {drive: d, read: [P50303]}\n",
        "utf-8",
    )
    project = api.check(spec).project
    assert project is not None
    picture = etree.fromstring(show("svg", project_tables(project)).encode())
    texts = [element.text for element in picture.iter("{http://www.w3.org/2000/svg}text")]
    assert "C4 7F" in texts


@pytest.mark.parametrize(("bits", "text"), [(0, "0 B"), (1, "1 bit"), (8, "1 B"), (15, "1 B 7 bit"), (80, "10 B")])
def test_sizes_are_bytes_and_bits(bits, text):
    assert size_text(bits) == text


def test_footnote_letters_go_on_behind_z():
    assert [letter(n) for n in (0, 25, 26, 27, 52)] == ["a", "z", "aa", "ab", "ba"]


PICTURES = Path(__file__).parents[2] / "docs" / "pictures"


def test_the_picture_in_the_documentation_is_what_layout_draws():
    """docs/pictures/conveyor.svg; after a change: plcgen layout conveyor.awl --block DB20 -f svg --out conveyor.svg."""
    result = api.layout(PICTURES / "conveyor.awl", block="DB20")
    assert show("svg", result.blocks) == (PICTURES / "conveyor.svg").read_text("utf-8")
    page = (PICTURES.parent / "layout.md").read_text("utf-8")
    assert show("text", result.blocks) in page


def test_the_documentation_states_every_rule_with_its_evidence():
    page = (PICTURES.parents[1] / "plcgen" / "s7" / "layout" / "README.md").read_text("utf-8")
    for rule in RULES.values():
        assert f"| {rule.text} | {rule.evidence}{': ' if rule.vectors else ''}{', '.join(rule.vectors)} |" in page


def test_a_response_has_no_picture():
    """Nobody knows the bytes of an answer: its buffer is a table, only requests are drawn."""
    blocks = api.layout(FAQ).blocks
    pictures = show("text", blocks).count("byte  +0")
    assert [block.data is not None for block in blocks] == [block.role.startswith("request") for block in blocks]
    assert 0 < pictures == sum(block.data is not None for block in blocks) < len(blocks)
