"""The generated SCL runs in the simulated CPU: good files pass, damaged ones are located."""

from __future__ import annotations

import atexit
import re
import shutil
import tempfile
from functools import cache
from pathlib import Path

import pytest

from plcgen import api
from plcgen.base.diagnostics import Report
from plcgen.project.loading import load_spec
from plcgen.project.nouns import Project
from plcgen.project.resolve import resolve
from plcgen.proof.checks import Check, Outcome
from plcgen.proof.execution import check_execution
from plcgen.proof.sharing import Sharing
from tests.projects import FAQ, MM4, SPECS, TARGETS, every_type, per_block, retargeted

PROJECTS = {
    **{f"every type {target}": every_type(target) for target in ("v5", "t15")},
    **{f"{spec.stem} {target}": retargeted(spec, target) for spec in (FAQ, MM4) for target in ("v5", "t3", "t15")},
    **{
        spec.stem: spec.read_text(encoding="utf-8")
        for spec in SPECS
        if spec.stem.startswith("s7-1") and "ppi" not in spec.stem and spec.stem != "s7-1200_plant"
    },
}
"""On an S7-1200 the plant has the same code as on an S7-1500 but for the number of places in DriveCalls; "every type"
has the same on TIA S7-300 as on STEP 7 V5 but for the spelling, and runs there without faults (tests/build)."""


@cache
def made(text: str) -> Path:
    """A spec and its files, generated once per process."""
    folder = Path(tempfile.mkdtemp(prefix="plcgen-execution-"))
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    (folder / "job.yaml").write_text(text, encoding="utf-8")
    result = api.generate(folder / "job.yaml", folder / "out")
    assert result.ok, result.diagnostics
    return folder


def generated(tmp_path: Path, text: str) -> tuple[Project, Path]:
    """The plan, and a copy of the files of its own."""
    shutil.copytree(made(text), tmp_path, dirs_exist_ok=True)
    loaded = load_spec(tmp_path / "job.yaml", Report())
    assert loaded is not None
    return resolve(loaded, Report()), tmp_path / "out"


def wrong(checks: list[Check]) -> list[str]:
    bad = {Outcome.ERROR, Outcome.WARNING}
    return [f"{check.id}: {check.verdict}" for check in checks if check.outcome in bad]


@pytest.mark.parametrize("name", PROJECTS)
def test_every_project_passes_every_scenario_with_full_coverage(name: str, tmp_path: Path) -> None:
    """Nominal run, fault matrix, several jobs, and 100 % of statements and branches but the explained ones."""
    project, folder = generated(tmp_path, PROJECTS[name])
    checks = list(check_execution(project, folder, "quick", share=Sharing(workers=1)))
    assert wrong(checks) == []
    shapes = [job.shape for plan in project.plans for job in plan.shapes]
    main = "OB1" if project.target.v5 else "Main"
    wanted = [f"coverage.{name}" for name in (*shapes, "DriveCalls", main)]
    assert [c.id for c in checks if c.id.startswith("coverage")] == wanted


TIMES = (
    "retries: 0",
    "retries: 1",
    "retries: 1000",
    "timeout: 1s",
    "timeout: 5s, retry_pause: 50ms",
    "timeout: 3333ms, retry_pause: 77ms",
    "timeout: 2s, retry_pause: 1900ms",
    "timeout: 60s, retry_pause: 1s",
)


@pytest.mark.parametrize(("times", "target"), list(zip(TIMES, ["v5", "t15", "t15", "v5"] * 2, strict=True)))
def test_any_times_pass(times: str, target: str, tmp_path: Path) -> None:
    """No scenario expects what the job's own times, or no retries at all, do not allow; the clock of either target."""
    family, toolchain = TARGETS[target]
    drive = f"{{device: sinamics-dcm, {'hardware_id' if target == 't15' else 'address'}: 256, drive_object: 2}}"
    text = f"plc: {{name: Times, family: {family}, toolchain: {toolchain}}}\ndrives:\n  dcm: {drive}\n"
    text += f"jobs:\n  a: {{drive: dcm, read: [P50303, P50304], {times}}}\n"
    project, folder = generated(tmp_path, text)
    assert wrong(list(check_execution(project, folder, "quick", share=Sharing(workers=1)))) == []


