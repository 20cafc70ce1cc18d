"""Files that are damaged in ways that nobody foresees: a report of every check, whatever one of them stumbles over."""

from __future__ import annotations

import random
import re
import subprocess
import sys
from pathlib import Path

import pytest

from plcgen import api
from plcgen.base.diagnostics import Severity
from plcgen.cli.main import run as run_main
from plcgen.ds47.proof import exchanges, rig
from plcgen.proof import headers, making, tables
from plcgen.proof.checks import Outcome
from plcgen.s7.cpu.cpu import Cpu

SPEC = """
plc: {name: Press, sources: per_block, family: s7-1500, toolchain: tia-v20}
drives:
  axis: {device: sinamics-s120, hardware_id: 281, drive_object: 3}
jobs:
  ramp: {drive: axis, read: [P1120, P1121], buffers: db, trigger: M50.0}
  set: {drive: axis, write: {P1120: 5.0, P1121: }, response: {db: 91}, request: {db: 90}}
ppi:
  line: {module: cm-ptp, port: 280, stations: {s: {address: 2}}, jobs: {level: {station: s, read: [VW100, M0.0]}}}
"""


GROUPS = ["files", "layout", "telegrams", "drive", "oracles", "spec", "execution"]


@pytest.fixture
def spec(tmp_path: Path) -> Path:
    """A spec of both protocols, with its files."""
    path = tmp_path / "press.yaml"
    path.write_text(SPEC, "utf-8")
    assert api.generate(path).ok
    return path


def failing(*_: object, **__: object) -> object:
    """Something that nobody expects."""
    raise LookupError("nobody expects this")


