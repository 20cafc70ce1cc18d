"""Spot checks: what somebody who had not seen the catalogue read in manuals, held against it."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import pytest
import yaml

from plcgen.ds47.catalogue import pages
from plcgen.ds47.device import Parameter
from plcgen.ds47.devices import find_device

CHECKS: list[dict[str, Any]] = yaml.safe_load(Path(__file__).with_name("spot_checks.yaml").read_text("utf-8"))
FOUND = [check for check in CHECKS if check["result"] == "found"]
FAMILIES = (
    "sinamics-g120",
    "sinamics-s120",
    "sinamics-s210",
    "sinamics-v90",
    "sinamics-dcm",
    "micromaster-4",
    "sinamics-g130",
)
TYPES = {"floatingpoint32": "FloatingPoint", "float": "FloatingPoint", "u16": "Unsigned16", "u32": "Unsigned32",
         "i16": "Integer16", "i32": "Integer32"}  # fmt: skip

ON_THE_WIRE = {("r948", "Unsigned32", "TimeDifference"), ("r965", "Unsigned16", "OctetString")}
"""A list's type and the one that is sent, as docs/devices.md says."""


def known(check: dict[str, Any]) -> Parameter:
    return find_device(check["device"]).parameters[int(check["parameter"].strip("pPrR"))]


def number(value: object) -> float | None:
    """A number as printed, with point or comma; None for words."""
    text = str(value).replace(" ", "")
    text = text.replace(",", ".") if text.count(",") == 1 and "." not in text else text
    return float(text) if re.fullmatch(r"[+-]?\d+(\.\d+)?", text) else None


def count(check: dict[str, Any]) -> int | str | None:
    """Indexes as printed: a number, the data set that they follow, 0 for none; None if the page does not say."""
    text = str(check.get("indexes", ""))
    if text == "none":
        return 0
    several = re.match(r"0\D*(\d+)$", text) or re.match(r"(\d+) \(", text)
    if several:
        return int(several[1]) + (text[0] == "0")
    match = re.match("(CDS|DDS|EDS|MDS)", text)
    return match[1] if match else None


def compared(check: dict[str, Any]) -> dict[str, bool]:
    """Each fact that page and catalogue state, whatever its grade, and whether they agree."""
    one = known(check)
    facts = {fact: value for fact, (value, _) in pages.facts(one).items()}
    found = {"access": check.get("access", facts["access"]) == facts["access"]}
    if check.get("type") and facts.get("type"):
        printed = str(check["type"]).split("/")[0].strip()
        stated = str(facts["type"]).split("[")[0]
        same = TYPES.get(printed.lower(), printed).lower() == stated.lower()
        found["type"] = same or (check["parameter"], printed, stated) in ON_THE_WIRE
    for key in ("min", "max", "default"):
        printed, stated = number(check.get(key)), facts.get(key)
        if printed is not None and isinstance(stated, int | float):
            found[key] = abs(printed - stated) <= 1e-6 * abs(printed)
    if check.get("unit") not in {None, "-"} and facts.get("unit"):
        found["unit"] = str(check["unit"]).lower() == str(facts["unit"]).lower()
    if count(check) is not None and facts.get("array") != "n":
        found["array"] = count(check) == facts.get("array", 0)
    return found


def test_what_was_drawn_was_looked_for() -> None:
    """Ten of each family by seed, and more where no page was found; every find has its page."""
    for family in FAMILIES:
        looked = [check for check in CHECKS if check["device"] == family]
        assert len(looked) >= 10, family
        found = sum(check["result"] == "found" for check in looked)
        assert found == 10 or len(looked) == 25, (family, found)  # with all of the 15 spare numbers
    assert {check["result"] for check in CHECKS} == {"found", "not found"}
    assert all(check["manual"] and check["page"] and check["where"] for check in FOUND)
    assert len({(check["device"], check["parameter"]) for check in CHECKS}) == len(CHECKS)


@pytest.mark.parametrize("check", FOUND, ids=lambda check: f"{check['device']} {check['parameter']}")
def test_the_catalogue_agrees(check: dict[str, Any]) -> None:
    """By now: what disagreed when it was drawn has been corrected."""
    assert [fact for fact, same in compared(check).items() if not same] == []
