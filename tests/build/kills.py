"""Kill a writer at random moments, again and again: what lies in the folder afterwards?

``python tests/build/kills.py FOLDER COUNT`` prints how many kills fell before, inside and behind the change, and
ends with 1 if a folder was ever anything but exactly old or exactly new after the next run.
"""

from __future__ import annotations

import json
import os
import random
import signal
import sys
import time
from pathlib import Path

from plcgen.build.environment import RenderedFile
from plcgen.build.manifest import digest
from plcgen.build.staging import recover
from plcgen.build.writing import compare_folder, write_folder
from plcgen.s7.read.generated import JOURNAL


def state(number: int) -> list[RenderedFile]:
    """Thirty files: some only in even states, some only in odd ones, the rest with other bytes."""
    names = [f"scl/{i}" for i in range(20)] + [f"udt/{number % 2}_{i}" for i in range(10)]
    files = [RenderedFile(name, f"{name} {number}\n".encode() * 200) for name in names]
    entries = [{"path": file.path, "sha256": digest(file.data)} for file in files]
    return [*files, RenderedFile("manifest.json", json.dumps({"files": entries}).encode())]


def tree(folder: Path) -> dict[str, bytes]:
    return {p.relative_to(folder).as_posix(): p.read_bytes() for p in folder.rglob("*") if p.is_file()}


def killed(folder: Path, number: int, delay: float) -> None:
    """Let a child write a state and kill it after ``delay`` seconds."""
    child = os.fork()
    if not child:
        write_folder(state(number), folder)
        os._exit(0)
    time.sleep(delay)
    os.kill(child, signal.SIGKILL)
    os.waitpid(child, 0)


def main(folder: Path, count: int) -> int:
    chance = random.Random(6)  # no secret
    write_folder(state(0), folder)
    begin = time.perf_counter()
    write_folder(state(1), folder)
    usual = time.perf_counter() - begin
    current = 1
    found = {"old": 0, "half-way, reported by --check": 0, "new": 0}
    for _ in range(count):
        wanted = current + 1
        killed(folder, wanted, chance.uniform(0, 4 * usual))
        half_way = (folder / JOURNAL).exists()
        reported = all(compare_folder(state(number), folder)[1] for number in (current, wanted))
        recover(folder)
        states = [number for number in (current, wanted) if tree(folder) == {f.path: f.data for f in state(number)}]
        if len(states) != 1 or (half_way and not reported):
            print("lost", sorted(tree(folder)))  # noqa: T201
            return 1
        found["half-way, reported by --check" if half_way else "new" if states == [wanted] else "old"] += 1
        current = states[0]
    print(json.dumps(found))  # noqa: T201
    return 0


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1]), int(sys.argv[2])))
