"""The second drive and the documents that it was written from."""

from __future__ import annotations

import ast
from pathlib import Path

import pytest

from plcgen.oracles import profidrive
from plcgen.oracles.documents import DocumentedType, PublishedTelegram, device, documented_types, published
from plcgen.oracles.profidrive import DocumentedDrive, HeldParameter, UnansweredError
from tests.projects import ROOT

ROOM = sorted((ROOT / "plcgen/oracles").glob("*.py"))
TELEGRAMS = {one.id: one for one in published()}


def imported(path: Path) -> set[str]:
    found = set()
    for node in ast.walk(ast.parse(path.read_text("utf-8"))):
        if isinstance(node, ast.ImportFrom):
            found.add(f"{'.' * node.level}{node.module}")
        elif isinstance(node, ast.Import):
            found |= {name.name for name in node.names}
    return found


@pytest.mark.parametrize("path", ROOM, ids=lambda path: path.name)
def test_an_oracle_shares_nothing(path: Path) -> None:
    """What it imports is Python's."""
    assert not {name for name in imported(path) if name.startswith(("plcgen", "."))}


def test_the_second_drive_is_small() -> None:
    """Small enough to be read beside the manual."""
    assert len((ROOT / "plcgen/oracles/profidrive.py").read_text("utf-8").splitlines()) <= 250


def drive_of(one: PublishedTelegram) -> DocumentedDrive:
    """The drive of the manual: with the values that it shows, or zeros where it shows how they are written."""
    parameters = {
        said.number: HeldParameter(
            said.type,
            {said.subindex + at: 0 if one.writes else value for at, value in enumerate(said.values)},
            array=len(said.values) > 1,
        )
        for said in one.parameters
    }
    return DocumentedDrive({one.drive_object: parameters}, one.by_size)


@pytest.mark.parametrize("name", TELEGRAMS)
def test_the_second_drive_answers_as_published(name: str) -> None:
    """Byte for byte, and a change has its effect."""
    one = TELEGRAMS[name]
    drive = drive_of(one)
    assert drive.answer(47, one.request) == one.answer
    for said in one.parameters:
        assert tuple(drive.objects[one.drive_object][said.number].values.values()) == said.values


