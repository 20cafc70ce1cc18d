"""What jobs of the kinds with settings of their own can say, to plcgen and to an editor, and what they cannot."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import jsonschema
import pytest

from plcgen import api
from plcgen.ds47.kind import Wait
from plcgen.ds47.plan.nouns import DrivePlan

HEAD = "plc: {{name: a, family: s7-1500, toolchain: tia-v19}}\ndrives: {{d: {{device: {device}, hardware_id: 270}}}}\n"
G120, G120C, S120 = "sinamics-g120", "sinamics-g120c", "sinamics-s120"


@pytest.mark.parametrize(
    ("device", "text", "code", "says"),
    [
        (G120, "save: ram", "PG107", "a value is in the RAM of the drive as soon as it is written"),
        (G120, "save: eeprom", "PG107", "is not a value of"),
        (
            G120,
            "save: {persist: drive_object, limit: 1s, interval: 2s}",
            "PG107",
            "the first poll would come after the limit",
        ),
        (G120, "save: {persist: drive_object, limit: 11min}", "PG107", "600000"),
        (G120, "save: {persist: drive_object, distance: 1s}", "PG107", "60000"),
        (G120, "save: {distance: 1min}", "PG105", "persist"),
        (G120, "save: {persist: drive_object, setting: 9}", "PG107", "10"),
        (G120C, "save: {persist: drive_object, setting: 10}", "PG243", "takes 10"),
        (S120, "save: {persist: drive_object, setting: 12}", "PG209", "P971 = 12"),
        (G120, "write: {P1120: 1.0}, verify: true", "PG107", "readback"),
        (G120, "write: {P1120: 1.0}, verify: compare", "PG107", "readback"),
        (G120, "write: {P1120: 1.0}, verify: readback, buffers: db", "PG223", "2 telegrams"),
        (G120, "write: {P9500: {value: 1, type: Unsigned16}}, verify: readback, save: drive_object", "PG219", "P9500"),
        (G120, "write: {P977: {value: 1, type: Unsigned16}}, verify: readback, save: drive_object", "PG219", "P977"),
        (G120, "write: {P1120: {as: x}, P1121: {as: xBack}}, verify: readback", "PG406", "xBack"),
        (G120, "compare: {P1120: 1.0}, write: {P1121: 1.0}", "PG218", "write or compare"),
        (G120, "compare: {P1120: 1.0}, buffers: db", "PG223", "compares"),
        (G120, "compare: {P1120: 1.0}, verify: readback", "PG247", "writes no values"),
        (G120, "compare: {P1120: {as: equal}}", "PG406", "equal"),
        (S120, "faults: latest", "PG107", "latest"),
        (S120, "faults: {columns: [code, text]}", "PG107", "text"),
        (S120, "faults: {columns: [value]}", "PG107", "without its code"),
        (S120, "faults: {columns: [code, code]}", "PG107", "named twice"),
        (S120, "faults: {history: 8}", "PG107", "7"),
        (S120, "faults: {tries: 0}", "PG107", "1"),
        (S120, "alarms: {columns: [code, drive_object]}", "PG107", "drive_object"),
        (S120, "faults: current, alarms: current", "PG218", "faults or alarms"),
        (S120, "faults: current, buffers: db", "PG223", "2 telegrams"),
        (S120, "faults: current, verify: readback", "PG247", "writes no values"),
        (S120, "clock: local", "PG107", "utc"),
        (S120, "clock: utc, activate: true", "PG218", "activate or clock"),
        (S120, "activate: maybe", "PG107", "is not a state of a drive object"),
        (S120, "activate: 2", "PG107", "write true, false, not_present or input"),
        (S120, "activate: {limit: 2s}", "PG105", "state"),
        (
            S120,
            "activate: {state: true, limit: 1s, interval: 2s}",
            "PG107",
            "the first poll would come after the limit",
        ),
        (S120, "activate: true, buffers: db", "PG223", "2 telegrams"),
        (S120, "acknowledge: false", "PG107", "does nothing"),
        (S120, "acknowledge: {limit: 1s, interval: 2s}", "PG107", "the first poll would come after the limit"),
        (S120, "acknowledge: true, faults: current", "PG218", "faults or acknowledge"),
        (S120, "acknowledge: true, save: drive_object", "PG218", "save or acknowledge"),
        (
            S120,
            "write: {P1121: {value: 1.0, type: FloatingPoint}}, verify: readback, acknowledge: true",
            "PG218",
            "write or",
        ),
        (S120, "acknowledge: true, verify: readback", "PG247", "writes no values"),
        (G120, "sequence: []", "PG107", ""),
        (G120, "sequence: [{}]", "PG107", "this one nothing"),
        (G120, "sequence: [{read: r21, write: {P1120: 1.0}}]", "PG107", "this one read and write"),
        (G120, "sequence: [{until: {timeout: 5s}}]", "PG107", "the step does not say what it waits for"),
        (G120, "sequence: [{until: {r722.0: null}}]", "PG107", "the value that r722.0 must have is missing"),
        (G120, 'sequence: [{until: {r21: "> "}}]', "PG107", "has no value to compare r21 with"),
        (G120, "sequence: [{until: r722.0}]", "PG107", "is not a comparison"),
        (G120, "sequence: [{until: r722.0 =}]", "PG107", "is not a comparison"),
        (G120, "sequence: [{until: r722.32 = 1}]", "PG251", "has the bits 0 to 31"),
        (G120, "sequence: [{until: P1300 = vektor}]", "PG211", '"vektor" is not a value'),
        (G120, "read: [P1120], save: ram", "PG107", "there is nothing to save"),
        (
            G120,
            "sequence: [{until: {r21: 1.0, timeout: 1s, interval: 2s}}]",
            "PG107",
            "the second poll would come after",
        ),
        (G120, "sequence: [{write: {P971: 1}}]", "PG219", "P971"),
        (G120, "sequence: [{write: {P1120: 1.0, p1120: 2.0}}]", "PG213", "twice in this step"),
        (G120, "sequence: [{read: r21}], read: [r21]", "PG218", "read or sequence"),
    ],
)
def test_what_cannot_be_meant(device: str, text: str, code: str, says: str, tmp_path: Path) -> None:
    """Each is told at its place, before anything else."""
    path = tmp_path / "job.yaml"
    path.write_text(f"{HEAD.format(device=device)}jobs: {{j: {{drive: d, {text}}}}}\n", "utf-8")
    found = [d for d in api.check(path).diagnostics if d.severity.name == "ERROR"]
    assert found[0].code == code, found
    assert says in found[0].message + found[0].help
    assert found[0].span.line == 3


@pytest.mark.parametrize(
    ("job", "right"),
    [
        ({"save": "unit"}, True),
        ({"save": {"persist": "unit", "limit": "2min"}}, True),
        ({"write": {"P1120": 1.0}, "save": "ram"}, True),
        ({"save": "RAM"}, False),
        ({"sequence": [{"until": "r722.0 = 1"}, {"until": {"r722.0": 1, "timeout": "5s"}}]}, True),
        ({"sequence": [{"until": "r722.0"}]}, False),
        ({"save": {}}, False),
        ({"write": {"P1120": 1.0}, "verify": "readback"}, True),
        ({"write": {"P1120": 1.0}, "verify": "ReadBack"}, False),
        ({"write": {"P1120": 1.0}, "verify": True}, False),
        ({"write": {"P1120": 1.0}, "verify": "readback", "on_error": "restore"}, True),
        ({"write": {"P1120": 1.0}, "on_error": {"restore": "running", "reason": "why"}}, True),
        ({"write": {"P1120": 1.0}, "on_error": "ignore"}, False),
        ({"write": {"P1120": 1.0}, "on_error": {"restore": "always"}}, False),
        ({"compare": {"P1120": 1.0, "P2900[0..1]": [1, 2], "P1121": None, "ramp_up_time": {"start": 2.0}}}, True),
        ({"compare": ["P1120"]}, False),
        ({"alarms": "all"}, True),
        ({"alarms": {"history": 2}}, True),
        ({"alarms": "some"}, False),
        ({"alarms": {"columns": ["text"]}}, False),
        ({"acknowledge": True}, True),
        ({"acknowledge": {"limit": "2s"}}, True),
        ({"acknowledge": False}, False),
        ({"acknowledge": "all"}, False),
    ],
    ids=str,
)
def test_what_an_editor_takes(job: dict[str, Any], right: bool) -> None:
    """The schema knows words and mappings."""
    plc = {"name": "t", "family": "s7-1500", "toolchain": "tia-v17"}
    spec = {"plc": plc, "drives": {}, "jobs": {"j": {"drive": "d", **job}}}
    assert jsonschema.Draft202012Validator(api.schema()).is_valid(spec) == right


@pytest.mark.parametrize(
    ("short", "long"),
    [
        ("r722.0 = 1", "{r722.0: 1}"),
        ("r722.3<>0", '{r722.3: "<> 0"}'),
        ("r21 <= 0.5", '{r21: "<= 0.5"}'),
        ("r21 >= -1.0", '{r21: ">= -1.0"}'),
        ("r21 < 16#10", '{r21: "< 16#10"}'),
        ("actual_speed > 100.0", '{actual_speed: "> 100.0"}'),
        ("P1300 = speed_control_encoderless", "{P1300: speed_control_encoderless}"),
    ],
)
def test_the_short_form_of_a_wait(short: str, long: str, tmp_path: Path) -> None:
    """One comparison in one line is the same step."""
    found = []
    for text in (short, long):
        path = tmp_path / "job.yaml"
        job = f"{{j: {{drive: d, sequence: [{{until: {text}}}]}}}}"
        path.write_text(f"{HEAD.format(device=G120)}jobs: {job}\n", "utf-8")
        project = api.check(path).project
        assert project is not None
        (use,) = project.plan(DrivePlan).jobs[0].uses
        found.append((use.label, use.as_(Wait), use.data))
    assert found[0] == found[1]


@pytest.mark.parametrize("save", ["ram", "{persist: ram}"])
def test_a_write_may_say_that_it_stays_in_ram(save: str, tmp_path: Path) -> None:
    """It is the same job as without the key."""
    path = tmp_path / "job.yaml"
    path.write_text(
        f"{HEAD.format(device=G120)}jobs: {{j: {{drive: d, write: {{P1120: 1.0}}, save: {save}}}}}\n", "utf-8"
    )
    project = api.check(path).project
    assert project is not None
    (job,) = project.plan(DrivePlan).jobs
    assert ([use.label for use in job.uses], job.poll) == (["P1120"], None)
