"""Every version of the engineering tools: what can be done with a spec can be done for each of them."""

from __future__ import annotations

from pathlib import Path
from typing import get_args

import pytest

from plcgen import api
from plcgen.base.diagnostics import Severity
from plcgen.project.opening import open_spec
from plcgen.project.schema import Toolchain

FAMILIES = {"s7-300": "address", "s7-1500": "hardware_id"}
TARGETS = [(one, two) for one in get_args(Toolchain) for two in FAMILIES if (one, two) != ("step7-v5", "s7-1500")]


@pytest.mark.parametrize(("toolchain", "family"), TARGETS)
def test_everything_can_be_done_for_every_version(toolchain: str, family: str, tmp_path: Path) -> None:
    """Generate, verify, convert in both directions where there are documents, lock: nothing is wrong."""
    spec, out = tmp_path / "fan.yaml", tmp_path / "out"
    spec.write_text(
        f"plc: {{name: Fan, family: {family}, toolchain: {toolchain}, sources: per_block}}\n"
        f"drives: {{fan: {{device: sinamics-s120, {FAMILIES[family]}: 270}}}}\n"
        "jobs: {speed: {drive: fan, read: [r21], trigger: M5.0}}\n",
        "utf-8",
    )
    assert api.generate(spec, out).ok
    assert [
        one.message for one in api.verify(spec, out, faults="none").problems if one.severity is Severity.ERROR
    ] == []
    version, classic = open_spec(spec).sound().target.xml_version, family == "s7-300"
    if version is not None:
        made = api.convert(
            out / "scl", to="xml", out=tmp_path / "xml", version=version, classic=classic, keep_going=True
        )
        assert len(made.written) >= 2
        back = api.convert(out / "xml", to="scl", out=tmp_path / "scl", classic=classic, keep_going=True)
        assert len(back.written) > len(made.written)
    lock = tmp_path / "plcgen.lock.json"
    api.lock(spec, out=lock)
    assert api.check_lock(spec, lock=lock).changes == ()