REFUSED = {
    "drive object 3 (19h)": ("01 01 03 01 10 01 04 60 00 00", "01 81 03 01 44 01 00 19"),
    "number 1 (00h)": ("01 01 01 01 10 01 00 01 00 00", "01 81 01 01 44 01 00 00"),
    "subindex of a simple parameter (04h)": ("01 01 01 01 10 01 04 60 00 01", "01 81 01 01 44 01 00 04"),
    "subindex 4 of 3 (03h, with it)": ("01 01 01 01 10 01 08 6B 00 04", "01 81 01 01 44 02 00 03 00 04"),
    "attribute 20h (09h)": ("01 01 01 01 20 01 04 60 00 00", "01 81 01 01 44 01 00 09"),
    "a word for a REAL (05h)": ("01 02 01 01 10 01 04 60 00 00 06 01 00 01", "01 82 01 01 44 01 00 05"),
    "two values for one (18h)": ("01 02 01 01 10 01 08 6B 00 01 06 02 00 01 00 02", "01 82 01 01 44 01 00 18"),
    "700.0 above 650 (02h)": ("01 02 01 01 10 01 04 60 00 00 08 01 44 2F 00 00", "01 82 01 01 44 02 00 02 00 00"),
    "a parameter to read (01h)": ("01 02 01 01 10 01 00 15 00 00 08 01 00 00 00 00", "01 82 01 01 44 02 00 01 00 00"),
    "one of two": (
        "01 02 01 02 10 01 04 60 00 00 10 01 00 01 00 00 43 01 41 20 00 00 06 01 00 00",
        "01 82 01 02 40 00 44 01 00 00",
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", REFUSED)
def test_what_the_second_drive_refuses(name: str) -> None:
    """Error values of table 10-31; the column "additional info" says which of them are followed by the subindex."""
    request, answer = map(bytes.fromhex, REFUSED[name])
    parameters = {
        1120: HeldParameter("FloatingPoint", {0: 10.0}, minimum=0, maximum=650),
        2155: HeldParameter("Unsigned16", {0: 1, 1: 2, 2: 3}, array=True),
        21: HeldParameter("FloatingPoint", {0: 0.0}, read_only=True),
    }
    assert DocumentedDrive({1: parameters}).answer(47, request) == answer


@pytest.mark.parametrize(
    ("record", "request_", "why"),
    [
        (0xB02D, "01 01 01 01 10 01 04 60 00 00", "record B02Dh"),
        (47, "00 01 01 01 10 01 04 60 00 00", "request reference 0"),
        (47, "01 03 01 01 10 01 04 60 00 00", "request ID 03h"),
        (47, "01 01 01 00", "0 parameters"),
        (47, "01 01 01 01 10 01 04 60 00", "in the parameter address"),
        (47, "01 01 01 01 10 01 04 60 00 00 00", "1 bytes too many"),
        (47, "01 02 01 01 10 01 04 60 00 00 0E 01 00 00", "format 0Eh has no size"),
    ],
)
def test_what_is_no_request(record: int, request_: str, why: str) -> None:
    """The documents define no answer."""
    with pytest.raises(UnansweredError, match=why):
        DocumentedDrive({}).answer(record, bytes.fromhex(request_))


UNDOCUMENTED = {
    "profidrive", "sinamics-g110m", "sinamics-g115d", "sinamics-g120c", "sinamics-g130", "sinamics-s150",
    "sinamics-s210", "sinamics-s210-fw6", "sinamics-s200", "sinamics-s200-basic", "sinamics-g220",
    "sinamics-g220-clean-power", "profidrive-encoder",
}  # fmt: skip
"""No device, or none with a document about its channel and its drive objects that was found."""


@pytest.mark.parametrize("profile", sorted((ROOT / "specs/devices").glob("*.yaml")), ids=lambda path: path.stem)
def test_every_shipped_device_was_looked_up(profile: Path) -> None:
    """Its drive object is among those that the document names, and the second drive has every type that is stated."""
    said = device(profile.stem)
    if profile.stem in UNDOCUMENTED:
        assert said is None
        return
    assert said is not None
    assert not said.drive_objects or said.drive_object in said.drive_objects
    stated = [one for said in documented_types(profile.stem).values() for one in said]
    assert {one.type for one in stated} <= set(profidrive.TYPES)
    assert all(one.source for one in stated)


@pytest.mark.parametrize("profile", sorted((ROOT / "specs/devices").glob("*.yaml")), ids=lambda path: path.stem)
def test_documents_agree_with_each_other(profile: Path) -> None:
    """No two documents state different types for one number of a device."""
    assert {n: said for n, said in documented_types(profile.stem).items() if len({one.type for one in said}) > 1} == {}


def test_another_document() -> None:
    """A list that the profile was made from is no second source: it is known by its package, another text by itself."""
    listed = DocumentedType("Integer16", "parameters of VECTOR (package sdrpa012)", "sdrpa012")
    assert not listed.another("TIA Portal help, parameters of VECTOR (package sdrpa012, list version 5207320)")
    assert listed.another("TIA Portal help, parameters of TM41 (package sdrpa201, firmware 5.2)")
    manual = DocumentedType("Integer16", "manual, page 7")
    assert manual.another("manual, page 8")
    assert not manual.another("manual, page 7")


def test_what_lists_print() -> None:
    """p0971, p0977 and p3981 in the lists of the control units and of VECTOR; MICROMASTER and p50303 are in none."""
    s120 = documented_types("sinamics-s120")
    assert [(one.type, one.package) for one in s120[971]][1:3] == [
        ("Unsigned16", "sdrpa012"),
        ("Unsigned16", "sdrpa001"),
    ]
    assert {one.package for one in s120[977]} == {"", "sdrpa001", "sdrpa400", "sdrpa401"}
    assert {one.type for one in s120[3981]} == {"Unsigned8"}
    assert {one.package for one in documented_types("sinamics-dcm")[50303]} == {""}
    assert {one.package for said in documented_types("micromaster-4").values() for one in said} == {""}
