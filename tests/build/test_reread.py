"""A text that gets past everything else does not become code: its place holds it, and the source is read again."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import pytest

from plcgen import api
from plcgen.base.diagnostics import DiagnosticError
from plcgen.build import reread as module
from plcgen.build.document import Document
from plcgen.build.engine import emit
from plcgen.build.environment import environment, render_all, render_text, respell_template
from plcgen.build.holes import FILTERS, StrayTextError, guard, left_its_place
from plcgen.build.nouns import MemberRow, StartAssignment
from plcgen.build.reread import Promise, reread
from plcgen.project.nouns import Project
from plcgen.s7.scl.classic import Spelling
from tests.projects import ROOT

V5, TIA_300, TIA_1500 = "s7-300_plant_v5", "s7-300_6ra80_dp_tia", "s7-1200_s120_recipe"
TYPE = 'TYPE "t"\nVERSION : 0.1\n  STRUCT\n    speed : Real := 1.5;  // rpm\n  END_STRUCT;\nEND_TYPE\n'
SPEED = MemberRow("speed", "Real", "rpm", "1.5")


def project(stem: str) -> Project:
    found = api.check(ROOT / "specs" / f"{stem}.yaml").project
    assert found is not None
    return found


@pytest.mark.parametrize(
    ("template", "kind"),
    [
        ('FUNCTION_BLOCK "{{ x }}"', "in_quotes"),
        ('  statTicket : "{{ a }}_{{ x }}";', "in_quotes"),
        ("TITLE = {{ x }}", "in_line"),
        ("TITLE = '{{ x }}'", "in_string"),
        ("REGION {{ x }}", "in_line"),
        ("// {{ x }}", "in_line"),
        ("  {{ a }} : Bool;  // {{ x }}", "in_line"),
        ("{% if a %}  // {{ x }}{% endif +%}", "in_line"),
        ("  {{ x }} : Bool;", "in_name"),
        ("  {{ x }} := 1;", "in_code"),
        ('  #{{ x }} := "{{ a }}".b;', "in_code"),
    ],
)
def test_where_a_template_prints(template: str, kind: str) -> None:
    """The last place of a line is held as what surrounds it says."""
    assert re.search(rf"\\( x \\) \\| {kind} ", guard(template)), guard(template)


@pytest.mark.parametrize("kind", FILTERS)
@pytest.mark.parametrize("char", ["\n", "\r", "\x85", "\u2028", "\u2029", "\u202e", "\0"])
def test_no_place_takes_what_ends_a_line(kind: str, char: str) -> None:
    """Code may have several lines, as the arguments of a call; nothing else may."""
    if (kind, char) == ("in_code", "\n"):
        assert FILTERS[kind]("a := 1,\n    b := 2")
    else:
        with pytest.raises(StrayTextError):
            FILTERS[kind](f"a{char}b")


@pytest.mark.parametrize(
    ("kind", "text"),
    [("in_quotes", 'a"b'), ("in_string", "a'b"), ("in_name", "x : INT; y"), ("in_name", "a, b"), ("in_name", "")]
    + [("in_code", text) for text in ("a; b", "a // b", "a (* b", "a */", "{x}", "'", '"', "a'b''")],
)
def test_what_leaves_its_place(kind: str, text: str) -> None:
    """It is refused; in quotes of its own the same is a value."""
    with pytest.raises(StrayTextError):
        FILTERS[kind](text)
    assert FILTERS["in_code"]("';'") == "';'"
    assert FILTERS["in_code"](7) == 7


@pytest.mark.parametrize("spelling", Spelling)
def test_a_template_in_every_spelling_is_held(spelling: Spelling) -> None:
    """Also where another spelling makes a comment of a region."""
    assert "REGION {{ title }}" in guard(respell_template("REGION {{ title }}\nEND_REGION\n", spelling)).replace(
        "( title ) | in_line ", "title "
    ).replace("// ---- {{ title }} ----", "REGION {{ title }}")
    with pytest.raises(StrayTextError):
        render_text("shared/instance.db.j2", {"name": 'x" y', "of": "z"}, spelling)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (TYPE.replace('"t"', '"u"'), "it is UDT u"),
        (TYPE.replace("speed", "slow"), "speed is slow"),
        (TYPE.replace("1.5", "55.5"), "speed is speed := 55.5"),
        (TYPE.replace("rpm", "1/min"), "speed is speed := 1.5, 1/min"),
        (TYPE.replace("  END_STRUCT", "    more : Int;\n  END_STRUCT"), "2 members where 1 are meant"),
        (TYPE + TYPE.replace('"t"', '"u"'), "2 blocks"),
        ("", "0 blocks"),
        (TYPE.replace("Real", "Nonsense of"), "line 4"),
    ],
)
def test_a_type_that_is_not_the_planned_one(text: str, said: str) -> None:
    """Name, members, comments and start values are those of the nouns, and there is one block."""
    promise = Promise("UDT", "t", str, [SPEED], starts=True)
    assert reread(TYPE, "udt/t.udt", promise).name == "t"
    with pytest.raises(DiagnosticError, match=said) as caught:
        reread(text, "udt/t.udt", promise)
    assert [(one.code, one.span.file) for one in caught.value.diagnostics] == [("PG510", "udt/t.udt")]


def test_an_assignment_that_nobody_planned() -> None:
    """A comment behind a start value that goes on as code: the case with which it began."""
    lines = "  record[1].ramp := 5.0;  // copper\n    record[1].ramp := 55.5; //\n"
    text = f'DATA_BLOCK "d"\n  STRUCT\n    speed : Real := 1.5;  // rpm\n  END_STRUCT;\nBEGIN\n{lines}END_DATA_BLOCK\n'
    planned = [StartAssignment("record[1].ramp", "5.0", "copper")]
    with pytest.raises(DiagnosticError, match="assigns other start values"):
        reread(text, "db/d.db", Promise("DB", "d", str, [SPEED], planned))


@pytest.mark.parametrize("stem", [V5, TIA_300, TIA_1500])
def test_every_source_of_every_target_is_read_again(stem: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """As many times as there are blocks."""
    read: list[str] = []
    monkeypatch.setattr(Promise, "broken", lambda _, block: read.append(block.name) or ())
    files = [file.path for file in render_all(emit(project(stem)))]
    assert len(read) == sum(path.startswith(("udt/", "db/", "scl/", "example/")) for path in files) > 10


@pytest.mark.parametrize("stem", [V5, TIA_300, TIA_1500])
def test_nothing_is_written_if_a_source_says_something_else(
    stem: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A diagnostic, and no folder."""
    monkeypatch.setattr(module.Promise, "broken", lambda *_: iter(["it is another one"]))
    result = api.generate(ROOT / "specs" / f"{stem}.yaml", tmp_path / "out")
    assert [one.code for one in result.diagnostics if one.severity.label == "error"] == ["PG510"]
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("name", ["x : Bool; y", "x, y", "x\n  y"])
def test_a_pin_that_gets_past_the_rules(name: str) -> None:
    """Neither its place in the template nor the second reading lets it through."""
    plan = project(V5).plans[0]
    program = next(one for one in plan.protocol.documents(plan).programs if one.commands and one.commands[0].inputs)
    command = program.commands[0]
    member = replace(command.inputs[0], member=command.inputs[0].member._replace(name=name))
    promise = Promise("FB", program.block.name, str, commands=[replace(command, inputs=[member])])
    text = next(f.data for f in render_all(emit(project(V5))) if f.path == f"scl/{program.block.name}.scl")
    with pytest.raises(DiagnosticError, match="it has no"):
        reread(text.decode("cp1252"), "scl/x.scl", promise)