def test_the_report_has_the_figures(tmp_path: Path) -> None:
    """Scans, busy calls and the value read; error numbers, positions, runs."""
    project, folder = generated(tmp_path, FAQ.read_text(encoding="utf-8"))
    checks = {c.id: c for c in check_execution(project, folder, "full", share=Sharing(workers=1))}
    run, faults = checks["run.read_ramp_up"], checks["faults.read_ramp_up"]
    assert re.fullmatch(r"\d+ scans, WRREC busy 3, RDREC B5 x2", run.text)
    assert run.verdict == "-> P50303 = 10.0 s"
    assert re.match(r"\d+ scenarios of values, errors, signals: [\d,]+ runs, 0 hangs, longest", faults.text)


def test_two_processes_say_what_one_says(tmp_path: Path) -> None:
    """The order and contents of the checks do not depend on how the work is shared out."""
    project, folder = generated(tmp_path, FAQ.read_text(encoding="utf-8"))
    assert list(check_execution(project, folder, share=Sharing(workers=2))) == list(
        check_execution(project, folder, share=Sharing(workers=1))
    )


def test_without_faults_only_the_nominal_run_is_made(tmp_path: Path) -> None:
    """What was not run is not called good."""
    project, folder = generated(tmp_path, FAQ.read_text(encoding="utf-8"))
    outcomes = {c.id: c.outcome for c in check_execution(project, folder, "none")}
    assert outcomes["run.read_ramp_up"] is Outcome.OK
    assert outcomes["faults.read_ramp_up"] is Outcome.NOT_RUN


PLANT = """
plc: {name: Plant, family: s7-1500, toolchain: tia-v19}
drives:
  one: {device: sinamics-g120, hardware_id: "Fan~1"}
  two: {device: sinamics-g120, hardware_id: 271}
jobs:
  set: {drive: [one, two], write: {P1120: null, P1121: null}, timeout: 12s, retry_pause: 300ms}
  get: {drive: [one, two], read: [P1120, P1121, "r945[0..7]"]}
"""
DAMAGE = {
    "slot of the other job": ("DriveCalls", "#getOne(", "slot := 2", "slot := 1", "slot of get.one is 1 instead of 2"),
    "wrong unit": ("DriveCalls", "#getTwo(", '"TwoUnit".unit', '"OneUnit".unit', "get.two|set.one|get.one"),
    "wrong channel": ("DriveCalls", "#channelTwo(", "channels[2]", "channels[1]", "no channel has place 2 of the gate"),
    "too few slots": ("DriveCalls", "#channelTwo(", "slots := 2", "slots := 1", "slots of two is 1 instead of 2"),
    "wrong record": (
        "DriveCalls",
        "#channelTwo(",
        "slots := 2",
        "slots := 2, recordIndex := 48",
        "recordIndex of two is 48",
    ),
    "wrong drive": ("DriveCalls", "#setTwo(", "hardwareId := 271", 'hardwareId := "Fan~1"', "hardwareId of set.two"),
    "wrong drive object": ("DriveCalls", "#setTwo(", "B#16#01", "B#16#02", "driveObject of set.two is 2"),
    "too many places": ("DriveCalls", "#driveGate(", "places := 10", "places := 11", "the gate has"),
    "swapped inputs": ("DriveCalls", "#setTwo(", "setTwo.rampUpTime", "setTwo.rampDownTime", "set.two does not send"),
    "output of another job": (
        "DriveCalls",
        "#getTwo(",
        "getTwo.rampUpTime",
        "getOne.rampUpTime",
        "getOne.rampUpTime is",
    ),
    "signal of another job": ("DriveCalls", "#getTwo(", "getTwo.done", "getOne.done", "get.(one|two): busy"),
    "expected type": ("Get", "", "DW#16#08010004;  // P1120", "DW#16#07010004;", "expected of P1120"),
    "expected number": ("Get", "", "DW#16#06080010", "DW#16#06070010", "expected of r945"),
    "swapped outputs": ("Get", "", "statResponse.rampUpTime", "statResponse.rampDownTime", "rampUpTime is"),
    "output of another parameter": (
        "Get",
        "",
        "#diagnosis.errors[2] = W",
        "#diagnosis.errors[1] = W",
        "is .* instead of",
    ),
    "drive object of the spec": (
        "Get",
        "",
        "#statRequest.driveObject := #driveObject;",
        ";",
        "instances|telegram 1 is",
    ),
    "time-out": ("Set", "", "L#12000", "L#10000", "timeout is 10000 instead of 12000"),
    "telegrams": ("Set", "", "telegrams := 1", "telegrams := 2", "a telegram 2 is handed over, the job has 1"),
    "pause": ("Set", "", "L#300", "L#200", "pause is 200 instead of 300"),
    "length": ("Set", "", "#statOrder.length := 28", "#statOrder.length := 24", "length is 24 instead of 28"),
    "inputs not latched": (
        "Set",
        "",
        "IF #statTicket.start THEN",
        "IF #busy OR #statTicket.start THEN",
        "all inputs change",
    ),
    "errors kept": (
        "Get",
        "",
        "#diagnosis.errors[#tempIndex] := #unit",
        "#diagnosis.errorInfos[#tempIndex] := #unit",
        "errors",
    ),
}
"""File, start of the line, old text, new text, what the message says."""


