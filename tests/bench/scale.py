"""Plants of 100, 1,000 and 10,000 jobs through check, generate and verify: time and memory of whole processes.

``python -m tests.bench.scale [JOBS ..] [--verify]`` prints the table of ``make bench``. 10,000 jobs are verified if
``--verify`` asks for it: about 20 min of CPU time.
"""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from pathlib import Path

from tests.bench.specs import grid

SIZES = {100: (10, 10), 1_000: (100, 10), 10_000: (100, 100)}
"""Jobs: shapes, and drives of each."""
GOAL = 400
"""MB of memory that check and generate of 10,000 jobs may take."""
VERIFIED = 1_000
"""So many jobs are verified in any case."""


def spent(arguments: list[str], environment: dict[str, str]) -> tuple[float, float]:
    """CPU seconds and peak MB (10**6 bytes) of a call of plcgen, of its largest process."""
    process = subprocess.Popen(
        [sys.executable, "-m", "plcgen", *arguments],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        env=environment,
    )
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode:
        raise SystemExit(f"{' '.join(arguments)}: exit code {process.returncode}")
    return usage.ru_utime + usage.ru_stime, usage.ru_maxrss * 1024 / 1e6


def main(chosen: tuple[int, ...] = tuple(SIZES), *, verify: bool = False) -> None:
    """Print the table."""
    print("plants of many jobs: CPU time, peak memory of the largest process")
    for jobs in chosen:
        with tempfile.TemporaryDirectory() as folder:
            spec = Path(folder) / "plant.yaml"
            spec.write_text(grid(*SIZES[jobs]), encoding="utf-8")
            environment = {**os.environ, "PLCGEN_CACHE": str(Path(folder) / "cache")}
            row = [f"  {jobs:>6} jobs"]
            verbs = ["check", "generate", *(["verify", "verify"] if verify or jobs <= VERIFIED else [])]
            for number, verb in enumerate(verbs):
                seconds, memory = spent([verb, str(spec), "--quiet"], environment)
                name = "again" if number == len(verbs) - 1 and verb == "verify" else verb
                row.append(f"{name} {seconds:7.1f} s {memory:5.0f} MB")
            print("   ".join(row), f"  goal < {GOAL} MB" if jobs == max(SIZES) else "", flush=True)


if __name__ == "__main__":
    sizes = tuple(int(text) for text in sys.argv[1:] if text != "--verify")
    main(sizes or tuple(SIZES), verify="--verify" in sys.argv)
