"""VERSION of the engine's blocks is a number: who changes what such a block says has to raise it.

``engine_versions.toml`` has the SHA-256 of each block under its number, without the line with the number. A changed
block has another hash: raise VERSION in its template and in ``plcgen/ds47/proof/wording``, then write both down.
"""

from __future__ import annotations

import hashlib
import re
import tomllib
from pathlib import Path

import pytest

from plcgen import api

KNOWN = tomllib.loads(Path(__file__).with_name("engine_versions.toml").read_text("utf-8"))
BLOCKS = ("DriveChannel", "DriveTicket", "DriveGate")
TARGETS = {
    "tia-v19": "plc: {name: Plant, family: s7-1500, toolchain: tia-v19}\n"
    "drives: {a: {device: sinamics-g120, hardware_id: 270}}\n",
    "step7-v5": "plc: {name: Plant, family: s7-300, toolchain: step7-v5}\n"
    "drives: {a: {device: sinamics-g120, address: 270}}\n",
}


def blocks(target: str, folder: Path) -> dict[str, tuple[str, str]]:
    """Number and hash of each block of the engine as it is generated."""
    spec = folder / "job.yaml"
    spec.write_text(f"{TARGETS[target]}jobs: {{look: {{drive: a, read: [r945]}}}}\n", "utf-8")
    assert api.generate(spec, folder / "out").ok
    text = "".join(file.read_text("utf-8-sig") for file in sorted((folder / "out").glob("*.scl")))
    found = {}
    for name in BLOCKS:
        (body,) = re.findall(rf'^FUNCTION_BLOCK "{name}"$.*?^END_FUNCTION_BLOCK', text, re.DOTALL | re.MULTILINE)
        (version,) = re.findall(r"^VERSION : '?([0-9.]+)'?$", body, re.MULTILINE)
        rest = re.sub(r"^VERSION : .*\n", "", body, flags=re.MULTILINE)
        found[name] = version, hashlib.sha256(rest.encode()).hexdigest()
    return found


@pytest.mark.parametrize("target", TARGETS)
def test_a_changed_block_has_another_version(target: str, tmp_path: Path) -> None:
    """What a block says belongs to its number; a number that is written down for other text is not given again."""
    for name, (version, found) in blocks(target, tmp_path).items():
        said = KNOWN[name].get(version, {}).get(target)
        assert said == found, f"{name} {version}: raise VERSION if it has changed; then write down {found} for it"


def test_numbers_ascend() -> None:
    """A block has had each of its numbers once, the latest last, for every target."""
    for name in BLOCKS:
        numbers = [tuple(map(int, version.split("."))) for version in KNOWN[name]]
        assert numbers == sorted(set(numbers))
        assert all(set(said) == set(TARGETS) for said in KNOWN[name].values())
