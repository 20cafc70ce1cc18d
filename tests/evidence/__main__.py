"""Measure a folder of exports and sources: ``python -m tests.evidence SOURCE_FOLDER [--save]``.

A part is a module of this package with ``report(folder, save) -> lines``; ``save`` writes what it keeps.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path

PARTS = ("simaticml", "scl", "help", "effects", "lists", "parameters")


def main(arguments: Sequence[str] | None = None) -> int:
    """Print the figures of every part that there is."""
    parser = argparse.ArgumentParser(prog="tests.evidence", description="Measure a folder of exports and sources.")
    parser.add_argument("folder", type=Path, help="one folder for each repository or project in it")
    parser.add_argument("--part", choices=PARTS, action="append", help="only this part; repeatable")
    parser.add_argument("--save", action="store_true", help="keep the counts as the reference of the tests")
    given = parser.parse_args(arguments)
    if not given.folder.is_dir():
        parser.error(f"{given.folder} is no folder")
    for name in given.part or PARTS:
        if find_spec(f"tests.evidence.{name}") is not None:
            for line in import_module(f"tests.evidence.{name}").report(given.folder, save=given.save):
                sys.stdout.write(f"{line}\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
