"""Break facts of the source one at a time and count what is noticed: ``python -m tests.mutation.beliefs [TABLE..]``."""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Mapping

from tests.mutation.beliefs.run import Outcome, seconds, tried
from tests.mutation.beliefs.tables import Break, breaks, names

GOAL = 95.0
"""Percent of the breaks that must be noticed or refused; each of the others has a reason."""


def say(line: str) -> None:
    """One line of the report."""
    sys.stdout.write(f"{line}\n")
    sys.stdout.flush()


def verdict(one: Break, found: Outcome) -> str:
    """What the report says about one break."""
    if not found.noticed:
        return f"not noticed: {one.reason}" if one.reason else "NOT NOTICED"
    return f"{found.how}: {found.said}" + ("; BUT THE TABLE SAYS WHY NOBODY NOTICES" if one.reason else "")


def failures(found: Mapping[Break, Outcome]) -> list[str]:
    """Why the run is not good: breaks whose outcome is not what the table says, and a share below the goal."""
    wrong = [f"{one.id}: {verdict(one, how)}" for one, how in found.items() if how.noticed == bool(one.reason)]
    share = 100.0 * sum(how.noticed for how in found.values()) / max(1, len(found))
    return [*wrong, f"{share:.1f} % is below {GOAL:.0f} %"] if share < GOAL else wrong


def main() -> int:
    """Print every break that is not noticed and the count; 1 if it is not as the tables say, or too few."""
    parser = argparse.ArgumentParser(prog="tests.mutation.beliefs")
    parser.add_argument("tables", nargs="*", metavar="TABLE", help=f"tables (default: all of {', '.join(names())})")
    parser.add_argument("--id", default="", help="only breaks with this in their id")
    parser.add_argument("--sample", action="store_true", help="only those that the tests run")
    parser.add_argument(
        "--workers", type=int, default=os.cpu_count() or 1, help="processes (default: one for each core)"
    )
    parser.add_argument("--verbose", action="store_true", help="say how each was noticed")
    given = parser.parse_args()
    started, used = seconds()
    work = [one for one in breaks(given.tables or names()) if given.id in one.id and (one.sample or not given.sample)]

    def told(one: Break, found: Outcome) -> None:
        if given.verbose or not found.noticed or one.reason:
            say(f"{one.id} ({one.what}): {verdict(one, found)}")

    found = tried(work, given.workers, told)
    ended, spent = seconds()
    noticed = sum(how.noticed for how in found.values())
    say(f"{noticed} of {len(found)} breaks noticed; {ended - started:.0f} s, {spent - used:.0f} s of CPU time")
    wrong = failures(found)
    for line in wrong:
        say(f"wrong: {line}")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
