"""The benchmarks run: what they measure is still there, and their peers take the text that they are given."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Callable

import pytest

from tests.bench import cpu_speed, editing, scale, scl_speed
from tests.bench.specs import grid, many_jobs


@pytest.fixture(autouse=True)
def _once(monkeypatch: pytest.MonkeyPatch) -> None:
    """Every run once: the figures say nothing."""

    def once(run: Callable[[], object], repeat: int = 1) -> float:  # noqa: ARG001 - how often does not matter
        run()
        return 1.0

    monkeypatch.setattr(cpu_speed, "best", once)
    monkeypatch.setattr(scl_speed, "alternate", lambda *runs: [once(run) if run else 1.0 for run in runs])


def test_the_soft_cpu(capsys: pytest.CaptureFixture[str]) -> None:
    """A line for each target."""
    cpu_speed.main()
    out = capsys.readouterr().out
    assert [out.count(f"idle scans, {target}") for target in cpu_speed.SPECS] == [1, 1, 1]


def test_the_front_end_beside_its_peers(capsys: pytest.CaptureFixture[str]) -> None:
    """Lark parses the same generated blocks, awlsim runs the same loop."""
    scl_speed.main()
    out = capsys.readouterr().out
    assert "not installed" not in out
    assert out.count("ratio") == 3


@pytest.mark.slow
def test_an_edit_beside_a_check(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    """Four questions of each of the two files, five of the page, every one with a goal."""
    monkeypatch.setattr(editing, "median", lambda run, _: (run(), 1.0)[1])
    editing.main()
    assert capsys.readouterr().out.count("ratio 1.00") == 13


def test_the_largest_plants_fit_an_engine() -> None:
    """At most 512 units, and 64 job instances on each (docs/generated-code.md): larger specs are refused (PG225)."""
    for text in (many_jobs(10_000), grid(*scale.SIZES[10_000])):
        assert text.count("{device:") <= 512
        drives = re.findall(r"{drive: \[?([\w, ]+?)\]?, (?:read|write)", text)
        instances = Counter(name for listed in drives for name in listed.split(", "))
        assert sum(instances.values()) == 10_000
        assert max(instances.values()) <= 64
