"""Engines that were proven with a release: hashes and what was run, in ``proven.json`` beside this file."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import TypedDict

FILE = Path(__file__).with_name("proven.json")
"""Written by ``python -m plcgen.protocols.ds47.proof.engine``."""


class Proven(TypedDict):
    """What is known about an engine: its target, sizes of its arrays, the release, what was run."""

    target: str
    bytes: int
    parameters: int
    slots: int
    channels: int
    release: str
    scenarios: int
    runs: int
    effort: str


def proven() -> Mapping[str, Proven]:
    """Proven engines by their hashes."""
    return json.loads(FILE.read_text(encoding="ascii")) if FILE.is_file() else {}


def write_proven(found: Mapping[str, Proven]) -> None:
    """Write the file anew."""
    FILE.write_text(json.dumps(dict(sorted(found.items())), indent=1) + "\n", encoding="ascii")
