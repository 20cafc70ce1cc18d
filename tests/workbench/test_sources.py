"""What the service says of PLC sources while somebody types them."""

from __future__ import annotations

import gc
import shutil
from itertools import pairwise
from pathlib import Path

import pytest

from plcgen.base.diagnostics import DiagnosticError
from plcgen.s7.cpu.program import Program
from plcgen.s7.cpu.sources import check_source
from plcgen.s7.scl.dialect import Dialect
from plcgen.s7.scl.instructions import parameters
from plcgen.workbench.service import Document, Symbol
from plcgen.workbench.service.results import Token
from plcgen.workbench.service.sources import state as source_state
from plcgen.workbench.service.sources.version import SourceState
from tests.projects import ROOT
from tests.s7.sd_documents import PAIRS
from tests.workbench.desk import Desk, edited

UDT = """TYPE "Point"
  STRUCT
    x : Int;
    y : Real := 1.5; // metres
    ok : Bool;
  END_STRUCT;
END_TYPE
"""
DB = """DATA_BLOCK "Plant"
{ S7_Optimized_Access := 'FALSE' }
  STRUCT
    on : Bool;
    points : Array[1..3] of "Point";
    deep : Struct
      last : DInt;
    END_STRUCT;
  END_STRUCT;
BEGIN
END_DATA_BLOCK
"""
FB = """FUNCTION_BLOCK "Mover"
{ S7_Optimized_Access := 'FALSE' }
VAR_INPUT
  speed : Real; // of the drive
  END_VAR
VAR_OUTPUT
  done : Bool;
END_VAR
VAR
  place : "Point";
  wait : TON;
END_VAR
VAR_TEMP
  i : Int;
END_VAR
BEGIN
  // what it does
  #i := #i + 1;
  #place.y := LIMIT(MN := 0.0, IN := #speed, MX := 10.0);
  "Plant".points[2].y := #place.y;
  "Plant".deep.last := 7;
  #wait(IN := #done, PT := T#1S);
END_FUNCTION_BLOCK
"""
OB = """ORGANIZATION_BLOCK "Main"
BEGIN
  "MoverData"(speed := 1.0);
END_ORGANIZATION_BLOCK
DATA_BLOCK "MoverData"
"Mover"
BEGIN
END_DATA_BLOCK
"""


@pytest.fixture
def desk(tmp_path: Path) -> Desk:
    """A folder with all of them on disk; none is open."""
    for name, text in (("point.udt", UDT), ("plant.db", DB), ("mover.scl", FB), ("main.scl", OB)):
        (tmp_path / name).write_text(text, "utf-8")
    return Desk(tmp_path)


def hovered(desk: Desk, text: str, name: str = "mover.scl") -> str:
    """What is shown at the cursor."""
    found = desk.workspace.hover(*desk.open(text, name))
    return "" if found is None else "\n".join([found.page.title, *(said for _, said in found.page.sections)])


@pytest.mark.parametrize("text", [UDT, DB, FB, OB])
def test_findings_are_those_of_check(text: str, tmp_path: Path) -> None:
    """With any one line left out: what ``check`` says of such a file, from the text alone."""
    desk = Desk(tmp_path)
    lines = text.splitlines(keepends=True)
    for out in range(len(lines)):
        damaged = "".join(lines[:out] + lines[out + 1 :])
        path = tmp_path / "damaged.scl"
        path.write_text(damaged, "utf-8")
        document = desk.workspace.open(path, damaged)
        said = [one.diagnostic for one in desk.workspace.diagnostics(document)]
        assert said == list(check_source(path).diagnostics)


def test_unsaved_text_counts(desk: Desk) -> None:
    """A mistake that is only in the editor, at its place."""
    document, *_ = desk.open(FB.replace("#i := #i + 1;", "#i := #i + ;"), "mover.scl")
    found = desk.workspace.diagnostics(document)
    assert [(one.diagnostic.code, one.diagnostic.span.line) for one in found] == [("PG801", 18)]
    assert found[0].reason


