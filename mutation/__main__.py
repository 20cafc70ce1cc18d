"""Damage the generated SCL and count what verify notices: ``python -m mutation [SPEC..] [--deletions]``."""

from __future__ import annotations

import argparse
import multiprocessing
import os
import sys
import time
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor

from mutation.cases import KINDS, PPI, ROOT, Case, cases, known_cases, project_of
from mutation.equivalent import reason
from mutation.known import FAQ, KNOWN, MM4
from mutation.run import Verdict, notice
from plcgen.protocols.ds47.plan.nouns import DrivePlan

GOAL = 98.0


def say(line: str) -> None:
    """One line of the report."""
    sys.stdout.write(f"{line}\n")
    sys.stdout.flush()


def verdicts_of(work: Sequence[Case]) -> list[Verdict]:
    """Run every case, on every core."""
    found = []
    with ProcessPoolExecutor(os.cpu_count(), multiprocessing.get_context("fork")) as pool:
        for number, verdict in enumerate(pool.map(notice, work, chunksize=4), 1):
            found.append(verdict)
            if sys.stderr.isatty():
                sys.stderr.write(f"\r{number}/{len(work)} " if number < len(work) else "\r\033[K")
    return found


def options() -> argparse.Namespace:
    """What to damage."""
    parser = argparse.ArgumentParser(prog="mutation")
    parser.add_argument(
        "specs", nargs="*", help="names of specs (default: the two S7-300 examples and the PPI masters)"
    )
    parser.add_argument(
        "--deletions",
        action="store_true",
        help="delete every statement of every block, of every spec with drive jobs and the PPI masters",
    )
    parser.add_argument("--kind", choices=tuple(KINDS), action="append", help="this kind of damage only; repeatable")
    parser.add_argument("--every", type=int, default=1, help="take every n-th mutant only")
    parser.add_argument("--file", default="", help="only files with this in their name")
    parser.add_argument("--text", default="", help="only mutants with this in their description")
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
    specs = given.specs or with_drives or [FAQ, MM4, *PPI]
    kinds = ("dropped",) if given.deletions else given.kind or tuple(KINDS)
    found = cases(specs, kinds, main=given.deletions)
    return [c for c in found if given.file in c.file and given.text in c.mutant.what][:: given.every]


def deletions(work: Sequence[Case], found: Sequence[Verdict]) -> int:
    """Print every deletion that was not noticed or not located; 1 if there is one."""
    noticed = sum(bool(verdict.text) for verdict in found)
    located = sum(verdict.located for verdict in found)
    for case, verdict in zip(work, found, strict=True):
        if not verdict.located:
            say(f"{case.spec}/{case.file}:{case.mutant.line}: {case.mutant.what}: {verdict.text or 'NOT NOTICED'}")
    say(f"{len(work)} deletions, {noticed} noticed, {located} of them with scenario, scan and line of the source")
    return 0 if located == len(work) else 1


def share(work: Sequence[Case], found: Sequence[Verdict]) -> float:
    """Print every survivor; the share of noticed ones among those that change something, in percent."""
    noticed = equivalent = 0
    for case, verdict in zip(work, found, strict=True):
        why = "" if verdict.text else reason(case.mutant)
        noticed += bool(verdict.text)
        equivalent += bool(why)
        if not verdict.text:
            say(f"{case.spec}/{case.file}:{case.mutant.line}: {case.mutant.what}: {why or 'NOT NOTICED'}")
    result = 100.0 * noticed / max(1, len(work) - equivalent)
    say(f"{len(work)} mutants, {noticed} noticed, {equivalent} change nothing that can be seen: {result:.2f} %")
    return result


def main() -> int:
    """Print the figures and every survivor; 1 if the goal is missed."""
    given = options()
    started = time.monotonic()
    known = [] if given.deletions else list(known_cases())
    work = [*known, *chosen(given)]
    found = verdicts_of(work)
    if given.verbose:
        for case, verdict in zip(work, found, strict=True):
            say(f"{case.file}:{case.mutant.line}: {case.mutant.what} -> {verdict.text or '-'}")
    if given.deletions:
        code = deletions(work, found)
    else:
        all_known = all(verdict.text for verdict in found[: len(KNOWN)])
        code = 0 if share(work, found) >= GOAL and all_known else 1
        say(f"all {len(KNOWN)} known faults noticed: {all_known}")
    say(f"{time.monotonic() - started:.0f} s")
    return code


if __name__ == "__main__":
    sys.exit(main())
