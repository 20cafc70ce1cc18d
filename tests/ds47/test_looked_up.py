"""A second spot check: facts that somebody looked up in documents of his own choice before he saw the catalogue."""

from __future__ import annotations

import csv
from pathlib import Path

import pytest

from plcgen.ds47 import messages
from plcgen.ds47.device import facts
from plcgen.ds47.devices import find_device

with Path(__file__).with_name("looked_up.tsv").open(encoding="utf-8", newline="") as _file:
    LOOKED_UP = list(csv.DictReader(_file, delimiter="\t", quoting=csv.QUOTE_NONE))


def known(row: dict[str, str]) -> object:
    """What the catalogue says of a fact."""
    device = find_device(row["device"])
    fact, _, number = row["fact"].partition(" ")
    if row["parameter"][0].isupper():
        kind, text = row["parameter"][0], int(row["parameter"][1:])
        said_of = {getattr(one, fact) for one in messages.find(text, device.messages, kind)}
        return row["value"] if row["value"] in said_of else said_of
    pnu = int(row["parameter"][1:])
    parameter = device.find(pnu, row["object"])
    assert parameter is not None
    if fact == "bit":
        return device.bit_text(pnu, int(number), row["object"]).partition(" (")[0]
    if fact == "value":
        return next(name for name, value in parameter.values.items() if value == int(number))
    if fact == "bico":
        return str(parameter.bico).lower()
    said = {str(key): value for key, (value, _) in facts(parameter).items()}
    return said.get("array" if fact == "count" else fact, "")


def test_there_are_two_hundred() -> None:
    """Twice a hundred, of fourteen devices and more, each with its document; drawn at random the second time."""
    assert len(LOOKED_UP) >= 200
    assert len({row["device"] for row in LOOKED_UP}) >= 14
    assert all(row["document"] for row in LOOKED_UP)


@pytest.mark.parametrize("row", LOOKED_UP, ids=lambda row: f"{row['device']} {row['parameter']} {row['fact']}")
def test_the_catalogue_says_what_is_printed(row: dict[str, str]) -> None:
    """By now: what was missing or said otherwise has been corrected."""
    said = known(row)
    assert said == (float(row["value"]) if isinstance(said, int | float) else row["value"])
