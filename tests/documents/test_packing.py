"""Very large projects: what is kept compressed is written as the same bytes."""

from __future__ import annotations

from pathlib import Path

import pytest
from projects import FAQ, ROOT

from plcgen import api
from plcgen.documents import environment
from plcgen.documents.environment import RenderedFile


def test_packed_files_have_the_same_bytes() -> None:
    """Small files stay as they are, large ones shrink."""
    small, large = RenderedFile("a", b"x" * 100), RenderedFile("b", b"y" * 100_000, "note")
    assert small.pack() is small
    packed = large.pack()
    assert (packed.data, packed.path, packed.experimental) == (large.data, "b", "note")
    assert len(packed.content) < 1000
    assert packed.pack() is packed


def test_a_project_beyond_the_bound_is_written_the_same(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Every byte as in the shipped example, with nothing kept plain."""
    monkeypatch.setattr(environment, "MAX_PLAIN", 0)
    assert api.generate(FAQ, tmp_path / "out").ok
    expected = ROOT / "examples" / FAQ.stem / "expected"
    for path in expected.rglob("*"):
        if path.is_file():
            assert (tmp_path / "out" / path.relative_to(expected)).read_bytes() == path.read_bytes()
