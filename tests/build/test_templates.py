"""Templates: written once as TIA SCL, rewritten for the other compilers when they are loaded."""

from __future__ import annotations

import re
from pathlib import Path

import jinja2
import pytest

from plcgen.base.diagnostics import Report
from plcgen.base.resources import templates_dir
from plcgen.build.document import Document
from plcgen.build.engine import emit
from plcgen.build.environment import environment, expand_marks, render_text, respell_template
from plcgen.project.loading import parse_spec
from plcgen.project.resolve import resolve
from plcgen.s7.scl.classic import Spelling, respell
from tests.projects import ROOT, SPECS, every_type, generated_example

TEXTS = {path.stem: path.read_text("utf-8") for path in SPECS} | {
    f"every type, {target}": every_type(target) for target in ("v5", "t3", "old")
}
KINDS = ROOT / "plcgen" / "ds47" / "kinds"
FILES = sorted(path for folder in (templates_dir(), KINDS) for path in folder.rglob("*.j2"))
SOURCES = [path for path in FILES if path.stem.endswith((".scl", ".udt", ".db"))]


def documents(text: str) -> list[Document]:
    loaded = parse_spec(text, "job.yaml", Report())
    assert loaded is not None
    return list(emit(resolve(loaded, Report())))


@pytest.mark.parametrize("name", TEXTS)
def test_rewriting_the_template_is_rewriting_the_text(name: str) -> None:
    """Templates are rewritten once, with their tags as words; the finished text rewritten as a whole is the same."""
    sources = [d for d in documents(TEXTS[name]) if d.path.split("/", 1)[0] in {"scl", "udt", "db"}]
    assert sources
    for document in sources:
        text = render_text(document.template, document.view, document.spelling)
        assert text == respell(render_text(document.template, document.view), document.spelling), document.path


def test_tags_come_through_unchanged() -> None:
    """Jinja's own text is hidden from the rewriting, whatever stands in it."""
    source = (
        "REGION {{ job['#title'] }}\n{% if a == 'Int' %}\n#stat{{ x }} := #{{ y ~ '#z' }}[{{ i }}];{# #a : Bool #}\n"
        "{% endif %}\nEND_REGION\n  m{{ n }} : Array[0..{{ last }}] of {{ type }};{% if b %} #c{% endif %}\n"
    )
    assert respell_template(source, Spelling.STEP7_V5) == (
        "// ---- {{ job['#title'] }} ----\n{% if a == 'Int' %}\nstat{{ x }} := {{ y ~ '#z' }}[{{ i }}];"
        "{# #a : Bool #}\n{% endif %}\n  m{{ n }} : ARRAY[0..{{ last }}] OF {{ type }};{% if b %} c{% endif %}\n"
    )


@pytest.mark.parametrize("path", SOURCES, ids=lambda p: "/".join(p.parts[-2:]))
def test_a_template_reads_as_scl(path: Path) -> None:
    """Jinja is there for loops, choices and names: no operator, local name or keyword of SCL is made inside a tag."""
    for tag in re.findall(r"\{\{.*?\}\}|\{%.*?%\}", path.read_text("utf-8"), re.DOTALL):
        code = re.sub(r"\{%\s*include.*?%\}", "", tag)
        assert not re.search(r"""["'][^"']*(?:#|=>|:=(?! ["'])|\bEND_|\bSFC)""", code), tag


def test_the_goldens_have_every_spelling() -> None:
    """The shipped examples hold all three: what the tests above compare is really different."""
    texts = {s: p.read_text("utf-8-sig") for s in SPECS for p in generated_example(s.stem).glob("*.scl")}
    assert any("\nREGION " in text for text in texts.values())
    assert any("// ---- " in text and "#" in text for text in texts.values())
    assert any("\nCONST\n" in text for text in texts.values())


MARK = re.compile(r"\{\{.*?\}\}|\{%.*?%\}", re.DOTALL)
JOB = [path for path in SOURCES if "ds47" in path.parts and "engine" not in path.parts]


@pytest.mark.parametrize("path", JOB, ids=lambda p: "/".join(p.parts[-2:]))
def test_the_template_of_a_job_does_not_calculate(path: Path) -> None:
    """Views hand over finished numbers and names: in a mark nothing is added, counted or formatted."""
    for mark in MARK.findall(path.read_text("utf-8")):
        code = re.sub(r"""\{%\s*include.*?%\}|"[^"]*"|'[^']*'""", "", mark)[2:-2]
        assert not re.search(r"[-+*/%|\[]|\brange\b|\bnamespace\b", code), mark


def test_an_indented_include_is_moved_to_the_right() -> None:
    """By as much as the mark; empty lines stay empty, an include of nothing leaves nothing, no line is added."""
    source = 'IF a THEN\n    {% include "one" %}\n{% include "one" %}\n  {% include "none" %}\nEND_IF;\n'
    prepared = expand_marks(source)
    assert prepared.count("\n") == source.count("\n")
    inner = {"one": "{% if true %}\nb;\n\n  c;\n{% endif %}\n", "none": "{% if false %}\nb;\n{% endif %}\n"}
    made = environment().overlay(loader=jinja2.DictLoader({"frame": prepared, **inner}))
    assert made.get_template("frame").render() == "IF a THEN\n    b;\n\n      c;\nb;\n\n  c;\nEND_IF;\n"


def test_the_page_explains_every_condition_and_part() -> None:
    """templates/README.md has each condition of the templates of a job and each part of a feature, and no others."""
    page = (ROOT / "templates" / "README.md").read_text("utf-8")
    text = "".join(path.read_text("utf-8") for path in JOB)
    conditions = {name for mark in re.findall(r"\{% (?:el)?if(.*?)%\}", text) for name in re.findall(r"job\.\w+", mark)}
    explained = {
        name for row in re.findall(r"^\| (`.*?) \|", page, re.MULTILINE) for name in re.findall(r"`(.*?)`", row)
    }
    assert {name for name in explained if re.fullmatch(r"job\.\w+", name)} == conditions
    parts = {name for mark in re.findall(r"\{%.*?%\}", text) for name in re.findall(r'part == "(.*?)"', mark)}
    places = set(re.findall(r'\{% (?:part|term) "(.*?)"', text))
    assert parts == places
    assert parts <= explained
