"""Twice as much of anything in a spec is twice as much work, counted in calls."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from plcgen import api
from tests.work import calls_of

HEAD = "plc: {name: T, family: s7-1500, toolchain: tia-v19}\n"
ONE = "drives: {d: {device: sinamics-g120, hardware_id: 281}}\n"


ALLOWED = "  # plcgen: allow PG228 read in a list"


def rows(row: str, number: int) -> str:
    return "".join(f"{row.replace('#', str(n))}\n" for n in range(number))


def drives(number: int) -> str:
    return HEAD + "drives:\n" + rows("  drv#: {device: sinamics-g120, hardware_id: 9#}", number) + "jobs:\n"


def recipes(number: int) -> str:
    return HEAD + ONE + "recipes:\n" + rows("  r#: {parameters: [P1120], records: 2}", number) + "jobs:\n"


GROWS: dict[str, Callable[[int], str]] = {
    "comments that allow": lambda n: f"{HEAD}{ONE}jobs:\n" + f"{ALLOWED}\n" * n + "  j: {drive: d, read: [P1120]}\n",
    "drives": lambda n: drives(n) + "  j: {drive: drv0, read: [P1120]}\n",
    "unknown drives": lambda n: drives(n) + rows("  j#: {drive: dvr#, read: [P1120]}", n),
    "unknown recipes": lambda n: recipes(n) + rows("  j#: {drive: d, write_recipe: s#}", n),
    "unknown variables": lambda n: f"{HEAD}{ONE}jobs:\n" + rows("  j#: {drive: d, read: [$(x#)]}", n),
    "unknown keys": lambda n: f"{HEAD}{ONE}jobs:\n" + rows("  j#: {drive: d, read: [P1120], colour: 1}", n),
    "jobs": lambda n: f"{HEAD}{ONE}jobs:\n" + rows("  j#: {drive: d, write: {P1120: 1.#}}", n),
}


@pytest.mark.parametrize("what", GROWS)
def test_work_grows_with_the_size(what: str, tmp_path: Path) -> None:
    """From 100 to 200 and from 200 to 400: the second step takes at most two and a half times the first."""
    spec = tmp_path / "job.yaml"
    counts = []
    for number in (10, 100, 200, 400):
        spec.write_text(GROWS[what](number))
        counts.append(calls_of(lambda: api.check(spec))[1])
    _, small, middle, large = counts
    assert large - middle < 2.5 * (middle - small), counts
