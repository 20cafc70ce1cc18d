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
from projects import generated_example
from proof.damaging import Edit, damaged, findings

ROWS: dict[tuple[str, str], list[Edit]] = {}
for example, table in tomllib.loads((Path(__file__).parent / "damages.toml").read_text("utf-8")).items():
    for what, *rest in table["rows"]:
        assert (example, what) not in ROWS, what
        ROWS[example, what] = [(rest[at], rest[at + 1], rest[at + 2]) for at in range(0, len(rest), 3)]
SAMPLE = 1 if os.environ.get("PLCGEN_DAMAGES") else 4
CHOSEN = [*ROWS][::SAMPLE]


def test_the_corpus_has_every_kind_of_file() -> None:
    """At least 300 rows, for each target and both protocols, and at least three for each kind of file."""
    kinds = Counter(
        name if "/" not in name else f"{name[: name.index('/')]}" for rows in ROWS.values() for name, *_ in rows
    )
    wanted = {"IMPORT.md", "LAYOUT.md", "manifest.json", "scl", "db", "udt", "watch", "xml", "symbols.sdf", "tags.csv"}
    assert len(ROWS) >= 300
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
