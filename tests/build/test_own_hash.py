"""NAME and VERSION in the header of blocks that are made from a spec: a hash of their text, and plcgen's version."""

from __future__ import annotations

import hashlib
import re
from pathlib import Path

import pytest

from plcgen import api
from plcgen._version import __version__
from tests.projects import FAQ, ROOT, generated_example
from tests.proof.damaging import findings, signed

PUMP = "s7-1500_g120_pn"
FB = re.compile(r'^FUNCTION_BLOCK "(\w+)"\n.*?^END_FUNCTION_BLOCK\n', re.DOTALL | re.MULTILINE)


def headers(folder: Path) -> dict[str, tuple[str, str, str]]:
    """NAME, VERSION and text of the function blocks of a project that have a NAME."""
    (source,) = folder.glob("*.scl")
    text = source.read_bytes().decode("cp1252" if b"\r\n" in source.read_bytes() else "utf-8-sig").replace("\r\n", "\n")
    found = {}
    for block in FB.finditer(text):
        name = re.search(r"^NAME : (.*)$", block[0], re.MULTILINE)
        version = re.search(r"^VERSION : '?([\d.]+)'?$", block[0], re.MULTILINE)
        if name and version:
            found[block[1]] = name[1], version[1], block[0]
    return found


@pytest.mark.parametrize(
    ("example", "blocks"),
    [
        (PUMP, {"SetRamps", "ReadSpeed", "ReadFaults", "DriveCalls"}),
        ("s7-300_mm440_dp", {"ReadParams", "WriteParams", "DriveCalls"}),
        ("s7-1200_s7-200_ppi", {"PumpsPpiMaster"}),
    ],
)
def test_the_hash_is_that_of_the_text_without_its_line(example: str, blocks: set[str]) -> None:
    """SHA-256 of all lines but NAME and VERSION; the engine, which is the same everywhere, has a number alone."""
    found = headers(generated_example(example))
    assert found.keys() == blocks
    for name, version, text in found.values():
        kept = re.sub(r"^(NAME|VERSION) : .*\n", "", text, flags=re.MULTILINE)
        assert name == "H" + hashlib.sha256(kept.encode()).hexdigest()[:7].upper()
        assert version == ".".join(__version__.split(".")[:2])


def test_a_header_has_room_for_both() -> None:
    """NAME has eight characters and begins with a letter (S7-SCL V5.3); VERSION goes up to 15.15 (STEP 7 V5 help)."""
    names = {name for name, *_ in headers(generated_example(PUMP)).values()}
    assert all(re.fullmatch(r"H[0-9A-F]{7}", name) for name in names)
    assert len(names) == 4
    assert all(int(part) <= 15 for part in __version__.split(".")[:2])


def test_documents_carry_the_same() -> None:
    """HeaderName is NAME; the instance, which is another block, has none."""
    folder = generated_example(PUMP)
    for block, (name, _, _) in headers(folder).items():
        assert f"<HeaderName>{name}</HeaderName>" in (folder / "xml" / f"{block}.xml").read_text("utf-8")
    assert "HeaderName" not in (folder / "xml" / "DriveCalls_DB.xml").read_text("utf-8")


@pytest.mark.slow
def test_verify_notices_a_text_that_is_not_that_of_its_hash(tmp_path: Path) -> None:
    """A line that moved by a blank, in text alone: nothing else reads blanks."""
    assert api.generate(ROOT / "specs" / f"{PUMP}.yaml", tmp_path / "out").ok
    (source,) = (tmp_path / "out").glob("*.scl")
    text = source.read_text("utf-8-sig")
    at = text.index("BEGIN", text.index('FUNCTION_BLOCK "SetRamps"'))
    source.write_text(text[:at] + " " + text[at:], "utf-8-sig")
    signed(tmp_path / "out", [source.name])
    (found,) = (one.message for check in findings(PUMP, tmp_path / "out") if (one := check.diagnostic) is not None)
    assert 'FB "SetRamps": its hash (NAME) is H' in found
    assert found.endswith("the text was changed")


def test_another_plcgen_alone_is_no_change(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Its version is another one in every block, and diff has nothing to say; the hashes are the same."""
    assert api.generate(FAQ, tmp_path / "old").ok
    monkeypatch.setattr("plcgen.build.own_hash.__version__", "0.9.1")
    assert api.generate(FAQ, tmp_path / "new").ok
    old, new = headers(tmp_path / "old"), headers(tmp_path / "new")
    assert {version for _, version, _ in new.values()} == {"0.9"}
    assert [name for name, *_ in old.values()] == [name for name, *_ in new.values()]
    assert api.diff([tmp_path / "old"], [tmp_path / "new"]).changes == ()


def test_a_changed_block_is_reported_once(tmp_path: Path) -> None:
    """As its code, not as its hash as well."""
    blocks = []
    for name, written in (("old", "P1120: 5.0"), ("new", "P1120: 5.0, P1121: 5.0")):
        spec = tmp_path / f"{name}.yaml"
        spec.write_text(
            "plc: {name: Pump, family: s7-1500, toolchain: tia-v19}\n"
            "drives: {pump: {device: sinamics-g120, hardware_id: 270}}\n"
            f"jobs: {{ramp: {{drive: pump, write: {{{written}}}, comment: 'VERSION : 0.0 NAME : H0000000'}},"
            " speed: {drive: pump, read: [r21]}}\n",
            "utf-8",
        )
        assert api.generate(spec, tmp_path / name).ok
        blocks.append(headers(tmp_path / name))
    changed = {block for block, header in blocks[0].items() if header[0] != blocks[1][block][0]}
    assert "Ramp" in changed
    assert "VERSION : 0.0 NAME : H0000000" in blocks[0]["Ramp"][2]
    assert "Speed" not in changed
    found = api.diff([tmp_path / "old"], [tmp_path / "new"]).changes
    assert found
    assert not [change.message for change in found if change.message.startswith(("name", "version"))]


def test_the_version_is_written_as_the_language_has_it() -> None:
    """In quotation marks for STEP 7 V5, as those of the engine (S7-SCL V5.3 manual, block attributes), else without."""
    for name, mark in (("s7-300_plant_v5", "'"), ("s7-1500_g120_compare", "")):
        (source,) = generated_example(name).glob("*.scl")
        text = source.read_bytes().decode("latin-1")
        heads = [head.split("VAR")[0] for head in re.split(r"^FUNCTION_BLOCK", text, flags=re.MULTILINE)[1:]]
        assert len(heads) > 3
        assert all(re.search(rf"^VERSION : {mark}\d+\.\d+{mark}\r?$", head, re.MULTILINE) for head in heads)
