"""Twice as much of anything in a spec is twice as much work, counted in calls."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from pathlib import Path

import pytest
from click.testing import CliRunner

from plcgen import api
from plcgen.cli.main import run
from tests.doors import DOORS
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


READ = "{drive: d, read: [P1120]}"


def many_drives(row: str, number: int) -> str:
    return f"{HEAD}drives:\n{rows(f'  {row}', number)}jobs: {{j: {{drive: d0, read: [P1120]}}}}\n"


def port(stations: str, jobs: str) -> str:
    return f"{HEAD}ppi:\n  m:\n    module: cm1241\n    port: 270\n    stations: {{{stations}}}\n    jobs:\n{jobs}"


GROWS: dict[str, Callable[[int], str]] = {
    "comments that allow": lambda n: f"{HEAD}{ONE}jobs:\n" + f"{ALLOWED}\n" * n + "  j: {drive: d, read: [P1120]}\n",
    "drives": lambda n: drives(n) + "  j: {drive: drv0, read: [P1120]}\n",
    "unknown devices": lambda n: many_drives("d#: {device: sinamic-#, hardware_id: 9#}", n),
    "profiles that are not there": lambda n: many_drives("d#: {device: ./p#.yaml, hardware_id: 9#}", n),
    "one hardware identifier": lambda n: many_drives("d#: {device: sinamics-g120, hardware_id: 270}", n),
    "one name": lambda n: many_drives("d: {device: sinamics-g120, hardware_id: 270}", n),
    "one block": lambda n: f"{HEAD}{ONE}jobs:\n" + rows("  j#: {drive: d, read: [P1120], name: Same}", n),
    "names in other letters": lambda n: f"{HEAD}{ONE}jobs:\n" + rows(f"  J#: {READ}\n  j#: {READ}", n // 2),
    "unknown stations": lambda n: port("p: {address: 2}", rows("      j#: {station: q#, read: [VB1]}", n)),
    "stations with one address": lambda n: port(
        rows("p#: {address: 2},", n).replace("\n", " "), "      j: {station: p0, read: [VB1]}\n"
    ),
    "missing includes": lambda n: f"{HEAD}include:\n" + rows("  - x#.yaml", n) + f"{ONE}jobs: {{j: {READ}}}\n",
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


DOOR_GROWS: dict[str, tuple[str, Callable[[int], str]]] = {
    "members of a lock": (
        "lock",
        lambda n: "format: 2\nblocks:\n- {kind: DB, name: B, hash: x, access: standard, members: [\n"
        + rows("  {path: m#, type: 1},", n) + "  ]}\n",
    ),
    "blocks of a lock": ("lock", lambda n: "format: 2\nblocks:\n" + rows("- {kind: XX, name: B#}", n)),
    "kinds of change": ("policy", lambda n: rows("member-renamet#: compatibel", n)),
    "addresses of a station": ("station", lambda n: "values:\n" + rows("  VX#: 1", n)),
    "stations": ("station", lambda n: "stations:\n" + rows("  - {address: 2, cpux: 1}", n)),
    "parameters of a drive": (
        "drive", lambda n: "objects:\n  - number: 0\n    parameters:\n" + rows("      - {pnu: 5, typ: Unsigned17}", n)
    ),
    "objects of a drive": ("drive", lambda n: "objects:\n" + rows("  - {number: 0, parameters: []}", n)),
    "faults of drives": ("drive faults", lambda n: rows("- {kind: buzy, drive: e#}", n)),
    "faults of a line": ("line faults", lambda n: rows("- {kind: junc, station: 999}", n)),
    "parameters of a profile": ("profile", lambda n: "parameters:\n" + rows("  P1#: {type: Unsigned17, titel: 3}", n)),
    "paths": ("config", lambda n: "specs:\n" + rows('  - ""', n)),
}  # fmt: skip


@pytest.mark.parametrize("what", DOOR_GROWS)
def test_work_of_other_files_grows_with_their_size(what: str) -> None:
    """As for a spec: every line has a mistake, and all of them are told."""
    kind, make = DOOR_GROWS[what]
    counts = []
    for number in (10, 100, 200, 400):
        text = make(number)
        found, count = calls_of(partial(DOORS[kind], text))
        assert len(found) >= number - 2
        counts.append(count)
    _, small, middle, large = counts
    assert large - middle < 2.5 * (middle - small), counts


@pytest.mark.parametrize("format_", ["text", "json", "sarif", "junit", "github"])
def test_work_of_showing_grows_with_the_number_of_problems(
    format_: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Excerpts of the source, too, for which the file is read."""
    monkeypatch.chdir(tmp_path)
    counts = []
    for number in (10, 100, 200, 400):
        Path("job.yaml").write_text(GROWS["one name"](number))
        with CliRunner().isolation():
            code, count = calls_of(lambda: run(["check", "job.yaml", "-f", format_]))
        assert code == 1
        counts.append(count)
    _, small, middle, large = counts
    assert large - middle < 2.5 * (middle - small), counts
