"""Runs breaks: each in a copy of the source with one fact changed, in a process of its own."""

from __future__ import annotations

import compileall
import contextlib
import json
import os
import resource
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from queue import SimpleQueue

from tests.mutation.beliefs.tables import ROOT, Break
from tests.mutation.beliefs.trial import GREEN, REFUSED

PARTS = ("plcgen", "specs", "templates")
TRIAL = Path(__file__).with_name("trial.py")
LONGEST = 600
"""Seconds after which a trial counts as noticed: it does not end."""


@dataclass(frozen=True, slots=True)
class Outcome:
    """How the trial of a break ended, and what was said first."""

    how: str
    said: str
    level: str = ""
    """How much ran when it was noticed."""

    @property
    def noticed(self) -> bool:
        """Whether anybody would know that something is wrong."""
        return self.how != GREEN


class Copy:
    """A copy of everything that generates and verifies."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        for part in PARTS:
            shutil.copytree(ROOT / part, folder / part)
        compileall.compile_dir(folder / "plcgen", quiet=1)

    def try_break(self, one: Break) -> Outcome:
        """Change the fact, try its specs until one is red, change it back."""
        path = self.folder / one.file
        before = path.read_text("utf-8")
        kept = path.with_name(f"{path.name}.kept")
        path.rename(kept)
        try:
            path.write_text(one.broken(before), "utf-8", newline="")
            ended = (self.try_spec(text, "none", "quick") for text in one.specs)
            return next((found for found in ended if found.noticed), Outcome(GREEN, ""))
        finally:
            kept.replace(path)

    def try_spec(self, text: str, *levels: str) -> Outcome:
        """Generate and verify a spec with this copy as it is, at one level of faults after the other."""
        with tempfile.TemporaryDirectory(dir=self.folder) as name:
            spec = Path(name) / "spec.yaml"
            spec.write_text(text, "utf-8")
            command = [sys.executable, str(TRIAL), str(spec), str(Path(name) / "out"), *levels]
            clean = {key: value for key, value in os.environ.items() if not key.startswith("PYTHON")}
            try:
                done = subprocess.run(
                    command,
                    cwd=self.folder,
                    env={**clean, "PYTHONDONTWRITEBYTECODE": "1"},
                    capture_output=True,
                    text=True,
                    timeout=LONGEST,
                    check=False,
                )
            except subprocess.TimeoutExpired:
                return Outcome(REFUSED, f"does not end within {LONGEST} s")
            if done.returncode:
                return Outcome(REFUSED, done.stderr.strip().rpartition("\n")[2])
            return Outcome(*json.loads(done.stdout.splitlines()[-1]))


@contextlib.contextmanager
def copies(count: int) -> Iterator[SimpleQueue[Copy]]:
    """Some copies, for as many threads."""
    queue: SimpleQueue[Copy] = SimpleQueue()
    with tempfile.TemporaryDirectory(prefix="plcgen-beliefs-") as name:
        for number in range(count):
            queue.put(Copy(Path(name) / str(number)))
        yield queue


def tried(
    work: Sequence[Break], workers: int, told: Callable[[Break, Outcome], None] = lambda _one, _found: None
) -> dict[Break, Outcome]:
    """How every break ended.

    Raises:
        ValueError: a spec is red without any break, so that it would notice everything.
    """
    with copies(workers) as free, ThreadPoolExecutor(workers) as pool:

        def borrowed(what: Callable[[Copy], Outcome]) -> Outcome:
            copy = free.get()
            try:
                return what(copy)
            finally:
                free.put(copy)

        def green(level: str, texts: Iterable[str]) -> None:
            plain = pool.map(lambda text: borrowed(lambda copy: copy.try_spec(text, level)), texts)
            for text, found in zip(texts, plain, strict=True):
                if found.noticed:
                    raise ValueError(f"red without a break: {found.said}\n{text}")

        green("none", dict.fromkeys(text for one in work for text in one.specs))
        outcomes = pool.map(lambda one: borrowed(lambda copy: copy.try_break(one)), work)
        result = {}
        for one, found in zip(work, outcomes, strict=True):
            told(one, found)
            result[one] = found
        # what only faults have shown counts if they show nothing without a break
        shown = (one for one, found in result.items() if found.level == "quick")
        green("quick", dict.fromkeys(text for one in shown for text in one.specs))
        return result


def seconds() -> tuple[float, float]:
    """Time on the clock, and CPU time of this process and those that it has started."""
    used = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return time.monotonic(), sum(each.ru_utime + each.ru_stime for each in used)
