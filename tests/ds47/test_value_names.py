"""Single values by name: in a job, in a profile that is written again, and where a drive answers."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from plcgen import api
from plcgen.protocols.ds47.catalogue.merging import profile_text
from plcgen.protocols.ds47.device import Parameter
from plcgen.protocols.ds47.devices import find_device, read_profile
from plcgen.protocols.ds47.live.parameters import decoded
from plcgen.protocols.ds47.plan.nouns import DrivePlan

SPEC = """\
plc: {name: a, family: s7-300, toolchain: tia-v16}
drives:
  d:
    device: sinamics-g120
    address: 256
    parameters:
      P1300: {type: Integer16, values: {linear: 0, vector: 20}}
      P15: {type: Unsigned32, values: {conveyor: 1}}
jobs: {j: {drive: d, write: {P1300: vector, P15: conveyor}, allow: {P15: new line}}}
"""


def test_a_job_may_write_the_name(tmp_path: Path) -> None:
    """The telegram has the number, 20 = 0014h; a name of an Unsigned32 is no BICO value."""
    spec = tmp_path / "job.yaml"
    spec.write_text(SPEC, "utf-8")
    job = api.check(spec).project.plan(DrivePlan).jobs[0]
    assert [use.data.hex() for use in job.uses] == ["0014", "00000001"]
    assert not any(use.sources for use in job.uses)


def test_names_of_values_read_back(tmp_path: Path) -> None:
    """A profile that is written again has them."""
    device = find_device("sinamics-v90")
    (pnu, one), *_ = device.parameters.items()
    named = replace(device, parameters={**device.parameters, pnu: replace(one, values={"off": 0, "vector_1": 1})})
    path = tmp_path / "own.yaml"
    path.write_text(profile_text(named), "utf-8")
    assert read_profile(path, named.key) == named


def test_an_answer_is_shown_with_its_name() -> None:
    """The number stays in front; a number without a name is shown as it is."""
    parameter = Parameter(1300, "Integer16", values={"vector": 20})
    assert [decoded(parameter, 0, bytes([0, value])).text for value in (20, 19)] == ["20 (vector)", "19"]
