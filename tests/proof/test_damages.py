"""Damage to what people read, by kind of file and kind of text: all of it is noticed, whatever the manifest says.

``make damages`` tries every row; ``make test`` every fourth one.
"""

from __future__ import annotations

import os
import shutil
import tomllib
from collections import Counter
from pathlib import Path

import pytest

from plcgen import api
from plcgen.project.opening import open_spec
from plcgen.proof.checks import Outcome
from plcgen.proof.files import delivered
from plcgen.proof.folder import read_folder
from tests.projects import generated_example
from tests.proof.damaging import Edit, damaged, findings

ROWS: dict[tuple[str, str], list[Edit]] = {}
for example, table in tomllib.loads((Path(__file__).parent / "damages.toml").read_text("utf-8")).items():
    for what, *rest in table["rows"]:
        assert (example, what) not in ROWS, what
        ROWS[example, what] = [(rest[at], rest[at + 1], rest[at + 2]) for at in range(0, len(rest), 3)]
SAMPLE = 1 if os.environ.get("PLCGEN_DAMAGES") else 4
CHOSEN = [*ROWS][::SAMPLE]


def test_the_corpus_has_every_kind_of_file() -> None:
    """At least 390 rows, for each target and both protocols, and at least three for each kind of file."""
    kinds = Counter(
        name if "/" not in name else f"{name[: name.index('/')]}" for rows in ROWS.values() for name, *_ in rows
    )
    wanted = {"IMPORT.md", "LAYOUT.md", "manifest.json", "scl", "db", "udt", "watch", "xml", "symbols.sdf", "tags.csv"}
    assert len(ROWS) >= 390
    assert {kind for kind, count in kinds.items() if count >= 3} >= wanted
    assert sum(len(rows) > 1 for rows in ROWS.values()) >= 25


@pytest.fixture(scope="module")
def copies(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Where copies of the examples lie."""
    return tmp_path_factory.mktemp("delivered")


def copied(copies: Path, example: str) -> Path:
    """A copy of an example, in which nothing is wrong."""
    if not (copies / example).is_dir():
        shutil.copytree(generated_example(example), copies / example)
        assert findings(example, copies / example) == []
    return copies / example


@pytest.mark.parametrize(("example", "what"), CHOSEN, ids=[" ".join(row) for row in CHOSEN])
def test_damage_is_noticed(example: str, what: str, copies: Path) -> None:
    """By what is written in the files, with the hashes right, before anything is run."""
    folder = copied(copies, example)
    with damaged(folder, ROWS[example, what], "cp1252" if example == "s7-300_mm440_dp" else "utf-8"):
        assert findings(example, folder)


ODD = """
plc: {name: "A|B <b> & C_d *e* `f`", family: %s, toolchain: %s, languages: [%s]}
drives:
  pump: {device: sinamics-g120, %s, comment: {en-US: "a <i> & b"}}
jobs:
  set_ramps:
    drive: pump
    write:
      P1120: {value: 5.0, comment: {en-US: "up | <b>fast</b> & 16#80nn 5 s", de-DE: "hoch | <b>schnell</b> 7 s"}}
      P1121: null
    comment: {en-US: "Set *both* <ramp> | times; P1120 'x' // (* y *) 5%%", de-DE: "Setze 3 {Rampen}"}
    trigger: {execute: M10.0, status: '"Plant".startRamps[1].x'}
  stop_it: {drive: pump, write: {P1121: 3.0}, on_error: restore, verify: readback}
"""


@pytest.mark.parametrize("languages", ["en-US, de-DE", "de-DE, en-US", "zh-CN, de-DE", "fr-FR"])
@pytest.mark.parametrize(
    ("family", "toolchain", "address"),
    [("s7-1500", "tia-v19", "hardware_id: 'pump~Drive_1'"), ("s7-300", "step7-v5", "address: 256")],
)
def test_texts_of_the_spec_are_no_damage(
    family: str, toolchain: str, address: str, languages: str, tmp_path: Path
) -> None:
    """Marks, numbers of their own in each language, names of a program: all may be said."""
    spec = tmp_path / "job.yaml"
    spec.write_text(ODD % (family, toolchain, languages, address), "utf-8")
    assert api.generate(spec, tmp_path / "out").ok
    project = open_spec(spec).sound()
    checks = delivered(project, read_folder(tmp_path / "out", project.target))
    assert [check.verdict for check in checks if check.outcome is Outcome.ERROR] == []
