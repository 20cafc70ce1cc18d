"""Verdicts of earlier runs: when they count, when not, and who could have put them there."""

from __future__ import annotations

import os
import re
import sys
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path

import pytest

from plcgen import api
from plcgen.project.nouns import Project
from plcgen.project.opening import open_spec
from plcgen.proof import cache as caches
from plcgen.proof.cache import VerdictCache
from plcgen.proof.checks import Check, Outcome, Verification
from plcgen.proof.dependence import part_keys
from plcgen.proof.execution import Work, run_procedure
from plcgen.proof.fingerprint import files_digest
from plcgen.proof.results import Result
from plcgen.proof.rig import ProgramBench
from plcgen.proof.scenario import Failure

SPEC = """
plc: {name: Plant, sources: per_block, family: s7-1500, toolchain: tia-v19}
drives:
  one: {device: sinamics-g120, hardware_id: 270}
jobs:
  set: {drive: one, write: {P1120: 7.5}}
  get: {drive: one, read: [P1121]}
"""
KEY = "5a" * 32
GOOD = Result(run="3 scans", values="P1121 = 10.0 s")
posix = pytest.mark.skipif(sys.platform == "win32", reason="there the folder is the user's own")


def generated(folder: Path, text: str = SPEC) -> Path:
    spec = folder / "plant.yaml"
    spec.write_text(text, "utf-8")
    assert api.generate(spec, folder / "out").ok
    return spec


def project_of(spec: Path) -> Project:
    return open_spec(spec).sound()


def keys(spec: Path) -> dict[str, str]:
    """Key of every part by its name."""
    work = Work(ProgramBench(project_of(spec), spec.parent / "out"), "quick")
    key = part_keys(work)
    names = [
        suite.jobs[part.job].key if part.job is not None else work.procedures[0][part.procedure].name
        for part in work.parts
        for suite in work.suites
    ]
    return {name: key(index) for index, name in enumerate(names)}


def changed(spec: Path, damage: Callable[[Path], None]) -> set[str]:
    """Parts that another key has after some damage."""
    before = keys(spec)
    damage(spec.parent / "out")
    after = keys(spec)
    assert before.keys() == after.keys()
    return {name for name, key in after.items() if key != before[name]}


def told(check: Check) -> tuple[object, ...]:
    """A check without what it says of the cache."""
    return check.id, check.outcome, re.sub(r"; (from the cache|\d+ of \d+ scen).*", "", check.text), check.trials


def cached(found: Verification) -> set[str]:
    return {check.id for check in found.checks() if "from the cache" in check.text}


def edit(name: str, old: str, new: str) -> Callable[[Path], None]:
    def change(folder: Path) -> None:
        path = folder / name
        text = path.read_text("utf-8-sig")
        assert old in text
        path.write_text(text.replace(old, new, 1), "utf-8-sig")

    return change


# --- what is taken, and what is not ---------------------------------------------------------------------------


def test_one_changed_job_is_run_and_the_others_are_not(tmp_path: Path) -> None:
    """The same report as without a cache; it says what comes from there and when that was made."""
    folder = tmp_path / "cache"
    spec = generated(tmp_path)
    first = api.verify(spec, tmp_path / "out", cache=folder)
    assert cached(first) == set()
    again = api.verify(spec, tmp_path / "out", cache=folder)
    assert cached(again) == {"run.set", "faults.set", "run.get", "faults.get", "together"}
    assert [told(check) for check in again.checks()] == [told(check) for check in first.checks()]
    assert re.search(
        r"made \d{4}-\d\d-\d\dT\d\d:\d\d:\d\dZ$", next(c.text for c in again.checks() if c.id == "run.set")
    )
    generated(tmp_path, SPEC.replace("7.5", "8.5"))
    third = api.verify(spec, tmp_path / "out", cache=folder)
    assert cached(third) == {"run.get", "faults.get", "together"}  # 28 starts of get with other instances
    (text,) = (check.text for check in third.checks() if check.id == "together")
    assert "; 28 of " in text
    plain = api.verify(spec, tmp_path / "out")
    assert [told(check) for check in third.checks()] == [told(check) for check in plain.checks()]


def test_a_damaged_block_is_noticed_whatever_is_in_the_cache(tmp_path: Path) -> None:
    """A good verdict of the block before does not count, and the bad one is not kept."""
    folder = tmp_path / "cache"
    spec = generated(tmp_path)
    assert api.verify(spec, tmp_path / "out", cache=folder, faults="none").ok
    edit("scl/Get.scl", "#unit.expected[1] := DW#16#0801", "#unit.expected[1] := DW#16#0601")(tmp_path / "out")
    for _ in range(2):
        found = {c.id: c.outcome for c in api.verify(spec, tmp_path / "out", cache=folder, faults="none").checks()}
        assert (found["run.get"], found["run.set"]) == (Outcome.ERROR, Outcome.OK)


WHOLE = "every job through OB1"


