"""``read: main_values``: which parameters these are, held against the titles of whole lists, and on the wire."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from plcgen import api
from plcgen.ds47 import lists
from plcgen.ds47.devices import device_names, find_device
from plcgen.ds47.plan.nouns import DrivePlan
from plcgen.ds47.references import number_of

WORDS = {
    "state": "operating display", "speed": "actual speed smoothed|speed actual value smoothed",
    "current": "absolute actual current", "torque": "actual torque", "dc_link_voltage": "dc link voltage",
    "power": "active power", "fault": "actual fault (code|number)", "alarm": "actual alarm (code|number)",
}  # fmt: skip
"""What the lists in the help of the TIA Portal call them."""
OWN_LIST = [key for key in device_names() if any(one.grade == "read" for one in find_device(key).lists)]
LISTED = [key for key in OWN_LIST if key != "sinamics-dcm"]
"""Of a DCM only the list of the control unit is public."""


@pytest.mark.parametrize("key", LISTED)
def test_whole_lists_call_them_so(key: str) -> None:
    """The title of each number in the list of the drive says what the output says."""
    device = find_device(key)
    assert device.main_values.keys() == WORDS.keys()
    for name, text in device.main_values.items():
        titles = [row.texts["title"].lower() for one in device.lists for row in lists.find(one.name, number_of(text))]
        assert any(re.search(WORDS[name], title) for title in titles), (name, titles)


@pytest.mark.parametrize("key", [key for key in device_names() if find_device(key).main_values])
def test_the_catalogue_knows_each_of_them(key: str) -> None:
    """With its type."""
    device = find_device(key)
    type_ = device.object_types.others if device.object_types is not None else ""
    for text in device.main_values.values():
        known = device.find(number_of(text.partition("[")[0]) or 0, type_)
        assert known is not None, text
        assert known.type, text


def test_one_telegram_asks_for_all_of_them(tmp_path: Path) -> None:
    """S120, drive object 3: r2, r21 = 15h, r27 = 1Bh, r31 = 1Fh, r26 = 1Ah, r32 = 20h, r2131 = 853h, r2132 = 854h."""
    spec = tmp_path / "job.yaml"
    spec.write_text("""plc: {name: a, family: s7-1500, toolchain: tia-v19}
drives: {d: {device: sinamics-s120, hardware_id: 270, drive_object: 3}}
jobs: {j: {drive: d, read: main_values}}
""")
    (job,) = api.check(spec).project.plan(DrivePlan).jobs
    numbers = ("0002", "0015", "001b", "001f", "001a", "0020", "0853", "0854")
    assert job.telegrams[0].request.data.hex() == "01010308" + "".join(f"1001{number}0000" for number in numbers)
    names = ["state", "speed", "current", "torque", "dcLinkVoltage", "power", "fault", "alarm"]
    assert [use.member for use in job.outputs] == names
