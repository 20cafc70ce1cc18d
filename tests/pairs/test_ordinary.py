"""Ordinary specs each of which was red once, by a fault of what was generated or of its proof."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
import yaml

from plcgen import api
from tests.pairs.trial import tried

S300, S400 = "family: s7-300, toolchain: tia-v16", "family: s7-400, toolchain: tia-v17"
V5, S1200, S1500 = (
    "family: s7-300, toolchain: step7-v5",
    "family: s7-1200, toolchain: tia-v17",
    "family: s7-1500, toolchain: tia-v19",
)
STARTS = """jobs: {j: {drive: a, write: {
  P43000: {start: 8197582173255673615}, "P43001[0..3]": {start: [5, 5, 0, 6]}, P43002: {start: "010203"}}}}"""
FLOAT = "P43000: {type: FloatingPoint}"


def spec(plc: str, parameters: str, jobs: str, *, device: str = "sinamics-g120", drives: int = 1) -> dict[str, Any]:
    """Drives a, b, .. with the same parameters, and jobs on them."""
    place = "address" if "s7-300" in plc or "s7-400" in plc else "hardware_id"
    each = (
        f"{'abc'[n]}: {{device: {device}, {place}: {256 + 20 * n}, parameters: {{{parameters}}}}}"
        for n in range(drives)
    )
    found: dict[str, Any] = yaml.safe_load(f"plc: {{name: P, {plc}}}\ndrives: {{{', '.join(each)}}}\n{jobs}")
    return found


ODD = 'P43000: {type: BinaryDate}, P43001: {type: Integer8}, P43002: {type: "VisibleString[5]"}'
OWN = 'jobs: {j: {drive: a, write: {P43000: null, "P43001[0..2]": null, P43002: null}, buffers: db}}'
RECIPE = "recipes: {r: {parameters: [P43000, P43001], records: 2}}\n"
READ = "read: [P43000], retries: 2"
UNLIKE = 'P43000: {type: Unsigned64}, P43001: {type: Integer16}, P43002: {type: "OctetString[3]"}'
SPECS: dict[str, dict[str, Any]] = {
    "inputs of an odd number of bytes for data blocks of their own": spec(S400, ODD, OWN),
    "the same in STEP 7 V5": spec(V5, ODD, OWN),
    "a text of one octet in a data block of its own": spec(
        S300, 'P43000: {type: "VisibleString[1]"}', "jobs: {j: {drive: a, write: {P43000: a}, buffers: db}}"
    ),
    **{
        f"several Booleans for a data block of their own, {plc}": spec(
            plc, "P43000: {type: Boolean}", 'jobs: {j: {drive: a, write: {"P43000[1..3]": null}, buffers: db}}'
        )
        for plc in (S300, V5, S1500)
    },
    "a pause that is longer than what counts of a scan": spec(
        S1500, FLOAT, "jobs: {j: {drive: a, read: [P43000], timeout: 60s, retry_pause: 2s}}"
    ),
    "a timeout with no room for a retry": spec(
        S400, FLOAT, "jobs: {j: {drive: a, write: {P43000: null}, verify: readback, timeout: 529ms}}"
    ),
    "a pause of nearly the whole timeout": spec(
        S1200, FLOAT, "jobs: {j: {drive: a, write: {P43000: 1.0}, timeout: 1s, retry_pause: 854ms}}"
    ),
    "start values of arrays whose elements differ": spec(S1200, UNLIKE, STARTS),
    "the same start values in STEP 7 V5": spec(V5, UNLIKE, STARTS),
    "a drive that is silent for an hour": spec(S1200, FLOAT, "jobs: {j: {drive: a, read: [P43000], timeout: 1 h}}"),
    "a drive that is switched off while old values can be restored for an hour": spec(
        S1200,
        FLOAT,
        "jobs: {j: {drive: a, write: {P43000: null}, verify: readback, on_error: {restore: running, reason: may},"
        " timeout: 3529245ms}}",
        device="sinamics-s210",
    ),
    "two hours of a clock that starts over every hour": spec(
        S1200,
        FLOAT,
        "jobs: {j: {drive: a, write: {P43000: null}, verify: readback, on_error: {restore: running, reason: may},"
        " timeout: 1h}}",
        device="sinamics-s120",
    ),
    "retries that are over before a third of the timeout is": spec(
        S300, FLOAT, "jobs: {j: {drive: a, read: [P43000], timeout: 2min, retries: 100}}", device="sinamics-v90"
    ),
    "a cycle of an hour that no run can outlast": spec(
        S1200, FLOAT, "jobs: {j: {drive: a, read: [P43000], cycle: 1h, timeout: 300ms}}"
    ),
    "a save without retries": spec(
        S1200, FLOAT, "jobs: {j: {drive: a, save: drive_object, timeout: 2s, retries: 0}}", device="profidrive"
    ),
    "a parameter that the list of a similar drive object knows as a display": spec(
        S1500, "P2902: {type: FloatingPoint}", "jobs: {j: {drive: a, write: {P2902: null}}}", device="sinamics-s120"
    ),
    "two drive objects behind one identifier, which are no unit in the spec": {
        "plc": {"name": "P", "family": "s7-1200", "toolchain": "tia-v17"},
        "drives": {
            key: {"device": "sinamics-s120", "hardware_id": 270, "drive_object": number}
            for key, number in (("a", 3), ("b", 4))
        },
        "jobs": {key: {"drive": key, "read": ["r21"]} for key in "ab"},
    },
    "a name that is shortened for its tags": spec(
        V5, FLOAT, "jobs: {ramp_up_and_down_of_the_feeder: {drive: a, read: [P43000], trigger: M50.0}}"
    ),
    "one recipe for two drives at one time": spec(
        S400, f"{FLOAT}, P43001: {{type: C4}}", f"{RECIPE}jobs: {{j: {{drive: [a, b], compare_recipe: r}}}}", drives=2
    ),
    "records that are not retained": spec(
        S300,
        FLOAT,
        "recipes: {r: {parameters: [P43000], records: 2, retain: false}}\njobs: {j: {drive: a, read_recipe: r}}",
    ),
    "a string from a drive that answers by size": spec(
        S400,
        'P43000: {type: "VisibleString[5]"}',
        "jobs: {j: {drive: a, write: {P43000: abcde}}}",
        device="micromaster-4",
    ),
    "a string of one octet": spec(S1200, 'P43000: {type: "VisibleString[1]"}', "jobs: {j: {drive: a, read: [P43000]}}"),
    "drives without jobs in front of the one that has some": spec(
        S400, FLOAT, f"jobs: {{j: {{drive: c, {READ}}}}}", drives=3
    ),
    "a list of one drive": spec(S1200, FLOAT, f"jobs: {{j: {{drive: [b], {READ}}}}}", drives=2),
    "jobs that are called as channels are": spec(
        S300, FLOAT, f"jobs: {{channel: {{drive: a, {READ}}}, channel_c: {{drive: a, {READ}}}}}", drives=2
    ),
    "a constant for each element of an array in a data block": spec(
        S1200, "P43000: {type: Unsigned16, unit: s}", 'jobs: {j: {drive: a, write: {"P43000[48..50]": 1}, buffers: db}}'
    ),
    "the lowest value of a type that no CPU has": spec(
        S300, "P43000: {type: TimeOfDay}", "jobs: {j: {drive: a, sequence: [{until: {P43000: 0, timeout: 2s}}]}}"
    ),
    "a number of 8 bytes that is waited for": spec(
        f"{S300}, languages: [zh-CN]",
        "P43000: {type: Integer64}",
        "jobs: {j: {drive: a, sequence: [{until: {P43000: 1}}]}}",
    ),
    "what is waited for follows an input, in three languages": spec(
        f"{S1500}, languages: [de-DE, zh-CN, en-US]",
        FLOAT,
        "jobs: {j: {drive: a, activate: input}}",
        device="sinamics-g150",
    ),
    "flags of a project whose names have a prefix": spec(
        f"{S1500}, prefix: Press04_",
        FLOAT,
        f"jobs: {{j: {{drive: a, {READ}, trigger: {{execute: M10.0, status: MW20}}}}}}",
    ),
    "what is waited for follows an input whose limits are nobody's": spec(
        S1200, FLOAT, "jobs: {j: {drive: a, activate: input}}", device="./alike.yaml"
    ),
    "a job with data blocks of its own beside another one": spec(
        S400, FLOAT, f"jobs: {{i: {{drive: a, write: {{P43000: null}}, buffers: db}}, j: {{drive: a, {READ}}}}}"
    ),
}
for word, slow in (("E5", "ack_timeout: 3000ms, polls: 1"), ("a reply", "reply_timeout: 5s")):
    SPECS[f"a master whose job ends before it stops waiting for {word}"] = yaml.safe_load(f"""