@pytest.mark.parametrize(
    ("damage", "jobs"),
    [
        (edit("scl/Get.scl", "BEGIN", "BEGIN "), {"get"}),
        (edit("scl/DriveCalls.scl", "BEGIN", "BEGIN "), set()),
        (edit("db/DriveJobs.db", "BEGIN", "BEGIN "), set()),
        (edit("scl/DriveChannel.scl", "BEGIN", "BEGIN "), {"get", "set"}),
        (edit("udt/typeDriveUnit.udt", "STRUCT", "STRUCT "), {"get", "set"}),
    ],
    ids=["a job", "the caller", "the commands", "the channel", "a type"],
)
def test_a_key_covers_what_is_reached(damage: Callable[[Path], None], jobs: set[str], tmp_path: Path) -> None:
    """What all jobs do together depends on every file; a job on its own, the engine and their types."""
    found = changed(generated(tmp_path), damage)
    assert WHOLE in found
    assert found & {"get", "set"} == jobs
    assert {name.partition(":")[0] for name in found if "other instances" in name} == jobs


@pytest.mark.parametrize(
    ("old", "new"), [("7.5", "8.5"), ("hardware_id: 270", "hardware_id: 271"), ("7.5}", "7.5}, timeout: 9s")]
)
def test_a_key_covers_the_spec(old: str, new: str, tmp_path: Path) -> None:
    """The files stay as they are: what the job is held to is another thing."""
    spec = generated(tmp_path)
    found = changed(spec, lambda _: spec.write_text(SPEC.replace(old, new), "utf-8") and None)
    assert {"set", WHOLE} <= found