def test_type_and_offset(desk: Desk) -> None:
    """Standard access: a Bool takes byte 0, an array begins at a word, a Point has 8 bytes (2 + 4 + 1, filled up).

    points[2] begins at 2 + 8 = 10, its y two bytes behind that; deep behind 3 Points at 26.
    """
    y = hovered(desk, FB.replace("points[2].y", "points[2].|y"))
    assert "type: REAL" in y.replace("Real", "REAL")
    assert 'offset: 12.0 in DB "Plant"' in y
    assert "size: 4 B" in y
    assert "metres" in y
    assert 'offset: 26.0 in DB "Plant"' in hovered(desk, FB.replace("deep.last", "deep.la|st"))
    assert 'offset: 6.0 in FB "Mover"' in hovered(desk, FB.replace("#place.y :=", "#pl|ace.y :="))  # 4 + 1, filled up
    assert 'offset: 8.0 in FB "Mover"' in hovered(desk, FB.replace("#place.y :=", "#place.|y :="))
    assert "offset" not in hovered(desk, FB.replace("#i :=", "#|i :="))  # temporary data has no fixed place
    assert "optimized access" in hovered(desk, FB.replace("'FALSE'", "'TRUE'").replace("#place.y :=", "#place.|y :="))
    assert "offset: 2.0" in hovered(desk, UDT.replace("    y", "    |y"), "point.udt")


def test_definitions_over_files(desk: Desk) -> None:
    """A member of a type in another file, a block, a local variable."""

    def goes(text: str) -> tuple[str, int]:
        place = desk.workspace.definition(*desk.open(text, "mover.scl"))
        assert place is not None
        return Path(place.file).name, place.line

    assert goes(FB.replace("points[2].y", "points[2].|y")) == ("point.udt", 4)
    assert goes(FB.replace('"Plant".points', '"Pl|ant".points')) == ("plant.db", 1)
    assert goes(FB.replace("IN := #speed", "IN := #sp|eed")) == ("mover.scl", 4)
    assert goes(FB.replace(': "Point"', ': "Po|int"')) == ("point.udt", 1)


def test_references_over_files(desk: Desk) -> None:
    """The member y of the type: its declaration and three uses of it, though only one file is open."""
    places = desk.workspace.references(*desk.open(UDT.replace("    y", "    |y"), "point.udt"))
    assert [(Path(one.file).name, one.line) for one in places] == [
        ("point.udt", 4),
        ("mover.scl", 19),
        ("mover.scl", 20),
        ("mover.scl", 20),
    ]
    blocks = desk.workspace.references(*desk.open(OB.replace('"Mover"', '"Mo|ver"'), "main.scl"))
    assert [(Path(one.file).name, one.line) for one in blocks] == [("mover.scl", 1), ("main.scl", 6)]


def test_signatures(desk: Desk) -> None:
    """An instance, a function block by its instance DB, an instruction by position and by name."""

    def shown(text: str, name: str = "mover.scl") -> tuple[str, int]:
        found = desk.workspace.signature(*desk.open(text, name))
        return ("", 0) if found is None else (found.label, found.active)

    label, active = shown(FB.replace("PT := T#1S", "PT := |T#1S"))
    assert label.startswith("TON(IN := ")
    assert active == 1
    assert shown(OB.replace("speed := 1.0", "|speed := 1.0"), "main.scl") == ("Mover(speed := REAL, done => BOOL)", 0)
    assert shown(FB.replace("MX := 10.0", "MX := 10|.0")) == ("LIMIT(MN, IN, MX)", 2)
    assert shown(FB.replace("LIMIT(MN := 0.0, IN := #speed, MX := 10.0)", "LIMIT(0.0, |)")) == ("LIMIT(MN, IN, MX)", 1)
    assert shown(FB.replace("#i := #i + 1", "#i := |#i + 1")) == ("", 0)


