"""VERSION of the engine's blocks: another text has another number, which a comparison in the TIA Portal shows."""

from __future__ import annotations

import hashlib
import re
import tomllib
from pathlib import Path

import pytest

from plcgen.s7.read.generated import generated_sources
from tests.engine import folders
from tests.engine.__main__ import dialect_of
from tests.engine.sources import BLOCKS, DriveEngine

HISTORY = Path(__file__).with_name("versions.toml")
_VERSION = re.compile(r"VERSION : '?([0-9.]+)'?")


@pytest.fixture(scope="module")
def engines(tmp_path_factory: pytest.TempPathFactory) -> list[DriveEngine]:
    """The smallest engine of each target."""
    root = tmp_path_factory.mktemp("engines")
    found = [folder for _, size, folder in folders.folders(root) if size == "S"]
    return [DriveEngine.of(generated_sources(folder), dialect_of(folder)) for folder in found]


def block(engine: DriveEngine, role: str) -> tuple[str, str]:
    """Version and tokens of a block; its version does not count among them."""
    (unit,) = (" ".join(unit) for unit in engine.units if unit[0] == "FUNCTION_BLOCK" and unit[1] == f"<{role}>")
    (version,) = _VERSION.findall(unit)
    return version, _VERSION.sub("", unit)


@pytest.mark.slow
@pytest.mark.parametrize("role", BLOCKS)
def test_another_text_has_another_version(engines: list[DriveEngine], role: str) -> None:
    """Whoever changes a block raises VERSION in its template, and adds the new version with its hash to the file."""
    blocks = [block(engine, role) for engine in engines]
    known = tomllib.loads(HISTORY.read_text("utf-8"))[role]
    numbers = [tuple(map(int, version.split("."))) for version in known]
    assert numbers == sorted(set(numbers))
    assert len(set(known.values())) == len(known)
    digest = hashlib.sha256("\n".join(sorted(text for _, text in blocks)).encode()).hexdigest()[:12]
    assert {version for version, _ in blocks} == {list(known)[-1]}
    assert known[list(known)[-1]] == digest, f"raise VERSION of the {role}, and add it with {digest} to {HISTORY.name}"