def test_another_tool_has_other_keys(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """One byte of one file of plcgen, of its templates or data, or another name of a file."""
    for name, data in (("a.py", "1"), ("b/c.j2", "2")):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text(data)
    digests = [files_digest((tmp_path,), "0.2.0")]
    digests.append(files_digest((tmp_path,), "0.2.1"))
    (tmp_path / "b/c.j2").write_text("3")
    digests.append(files_digest((tmp_path,), "0.2.0"))
    (tmp_path / "b/c.j2").rename(tmp_path / "b/d.j2")
    digests.append(files_digest((tmp_path,), "0.2.0"))
    assert len(set(digests)) == 4
    spec = generated(tmp_path)
    before = keys(spec)
    monkeypatch.setattr("plcgen.proof.dependence.fingerprint", lambda: digests[0])
    assert not set(before.values()) & set(keys(spec).values())


def test_what_ran_before_does_not_matter(tmp_path: Path) -> None:
    """Each procedure alone, on a new plant, gives what it gives behind all others: so each may be left out."""
    spec = generated(tmp_path)
    work = Work(ProgramBench(project_of(spec), tmp_path / "out"), "quick")
    program = work.bench.program
    in_turn = [run_procedure(program, each) for each in work.procedures[0]]
    for number, result in enumerate(in_turn):
        if number % 7 == 0 or number > len(in_turn) - 20:
            alone = list(work.suites[0].procedures(program))[number]
            assert run_procedure(program, alone) == result, alone.name


# --- the folder -----------------------------------------------------------------------------------------------


def test_an_entry_that_is_damaged_is_none(tmp_path: Path) -> None:
    """Cut, no JSON, of another key or format, with a failure, too large: whoever did that is not believed."""
    cache = VerdictCache(tmp_path / "cache", tmp_path)
    cache.open()
    cache.keep(KEY, GOOD)
    assert cache.find(KEY) == replace(GOOD, made=cache.find(KEY).made)
    (path,) = cache.folder.glob("*/*.json")
    good = path.read_text()
    for bad in (
        "", good[:-5], "[]", "{}", good.replace(KEY, "00" * 32), good.replace('"format":1', '"format":2'),
        good.replace("3 scans", '3"'), good.replace('\\"broken\\":false', '\\"broken\\":true'),
        good.replace('\\"failures\\":[]', '\\"failures\\":[1]'), good + " " * caches.MAX_ENTRY,
    ):  # fmt: skip
        assert bad != good
        path.write_text(bad)
        assert cache.find(KEY) is None, bad[:80]
    path.write_text(good)
    assert cache.find(KEY) is not None


@posix
def test_nobody_else_can_plant_a_verdict(tmp_path: Path) -> None:
    """A folder that others may write to is not used, nor a link to another file; the report says so."""
    spec = generated(tmp_path)
    folder = tmp_path / "cache"
    folder.mkdir(mode=0o700)
    folder.chmod(0o770)
    found = api.verify(spec, tmp_path / "out", cache=folder, faults="none")
    assert [d.code for d in found.diagnostics] == ["PG624"]
    assert list(folder.iterdir()) == []
    folder.chmod(0o700)
    cache = VerdictCache(folder, tmp_path)
    cache.open()
    cache.keep(KEY, GOOD)
    (path,) = folder.glob("*/*.json")
    path.rename(tmp_path / "elsewhere.json")
    path.symlink_to(tmp_path / "elsewhere.json")
    assert cache.find(KEY) is None


def test_only_what_went_well_is_kept(tmp_path: Path) -> None:
    """What fails is run again, and says where."""
    cache = VerdictCache(tmp_path / "cache", tmp_path)
    cache.open()
    cache.keep(KEY, Result(failures=[Failure("nominal run", 3, "it hangs", "a.scl", 7)]))
    cache.keep(KEY, Result(broken=True))
    assert cache.find(KEY) is None


def test_several_may_write_at_once_and_it_is_bounded(tmp_path: Path) -> None:
    """Nothing half-written is ever found; what was not used for long goes first."""
    cache = VerdictCache(tmp_path / "cache", tmp_path, limit=4000)
    cache.open()
    names = [f"{number:064x}" for number in range(40)]
    with ThreadPoolExecutor(8) as threads:
        list(threads.map(lambda name: cache.keep(name, GOOD), names * 3))
    assert all(cache.find(name) for name in names)
    for age, path in enumerate(sorted(cache.folder.glob("*/*.json"))):
        os.utime(path, (age, age))
    cache.close()
    left = sorted(cache.folder.glob("*/*"))
    assert sum(path.stat().st_size for path in left) <= 4000 * 4 // 5
    assert left[-1].stem == names[-1]
    assert left[0].stem != names[0]


TAG = "Signature: 8a477f597d28d172789f06886806bc55\n"
"""Of the Cache Directory Tagging Specification."""


@pytest.mark.parametrize("other", ["2025/measure.json", "aa/notes.json", "aa/deep/x.json", "CACHEDIR.TAG", "mine.txt"])
def test_a_folder_of_something_else_is_left_alone(other: str, tmp_path: Path) -> None:
    """Nobody's files become entries: such a folder is refused as it is, with PG624."""
    spec, folder = generated(tmp_path), tmp_path / "data"
    folder.mkdir(mode=0o700)
    (folder / other).parent.mkdir(exist_ok=True, parents=True)
    (folder / other).write_text(TAG if other == "CACHEDIR.TAG" else "{}")
    before = sorted(folder.rglob("*"))
    found = api.verify(spec, tmp_path / "out", cache=folder, faults="none")
    assert [(d.code, "other files than verdicts" in d.message) for d in found.diagnostics] == [("PG624", True)]
    assert sorted(folder.rglob("*")) == before


def test_only_its_own_names_are_deleted(tmp_path: Path) -> None:
    """Whatever somebody puts into a cache later, however old and large: it does not count, and it stays."""
    cache = VerdictCache(tmp_path / "cache", tmp_path, limit=2000)
    cache.open()
    assert (cache.folder / "CACHEDIR.TAG").read_text().startswith(TAG)
    for number in range(20):
        cache.keep(f"{number:064x}", GOOD)
    others = [cache.folder / name for name in ("00/notes.json", "2025/01.json", "00/" + "0" * 63, "zz/" + "0" * 64)]
    for path in others:
        path.parent.mkdir(exist_ok=True)
        path.write_bytes(bytes(100_000))
        os.utime(path, (1, 1))
    again = VerdictCache(cache.folder, tmp_path, limit=2000)
    again.open()
    again.keep(KEY, GOOD)
    again.close()
    left = {path for path in cache.folder.glob("*/*") if path not in others}
    assert 0 < sum(path.stat().st_size for path in left) <= 2000 * 4 // 5
    assert all(path.is_file() for path in others)


def test_a_cache_without_a_tag_is_known_by_its_names(tmp_path: Path) -> None:
    """Earlier versions made none."""
    cache = VerdictCache(tmp_path / "cache", tmp_path)
    cache.open()
    cache.keep(KEY, GOOD)
    (cache.folder / "CACHEDIR.TAG").unlink()
    cache.open()
    assert cache.find(KEY) is not None
    assert (cache.folder / "CACHEDIR.TAG").is_file()


def test_where_it_lies(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The environment names a folder or none; else it is where the system has caches (XDG base directories)."""
    for text in ("off", "0", ""):
        monkeypatch.setenv(caches.VARIABLE, text)
        assert caches.chosen_folder() is None
    monkeypatch.setenv(caches.VARIABLE, str(tmp_path))
    assert caches.chosen_folder() == tmp_path
    monkeypatch.delenv(caches.VARIABLE)
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    monkeypatch.setattr(sys, "platform", "linux")
    assert caches.chosen_folder() == tmp_path / "plcgen/verdicts"
    monkeypatch.setenv("XDG_CACHE_HOME", "cache")  # a relative one is to be ignored, says the specification
    assert caches.chosen_folder() == Path.home() / ".cache/plcgen/verdicts"
    monkeypatch.setattr(sys, "platform", "darwin")
    assert caches.chosen_folder() == Path.home() / "Library/Caches/plcgen/verdicts"
    monkeypatch.setattr(sys, "platform", "win32")
    monkeypatch.setenv("LOCALAPPDATA", str(tmp_path))
    assert caches.chosen_folder() == tmp_path / "plcgen/Cache/verdicts"
