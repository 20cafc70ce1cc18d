"""A plant, 20 drives with 3 jobs each: how much of it there is to read."""

from __future__ import annotations

from pathlib import Path

import pytest

from plcgen import api
from plcgen.s7.memory.estimate import estimate
from plcgen.s7.read.text import decode_source
from plcgen.s7.scl.dialect import Dialect
from tests.projects import per_block_spec

ROOT = Path(__file__).parents[2]
ENGINE = {"DriveChannel", "DriveGate", "DriveTicket"}
JOBS = {"ReadFault", "ReadRamps", "SetRamps"}
INSTANCES, UNITS = 60, 20


def _lines(text: str) -> list[str]:
    """Lines of code: no comments, no empty ones, no titles of regions, nothing in front of BEGIN."""
    body = text.split("\nBEGIN\n", 1)[1].splitlines()
    left_out = ("//", "REGION", "END_REGION", "END_FUNCTION_BLOCK")
    return [line.strip() for line in body if line.strip() and not line.strip().startswith(left_out)]


@pytest.fixture(scope="module", params=["s7-300_plant_v5", "s7-1200_plant", "s7-1500_plant"])
def sources(request: pytest.FixtureRequest) -> dict[str, str]:
    """Text of every code block, by name; the spec as key ""."""
    out = per_block_spec(request.param).with_name("out")
    found = {"": request.param}
    for file in (out / "scl").glob("*.scl"):
        text = decode_source(file.read_bytes(), file.name)
        assert isinstance(text, str)
        found[file.stem] = text.replace("\r\n", "\n")
    return found


def test_blocks(sources: dict[str, str]) -> None:
    """Six function blocks and the caller, whatever the number of drives."""
    assert set(sources) - {"", "Main"} == ENGINE | JOBS | {"DriveCalls"}


@pytest.mark.parametrize("job", sorted(JOBS))
def test_a_job_is_read_on_two_pages(sources: dict[str, str], job: str) -> None:
    """A block of up to three parameters has at most 80 lines, declarations and comments included."""
    assert len(sources[job].splitlines()) <= 80


def test_code_of_all_blocks_but_the_caller(sources: dict[str, str]) -> None:
    """At most 500 lines."""
    lines = {name: len(_lines(sources[name])) for name in ENGINE | JOBS}
    assert sum(lines.values()) <= 500, lines


def test_the_caller_has_few_lines_for_each_instance(sources: dict[str, str]) -> None:
    """One for the gate, one for each channel, at most 4 for each job."""
    lines = _lines(sources["DriveCalls"])
    assert len(lines) - 1 - UNITS <= 4 * INSTANCES


def test_main_has_one_line(sources: dict[str, str]) -> None:
    """What a program has to call."""
    calls = [line for line in sources["Main"].split("\nBEGIN\n", 1)[1].splitlines() if "DriveCalls" in line]
    assert len(calls) == 1


def test_work_memory(tmp_path: Path) -> None:
    """At most 45 KB on an S7-300 by the rules of plcgen/s7/memory/README.md."""
    api.generate(ROOT / "specs" / "s7-300_plant_v5.yaml", tmp_path / "out")
    found = estimate(tmp_path / "out", Dialect.STEP7_V5)
    assert not found.diagnostics
    assert found.total <= 45 * 1024, found.summary()