@pytest.mark.parametrize("name", DAMAGE)
def test_damage_is_found(name: str, tmp_path: Path) -> None:
    """Whatever is changed in a job or in the caller: a scenario fails and says what is wrong."""
    block, line, old, new, said = DAMAGE[name]
    project, folder = generated(tmp_path, per_block(PLANT))
    source = folder / "scl" / f"{block}.scl"
    text = source.read_text(encoding="utf-8-sig")
    at = text.index(line) if line else 0
    assert old in text[at:]
    changed = text[:at] + text[at:].replace(old, new, 1)
    source.write_text("\ufeff" + changed, encoding="utf-8")
    told = ""
    for level in ("none", "quick"):  # the nominal run tells most of it
        if not re.search(said, told):
            checks = check_execution(project, folder, level, share=Sharing(workers=1))
            told = " | ".join(c.diagnostic.message for c in checks if c.diagnostic is not None)
    assert re.search(said, told), told


def test_dead_code_is_reported(tmp_path: Path) -> None:
    """A statement that no scenario reaches is an error with its line."""
    project, folder = generated(tmp_path, per_block(FAQ.read_text(encoding="utf-8")))
    source = folder / "scl" / "ReadRampUp.scl"
    text = source.read_text(encoding="utf-8-sig")
    dead = "#busy := #statTicket.busy;"
    changed = text.replace(dead, dead + "\nIF #statTicket.take AND #statTicket.start THEN\n  #tempSlot := 0;\nEND_IF;")
    source.write_text("\ufeff" + changed, encoding="utf-8")
    found = [
        c.diagnostic for c in check_execution(project, folder, share=Sharing(workers=1)) if c.diagnostic is not None
    ]
    assert [d.code for d in found] == ["PG622"]
    assert found[0].span.line == 1 + changed[: changed.index("IF #statTicket.take AND")].count("\n")


def test_a_source_that_does_not_compile_is_an_error(tmp_path: Path) -> None:
    """Nothing is executed, and the compiler's diagnostic is the check's."""
    project, folder = generated(tmp_path, per_block(FAQ.read_text(encoding="utf-8")))
    source = folder / "scl" / "ReadRampUp.scl"
    source.write_text(
        source.read_text(encoding="utf-8").replace(":= #statTicket.status;", ":= #noSuchName;"), encoding="utf-8"
    )
    checks = list(check_execution(project, folder))
    assert [(c.outcome, c.diagnostic.code if c.diagnostic else "") for c in checks] == [(Outcome.ERROR, "PG820")]