plc: {{name: P, {S1500}}}
ppi:
  line: {{module: cm-ptp, {slow}, port: 271, baud: 19200, stations: {{s: {{address: 2}}}},
         jobs: {{w: {{station: s, read: [VW20], timeout: 2s}}}}}}
""")


@pytest.mark.slow
@pytest.mark.parametrize("name", SPECS)
def test_an_ordinary_spec_is_generated_and_verified(name: str, tmp_path: Path) -> None:
    """Everything that is done with a row of the array, and its faults too."""
    assert not tried(SPECS[name], tmp_path, "quick")


def test_channels_are_numbered_among_the_units_that_have_jobs(tmp_path: Path) -> None:
    """Of three units two have no job: one channel, and it has the first place of the gate."""
    path = tmp_path / "spec.yaml"
    path.write_text(yaml.safe_dump(SPECS["drives without jobs in front of the one that has some"]), "utf-8")
    assert api.generate(path, tmp_path / "out").ok
    (calls,) = (file.read_text("utf-8-sig") for file in tmp_path.glob("out/*.scl"))
    assert "channels := 1," in calls
    assert "gate.channels[1]" in calls
    assert "gate.channels[3]" not in calls


def test_start_values_of_arrays_are_declared_whatever_they_are(tmp_path: Path) -> None:
    """8197582173255673615 is 71C3 A98D CDFA A70Fh, eight octets on an S7-1200; two elements alike are written once."""
    path = tmp_path / "spec.yaml"
    path.write_text(yaml.safe_dump(SPECS["start values of arrays whose elements differ"]), "utf-8")
    assert api.generate(path, tmp_path / "out").ok
    (text,) = (file.read_text("utf-8-sig") for file in tmp_path.glob("out/*.scl"))
    assert "Array[0..7] of Byte := [16#71, 16#C3, 16#A9, 16#8D, 16#CD, 16#FA, 16#A7, 16#0F];" in text
    assert "Array[0..3] of Int := [2(5), 0, 6];" in text
    assert "Array[1..3] of Byte := [16#01, 16#02, 16#03];" in text
