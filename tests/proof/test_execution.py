"""The generated SCL runs in the simulated CPU: good files pass, damaged ones are located."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from projects import FAQ, MM4, SPECS, TARGETS, every_type, retargeted

from plcgen import api
from plcgen.diagnostics import Report
from plcgen.project.loading import load_spec
from plcgen.project.nouns import Project
from plcgen.project.resolve import resolve
from plcgen.proof.checks import Check, Outcome
from plcgen.proof.execution import check_execution
from plcgen.protocols.ds47.proof.scenario import TimeLimits
from plcgen.protocols.ds47.proof.words import WORDS

PROJECTS = {
    **{f"every type {target}": every_type(target) for target in ("v5", "t3", "t15")},
    **{f"{spec.stem} {target}": retargeted(spec, target) for spec in (FAQ, MM4) for target in ("v5", "t3", "t15")},
    **{
        spec.stem: spec.read_text(encoding="utf-8")
        for spec in SPECS
        if spec.stem.startswith("s7-1") and "ppi" not in spec.stem
    },
}


def generated(tmp_path: Path, text: str) -> tuple[Project, Path]:
    spec = tmp_path / "job.yaml"
    spec.write_text(text, encoding="utf-8")
    result = api.generate(spec, tmp_path / "out")
    assert result.ok, result.diagnostics
    loaded = load_spec(spec, Report())
    assert loaded is not None
    return resolve(loaded, Report()), tmp_path / "out"


def wrong(checks: list[Check]) -> list[str]:
    return [f"{check.id}: {check.verdict}" for check in checks if check.outcome is not Outcome.OK]


@pytest.mark.parametrize("name", PROJECTS)
def test_every_project_passes_every_scenario_with_full_coverage(name: str, tmp_path: Path) -> None:
    """Nominal run, fault matrix, several jobs, and 100 % of statements and branches but the explained ones."""
    project, folder = generated(tmp_path, PROJECTS[name])
    checks = list(check_execution(project, folder, "quick", workers=1))
    assert wrong(checks) == []
    assert [c.id for c in checks if c.id.startswith("coverage")] == [f"coverage.{job.key}" for job in project.jobs]


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


@pytest.mark.parametrize("target", ["v5", "t15"])
@pytest.mark.parametrize("times", TIMES)
def test_any_times_pass(times: str, target: str, tmp_path: Path) -> None:
    """No scenario expects what the job's own times, or no retries at all, do not allow."""
    family, toolchain = TARGETS[target]
    drive = f"{{device: sinamics-dcm, {'hardware_id' if target == 't15' else 'address'}: 256, drive_object: 2}}"
    text = f"plc: {{name: Times, family: {family}, toolchain: {toolchain}}}\ndrives:\n  dcm: {drive}\n"
    text += f"jobs:\n  a: {{drive: dcm, read: [P50303, P50304], {times}}}\n"
    project, folder = generated(tmp_path, text)
    assert wrong(list(check_execution(project, folder, "quick", workers=1))) == []


def test_the_report_has_the_figures(tmp_path: Path) -> None:
    """Scans, busy calls and the value read; error numbers, positions, runs."""
    project, folder = generated(tmp_path, FAQ.read_text(encoding="utf-8"))
    checks = {c.id: c for c in check_execution(project, folder, "full", workers=1)}
    run, faults = checks["run.read_ramp_up"], checks["faults.read_ramp_up"]
    assert re.fullmatch(r"\d+ scans, WRREC busy 3, RDREC B5 x2", run.text)
    assert run.verdict == "-> P50303 = 10.0 s"
    assert re.match(r"67 error numbers x 1 positions, \d+ other faults: [\d,]+ runs, 0 hangs, longest", faults.text)


def test_two_processes_say_what_one_says(tmp_path: Path) -> None:
    """The order and contents of the checks do not depend on how the work is shared out."""
    project, folder = generated(tmp_path, FAQ.read_text(encoding="utf-8"))
    assert list(check_execution(project, folder, workers=2)) == list(check_execution(project, folder, workers=1))


