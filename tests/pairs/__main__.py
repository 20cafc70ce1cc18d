"""All of them: ``python -m tests.pairs``; ``--part 2/4`` for a share, ``--effort quick`` for all faults."""

from __future__ import annotations

import argparse
import os
import sys
import tempfile
import time
from pathlib import Path

from tests.pairs import drives, ppi
from tests.pairs.cover import cover
from tests.pairs.refusals import DRIVES, possible
from tests.pairs.trial import WrongError, tried


def main() -> int:
    """Try every row; the exit code is 0 if each that is not refused works, and none is refused for another reason."""
    parser = argparse.ArgumentParser(prog="tests.pairs")
    parser.add_argument("--part", default="1/1", help="every n-th row")
    parser.add_argument("--effort", default="none", choices=("none", "quick"))
    given = parser.parse_args()
    os.environ["PLCGEN_CACHE"] = "off"
    number, of = map(int, given.part.split("/"))
    rows = cover(drives.DIMENSIONS, possible(DRIVES), drives.TRIPLES)
    specs = [(row, drives.spec(row)) for row in rows]
    specs += [(row, ppi.spec(row)) for row in cover(ppi.DIMENSIONS, possible(ppi.REFUSALS))]
    wrong, begun = 0, time.process_time()
    with tempfile.TemporaryDirectory() as folder:
        for row, spec in specs[number - 1 :: of]:
            try:
                codes = tried(spec, Path(folder), given.effort)
                said = f"refused with {', '.join(sorted(codes))}" if codes else ""
            except WrongError as problem:
                said = str(problem)
            if said:
                wrong += 1
                sys.stdout.write(f"{said}\n  {row}\n")
                sys.stdout.flush()
    count = len(specs[number - 1 :: of])
    sys.stdout.write(f"{count} specs, {wrong} wrong, {time.process_time() - begun:.0f} s of CPU time\n")
    return int(wrong > 0)


if __name__ == "__main__":
    sys.exit(main())
