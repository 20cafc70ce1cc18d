"""Search of the catalogue: numbers, words of titles, messages; why nothing was found, and what can be done."""

from __future__ import annotations

from pathlib import Path

import pytest

from plcgen.ds47.devices import device_names
from plcgen.workbench.service.specs.search import MOST, Search, search
from tests.workbench.desk import Desk

TEXT = """\
plc: {name: Press, family: s7-1500, toolchain: tia-v19}
drives:
  axis: {device: sinamics-g120, hardware_id: 270}
  maker: {device: profidrive, hardware_id: 271}
units:
  cabinet: {device: sinamics-s120, drives: {one: {drive_object: 3, hardware_id: 272}}}
jobs:
  read_axis: {drive: axis, read: [r21]}
  read_maker: {drive: maker, read: [P922]}
"""


def found(folder: Path, words: str, *place: str, text: str = TEXT) -> Search:
    """What a search finds."""
    desk = Desk(folder)
    document, _, _ = desk.open(text)
    return search(desk.workspace.specs.state(document), place, words)


@pytest.mark.parametrize(
    "words", ["1120", "P1120", "p01120", "ramp-function generator ramp-up", "P1120[1]", "ramp_up_time"]
)
def test_a_parameter(words: str, tmp_path: Path) -> None:
    """The list manual of the G120: p1120 is the ramp-up time of the ramp-function generator, in seconds."""
    (one,) = [one for one in found(tmp_path, words, "jobs", "read_axis").parameters if one.parameter == "P1120"]
    assert (one.device, one.writable) == ("sinamics-g120", True)
    assert "amp-up time · s" in one.text


@pytest.mark.parametrize("words", ["F30001", "f30001", "30001", "F3000", "overcurrent", "power unit overcurrent"])
def test_a_message(words: str, tmp_path: Path) -> None:
    """List manual of the G120, chapter of faults and alarms: F30001 Power unit: Overcurrent, reaction OFF2."""
    (one,) = [one for one in found(tmp_path, words, "jobs", "read_axis").messages if one.key == "F30001"]
    assert one.title == "Power unit: Overcurrent"
    assert "OFF2" in one.text


@pytest.mark.parametrize(
    ("german", "english"),
    [("Drehzahl", "speed"), ("strom", "current"), ("Motortemperatur", "motor temperature"), ("Rampe", "ramp")],
)
def test_german_words(german: str, english: str, tmp_path: Path) -> None:
    """They find what the English ones of the titles find, and that is something."""
    assert found(tmp_path, german).parameters == found(tmp_path, english).parameters != ()


def test_addresses_and_symbols_of_a_station(tmp_path: Path) -> None:
    """The address that was typed, as the S7-200 writes it, or symbols by their words; nothing of the drives."""
    text = (
        "plc: {name: Press, family: s7-1200, toolchain: tia-v19}\n"
        "ppi:\n  line:\n    module: cm1241\n    port: 270\n"
        "    stations: {well: {address: 2, symbols: {level: VD104, running: Q0.0}}}\n"
        "    jobs: {read_well: {station: well, read: [VW100]}}\n"
    )
    place = ("ppi", "line", "jobs", "read_well")
    for words, wanted in (("vd200", ["VD200"]), ("Level", ["level"]), ("VD104", ["VD104", "level"]), ("speed", [])):
        shown = found(tmp_path, words, *place, text=text).parameters
        assert [one.parameter for one in shown] == wanted
        assert {one.device for one in shown} <= {"well"}


def test_every_drive_is_asked(tmp_path: Path) -> None:
    """Without a job all of them, those of units too, each device once; with one its drives alone."""
    assert {one.device for one in found(tmp_path, "F30001").messages} == {"sinamics-g120", "sinamics-s120"}
    assert [one.device for one in found(tmp_path, "F30001").nothing] == ["profidrive"]
    twice = TEXT.replace("units:", "  again: {device: sinamics-g120, hardware_id: 280}\nunits:")
    assert len(found(tmp_path, "F30001", text=twice).messages) == 2
    assert not found(tmp_path, "F30001", "jobs", "read_maker").messages


@pytest.mark.parametrize(
    ("words", "place", "why", "help_"),
    [
        ("ramp", "read_maker", "no list of it is known", "type the number and the type"),
        ("P2000", "read_maker", "P2000 is unknown", "type: .."),
        ("F30001", "read_maker", "no list of its messages is known", "manual"),
        ("F99999", "read_axis", "no such number", "manual"),
        ("xyzzy", "read_axis", 'no title has "xyzzy"', "other words"),
    ],
)
def test_nothing(words: str, place: str, why: str, help_: str, tmp_path: Path) -> None:
    """The device by its title, what was searched, what can be done."""
    result = found(tmp_path, words, "jobs", place)
    (one,) = result.nothing
    assert (result.parameters, result.messages) == ((), ())
    assert why in one.why
    assert help_ in one.help


@pytest.mark.parametrize("name", device_names())
def test_nothing_is_always_told(name: str, tmp_path: Path) -> None:
    """Of every device: a number, a message and words that nobody has."""
    text = f"plc: {{name: A, family: s7-1500, toolchain: tia-v19}}\ndrives: {{axis: {{device: {name}}}}}\n"
    for words in ("P64999", "F59999", "xyzzy"):
        (one,) = found(tmp_path, words, text=text).nothing
        assert one.device == name
        assert one.why
        assert one.help


def test_what_a_device_surely_lacks(tmp_path: Path) -> None:
    """The list of S200 PN has no p3981: the drive would refuse it, whatever type is given."""
    text = "plc: {name: A, family: s7-1500, toolchain: tia-v19}\ndrives: {axis: {device: sinamics-s200}}\n"
    (one,) = found(tmp_path, "P3981", text=text).nothing
    assert "has no P3981" in one.why
    assert "00h" in one.help


def test_no_more_than_can_be_read(tmp_path: Path) -> None:
    """A word that many titles have: a part of them, and that there is more."""
    result = found(tmp_path, "motor", "jobs", "read_axis")
    assert len(result.parameters) <= MOST
    assert len(result.messages) <= MOST
    assert result.more
    assert found(tmp_path, "   ") == Search((), (), (), more=False)
