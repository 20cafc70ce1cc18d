"""Reads without a type: what a drive answers, in the four outputs; by hand."""

from __future__ import annotations

import struct
from pathlib import Path

import pytest

from plcgen import api
from plcgen.ds47.proof.plant import Plant
from plcgen.ds47.sim.parameters import SimulatedParameter
from plcgen.ds47.wire.formats import Value, by_name
from tests.ds47.proof.playing import ended, job_of, noticed, sent, told_of

SPEC = """
drives:
  a: {device: sinamics-v90, ID: 281}
jobs:
  look: {drive: a, read: [r42051, {parameter: "r42052[3]", as: there}]}
"""


@pytest.mark.parametrize(
    ("type_", "value", "octets", "code", "dint", "real"),
    [
        ("Integer16", -2, "fffe000000000000", 0x03, -2, -2.0),
        ("Integer8", 127, "7f00000000000000", 0x02, 127, 127.0),
        ("Unsigned16", 0xFFFE, "fffe000000000000", 0x06, 65534, 65534.0),
        ("Integer32", -100000, "fffe796000000000", 0x04, -100000, -100000.0),
        ("FloatingPoint", 1.5, "3fc0000000000000", 0x08, 0x3FC00000, 1.5),
        ("DoubleWord", 0x3FC00000, "3fc0000000000000", 0x43, 0x3FC00000, 1.5),
        ("N2", -0x4000, "c000000000000000", 0x71, -0x4000, -16384.0),
        ("Unsigned64", 7, "0000000000000007", 0x38, 0, 0.0),
        ("TimeOfDay", bytes.fromhex("010203040506"), "0102030405060000", 0x0C, 0, 0.0),
    ],
)
def test_the_answer_says_the_type(
    plant: Plant, type_: str, value: Value, octets: str, code: int, dint: int, real: float
) -> None:
    """r42051 = A443h is asked for with one element; octets from the left, the number as DINT and as REAL."""
    job = job_of(plant, "look")
    parameters = plant.units["a"].objects[2].parameters
    parameters[42051] = SimulatedParameter(42051, by_name(type_), [value])
    plant.begin(delivered=True)
    assert ended(plant, job) == 0
    assert sent(plant) == ["01 02 02 10 01 a4 43 00 00 10 01 a4 44 00 03"]
    shown = '"DriveJobs".look.r42051'
    assert bytes(plant.cpu[shown]).hex() == octets
    assert (plant.cpu[f"{shown}Format"], plant.cpu[f"{shown}Dint"]) == (code, dint)
    assert plant.cpu[f"{shown}Real"] == struct.unpack(">f", struct.pack(">f", real))[0]
    assert plant.cpu['"DriveJobs".look.thereFormat'] == 0x38  # what the simulated drive has


DAMAGE = {
    "no sign": ("#tempNumber := DW#16#FFFFFFFF;", "#tempNumber := DW#16#0;"),
    "octets of the answer before": ("#r42051[#tempIndex] := B#16#00;", ";"),
    "a REAL as a number": ("#tempFormat = 8 OR #tempFormat = 67", "#tempFormat = 67"),
    "a size": ("12, 53: #tempSize := 6;", "12, 53: #tempSize := 4;"),
    "the number of values instead of the format": (
        "#r42051Format := #statResponseBytes[4]",
        "#r42051Format := #statResponseBytes[5]",
    ),
    "of an answer that is an error": (
        "IF #diagnosis.errors[1] = W#16#0000 THEN\n      // r42051",
        "IF TRUE THEN\n      // r42051",
    ),
    "asked for with a type": ("DW#16#00010008", "DW#16#38010008"),
}


@pytest.mark.slow
@pytest.mark.parametrize("damage", DAMAGE)
def test_damage_is_noticed(damage: str, tmp_path: Path) -> None:
    """One change of a source, and verify is red."""
    found = noticed(
        tmp_path,
        """plc: {name: Plant, family: s7-1500, toolchain: tia-v19}
drives: {a: {device: sinamics-v90, hardware_id: 270}}
jobs: {look: {drive: a, read: [r42051]}}
""",
        *DAMAGE[damage],
    )
    assert told_of("look", found)


def test_what_is_written_has_the_type_of_the_family(tmp_path: Path) -> None:
    """P1047 = 0417h of a V90 is a FloatingPoint in all lists of the family: format 08h, 3.0 = 40 40 00 00."""
    spec = tmp_path / "job.yaml"
    spec.write_text("""plc: {name: a, family: s7-1500, toolchain: tia-v19}
drives: {d: {device: sinamics-v90, hardware_id: 270}}
jobs: {j: {drive: d, write: {P1047: 3.0}}}
""")
    (job,) = api.check(spec).project.jobs
    assert job.telegrams[0].request.data.hex(" ") == "01 02 02 01 10 01 04 17 00 00 08 01 40 40 00 00"
