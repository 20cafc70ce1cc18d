"""verify compares the text source and the document of every code block, as they lie on disk."""

from __future__ import annotations

from pathlib import Path

import pytest

from plcgen import api
from plcgen.project.target import target
from plcgen.proof.checks import Outcome
from plcgen.proof.folder import read_folder
from plcgen.proof.twins import difference
from plcgen.s7.read.text import read_source
from plcgen.s7.xml.reading.documents import read_simaticml
from tests.projects import per_block_spec

FAQ = per_block_spec("s7-300_6ra80_dp_tia")
EXAMPLE = FAQ.with_name("out")


def pair(name: str, change: tuple[str, str] | None = None):
    """Text block and document block; ``change`` is made in the document."""
    known = read_folder(EXAMPLE, target("s7-300", "tia-v16")).text
    data = (EXAMPLE / f"xml/{name}.xml").read_text("utf-8-sig")
    if change is not None:
        assert change[0] in data
        data = data.replace(*change, 1)
    folder = "db" if name.endswith("_DB") else "scl"
    text = read_source(EXAMPLE / folder / f"{name}.{folder}")[0][0]
    return text, read_simaticml(data.encode(), classic=True)[0][0], known


@pytest.mark.parametrize("name", ["ReadRampUp", "DriveChannel", "DriveCalls_DB", "Main"])
def test_shipped_twins_say_the_same(name: str) -> None:
    """An FB, its instance DB, the OB."""
    text, document, known = pair(name)
    problem, count, _ = difference(text, document, known)
    assert problem == ""
    assert (count > 0) == (text.code is not None)


@pytest.mark.parametrize(
    ("name", "change", "expected"),
    [
        ("ReadRampUp", ('<Token Text="&lt;&gt;"', '<Token Text="="'), "line 1 of the code has <>, the document ="),
        ("DriveChannel", ('Name="STATE_IDLE"', 'Name="STATE_READ"'), "Constant has other members"),
        ("DriveChannel", (">W#16#8101<", ">W#16#8102<"), "Constant STATUS_TIMEOUT is declared differently"),
        ("ReadRampUp", ('Name="busy" Datatype="Bool"', 'Name="busy" Datatype="Byte"'), "Output busy is declared"),
        ("ReadRampUp", ("the job is running", "the job is walking"), "Output busy is declared differently"),
        ("DriveChannel", ('Datatype="WRREC" Version="1.0"', 'Datatype="WRREC" Version="1.1"'), "Static instWrite"),
        ("ReadRampUp", ("<Text>Read the ramp-up", "<Text>Write the ramp-up"), "title or comment differ"),
        ("DriveCalls_DB", ('<Member Name="driveGate"', '<Member Name="driveGates"'), "Static has other members"),
        ("DriveCalls_DB", ("<InstanceOfName>DriveCalls", "<InstanceOfName>WriteRampDown"), "another kind of block"),
        ("DriveCalls", ('Name="readRampUpDone"', 'Name="readRampUpGone"'), 'the document "readRampUpGone"'),
    ],
)  # fmt: skip
def test_every_difference_is_found(name: str, change: tuple[str, str], expected: str) -> None:
    """Tokens, names, types, start values, comments, versions, titles, what an instance is made from."""
    problem, _, _ = difference(*pair(name, change))
    assert expected in problem


def test_verify_says_it(tmp_path: Path) -> None:
    """A source changed by hand, and a document that is gone, are errors of the folder."""
    assert api.generate(FAQ, tmp_path / "out").ok
    source = tmp_path / "out/scl/ReadRampUp.scl"
    text = source.read_text("utf-8-sig")
    source.write_text(text.replace("LIMIT(MN := 1,", "LIMIT(MN := 2,"), "utf-8-sig")
    (edited,) = [number for number, line in enumerate(text.splitlines(), 1) if "LIMIT(MN := 1," in line]
    found = api.verify(FAQ, tmp_path / "out", faults="none")
    (told,) = [c.diagnostic for c in found.checks() if c.id == "files.twins"]
    assert (told.span.file, told.span.line) == (str(source), edited)
    (tmp_path / "out/xml/Main.xml").unlink()
    found = api.verify(FAQ, tmp_path / "out", faults="none")
    (check,) = [c for c in found.checks() if c.id == "files.twins"]
    assert check.outcome is Outcome.ERROR
    assert {"PG608", "PG612"} & {check.diagnostic.code}
    assert "(+1 more)" in check.verdict
