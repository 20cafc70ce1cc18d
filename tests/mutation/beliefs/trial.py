"""Generate and verify a spec with the plcgen of a folder: ``python trial.py SPEC OUT LEVEL..`` prints how that ended.

It runs on its own in the folder of a damaged copy, so it imports nothing but that copy. The cheap parts come first:
most breaks show before anything is executed.
"""

from __future__ import annotations

import json
import os
import sys
from pathlib import Path

REFUSED, NOTICED, GREEN = "refused", "noticed", "green"


def trial(spec: str, out: str, *levels: str) -> tuple[str, str, str]:
    """How it ended, the first thing that was said, and when; ``levels`` are how much runs, one after the other."""
    from plcgen import api

    made = api.generate(spec, out)
    if not made.ok:
        return REFUSED, _first(made.diagnostics), ""
    for level in levels:
        found = api.verify(spec, out, faults=level)
        if not found.ok:
            return NOTICED, _first(found.problems), level
    return GREEN, "", ""


def _first(problems: object) -> str:
    errors = (f"{each.code} {each.message}" for each in problems if each.severity.label == "error")  # type: ignore[attr-defined]
    return next(errors, "an error")


if __name__ == "__main__":
    sys.path.insert(0, str(Path.cwd()))
    os.cpu_count = lambda: 1  # one process for each break: the runner of the breaks uses the cores
    sys.stdout.write(json.dumps(trial(*sys.argv[1:])) + "\n")
