"""What a comparison of two specs says first: a sentence for each job, addresses of an HMI, values before and after."""

from __future__ import annotations

from pathlib import Path

import pytest

from plcgen import api
from plcgen.base.display.view import PLAIN
from plcgen.report.registry import output_format
from plcgen.s7.compare.model import Comparison

DRIVES = [f"f{number:02}" for number in range(20)]
PLANT = (
    "plc: {name: P, family: s7-1500, toolchain: tia-v19}\n"
    "drives:\n"
    + "".join(f"  {key}: {{device: sinamics-g120, hardware_id: {270 + n}}}\n" for n, key in enumerate(DRIVES))
    + "jobs:\n"
    f"  actual: {{drive: [{', '.join(DRIVES)}], read: [r21, r27]}}\n"
    f"  ramps: {{drive: [{', '.join(DRIVES)}], write: {{P1120: 5.0, P1121: }}}}\n"
)


def compared(folder: Path, old: str, new: str) -> Comparison:
    """Two specs."""
    for name, text in (("old", old), ("new", new)):
        (folder / f"{name}.yaml").write_text(text, "utf-8")
    return api.diff(folder / "old.yaml", folder / "new.yaml")


def shown(name: str, comparison: Comparison) -> str:
    """In a format."""
    format_ = output_format(name)
    assert format_ is not None
    return format_.render("comparison", comparison, PLAIN)


@pytest.fixture(scope="module")
def added(tmp_path_factory: pytest.TempPathFactory) -> Comparison:
    """One parameter more in a plant of 20 drives."""
    return compared(tmp_path_factory.mktemp("plant"), PLANT, PLANT.replace("[r21, r27]", "[r21, r27, r26]"))


def test_one_parameter_more_is_one_sentence(added: Comparison) -> None:
    """4 bytes of signals, two REALs and a diagnosis of 6 words: a job every 24 bytes; with a third REAL, every 32."""
    first, second = added.sentences
    assert first.text.startswith(
        "r26 added after r27; actualF00.diagnosis.recordStatus now at DriveJobs.DBW16 (was DBW12)"
    )
    assert (first.who, len(first.partners)) == ("actual, 20 drives", 20)
    assert second.who == "ramps, 20 drives"
    assert second.text.startswith("rampsF00.status now at DriveJobs.DBW642 (was DBW482)")
    assert first.span is not None
    assert first.span.line == 24


def test_a_moved_address_is_breaking_in_the_sentence_too(tmp_path: Path) -> None:
    """A compatible change of a job (a value of a constant) does not hide that its addresses are others: a panel with
    absolute addresses reads other bytes, and the table below has member-moved as breaking.
    """
    new = PLANT.replace("[r21, r27]", "[r21, r27, r26]").replace("P1120: 5.0", "P1120: 6.0")
    found = compared(tmp_path, PLANT, new)
    kinds = {change.kind: change.level.value for change in found.changes}
    assert (kinds["telegram-value"], kinds["member-moved"]) == ("compatible", "breaking")
    ramps = next(one for one in found.sentences if one.job == "ramps")
    assert ramps.text.startswith("P1120 5.0 -> 6.0; ")
    assert ramps.text.endswith("more addresses: a panel with absolute addresses reads other bytes")
    assert ramps.level.value == "breaking"


def test_the_text_is_short_and_the_engine_closed(added: Comparison) -> None:
    """At most 60 lines, the sentences first; what follows inside of blocks is named, --verbose has it."""
    lines = shown("text", added).splitlines()
    assert len(lines) <= 60
    assert lines[0].startswith("breaking       actual, 20 drives: r26 added after r27")
    assert 'inside of DB "DriveCalls_DB", FB "Actual", FB "DriveCalls": --verbose' in lines
    assert not any(line.startswith("FB ") for line in lines)
    assert "job actual.f00 .. actual.f19 (20 alike)" in lines


def test_markdown_is_short_and_github_has_one_annotation_for_each_job(added: Comparison) -> None:
    """Below 20 kB; jobs at their lines, the data block and the type in it once."""
    markdown = shown("markdown", added)
    assert len(markdown.encode()) < 20_000
    assert markdown.index("**actual, 20 drives**: r26 added after r27") < markdown.index("<details>")
    annotations = shown("github", added).splitlines()
    assert [line.partition("::breaking: ")[2].partition(":")[0] for line in annotations] == [
        "actual, 20 drives", "ramps, 20 drives", 'DB "DriveJobs"', 'UDT "typeActual_Diagnosis"',
    ]  # fmt: skip
    assert ",line=24," in annotations[0]


CHANGES = {
    "a value": ("P1120: 5.0", "P1120: 6.0", "P1120 5.0 -> 6.0"),
    "a constant becomes an input": ("P1120: 5.0", "P1120: ", "P1120 5.0 -> 10.0 (input)"),
    "one less": ("[r21, r27]", "[r21]", "r27 removed"),
    "another in its place": ("[r21, r27]", "[r21, r26]", "r27 removed; r26 added after r21"),
    "the first": ("[r21, r27]", "[r26, r21, r27]", "r26 added as the first"),
    "in another order": ("[r21, r27]", "[r27, r21]", "r27 now the first"),
    "a time": ("[r21, r27]", "[r21, r27], timeout: 5s", "timeout 10000 ms -> 5000 ms"),
    "a job less": ("  ramps", "  ramps2", "new: writes P1120 = 5.0, P1121 = 10.0 (input)"),
}


@pytest.mark.parametrize("name", CHANGES)
def test_what_changed_is_told_once(name: str, tmp_path: Path) -> None:
    """In the words of the spec, with the value before and after."""
    old, new, said = CHANGES[name]
    assert old in PLANT
    texts = [one.text for one in compared(tmp_path, PLANT, PLANT.replace(old, new)).sentences]
    assert sum(said in text for text in texts) == 1, texts


def test_a_drive_more_concerns_that_drive(tmp_path: Path) -> None:
    """The other nineteen have no sentence of their own, apart from their addresses."""
    found = compared(tmp_path, PLANT.replace(", f19]", "]"), PLANT)
    new = {one.job: one.partners for one in found.sentences if one.text.startswith("new: ")}
    assert new == {"actual": ("f19",), "ramps": ("f19",)}


def test_sources_have_no_sentences(tmp_path: Path) -> None:
    """Only a spec knows jobs: the blocks on disk are compared as before."""
    (tmp_path / "a.scl").write_text('DATA_BLOCK "A"\nSTRUCT\n x : Int;\nEND_STRUCT;\nBEGIN\nEND_DATA_BLOCK\n')
    (tmp_path / "b.scl").write_text('DATA_BLOCK "A"\nSTRUCT\n y : Int;\nEND_STRUCT;\nBEGIN\nEND_DATA_BLOCK\n')
    found = api.diff(tmp_path / "a.scl", tmp_path / "b.scl")
    assert (found.sentences, found.inside) == ((), frozenset())


def test_code_of_a_job_of_which_nothing_else_is_told_is_open(tmp_path: Path) -> None:
    """Which bit of a word is written is in no telegram: the block of that job stays open."""
    old = PLANT.replace("P1121: }", "P1030.2: 1}")
    found = compared(tmp_path, old, old.replace("P1030.2: 1", "P1030.3: 1").replace("[r21, r27]", "[r21]"))
    assert 'FB "Actual"' in found.inside
    shown_ = shown("text", found)
    assert 'FB "Actual"\n' not in shown_
    assert "P1030" in shown_ or 'FB "Ramps"\n' in shown_