def renamed(desk: Desk, text: str, name: str, new: str) -> dict[str, str]:
    """Every text of the folder after what stands at the cursor has another name."""
    document, line, column = desk.open(text, name)
    edits = desk.workspace.rename(document, line, column, new)
    texts = {path.name: path.read_text("utf-8") for path in desk.folder.iterdir()} | {name: document.text}
    places = {file: tuple(one for one in edits if Path(one.span.file).name == file) for file in texts}
    return {file: edited(text, places[file]) for file, text in texts.items()}


@pytest.mark.parametrize(
    ("text", "name", "new", "changed"),
    [
        (FB.replace("speed : Real", "spe|ed : Real"), "mover.scl", "pace",
         {"mover.scl": FB.replace("speed", "pace"), "main.scl": OB.replace("speed", "pace")}),
        (OB.replace("speed :=", "|speed :="), "main.scl", "pace",
         {"mover.scl": FB.replace("speed", "pace"), "main.scl": OB.replace("speed", "pace")}),
        (FB.replace("#i + 1", "#|i + 1"), "mover.scl", "two words",
         {"mover.scl": FB.replace("  i : Int", '  "two words" : Int').replace("#i", '#"two words"')}),
        (UDT.replace("  y :", "  |y :"), "point.udt", "height",
         {"point.udt": UDT.replace("y :", "height :"), "mover.scl": FB.replace(".y", ".height"),
          "plant.db": DB.replace(".y", ".height")}),
        (FB.replace('"Mover"', '"Mo|ver"'), "mover.scl", "Slider",
         {"mover.scl": FB.replace('"Mover"', '"Slider"'), "main.scl": OB.replace('"Mover"', '"Slider"')}),
        (FB.replace('"Plant".deep', '"Pl|ant".deep'), "mover.scl", "Site",
         {"mover.scl": FB.replace('"Plant"', '"Site"'), "plant.db": DB.replace('"Plant"', '"Site"')}),
    ],
)  # fmt: skip
def test_another_name(text: str, name: str, new: str, changed: dict[str, str], desk: Desk) -> None:
    """A parameter with the arguments of its calls, a local variable, a member of a type, blocks: everywhere, and
    nothing of the same name besides; with quotes where the new name needs them.
    """
    before = {"mover.scl": FB, "main.scl": OB, "plant.db": DB, "point.udt": UDT}
    assert renamed(desk, text, name, new) == before | changed


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("spe|ed : Real", "done", "already"),
        ("spe|ed : Real", "END_IF", "reserved"),
        ("spe|ed : Real", "a.b", "not allowed"),
        ("w|ait : TON", "Mover", None),
        ("TO|N", "x", "no name|system"),
        ("#wait(|IN", "x", "system"),
        ('FUNCTION_BLOCK "Mo|ver"', "Plant", "already"),
        ("#i := #i| + 1", "speed", "already"),
        ("#i := |#i + ;", "j", "cannot be read whole"),
    ],
)
def test_a_name_that_cannot_be_given(old: str, new: str, said: str | None, desk: Desk) -> None:
    """It is refused with the reason; a member may be called as a block is."""
    whole = old.replace("|", "")
    text = FB.replace("#i + 1;", "#i + ;") if whole not in FB else FB
    assert whole in text
    if said is None:
        assert renamed(desk, text.replace(whole, old), "mover.scl", new)
        return
    with pytest.raises(DiagnosticError, match=said):
        renamed(desk, text.replace(whole, old), "mover.scl", new)


def test_what_is_generated_keeps_its_names(desk: Desk) -> None:
    """A file of a manifest, or a second program in the folder with the same block: the reason names what to do."""
    shutil.copytree(ROOT / "examples/s7-1500_g120_pn/expected", desk.folder / "made")
    source = desk.folder / "made/Pump_station.scl"
    text = source.read_text("utf-8-sig").replace('FUNCTION_BLOCK "', 'FUNCTION_BLOCK "|', 1)
    with pytest.raises(DiagnosticError, match="generated from a spec"):
        desk.workspace.rename(*desk.open(text, "made/Pump_station.scl"), "other")
    (desk.folder / "copy.scl").write_text(FB, "utf-8")
    desk.workspace.changed()
    with pytest.raises(DiagnosticError, match=r"more than once: mover.scl and copy.scl"):
        renamed(desk, FB.replace("spe|ed", "speed").replace("speed : Real", "spe|ed : Real"), "mover.scl", "pace")


