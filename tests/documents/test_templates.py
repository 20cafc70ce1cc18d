"""Templates: written once as TIA SCL, rewritten for the other compilers when they are loaded."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from projects import SPECS, every_type, generated_example

from plcgen.diagnostics import Report
from plcgen.documents.document import Document
from plcgen.documents.engine import emit
from plcgen.documents.environment import render_text, respell_template
from plcgen.project.loading import parse_spec
from plcgen.project.resolve import resolve
from plcgen.resources import templates_dir
from plcgen.scl.classic import Spelling, respell

TEXTS = {path.stem: path.read_text("utf-8") for path in SPECS} | {
    f"every type, {target}": every_type(target) for target in ("v5", "t3", "old")
}
SOURCES = [path for path in sorted(templates_dir().rglob("*.j2")) if path.stem.endswith((".scl", ".udt", ".db"))]


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


@pytest.mark.parametrize("path", SOURCES, ids=lambda p: p.relative_to(templates_dir()).as_posix())
def test_a_template_reads_as_scl(path: Path) -> None:
    """Jinja is there for loops, choices and names: no operator, local name or keyword of SCL is made inside a tag."""
    for tag in re.findall(r"\{\{.*?\}\}|\{%.*?%\}", path.read_text("utf-8"), re.DOTALL):
        code = re.sub(r"\{%\s*include.*?%\}", "", tag)
        assert not re.search(r"""["'][^"']*(?:#|=>|:=(?! ["'])|\bEND_|\bSFC)""", code), tag


def test_the_goldens_have_every_spelling() -> None:
    """The shipped examples hold all three: what the tests above compare is really different."""
    texts = {p.name: p.read_text("utf-8-sig") for s in SPECS for p in generated_example(s.stem).glob("scl/*.scl")}
    assert any("\nREGION " in text for text in texts.values())
    assert any("// ---- " in text and "#" in text for text in texts.values())
    assert any("\nCONST\n" in text for text in texts.values())