def test_without_faults_only_the_nominal_run_is_made(tmp_path: Path) -> None:
    """What was not run is not called good."""
    project, folder = generated(tmp_path, FAQ.read_text(encoding="utf-8"))
    outcomes = {c.id: c.outcome for c in check_execution(project, folder, "none")}
    assert outcomes["run.read_ramp_up"] is Outcome.OK
    assert outcomes["faults.read_ramp_up"] is Outcome.NOT_RUN


DAMAGE = {
    "output not copied": (
        "        #rampUpTime1 := ",
        "        #tempWireCount := 0; // ",
        "PG620",
        "nominal run|first run",
    ),
    "no drain": (
        "IF NOT (#statWriteActive OR #statReadActive) OR #tempDrainOver THEN",
        "IF TRUE THEN",
        "PG621",
        "busy|slow bus",
    ),
    "stale answer fatal": (
        "#tempResume := #STATE_READ;  // the answer",
        "#tempResult := #STATUS_RETRIES; //",
        "PG621",
        "old",
    ),
    "reference wraps to 0": (
        ".requestReference < 255",
        ".requestReference < 256",
        "PG621",
        "instead of 16#|request reference 0 follows 255",
    ),
    "length unchecked": (" OR #statLength <> 10", "", "PG621", "cut to|too long|behind"),
    "generic formats refused": (" AND #statResponse[4] <> B#16#43", "", "PG621", "in format 43h"),
    "token kept": ('"DcmToken".owner := 0;', ";", "PG620", "run"),
}


@pytest.mark.parametrize("name", DAMAGE)
def test_damage_is_found_and_located(name: str, tmp_path: Path) -> None:
    """The scenario is named, and the diagnostic points into the damaged source."""
    old, new, code, scenario = DAMAGE[name]
    project, folder = generated(tmp_path, FAQ.read_text(encoding="utf-8"))
    source = folder / "scl" / "ReadRampUp.scl"
    text = source.read_text(encoding="utf-8-sig")
    assert old in text
    source.write_text("\ufeff" + text.replace(old, new), encoding="utf-8")
    found = [c.diagnostic for c in check_execution(project, folder, workers=1) if c.diagnostic is not None]
    assert found[0].code == code
    assert re.search(scenario, found[0].message), found[0].message
    assert found[0].span.file == str(source)
    assert found[0].span.line > 0
    assert "scan " in found[0].message


def test_dead_code_is_reported(tmp_path: Path) -> None:
    """A statement that no scenario reaches is an error with its line."""
    project, folder = generated(tmp_path, FAQ.read_text(encoding="utf-8"))
    source = folder / "scl" / "ReadRampUp.scl"
    text = source.read_text(encoding="utf-8-sig")
    dead = "#busy := #statState <> #STATE_IDLE;"
    changed = text.replace(dead, dead + "\nIF #statState > 99 THEN\n  #statRetries := 0;\nEND_IF;")
    source.write_text("\ufeff" + changed, encoding="utf-8")
    found = [c.diagnostic for c in check_execution(project, folder, workers=1) if c.diagnostic is not None]
    assert [d.code for d in found] == ["PG622"]
    assert found[0].span.line == 1 + changed[: changed.index("IF #statState > 99")].count("\n")


def test_a_source_that_does_not_compile_is_an_error(tmp_path: Path) -> None:
    """Nothing is executed, and the compiler's diagnostic is the check's."""
    project, folder = generated(tmp_path, FAQ.read_text(encoding="utf-8"))
    source = folder / "scl" / "ReadRampUp.scl"
    source.write_text(
        source.read_text(encoding="utf-8").replace(":= #statStatus;", ":= #noSuchName;"), encoding="utf-8"
    )
    checks = list(check_execution(project, folder))
    assert [(c.outcome, c.diagnostic.code if c.diagnostic else "") for c in checks] == [(Outcome.ERROR, "PG820")]


@pytest.mark.parametrize(
    ("retries", "timeout", "expected"),
    [(10, 10000, "RETRIES"), (50, 10000, "TIMEOUT"), (40, 8500, "RETRIES TIMEOUT")],
)
def test_repeated_errors_end_with_what_is_reached_first(retries: int, timeout: int, expected: str) -> None:
    """Retries or time, and either of them where scans decide."""
    limits = TimeLimits(timeout, 200, retries, 5000, 3000)
    assert limits.repeated(10, 1) == tuple(WORDS[word] for word in expected.split())