@pytest.mark.parametrize("name", sorted(parameters()))
def test_parameters_of_the_table_are_those_that_the_soft_cpu_takes(name: str) -> None:
    """A call with each of them by name is compiled; with another name in the place of the first it is refused."""

    def refused(names: tuple[str, ...]) -> list[bool]:
        call = f"{name}({', '.join(f'{one} := 1' for one in names)});"
        source = f'FUNCTION "Probe" : VOID\nBEGIN\n{call}\nEND_FUNCTION\n'
        targets = (Dialect.TIA_1200_1500, Dialect.TIA_300_400)
        found = [Program.load([("probe.scl", source)], target).diagnostics for target in targets]
        return [any(one.code == "PG822" for one in each) for each in found]

    names = parameters()[name]
    assert False in refused(names)
    assert True in refused(("nonsense_", *names[1:]))


def test_types_of_functions_are_shown(desk: Desk) -> None:
    """What the table of the soft CPU says of each parameter; a type behind the name changes nothing."""
    for name in ("NORM_X", "NORM_X_REAL"):
        found = desk.workspace.signature(*desk.open(FB.replace("LIMIT(MN := 0.0", f"{name}(MIN := |0.0"), "mover.scl"))
        assert found is not None
        assert found.label == f"{name}(MIN := any type, VALUE := any type, MAX := any type)"


def test_outline(desk: Desk) -> None:
    """Blocks and their members; what is in a structure stands in it."""
    document, *_ = desk.open(DB, "plant.db")
    (block,) = desk.workspace.outline(document)
    assert (block.name, block.kind, block.place.line, block.place.column) == ("Plant", "block", 1, 12)
    assert [(one.name, one.detail) for one in block.children] == [
        ("on", "Bool"),
        ("points", 'Array[1..3] of "Point"'),
        ("deep", "Struct"),
    ]
    assert [one.name for one in block.children[2].children] == ["last"]


def coloured(desk: Desk, document: Document) -> list[Token]:
    """The tokens of a file that is read as a whole."""
    ((first, painted),) = desk.workspace.tokens(document)
    assert first == 0
    return list(painted.tokens)


def test_colours(desk: Desk) -> None:
    """Every token once, in order, inside its line; words of the language, locals, blocks, numbers, comments."""
    document, *_ = desk.open(FB, "mover.scl")
    found = coloured(desk, document)
    kinds = {document.part(one.span): one.kind for one in found}
    assert kinds["FUNCTION_BLOCK"] == "keyword"
    assert kinds["#speed"] == "variable"
    assert kinds['"Plant"'] == "namespace"
    assert kinds["T#1S"] == "number"
    assert kinds["LIMIT"] == "function"
    assert kinds["Real"] == "type"
    assert kinds["points"] == "property"
    assert kinds["// what it does"] == "comment"
    places = [(one.span.line, one.span.column, one.span.end_column) for one in found]
    assert places == sorted(places)
    assert all(before[0] < after[0] or before[2] <= after[1] for before, after in pairwise(places))


def test_comments_over_lines(desk: Desk) -> None:
    """A comment of three lines is three parts."""
    document, *_ = desk.open("FUNCTION f : Void\n(* one\n   two\n three *)\nBEGIN\nEND_FUNCTION\n", "f.scl")
    found = [document.part(one.span) for one in coloured(desk, document) if one.kind == "comment"]
    assert found == ["(* one", "   two", " three *)"]


