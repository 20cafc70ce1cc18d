"""What a call leaves behind: no project, no plan, no source; and the garbage collector as it was."""

from __future__ import annotations

import gc
import weakref
from pathlib import Path

import pytest

import plcgen
from plcgen.build.rendering import render_project
from plcgen.project.nouns import Plan, Project
from plcgen.s7.scl import ast
from plcgen.s7.types.blocks import Block
from tests.projects import FAQ, ROOT

SPECS = [FAQ, ROOT / "specs" / "s7-1200_s7-200_ppi.yaml"]


@pytest.fixture(scope="module")
def apart() -> None:
    """What other tests left behind is not looked at: each look would take a second."""
    gc.collect()
    gc.freeze()


def alive(*classes: type) -> int:
    """How many objects of these classes there are."""
    gc.collect()
    return sum(isinstance(found, classes) for found in gc.get_objects())


@pytest.mark.slow
@pytest.mark.usefixtures("apart")
@pytest.mark.parametrize("spec", SPECS, ids=lambda path: path.stem)
def test_no_cache_keeps_a_project(spec: Path, tmp_path: Path) -> None:
    """Whoever forgets a project and what was made of it gets its memory back."""
    before = alive(Project, Plan)
    project = plcgen.check(spec).project
    assert project is not None
    known = [weakref.ref(project), *(weakref.ref(plan) for plan in project.plans)]
    assert len(list(render_project(project))) > 10
    assert plcgen.generate(spec, tmp_path / "out").ok
    assert plcgen.verify(spec, tmp_path / "out", faults="none").ok
    assert plcgen.layout(spec).blocks
    assert plcgen.encode(spec).ok
    assert plcgen.diff(spec, spec).readable
    assert alive(Project, Plan) > before
    del project
    assert alive(Project, Plan) == before
    assert [found() for found in known] == [None] * len(known)


@pytest.mark.slow
@pytest.mark.usefixtures("apart")
def test_no_cache_keeps_sources(tmp_path: Path) -> None:
    """Another run over other sources of the same size leaves no more blocks and statements behind."""
    text = (
        'FUNCTION_BLOCK "Motor{n}"\nVAR_INPUT start{n} : BOOL; END_VAR\n'
        "VAR s : STRUCT a{n} : INT; END_STRUCT; END_VAR\n"
        "BEGIN\nIF #start{n} THEN #s.a{n} := #s.a{n} + {n}; END_IF;\nEND_FUNCTION_BLOCK\n"
    )
    counts = []
    for n in range(3):
        source = tmp_path / str(n) / "x.scl"
        source.parent.mkdir()
        source.write_text(text.replace("{n}", str(n)))
        assert plcgen.layout(source).blocks
        assert plcgen.convert(source, to="xml", out=source.parent / "xml").ok
        assert plcgen.convert(source.parent / "xml", to="scl", out=source.parent / "scl").ok
        assert plcgen.diff(source, source.parent / "scl").readable
        counts.append(alive(Block, ast.Statement))
    assert counts[1] == counts[2]


def test_the_collector_of_the_caller(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Thresholds and switch of the garbage collector belong to the process that imports plcgen."""
    for name in ("disable", "freeze", "set_threshold"):
        monkeypatch.setattr(gc, name, lambda *_: pytest.fail("the collector is not ours"))
    assert plcgen.generate(FAQ, tmp_path / "out").ok
    assert plcgen.layout(tmp_path / "out").blocks
    assert plcgen.verify(FAQ, tmp_path / "out", faults="none").ok
    assert gc.isenabled()
