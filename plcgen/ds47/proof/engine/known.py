"""Engines that were proven: their hashes, that of the prover, and what was run; in ``proven.json`` beside this file."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import TypedDict

FILE = Path(__file__).with_name("proven.json")
"""Written by ``python -m plcgen.ds47.proof.engine``."""


PROVER = ("ds47/proof", "ds47/sim", "ds47/wire", "proof", "s7")
"""The folders of plcgen that take part in the proof of an engine: soft CPU, front end, simulated drive, scenarios."""


class Proven(TypedDict):
    """What is known about an engine: its target, sizes of its arrays, release and hash of the prover, what was run."""

    target: str
    bytes: int
    parameters: int
    slots: int
    channels: int
    release: str
    prover: str
    scenarios: int
    runs: int
    effort: str


def proven() -> Mapping[str, Proven]:
    """Proven engines by their hashes."""
    return json.loads(FILE.read_text(encoding="ascii")) if FILE.is_file() else {}


@cache
def prover_hash(package: Path = FILE.parents[3]) -> str:
    """SHA-256 over names and code of all that proves an engine; line ends of a Windows checkout do not count."""
    digest = hashlib.sha256()
    for folder in PROVER:
        for path in sorted((package / folder).rglob("*")):
            if path.suffix in {".py", ".scl"} and "__pycache__" not in path.parts:
                data = path.read_bytes().replace(b"\r\n", b"\n")
                digest.update(f"{path.relative_to(package).as_posix()} {len(data)}\n".encode() + data)
    return digest.hexdigest()


def write_proven(found: Mapping[str, Proven]) -> None:
    """Write the file anew."""
    FILE.write_text(json.dumps(dict(sorted(found.items())), indent=1) + "\n", encoding="ascii")
