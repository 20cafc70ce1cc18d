"""Bits of words that are read: one access for all bits of a word, each an output of its own; by hand."""

from __future__ import annotations

from pathlib import Path

import pytest

from plcgen import api
from plcgen.ds47.proof.plant import Plant
from tests.ds47.proof.playing import ended, job_of, noticed, sent

SPEC = """
drives:
  a:
    device: sinamics-s120
    ID: 281
    drive_object: 3
    parameters: {P43000: {type: Unsigned32}, P43001: {type: Integer8}}
jobs:
  look: {drive: a, read: [r899.2, P43000.31, P43001.7, r899.11, {parameter: P43000.0, as: lowest}]}
"""
OUTPUTS = ("operationEnabled", "pulsesEnabled", "p43000Bit31", "lowest", "p43001Bit7")
"""Bits 2 and 11 of r0899 as the list of the drive calls them, 31 and 0 of P43000, 7 of P43001."""


@pytest.mark.parametrize(
    ("r899", "p2900", "p2901", "wanted"),
    [
        (0x0004, 0x00000000, 0, (True, False, False, False, False)),
        (0x0800, 0x00000001, 0, (False, True, False, True, False)),
        (0xF7FB, 0x80000000, -128, (False, False, True, False, True)),
        (0xFFFF, 0x7FFFFFFE, 127, (True, True, False, False, False)),
    ],
)
def test_each_bit_is_an_output(plant: Plant, r899: int, p2900: int, p2901: int, wanted: tuple[bool, ...]) -> None:
    """One request of three words: r899 = 383h, P43000 = A7F8h, P43001 = A7F9h; the outputs are bits of the answer."""
    job = job_of(plant, "look")
    parameters = plant.units["a"].objects[3].parameters
    plant.begin(delivered=True)
    for number, value in ((899, r899), (43000, p2900), (43001, p2901)):
        parameters[number].values[:] = [value]
    assert ended(plant, job) == 0
    assert sent(plant) == ["01 03 03 10 01 03 83 00 00 10 01 a7 f8 00 00 10 01 a7 f9 00 00"]
    assert tuple(plant.cpu[f'"DriveJobs".look.{name}'] for name in OUTPUTS) == wanted


DAMAGE = {
    "another bit": ("B#16#04) <> B#16#00", "B#16#08) <> B#16#00"),
    "another octet": ("#operationEnabled := (#statResponseBytes[7]", "#operationEnabled := (#statResponseBytes[6]"),
    "the other way round": ("AND B#16#04) <> B#16#00", "AND B#16#04) = B#16#00"),
    "of an answer that is an error": (
        "IF #diagnosis.errors[1] = W#16#0000 THEN #operationEnabled",
        "IF TRUE THEN #operationEnabled",
    ),
}


@pytest.mark.slow
@pytest.mark.parametrize("damage", DAMAGE)
def test_damage_is_noticed(damage: str, tmp_path: Path) -> None:
    """One change of a source, and verify is red."""
    text = """plc: {name: Plant, family: s7-1500, toolchain: tia-v19}
drives: {a: {device: sinamics-s120, hardware_id: 270}}
jobs: {look: {drive: a, read: [r899.2]}}
"""
    assert {one.code for one in noticed(tmp_path, text, *DAMAGE[damage])} & {"PG620", "PG621", "PG641"}


def test_a_simulated_run_shows_them(tmp_path: Path) -> None:
    """The first value of a simulated S120 is 16 = 0010h: bit 4 alone is set, which the list calls so."""
    spec = tmp_path / "job.yaml"
    spec.write_text("""plc: {name: Plant, family: s7-1500, toolchain: tia-v19}
drives: {a: {device: sinamics-s120, hardware_id: 270}}
jobs: {look: {drive: a, read: [r899.4]}}
""")
    assert api.generate(spec, tmp_path / "out").ok
    trace = api.simulate(spec, tmp_path / "out")
    names = [signal.id for signal in trace.signals]
    last = {names[at]: value for step in trace.steps for at, value in step.changes}
    assert (last["look.r899"], last["look.noCoastingActive"]) == (16, True)
