"""Single values by name: in a job, in a profile that is written again, and where a drive answers."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import pytest

from plcgen import api
from plcgen.ds47.catalogue.merging import profile_text
from plcgen.ds47.catalogue.pages import parameter_page
from plcgen.ds47.device import Parameter
from plcgen.ds47.devices import device_names, find_device, read_profile
from plcgen.ds47.live.parameters import element_value
from plcgen.ds47.plan.nouns import DrivePlan

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
    assert [element_value(parameter, 0, bytes([0, value])).text for value in (20, 19)] == ["20 (vector)", "19"]


@pytest.mark.parametrize(
    ("device", "parameter", "name", "value"),
    [
        # TIA Portal information system, parameters of VECTOR (list version 5207320)
        ("sinamics-s120", "P1300", "speed_control_encoderless", 20),
        ("sinamics-s150", "P1300", "torque_control_with_encoder", 23),
        ("sinamics-g150", "P10", "quick_commissioning", 1),
        ("sinamics-s120", "P10", "parameter_reset", 30),
        ("sinamics-s120", "r2", "ready_for_switching_on", 31),
        ("sinamics-g130", "P1215", "always_open", 2),
        ("sinamics-s120", "P922", "siemens_telegram_352", 352),
        # the same, parameters of the control units
        ("sinamics-s120", "P9", "device_configuration", 1),
        ("sinamics-s120", "P922", "siemens_telegram_390", 390),
        ("sinamics-s150", "P3100", "utc", 1),
        # the same, parameters of SINAMICS S210 (package sdrpa400)
        ("sinamics-s210", "r2", "operation_speed_setpoint_not_enabled", 14),
        ("sinamics-s210", "r922", "siemens_telegram_105", 105),
        ("sinamics-s210", "P1558", "reset_values", -1),
        # the same, commissioning and parameterizing SINAMICS G120 and G120C, alarms of SINAMICS G120
        ("sinamics-g120", "P1300", "torque_control_encoderless", 22),
        ("sinamics-g120", "P1210", "acknowledge_and_restart_with_on", 26),
        ("sinamics-g120", "P10", "encoder_commissioning", 4),
        ("sinamics-g120c", "P1300", "uf_parabolic_eco", 7),
    ],
)
def test_names_that_were_read(device: str, parameter: str, name: str, value: int) -> None:
    """One word, one number, the grade of the fact."""
    known = find_device(device).parameters[int(parameter[1:])]
    assert known.values[name] == value
    assert known.read("values")


def test_names_are_words_and_lie_within_the_limits() -> None:
    """snake_case, no number twice, and nothing that the limits refuse; names of the base device are not lent."""
    for device in map(find_device, device_names()):
        for one in device.parameters.values():
            low, high = one.minimum, one.maximum
            assert len(set(one.values.values())) == len(one.values), (device.key, one.pnu)
            for name, value in one.values.items():
                assert re.fullmatch(r"[a-z][a-z0-9]*(_[a-z0-9]+)*", name), name
                assert value >= (value if low is None else low), (device.key, one.pnu, name)
                assert value <= (value if high is None else high), (device.key, one.pnu, name)
    lent = find_device("sinamics-g120x").parameters[1300]
    assert (lent.values, lent.doubted["values"]["uf_linear"]) == ({}, 0)


def test_a_shipped_name_in_a_job(tmp_path: Path) -> None:
    """Written, compared and waited for: 20 = 0014h, 31 = 001Fh, 1 = 0001h."""
    spec = tmp_path / "job.yaml"
    spec.write_text(
        "plc: {name: a, family: s7-300, toolchain: tia-v16}\n"
        "drives: {d: {device: sinamics-s120, address: 256, drive_object: 3}}\n"
        "jobs:\n"
        "  j: {drive: d, write: {P1300: speed_control_encoderless}}\n"
        "  k: {drive: d, compare: {P1215: as_sequence_control}}\n"
        "  s: {drive: d, sequence: [until: {r2: ready_for_switching_on}]}\n",
        "utf-8",
    )
    found = {
        job.key: [use.data.hex() for use in job.uses if use.data]
        for job in api.check(spec).project.plan(DrivePlan).jobs
    }
    assert found == {"j": ["0014"], "k": ["0001"], "s": ["001f"]}


def test_scaling_is_shown() -> None:
    """p0021 of VECTOR and r0026 of S210, as their lists say."""
    assert find_device("sinamics-s150").parameters[21].scaling == "p2000"
    known = find_device("sinamics-s210")
    assert "scaling  p2001  (read)" in dict(parameter_page(known, known.parameters[26]).sections)["Facts"]


@pytest.mark.parametrize("device", ["sinamics-s120", "sinamics-s150", "sinamics-g130", "sinamics-g150"])
def test_commissioning_needs_no_types_of_the_user(device: str, tmp_path: Path) -> None:
    """p0009 and r0722 of the control unit, p0010 of the drive; both filters are dangerous all the same."""
    spec = tmp_path / "job.yaml"
    text = (
        "plc: {name: a, family: s7-1500, toolchain: tia-v19}\n"
        "units:\n"
        f"  cu: {{device: {device}, drives: {{control: {{hardware_id: 270, drive_object: 1}},"
        " axis: {hardware_id: 271, drive_object: 2}}}\n"
        "jobs:\n"
        "  unit: {drive: control, sequence: [until: r722.0 = 1, write: {P9: ready}], allow: {P9: commissioned}}\n"
        "  drive: {drive: axis, sequence: [write: {P10: quick_commissioning}, until: P10 = 1], allow: {P10: motor}}\n"
    )
    spec.write_text(text, "utf-8")
    checked = api.check(spec)
    assert checked.ok, checked.diagnostics
    uses = [
        (use.label, use.format.name, use.data.hex()) for job in checked.project.plan(DrivePlan).jobs for use in job.uses
    ]
    assert uses == [
        ("r722", "Unsigned32", "00000001"), ("P9", "Integer16", "0000"),
        ("P10", "Integer16", "0001"), ("P10", "Integer16", "0001"),
    ]  # fmt: skip
    spec.write_text(text.replace(", allow: {P9: commissioned}", ""), "utf-8")
    assert [one.code for one in api.check(spec).diagnostics if one.severity.name == "ERROR"] == ["PG219"]
