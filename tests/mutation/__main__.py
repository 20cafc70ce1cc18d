"""Damage the generated SCL and count what verify notices: ``python -m tests.mutation [SPEC..] [--deletions]``."""

from __future__ import annotations

import argparse
import multiprocessing
import os
import sys
import time
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass

from plcgen.ds47.plan.nouns import DrivePlan
from tests.mutation.cases import KINDS, PPI, ROOT, Case, cases, known_cases, project_of, spread
from tests.mutation.engine import ENGINE
from tests.mutation.equivalent import reason
from tests.mutation.known import FAQ, KNOWN, MM4, PUMP
from tests.mutation.run import Verdict, notice

GOAL = 99.0
"""Percent of mutants that must be noticed, of every line of the table."""


def say(line: str) -> None:
    """One line of the report."""
    sys.stdout.write(f"{line}\n")
    sys.stdout.flush()


def verdicts_of(work: Sequence[Case], workers: int | None, told: Callable[[Case, Verdict], None]) -> list[Verdict]:
    """Run every case and tell of each at once; ``workers`` None takes every core."""
    found = []
    with ProcessPoolExecutor(workers or os.cpu_count(), multiprocessing.get_context("fork")) as pool:
        verdicts = zip(work, pool.map(notice, work, chunksize=4), strict=True)
        for number, (case, verdict) in enumerate(verdicts, 1):
            found.append(verdict)
            told(case, verdict)
            if sys.stderr.isatty():
                sys.stderr.write(f"\r{number}/{len(work)} " if number < len(work) else "\r\033[K")
    return found


def options() -> argparse.Namespace:
    """What to damage."""
    parser = argparse.ArgumentParser(prog="tests.mutation")
    parser.add_argument(
        "specs", nargs="*", help="names of specs (default: an example of each target with drives, and the PPI masters)"
    )
    parser.add_argument(
        "--deletions",
        action="store_true",
        help="delete every statement of every block, of every spec with drive jobs and the PPI masters",
    )
    parser.add_argument("--kind", choices=tuple(KINDS), action="append", help="this kind of damage only; repeatable")
    parser.add_argument("--every", type=int, default=1, help="take every n-th mutant only")
    parser.add_argument("--part", choices=("engine", "jobs"), help="the blocks that all projects share, or all others")
    parser.add_argument("--file", default="", help="only files with this in their name")
    parser.add_argument("--text", default="", help="only mutants with this in their description")
    parser.add_argument("--argued", action="store_true", help="run those too that have a reason why nobody can notice")
    parser.add_argument("--workers", type=int, help="processes (default: one for each core)")
    parser.add_argument("--verbose", action="store_true", help="say how each was noticed")
    return parser.parse_args()


def chosen(given: argparse.Namespace) -> list[Case]:
    """The mutants of this run, without the known faults."""
    every = sorted(path.stem for path in (ROOT / "specs").glob("*.yaml"))
    with_drives = (
        [*(name for name in every if project_of(name).plan(DrivePlan)), *PPI]
        if given.deletions and not given.specs
        else []
    )
    specs = given.specs or with_drives or [FAQ, MM4, PUMP, *PPI]
    kinds = ("dropped",) if given.deletions else given.kind or tuple(KINDS)
    found = list(cases(specs, kinds, main=given.deletions))
    found = found if given.deletions else spread(found)
    parts = {"engine": {True}, "jobs": {False}}.get(given.part, {True, False})
    found = [c for c in found if (c.key == ENGINE) in parts and given.file in c.file and given.text in c.mutant.what]
    return found[:: given.every]


@dataclass(slots=True)
class Count:
    """Line of the table."""

    all: int = 0
    noticed: int = 0
    argued: int = 0
    located: int = 0

    @property
    def share(self) -> float:
        """Noticed ones among those that change something, in percent."""
        return 100.0 * self.noticed / max(1, self.all - self.argued)


def counted(work: Sequence[Case], found: Mapping[Case, Verdict]) -> dict[str, Count]:
    """The table, its sum at the end."""
    table: dict[str, Count] = {}
    for case in work:
        verdict = found.get(case, Verdict())
        for group in (case.group, "all"):
            count = table.setdefault(group, Count())
            count.all += 1
            count.noticed += bool(verdict.text)
            count.located += verdict.located
            count.argued += not verdict.text and bool(reason(case))
    table["all"] = table.pop("all", Count())
    return table


def show(table: Mapping[str, Count], name: str, *, located: bool) -> None:
    """Print the table."""
    say(f"{'':32}{name:>10}{'noticed':>10}{'argued':>10}{'open':>10}" + ("   located" if located else ""))
    for group, count in table.items():
        rest = count.all - count.noticed - count.argued
        line = f"{group:32}{count.all:10}{count.noticed:10}{count.argued:10}{rest:10}"
        say(line + (f"{count.located:10}" if located else f"   {count.share:.1f} %"))


def main() -> int:
    """Print what nobody noticed and the table; 1 if it is too much: one deletion, or more than 1 % of the mutants."""
    given = options()
    started = time.monotonic()
    known = [] if given.deletions else list(known_cases())
    work = chosen(given)
    run = [*known, *(case for case in work if given.argued or not reason(case))]
    tried = set(run)

    def told(case: Case, verdict: Verdict) -> None:
        text = verdict.text or reason(case) or "NOT NOTICED"
        if given.verbose or text == "NOT NOTICED" or (given.deletions and case in tried and not verdict.located):
            say(f"{case.spec}/{case.file}:{case.mutant.line}: {case.mutant.what}: {text}")

    found = dict(zip(run, verdicts_of(run, given.workers, told), strict=True))
    for case in work:
        if case not in tried:
            told(case, Verdict())
    table = counted(work, found)
    show(table, "deletions" if given.deletions else "mutants", located=given.deletions)
    count, good = table["all"], all(found[case].text for case in known)
    if known:
        say(f"all {len(KNOWN)} known faults noticed: {good}")
    minutes, cpu = (time.monotonic() - started) / 60, sum(verdict.seconds for verdict in found.values()) / 60
    say(f"{minutes:.0f} min, {cpu:.0f} min of CPU time")
    if given.deletions:
        return 0 if count.noticed + count.argued == count.all and count.located == count.noticed else 1
    return 0 if good and all(line.share >= GOAL for line in table.values()) else 1


if __name__ == "__main__":
    sys.exit(main())