def codes_of(document: Document) -> set[str]:
    """Why a source is refused."""
    try:
        list(render_all([replace(document, twins=None)]))
    except DiagnosticError as problem:
        return {one.code for one in problem.diagnostics}
    return set()


@pytest.mark.parametrize("stem", [V5, TIA_300, TIA_1500])
@pytest.mark.parametrize(
    ("kind", "stray"),
    [
        ("in_line", "\n  #statTicket := 1;"),
        ("in_line", "\n  // more"),
        ("in_quotes", '" := 1; "'),
        ("in_string", "'; x := '"),
        ("in_name", " : Bool; y"),
    ],
)
def test_no_source_depends_on_the_filters(kind: str, stray: str, stem: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """A place that holds nothing is noticed when the source is read again: in a body and a comment, too.

    Every source whose template has such a place is refused, with all others as they are.
    """
    documents = [one for one in emit(project(stem)) if one.promise is not None]
    spelling = documents[0].spelling
    held = environment(spelling).filters[kind]
    refused = 0
    for document in documents:
        filled = []

        def loose(value: object, filled: list[object] = filled) -> object:
            shown = held(value)
            filled.append(shown)
            return f"{value}{stray}" if shown == value and len(filled) == 1 else shown

        with monkeypatch.context() as patch:
            patch.setitem(environment(spelling).filters, kind, loose)
            codes = codes_of(document)
        assert codes == ({"PG510"} if filled else set()), document.path
        refused += bool(codes)
    assert refused or kind == "in_string"


def test_a_source_of_which_nothing_is_promised() -> None:
    """A new template that nobody reads again is none."""
    document = replace(next(one for one in emit(project(V5)) if one.promise is not None), promise=None)
    with pytest.raises(DiagnosticError, match="nothing is promised"):
        list(render_all([document]))


@pytest.mark.parametrize(
    ("text", "stray"),
    [
        ("a := 1; // x", ""),
        ("b := 1; // *) (* \" ' $ := ;", ""),
        ("b := 2; // x", "2"),
        ("a := 1; c // x", "c"),
        ("a := 1; // x // y\n// z", "// z"),
        ("a (* := 1; // x", "("),
        ("a := 1;", "// \ua4d1"),
    ],
)
def test_what_left_its_place(text: str, stray: str) -> None:
    """Names and comments may be any, their number and the rest may not."""
    assert left_its_place(text, "\ua4d1 := 1; // \ua4d1") == stray
