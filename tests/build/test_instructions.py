"""Versions of instructions: the default ones, and those that a spec asks for."""

from pathlib import Path

from plcgen import api

SPEC = """plc: {{name: a, sources: per_block, family: s7-1500, toolchain: tia-v19{0}}}
drives: {{d: {{device: sinamics-g120, hardware_id: 270}}}}
jobs: {{j: {{drive: d, read: [r21]}}}}
"""


def channel(tmp_path: Path, more: str) -> str:
    """Text of the generated channel."""
    spec = tmp_path / "job.yaml"
    spec.write_text(SPEC.format(more), "utf-8")
    assert api.generate(spec, tmp_path / "out").ok
    return (tmp_path / "out/scl/DriveChannel.scl").read_text("utf-8-sig")


def test_versions_as_in_a_genuine_export(tmp_path: Path) -> None:
    """Modbus_Comm_Load as exported by TIA Portal V17: WRREC 1.1, RDREC 1.0."""
    text = channel(tmp_path, "")
    assert "{InstructionName := 'WRREC'; LibVersion := '1.1'}" in text
    assert "{InstructionName := 'RDREC'; LibVersion := '1.0'}" in text


def test_versions_of_the_spec(tmp_path: Path) -> None:
    """An older firmware may know an older version only."""
    text = channel(tmp_path, ', instructions: {WRREC: "1.0", TON_TIME: "2.0"}')
    assert "{InstructionName := 'WRREC'; LibVersion := '1.0'}" in text
    assert "{InstructionName := 'TON_TIME'; LibVersion := '2.0'}" in text