@pytest.mark.parametrize(
    ("place", "name", "check", "file"),
    [
        (tables, "_rows", "files.tables", "tags.csv"),
        (headers, "_block", "headers", ""),
        (exchanges, "_check_request", "telegram.Ramp_Request", "db/Ramp_Request.db"),
        (exchanges, "_negative", "negative.Ramp_Response", "db/Ramp_Request.db"),
        (rig.JobRig, "unit_of", "run.ramp", "scl/Ramp.scl"),
        (Cpu, "call", "run.ramp", "scl/Ramp.scl"),
    ],
)
def test_an_exception_is_a_red_check(
    place: object, name: str, check: str, file: str, spec: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """It has the name of the check, a code of its own, the file and what was raised; every other check is made.

    Of a job that cannot be run there is no matrix of faults.
    """
    good = {c.id for c in api.verify(spec, faults="none").checks()}
    monkeypatch.setattr(place, name, failing)
    found = {c.id: c for c in api.verify(spec, faults="none").checks()}
    stopped = found[check].diagnostic
    assert stopped is not None
    assert (found[check].outcome, stopped.code, stopped.severity) == (Outcome.ERROR, "PG627", Severity.ERROR)
    assert "LookupError: nobody expects this" in stopped.message
    assert file in stopped.span.file
    assert {id_.partition(".")[0] for id_ in good - found.keys()} <= {"headers", "faults"}


@pytest.mark.parametrize("source", ["db/Ramp_Request.db", "udt/typeOwn_Request.udt", "db/LineLevel_Request.db"])
def test_another_start_value_is_told_at_its_line(source: str, spec: Path) -> None:
    """One byte of a request, in a data block, a type in an instance, a table: PG604 names the line that was edited."""
    spec.write_text(SPEC.replace("  set:", "  own: {drive: axis, read: [P1120, P1121]}\n  set:"), "utf-8")
    path = api.generate(spec).folder / source
    lines = path.read_text("utf-8-sig").splitlines()
    said = [number for number, line in enumerate(lines) if re.search(r":= 16#[0-9A-F]{2};", line)]
    for number in (said[0], said[len(said) // 2]):
        other = [*lines]
        other[number] = re.sub(r"16#(..);", lambda found: f"16#{int(found[1], 16) ^ 1:02X};", lines[number])
        path.write_text("\n".join(other), "utf-8-sig")
        checks = [one for one in api.verify(spec, faults="none").checks() if one.id.startswith("telegram.")]
        (found,) = [one.diagnostic for one in checks if one.diagnostic is not None]
        assert (found.code, Path(found.span.file).name, found.span.line) == ("PG604", path.name, number + 1)


IN_A_WORKER = """
import os, sys
from plcgen import api
from plcgen.ds47.proof import rig

def failing(*_, **__):
    raise LookupError("nobody expects this")

rig.JobRig.unit_of = failing
os.cpu_count = lambda: 2
print(*sorted(f"{c.id}={c.diagnostic.code}" for c in api.verify(sys.argv[1]).checks() if c.outcome.value == "error"))
"""


def test_an_exception_in_a_worker_is_one_too(spec: Path) -> None:
    """Every job is run, each in one of two processes; those of a process without threads are forked as it is."""
    done = subprocess.run([sys.executable, "-c", IN_A_WORKER, str(spec)], capture_output=True, text=True, check=False)
    assert {"run.ramp=PG627", "run.set=PG627"} <= set(done.stdout.split()), done.stderr


@pytest.mark.parametrize("problem", [MemoryError, KeyboardInterrupt])
@pytest.mark.parametrize("place", [(exchanges, "_check_request"), (Cpu, "call"), (making, "stopped")])
def test_what_is_no_matter_of_a_check_ends_the_run(
    problem: type[BaseException], place: tuple[object, str], spec: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Memory that runs out, and Ctrl-C: also while the result of a check that stopped is written down."""

    def end(*_: object, **__: object) -> object:
        raise problem

    monkeypatch.setattr(tables, "_rows", failing)
    monkeypatch.setattr(headers, "_block", failing)
    monkeypatch.setattr(*place, end)
    with pytest.raises(problem):
        api.verify(spec, faults="none")


def test_it_is_a_failed_verification_for_a_shell(
    spec: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Exit code 1 as for every red check, not that of an internal error."""
    monkeypatch.setattr(tables, "_rows", failing)
    assert run_main(["verify", str(spec), "--faults", "none"]) == 1
    assert "PG627" in "".join(capsys.readouterr())


def damages(text: str, draw: random.Random) -> str:
    """A line or a name is gone, twice there or another one, or the end is missing."""
    lines = text.splitlines(keepends=True) or [""]
    at = draw.randrange(len(lines))
    names = [*re.finditer(r"[A-Za-z_]\w{2,}", text)]
    kind = draw.randrange(5)
    if kind == 0:
        return "".join(lines[:at] + lines[at + 1 :])
    if kind == 1:
        return "".join(lines[: at + 1] + lines[at:])
    if kind == 2:
        return text[: draw.randrange(len(text) + 1)]
    if kind == 3 and names:
        name = draw.choice(names)
        return text[: name.end()] + "X" + text[name.end() :]
    return re.sub(r"\d+", lambda _: draw.choice(("0", "-1", "99999999999")), text, count=draw.randrange(1, 9))


def test_whatever_is_damaged_there_is_a_report(spec: Path) -> None:
    """Every fourth file: deleted or damaged somewhere. The damage is noticed, and every group has its checks."""
    folder = spec.with_name("press_generated")
    draw = random.Random("damage")  # which damage
    for path in sorted(p for p in folder.rglob("*") if p.is_file() and "Ppi" not in p.name)[::4]:
        data = path.read_bytes()
        if draw.random() < 0.2:
            path.unlink()
        else:
            text = data.decode("latin-1")
            path.write_bytes(next(new for _ in range(99) if (new := damages(text, draw)) != text).encode("latin-1"))
        found = api.verify(spec, faults="none")
        assert not found.ok, path
        assert [group.name for group in found.groups] == GROUPS
        assert all(group.checks for group in found.groups), path
        path.write_bytes(data)


def test_a_member_of_a_response_has_another_name(spec: Path) -> None:
    """The first or the last member of each data block and type: what reads them says so."""
    folder = spec.with_name("press_generated")
    for number, path in enumerate(sorted(folder.glob("*/*Response*.*"))):
        data = path.read_bytes()
        names = [*dict.fromkeys(re.findall(rb'Name="(\w+)"|^ +(\w+) :', data, re.MULTILINE))]
        old = b"".join(names[-(number % 2)])
        path.write_bytes(data.replace(old, old + b"X", 1))
        found = api.verify(spec, faults="none")
        assert not found.ok
        assert found.groups
        path.write_bytes(data)
