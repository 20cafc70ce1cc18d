"""What a spec demands, stated from its YAML and the documents alone: sentences by hand from docs/spec.md."""

from __future__ import annotations

import ast
from pathlib import Path

import pytest
import yaml

import plcgen.oracles.spec
from plcgen.oracles.spec.ds47.state import state_jobs
from plcgen.oracles.spec.ds47.statement import Statement
from plcgen.oracles.spec.place import Keys, SpecPlace, SpecSource

DEVICES = Path(__file__).parents[2] / "specs" / "devices"
S120 = """
units:
  cu:
    device: sinamics-s120
    drives: {cu: {hardware_id: 280, drive_object: 1}, axis: {hardware_id: 281, drive_object: 3}}
"""
G120 = "drives: {axis: {device: sinamics-g120, hardware_id: 270}}"
MM4 = """
drives:
  m: {device: micromaster-4, address: 256, output_address: true, parameters: {P701: {type: Unsigned32, bico: true}}}
"""


def stated(jobs: str, drives: str = S120, family: str = "s7-1500") -> Statement:
    """The statement about jobs; everything stands in line 1."""
    spec = yaml.safe_load(f"plc: {{name: t, family: {family}}}\n{drives}\njobs: {{{jobs}}}")
    profiles = {path.stem: yaml.safe_load(path.read_text("utf-8")) for path in DEVICES.glob("*.yaml")}

    def place(_: Keys) -> SpecPlace:
        return SpecPlace("t.yaml", 1)

    return state_jobs(SpecSource(spec, place, profiles))


def text(jobs: str, drives: str = S120, family: str = "s7-1500") -> list[str]:
    """Lines of the sentence about the first job."""
    found = stated(jobs, drives, family)
    assert not found.unstated
    return [line.strip() for line in found.jobs[0].text().splitlines()]


def test_nothing_of_plcgen_is_imported() -> None:
    """What generator and proof believe together stops at this door."""
    folder = Path(plcgen.oracles.spec.__file__).parent
    for file in folder.rglob("*.py"):
        for node in ast.walk(ast.parse(file.read_text("utf-8"))):
            names = [alias.name for alias in node.names] if isinstance(node, ast.Import) else []
            names += [node.module or ""] if isinstance(node, ast.ImportFrom) else []
            assert not [n for n in names if n.startswith("plcgen") and not n.startswith("plcgen.oracles")], file


@pytest.mark.parametrize(
    ("jobs", "lines"),
    [
        (
            'j: {drive: axis, read: ["r945[0..1]", r722], timeout: 4s, retries: 5}',
            [
                "j (read) on axis: identifier 281, drive object 3, record B02Fh",
                "1 reads: r945[0..1] (Unsigned16, 2 values) -> faultCode; r722 (Unsigned32) -> r722",
                "timeout 4000 ms, 5 retries, a pause of 200 ms",
            ],
        ),
        # 722 = 2D2h, drive object 63 = 3Fh: 02D2h, 111111b and bit 4 = FC04h
        ('j: {drive: axis, write: {"P2116[0]": r722.4}}', ["1 writes: P2116[0] (Unsigned32) = 47381508"]),
        # p0977 is on the control unit; 4/5 of 10 s + 2 min + 1 s, divided by 200 ms
        (
            "j: {drive: cu, save: {persist: unit, limit: 2min}}",
            [
                "1 saves: P977 (Unsigned16) = 1, never sent twice",
                "P977 (Unsigned16) -> saving, every 1000 ms until P977 value = 0, at most 120000 ms",
                "timeout 131000 ms, 524 retries, a pause of 200 ms",
                "at least 600000 ms from one save to the next",
            ],
        ),
        (
            "j: {drive: axis, activate: not_present}",
            [
                "1 writes: p105 (Integer16) = 2",
                "2 asks: r106 (Integer16) -> active, every 1000 ms until r106 value = 0, at most 60000 ms",
            ],
        ),
        (
            "j: {drive: cu, clock: utc}",
            [
                "1 writes: p3100 (Unsigned16) = 1; p3103 (Integer16) = 2; p3101[1] (Unsigned32) = days since 1970",
                "p3101[0] (Unsigned32) = milliseconds of the day of input utc",
            ],
        ),
        (
            "j: {drive: axis, alarms: {history: 2, columns: [code, removed], tries: 1}}",
            ["2 reads the columns: r2122[0..23] (Unsigned16, 24 values); r2125[0..23] (Unsigned32, 24 values)"],
        ),
        (
            'j: {drive: axis, sequence: [{write: {P10: 1}}, {until: {r21: "<= 0.5", timeout: 1min, interval: 2s}}]}',
            [
                "1 writes: P10 (Integer16) = 1",
                "2 asks: r21 (FloatingPoint) -> actualSpeedStep2, every 2000 ms until r21 value <= 0.5",
            ],
        ),
    ],
)
def test_what_a_job_demands(jobs: str, lines: list[str]) -> None:
    """Numbers of parameters from docs/spec.md, types from the lists of the profiles, times from the tables of keys."""
    found = "\n".join(text(jobs))
    assert [line for line in lines if line not in found] == []


def test_an_output_address_and_the_plain_sources_of_a_micromaster() -> None:
    """Bit 15 is told; without drive objects a source is number and index: 722 = 2D2h."""
    found = text("j: {drive: m, write: {P701: r722.2}}", MM4, "s7-300")
    assert found[:2] == [
        "j (write) on m: identifier 256 (outputs), drive object 0, record 002Fh",
        f"1 writes: P701 (Unsigned32) = {0x02D20002}",
    ]


def test_restoring_asks_three_times_and_takes_twice_as_long() -> None:
    """docs/generated-code.md, "A job that restores": old values and r0899, write, what it has and r0899."""
    found = text("j: {drive: axis, write: {P1030.0: 1, P1030.2: null}, verify: readback, on_error: restore}", G120)
    assert found[1:5] == [
        "1 remembers: P1030 (Unsigned16) -> p1030Before; r899 (Unsigned16) -> stateBefore",
        "2 writes: P1030 (Unsigned16): bit 0 = 1, bit 2 = input p1030Bit2",
        "3 reads back: P1030 (Unsigned16): bit 0 = 1, bit 2 = input p1030Bit2; r899 (Unsigned16) -> stateBack",
        "timeout 20000 ms, 40 retries, a pause of 200 ms",
    ]


def test_a_kind_that_nobody_states() -> None:
    """It is told, with the job that has it."""
    found = stated("j: {drive: axis, dance: true}")
    assert not found.jobs
    assert [job.key for job in found.unstated] == ["j"]
