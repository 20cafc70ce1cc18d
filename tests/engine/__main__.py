"""Prove the engines of generated folders and record them: ``python -m tests.engine FOLDER...``.

Every folder is one that ``plcgen generate`` wrote. ``--thorough`` runs an interrupt at every point of every scan, and
loads every set of data blocks behind every scan. The file of proven engines is written anew: it holds the engines of
these folders and no other. Of those that differ in their sizes only the first is run through everything, 70,000 jobs in
a row included. If one fails, the exit code is 1 and nothing is written.
"""

from __future__ import annotations

import argparse
import json
import sys
from pathlib import Path

from plcgen._version import __version__
from plcgen.ds47.proof.engine import SHORT, Proven, prover_hash
from plcgen.proof.checks import Check
from plcgen.proof.sharing import Sharing
from plcgen.s7.read.generated import MANIFEST, generated_sources
from plcgen.s7.scl.dialect import Dialect
from tests.engine.checks import Effort, prove
from tests.engine.sources import DriveEngine, write_proven


def dialect_of(folder: Path) -> Dialect:
    """Target of a generated folder, by its manifest."""
    manifest = json.loads((folder / MANIFEST).read_text(encoding="utf-8"))
    if manifest["toolchain"].startswith("step7"):
        return Dialect.STEP7_V5
    return Dialect.TIA_300_400 if manifest["family"] in {"s7-300", "s7-400"} else Dialect.TIA_1200_1500


def _shown(check: Check) -> str:
    """One line of a check."""
    return f"  {check.outcome.value:8} {check.subject}: {check.text} {check.verdict}"


def main(arguments: list[str] | None = None) -> int:
    """Exit code."""
    parser = argparse.ArgumentParser(prog="tests.engine", description=__doc__)
    parser.add_argument("folders", nargs="+", type=Path)
    parser.add_argument("--thorough", action="store_true")
    parser.add_argument("--workers", type=int, default=None)
    options = parser.parse_args(arguments)
    found: dict[str, Proven] = {}
    whole: list[DriveEngine] = []
    good = True
    for folder in options.folders:
        dialect = dialect_of(folder)
        engine = DriveEngine.of(generated_sources(folder), dialect)
        if engine.hash in found:
            continue
        effort: Effort = "thorough" if options.thorough else "recorded"
        if any(engine.differs_in_sizes_only(other) for other in whole):
            effort = "sizes"
        else:
            whole.append(engine)
        proof = prove(engine, effort, Sharing(workers=options.workers))
        sizes = engine.sizes
        print(f"{folder}: {dialect.label}, {sizes.last + 1} bytes, {sizes.slots} slots, engine {engine.hash[:SHORT]}")  # noqa: T201
        for check in proof.checks:
            print(_shown(check), flush=True)  # noqa: T201
        good = good and proof.ok
        found[engine.hash] = Proven(
            target=dialect.value,
            bytes=sizes.last + 1,
            parameters=sizes.blocks,
            slots=sizes.slots,
            channels=sizes.channels,
            release=__version__,
            prover=prover_hash(),
            scenarios=proof.scenarios,
            runs=proof.runs,
            effort=effort,
        )
    if good:
        write_proven(found)
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main())
