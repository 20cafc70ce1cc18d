"""A large source: an edit reads the block in which it is, and every answer is that of a text read as a whole."""

from __future__ import annotations

import gc
import random
from pathlib import Path

import pytest

from plcgen.workbench.service import Document, Workspace
from plcgen.workbench.service.sources import parts, version, views
from tests.projects import generated_example
from tests.workbench.desk import Desk

EXAMPLE = "s7-1500_g120_pn"


def large() -> str:
    """A generated source of several thousand lines."""
    (made,) = generated_example(EXAMPLE).glob("*.scl")
    return made.read_text("utf-8-sig").replace("\r\n", "\n")


def answers(workspace: Workspace, document: Document, line: int) -> list[object]:
    """Everything that can be asked about a text, at the places of one line."""
    found: list[object] = [
        [(one.diagnostic, [fix.edits for fix in one.fixes]) for one in workspace.diagnostics(document)],
        workspace.outline(document),
    ]
    colours = []
    for first, painted in workspace.tokens(document):
        colours += [(one.span.line + first, one.span.column, one.span.end_column, one.kind) for one in painted.tokens]
    found.append(colours)
    text = document.lines[line - 1]
    for column in sorted({1, len(text) // 2 + 1, len(text) + 1, *(n + 1 for n, c in enumerate(text) if c in '#".(')}):
        where = (document, line, column)
        found += [
            workspace.hover(*where), workspace.definition(*where), workspace.references(*where)[:50],
            workspace.complete(*where), workspace.signature(*where), workspace.name_at(*where),
        ]  # fmt: skip
    return found


@pytest.fixture
def desk(tmp_path: Path) -> Desk:
    """An empty folder."""
    return Desk(tmp_path)


def test_an_edit_reads_one_block(desk: Desk, monkeypatch: pytest.MonkeyPatch) -> None:
    """Hover, completion, outline, colours and problems after an edit: the lines of its block alone are read."""
    text = large()
    document, *_ = desk.open(text, "large.scl")
    answers(desk.workspace, document, 1)
    line = next(n for n, one in enumerate(text.split("\n"), 1) if one.lstrip().startswith("#") and n > 1000)
    lines = text.split("\n")
    lines.insert(line, "      // " + lines[line].strip())
    edited, *_ = desk.open("\n".join(lines), "large.scl")
    read: list[int] = []
    whole = version.read_shown

    def counted(shown: str, *rest: object, **more: object) -> object:
        read.append(shown.count("\n"))
        return whole(shown, *rest, **more)  # type: ignore[arg-type]

    monkeypatch.setattr(version, "read_shown", counted)
    answers(desk.workspace, edited, line)
    assert len(read) == 1
    assert read[0] < len(lines) / 2
    assert len(lines) > parts.LARGE


EDITS = {
    "drop": lambda lines, at: lines[:at] + lines[at + 1 :],
    "double": lambda lines, at: lines[:at] + lines[at : at + 1] + lines[at:],
    "cut": lambda lines, at: [*lines[:at], lines[at][: len(lines[at]) // 2], *lines[at + 1 :]],
    "comment": lambda lines, at: [*lines[:at], "// a", "", *lines[at:]],
    "open comment": lambda lines, at: [*lines[:at], "(* a", *lines[at:]],
    "block": lambda lines, at: [*lines[:at], 'FUNCTION "a" : VOID', *lines[at:]],
    "statement": lambda lines, at: [*lines[:at], "#a := #b.c;", *lines[at:]],
}


@pytest.mark.parametrize("kind", EDITS)
def test_answers_are_those_of_the_whole(kind: str, desk: Desk, monkeypatch: pytest.MonkeyPatch) -> None:
    """Two edits in a row, at places that are drawn and at words of blocks: the same as of a text that is new."""
    random_ = random.Random(kind)  # the same places each time
    base = large().split("\n")
    words = ("FUNCTION", "END_", "DATA", "TYPE", "VAR", "BEGIN")
    heads = [number for number, line in enumerate(base) if line.startswith(words)]
    for at in (*random_.sample(heads, 3), *random_.sample(range(len(base)), 3)):
        lines = base
        document, *_ = desk.open("\n".join(lines), "large.scl")
        assert len(desk.workspace.tokens(document)) > 3
        for place in (at, min(at + 2, len(base) - 1)):
            lines = EDITS[kind](lines, place)
            document, *_ = desk.open("\n".join(lines), "large.scl")
            line = min(place + 1, len(lines))
            found, fresh = answers(desk.workspace, document, line), Workspace(desk.folder)
            with monkeypatch.context() as patch:
                patch.setattr(parts, "LARGE", 1_000_000)
                whole = answers(fresh, fresh.open(document.path, document.text), line)
            assert found == whole, (kind, at)


def test_edits_leave_nothing(desk: Desk) -> None:
    """After 200 edits that are each asked about there is one state for each part, and no colours of others."""
    text = large()
    assert "// a rising edge" in text
    for number in range(200):
        document, *_ = desk.open(text.replace("// a rising edge", f"// {number}", 1), "large.scl")
        desk.workspace.tokens(document)
        desk.workspace.hover(document, 700, 5)
    gc.collect()
    kept = [one for one in gc.get_objects() if isinstance(one, version.SourceState)]
    count = len(desk.workspace.tokens(document))
    assert count > 3
    assert len(kept) == count
    assert len(views._PAINTED) <= count
