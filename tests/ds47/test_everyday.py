"""What engineers ask for every day of devices whose lists are not public whole: known, with its type."""

from __future__ import annotations

from pathlib import Path

import pytest

from plcgen.ds47.device import Parameter
from plcgen.ds47.devices import find_device
from plcgen.ds47.references import number_of
from tests.yaml_files import read_yaml

EVERYDAY: dict[str, list[str]] = read_yaml(Path(__file__).with_name("everyday.yaml").read_text("utf-8"))
UNKNOWN = {"sinamics-v90": {"P977"}}
"""What nobody found in a source."""
PAGE = (Path(__file__).parents[2] / "docs" / "devices.md").read_text("utf-8")


def _known(name: str) -> dict[str, Parameter]:
    device = find_device(name)
    found = {text: device.find(number_of(text) or 0) for text in EVERYDAY[name]}
    return {text: one for text, one in found.items() if one is not None and one.type and one.title}


@pytest.mark.parametrize("name", EVERYDAY)
def test_everyday_parameters_are_known(name: str) -> None:
    """At least 45 of 60, with type, title, source and access; what is from memory alone has that grade."""
    asked, known = EVERYDAY[name], _known(name)
    assert len(set(asked)) == len(asked) == 60
    assert set(asked) - set(known) == UNKNOWN.get(name, set())
    assert len(known) >= 45
    assert not [text for text, one in known.items() if (one.access == "r") is not text.startswith("r")]
    memory = [one for one in known.values() if one.source.startswith("from general knowledge")]
    assert {one.grades["type"] for one in memory} <= {"recalled"}


def test_the_page_counts_types_that_were_read() -> None:
    """docs/devices.md: of how many of the sixty the type was read."""
    read = {name: [one.grades.get("type", "read") for one in _known(name).values()].count("read") for name in EVERYDAY}
    assert read == {"micromaster-4": 2, "sinamics-dcm": 1, "sinamics-v90": 0}
    assert "the type was read for 2 of a MICROMASTER, 1 of a DCM and none of a V90" in " ".join(PAGE.split())
