"""What is said about hardware identifiers: in IMPORT.md for each drive, by explain, and on a page with pictures."""

from __future__ import annotations

import re
import xml.etree.ElementTree as ET
from pathlib import Path

import pytest
from click.testing import CliRunner

from plcgen import api
from plcgen.cli.main import cli

DOCS = Path(__file__).parents[2] / "docs"
PICTURES = sorted((DOCS / "pictures").glob("hardware-id-*.svg"))


def rows(folder: Path, plc: str, drives: str) -> dict[str, list[str]]:
    """The table of identifiers in IMPORT.md, by drive."""
    spec = folder / "job.yaml"
    spec.write_text(f"plc: {{name: a, {plc}}}\n{drives}\njobs: {{j: {{drive: [a, b], read: [r944]}}}}\n", "utf-8")
    assert api.generate(spec, folder / "out").ok
    guide = (folder / "out" / "IMPORT.md").read_text("utf-8")
    table = guide[guide.index("**Identifiers of the drives.**") :].split("\n\n")[1].splitlines()[2:]
    cells = [[cell.strip() for cell in line.strip("|").split("|")] for line in table]
    return {row[0]: row[1:] for row in cells}


def test_import_guide_on_an_s7_1500(tmp_path: Path) -> None:
    """Name or number, drive object, record index, and the line of the device view."""
    found = rows(
        tmp_path,
        "family: s7-1500, toolchain: tia-v19",
        "units: {cu: {device: sinamics-s120, drives: {a: {hardware_id: Cu~Drive_1, drive_object: 2}, "
        "b: {hardware_id: 284, drive_object: 3}}}}",
    )
    place = "device view: System constants of the Module Access Point of drive object"
    assert found == {"a": ["`Cu~Drive_1`", "2", "16#B02F", f"{place} 2"], "b": ["`284`", "3", "16#B02F", f"{place} 3"]}


def test_import_guide_on_an_s7_300(tmp_path: Path) -> None:
    """Addresses, and that one is an output address; unused drives are left out."""
    found = rows(
        tmp_path,
        "family: s7-300, toolchain: step7-v5",
        "drives: {a: {device: sinamics-s120, address: 256, record_index: 47}, b: {device: sinamics-s120, "
        "address: 300, output_address: true, record_index: 47}, c: {device: sinamics-s120, address: 400}}",
    )
    assert [found["a"][0], found["b"][0]] == ["`256`", "`300, output`"]
    assert "process data" in found["a"][3]
    assert set(found) == {"a", "b"}


def test_explain() -> None:
    """In any letter case, and offered where it is misspelt."""
    result = CliRunner().invoke(cli, ["explain", "Hardware-ID"])
    assert "Module Access Point" in result.output
    page = api.explain("hardware-id")
    assert page is not None
    assert {"ET 200", "PROFIBUS", "S120: several drive objects"} <= {heading for heading, _ in page.sections}


@pytest.mark.parametrize("picture", PICTURES, ids=lambda path: path.stem)
def test_pictures_are_on_the_page_and_say_what_they_show(picture: Path) -> None:
    """Each is shown with a text, has a title and a description, and every line of text lies inside of it."""
    page = (DOCS / "hardware-id.md").read_text("utf-8")
    assert re.search(rf"!\[[^\]]{{20,}}\]\(pictures/{picture.name}\)", page)
    root = ET.fromstring(picture.read_text("utf-8"))  # a file of this repository
    name = "{http://www.w3.org/2000/svg}"
    assert (root.findtext(f"{name}title"), root.findtext(f"{name}desc")) != (None, None)
    for text in root.iter(f"{name}text"):
        assert float(text.get("x", "")) + 8 * len(text.text or "") <= float(root.get("width", "")) + 60, text.text


def test_there_is_a_picture_for_each_case() -> None:
    """PROFINET, S120, ET 200, DP."""
    assert [path.stem.rpartition("-")[2] for path in PICTURES] == ["dp", "et200", "pn", "s120"]