def test_typing_reads_no_other_file(desk: Desk, monkeypatch: pytest.MonkeyPatch) -> None:
    """Other files are read for the first answer, and again only when one of them is another on disk."""
    read: list[str] = []
    load = source_state.load_text
    monkeypatch.setattr(source_state, "load_text", lambda path: read.append(Path(path).name) or load(path))
    text = FB.replace("points[2].y", "points[2].|y")
    assert "12.0" in hovered(desk, text)
    assert sorted(read) == ["main.scl", "plant.db", "point.udt"]
    read.clear()
    for n in range(50):
        assert "12.0" in hovered(desk, f"{text}// {n}\n")
    assert read == []
    (desk.folder / "point.udt").write_text(UDT.replace("x : Int", "x : DInt; z : DInt"), "utf-8")
    desk.workspace.changed()
    assert "24.0" in hovered(desk, text)  # 2 + 14 + 8
    assert read == ["point.udt"]


def test_an_open_type_counts(desk: Desk) -> None:
    """What an open file declares is known to the others before it is saved: 4 + 4 bytes more in front of y."""
    desk.open(UDT.replace("x : Int", "w : DInt; x : DInt"), "point.udt")
    assert 'offset: 24.0 in DB "Plant"' in hovered(desk, FB.replace("points[2].y", "points[2].|y"))  # 2 + 14 + 8


def test_edits_leave_nothing(desk: Desk) -> None:
    """After 10,000 edits one version of one source is known."""
    for n in range(10_000):
        document, *_ = desk.open(f"{FB}// {n}\n", "mover.scl")
        if n % 200 == 0:
            desk.workspace.diagnostics(document)
            desk.workspace.hover(document, 20, 21)
    gc.collect()
    kept = [one for one in gc.get_objects() if isinstance(one, Document | SourceState)]
    assert len(kept) <= 3


@pytest.mark.parametrize(
    "text", ["", "\n", "FUNCTION_BLOCK", '"', "(*", "'", "TYPE a : STRUCT x : ARRAY[", "#", "\ufeff", "a.b.c["]
)
def test_half_a_text(desk: Desk, text: str) -> None:
    """Every question has an answer at every place of a text that has just begun."""
    document, *_ = desk.open(text, "x.scl")
    for line in range(1, 4):
        for column in range(1, len(text) + 3):
            desk.workspace.hover(document, line, column)
            desk.workspace.definition(document, line, column)
            desk.workspace.references(document, line, column)
            desk.workspace.signature(document, line, column)
    desk.workspace.outline(document)
    desk.workspace.tokens(document)
    desk.workspace.diagnostics(document)


@pytest.mark.parametrize("what", PAIRS)
def test_simatic_sd(what: str, tmp_path: Path) -> None:
    """A document has the outline of the source that says the same, and no problem; its attributes are texts."""
    desk = Desk(tmp_path)
    document, source = (
        desk.workspace.open(tmp_path / name, text) for name, text in zip(("a.s7dcl", "b.scl"), PAIRS[what], strict=True)
    )

    def names(symbols: tuple[Symbol, ...]) -> list[object]:
        return [(one.name, one.kind, names(one.children)) for one in symbols]

    assert names(desk.workspace.outline(document)) == names(desk.workspace.outline(source)) != []
    assert desk.workspace.diagnostics(document) == ()
    colours = {document.part(one.span): one.kind for one in coloured(desk, document)}
    assert {colours[text] for text in ('"TRUE"', '"0.1"') if text in colours} <= {"string"}


def test_completion(desk: Desk) -> None:
    """Variables of the block, members of a type in another file, blocks; while the statement is broken."""

    def offered(written: str) -> list[str]:
        document, line, column = desk.open(FB.replace("#i := #i + 1;", written), "mover.scl")
        return [one.label for one in desk.workspace.complete(document, line, column)]

    assert offered("#|") == ["speed", "done", "place", "wait", "i"]
    assert offered("#place.|") == ["x", "y", "ok"]
    assert offered('"Plant".points[2].|') == ["x", "y", "ok"]
    assert offered('x := "Plant".de|') == ["on", "points", "deep"]
    assert "PT" in offered("#wait.|")
    assert {"Plant", "Mover", "MoverData", "Point"} <= set(offered('"|'))
    assert offered("1 + |") == []
