"""A plant of 20 drives with 3 jobs each, and plants of many jobs: size, idle scan, and what verify takes.

``python -m tests.bench.plants`` prints the table of ``make bench``; each verify is a process, nothing is warm.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

from tests.bench.specs import PLCS, plant, shapes
from tests.bench.work_memory import RECORDS

GOAL_PLANT, GOAL_MANY = 30, 120
"""CPU seconds of verify, the engine not included: of a plant, of many shapes."""


def verify_seconds(text: str) -> tuple[float, dict[str, int]]:
    """CPU seconds of ``plcgen verify`` on what a spec generates, its workers included, and the size of that."""
    from plcgen import api

    with tempfile.TemporaryDirectory() as folder:
        spec = Path(folder) / "plant.yaml"
        spec.write_text(text, encoding="utf-8")
        result = api.generate(spec, stats=True)
        size = result.size()
        assert size is not None
        before = os.times()
        done = subprocess.run([sys.executable, "-m", "plcgen", "verify", str(spec), "--quiet"], check=False)
        after = os.times()
        if done.returncode:
            raise SystemExit("the plant is not verified")
        spent = after.children_user - before.children_user + after.children_system - before.children_system
        return spent, size.data()


def main() -> None:
    """Print the old plant, those of now, and what many jobs cost."""
    old = json.loads(RECORDS.read_text())[0]
    print("20 drives x 3 jobs: lines of FBs, blocks, work memory (docs/memory.md), statements of an idle scan, verify")
    row = old["sizes"]
    figures = f"{row['fb_lines']:>6} lines {row['fbs']:>3} FBs {row['dbs']:>4} DBs {row['total_bytes']:>7} bytes"
    print(f"  {'S7-300 V5, ' + old['what']:<42} {figures}")
    for plc in PLCS:
        _print(plc, *verify_seconds(plant(plc=plc)), GOAL_PLANT)
    print("many jobs")
    for name, text in (("10 shapes x 20 drives", shapes(10, 20)), ("200 different shapes", shapes(200, 1))):
        _print(name, *verify_seconds(text), GOAL_MANY)


def _print(name: str, seconds: float, size: dict[str, int], goal: int) -> None:
    figures = f"{size['lines']:>6} lines {size['fbs']:>3} FBs {size['dbs']:>4} DBs {size['total']:>7} bytes"
    idle = f"{size['idle_statements']:>6} statements"
    print(f"  {name:<42} {figures} {idle}   verify {seconds:5.1f} s of CPU, goal < {goal}", flush=True)


if __name__ == "__main__":
    main()
