"""What docs/generated-code.md promises of a job: each promise is broken once, and a scenario of that job notices."""

from __future__ import annotations

import atexit
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
from plcgen.proof.execution import attempt, main_coverage, run_job
from plcgen.proof.rig import ProgramBench
from plcgen.proof.scenario import Failure
from plcgen.proof.suite import Suite
from plcgen.s7.cpu.cpu import Cpu
from tests.projects import per_block

PLANT = """
plc: {name: Plant, family: s7-1500, toolchain: tia-v19}
drives: {one: {device: sinamics-g120, hardware_id: 40271}}
jobs:
  set: {drive: one, write: {P1120: null, P1121: null}}
  get: {drive: one, read: [P1120, P1121, "r945[0..7]"]}
"""
START, TAKE, CHANNEL = "IF #statTicket.start THEN", "IF #statTicket.take THEN", "DriveChannel"
OUTPUT = "#rampUpTime := #statResponse.rampUpTime;"
WORD = "WORD_TO_UINT(UINT_TO_WORD(#hardwareId)"
BROKEN = {
    "the record changes during a request": (
        "Set", CHANNEL, "INDEX := #statIndex, LEN", "INDEX := #recordIndex, LEN", "all inputs change after the edge",
    ),
    "bit 15 of an address is lost": (
        "Get", "Get", "#statOrder.hardwareId := #hardwareId;", f"#statOrder.hardwareId := {WORD} AND W#16#7FFF);",
        "first run",
    ),
    "bit 15 of an address is always there": (
        "Get", "Get", "#statOrder.hardwareId := #hardwareId;",
        f"#statOrder.hardwareId := {WORD} OR W#16#8000);", "an address with bit 15",
    ),
    "an edge in the call after the end is lost": (
        "Get", "Get", "#statTicket(execute := #execute,", "#statTicket(execute := #execute OR #busy,",
        "execute falls before scan 2 and rises in the call after the end",
    ),
    "the count of a negative answer is not looked at": (
        "Set", CHANNEL, "ELSIF #tempHead[3] <> #tempSent[3] THEN",
        "ELSIF #tempHead[3] <> #tempSent[3] AND NOT #tempNegative THEN",
        "telegram 1 is refused with another number of parameters",
    ),
    "a request is given up because one before it had an old answer": (
        "Set", CHANNEL, "#statSilent := 0;\n        #statForeign := FALSE;", "#statSilent := 0;",
        "an old refusal before the answer to telegram 1",
    ),
    "RDREC asks for another record": (
        "Set", CHANNEL, "INDEX := #statIndex, MLEN", "INDEX := #statIndex + 1, MLEN", "first run",
    ),
    "NaN is not passed on": (
        "Get", "Get", OUTPUT,
        f"IF #statResponse.rampUpTime = #statResponse.rampUpTime THEN {OUTPUT} END_IF;", "NaN comes",
    ),
    "-0.0 becomes 0.0": ("Get", "Get", OUTPUT, OUTPUT.replace(":=", ":= 0.0 +"), "-1, -0.0, 2**15, 2**31"),
    "-0.0 is sent as 0.0": ("Set", "Set", ":= #rampUpTime;", ":= 0.0 + #rampUpTime;", "-1, -0.0, 2**15, 2**31"),
    "a flag changes": ("Get", "Get", START, f"%M100.0 := TRUE; {START}", "first run"),
    "a data block changes at the end": (
        "Get", "Get", TAKE, f'{TAKE} "DriveJobs".set.rampUpTime := 1.0;', "first run",
    ),
    "the request of another slot changes": ("Get", "Get", START, f"#unit.asks[3].mark := 7; {START}", "first run"),
    "the place of another channel changes": (
        "Get", CHANNEL, "#place.beat := #tempBeat;",
        '#place.beat := #tempBeat; "ProofGateData".gate.channels[3].beat := 7;', "first run",
    ),
    "a job is not called when it has ended": ("Get", "Get", " OR #status <> W#16#7000 THEN", " THEN", "first run"),
    "a job is not called when its command comes": ("Get", "Get", "IF #execute OR #status", "IF #status", "first run"),
}  # fmt: skip
"""Job, file, what stands there, what stands there instead, the scenario that notices."""


@cache
def made(text: str) -> Path:
    """A spec and its files, generated once per process."""
    folder = Path(tempfile.mkdtemp(prefix="plcgen-promises-"))
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    (folder / "job.yaml").write_text(per_block(text), encoding="utf-8")
    assert api.generate(folder / "job.yaml", folder / "out").ok
    return folder


def generated(tmp_path: Path, text: str) -> tuple[Project, Path]:
    """The plan of a spec, and files of its own."""
    shutil.copytree(made(text), tmp_path, dirs_exist_ok=True)
    loaded = load_spec(tmp_path / "job.yaml", Report())
    assert loaded is not None
    return resolve(loaded, Report()), tmp_path / "out"


def broken(folder: Path, file: str, old: str, new: str) -> None:
    """Change a source; everything else is as generated."""
    source = folder / "scl" / f"{file}.scl"
    text = source.read_text(encoding="utf-8-sig")
    assert old in text
    source.write_text("\ufeff" + text.replace(old, new, 1), encoding="utf-8")


def suite_of(project: Project) -> Suite:
    """The only one."""
    (suite,) = (s for plan in project.plans for s in plan.protocol.proof(plan).suites())
    return suite


@pytest.mark.parametrize("promise", BROKEN)
def test_a_broken_promise_is_noticed(promise: str, tmp_path: Path) -> None:
    """One change of a block, one scenario that fails because of it."""
    key, file, old, new, scenario = BROKEN[promise]
    project, folder = generated(tmp_path, PLANT)
    broken(folder, file, old, new)
    assert failure_of(project, folder, key.lower(), scenario) is not None


def failure_of(project: Project, folder: Path, key: str, name: str) -> Failure | None:
    """What becomes of one scenario of a job; the first run must be good, unless it is the one."""
    suite = suite_of(project)
    job = next(job for job in suite.jobs if job.key == key)
    runner = suite.runner(ProgramBench(project, folder).program, job)
    first = runner.try_run(suite.first())
    if name == suite.first().name:
        return first
    assert first is None
    chosen = [s for s in suite.matrix(runner, runner.statistics.longest, "quick") if s.name.startswith(name)]
    assert chosen
    return next((failure for s in chosen if (failure := runner.try_run(s)) is not None), None)


@pytest.mark.parametrize("key", ["set", "get"])
def test_kept_promises(key: str, tmp_path: Path) -> None:
    """The scenarios that notice something above find nothing in the files as generated."""
    project, folder = generated(tmp_path, PLANT)
    for name in sorted({name for job, _, _, _, name in BROKEN.values() if job.lower() == key}):
        assert failure_of(project, folder, key, name) is None


THREE = """
plc: {name: Three, family: s7-1500, toolchain: tia-v19}
drives: {one: {device: sinamics-g120, hardware_id: 271}}
jobs:
  a: {drive: one, write: {P1120: 7.5}}
  b: {drive: one, read: [P1120, P1121, P1082]}
  c: {drive: one, read: [P1121]}
"""


def test_a_take_over_from_one_job_only_is_noticed(tmp_path: Path) -> None:
    """Job c relies on what b left behind, and takes turns a, b, c all the time: behind a it sends what a sent."""
    project, folder = generated(tmp_path, THREE)
    copy = "FOR #tempIndex := 0 TO 9 DO #unit.telegram"
    broken(folder, "C", copy, f"IF #unit.order.length <> 16 THEN {copy}")
    broken(folder, "C", "#statRequestBytes[#tempIndex]; END_FOR;", "#statRequestBytes[#tempIndex]; END_FOR; END_IF;")
    failed: list[Failure] = []
    for procedure in suite_of(project).procedures(ProgramBench(project, folder).program):
        if procedure.name in {"all jobs again and again", "every job takes its unit over from every other"}:
            failure, _ = attempt(procedure)
            failed += [failure] if failure is not None else []
    assert [failure.scenario for failure in failed] == ["every job takes its unit over from every other"]


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("execute : Bool;", "execute : Bool := TRUE;", "set starts on its own"),
        ("rampUpTime : Real := 10.0", "rampUpTime : Real := 11.0", "set does not send 00 02 01 02"),
    ],
)
def test_data_blocks_run_with_their_start_values(old: str, new: str, said: str, tmp_path: Path) -> None:
    """A command that is TRUE at first starts its job; another start value goes out."""
    project, folder = generated(tmp_path, PLANT)
    control = folder / "db" / "DriveJobs.db"
    text = control.read_text(encoding="utf-8-sig")
    assert old in text
    control.write_text("\ufeff" + text.replace(old, new, 1), encoding="utf-8")
    (procedure,) = (
        one
        for one in suite_of(project).procedures(ProgramBench(project, folder).program)
        if one.name == "every job with the values as delivered"
    )
    failure, _ = attempt(procedure)
    assert failure is not None
    assert failure.message.startswith(said), failure


def test_the_cyclic_ob_counts_for_coverage(tmp_path: Path) -> None:
    """A statement of Main that never runs is an error at its line; of a Main of the user's own nobody asks."""
    project, folder = generated(tmp_path, PLANT)
    broken(folder, "Main", '"DriveCalls_DB"();', 'IF FALSE THEN\n"DriveCalls_DB"();\nEND_IF;\n"DriveCalls_DB"();')
    program = ProgramBench(project, folder).program
    cpu = Cpu(program)
    cpu.scan()
    line = (folder / "scl" / "Main.scl").read_text("utf-8-sig").splitlines().index("IF FALSE THEN") + 1
    (check,) = main_coverage(project, program, cpu.coverage)
    assert check.diagnostic is not None
    assert (check.diagnostic.code, check.diagnostic.span.line) == ("PG622", line)
    owned = generated(tmp_path / "owned", PLANT.replace("tia-v19", "tia-v19, user_owned: [Main]"))[0]
    assert list(main_coverage(owned, program, cpu.coverage)) == []


def test_an_operand_that_decides_nothing_is_an_error(tmp_path: Path) -> None:
    """``a OR b`` with a TRUE in every scan: a has never decided with FALSE, b not at all."""
    project, folder = generated(tmp_path, PLANT)
    call = '"DriveCalls_DB"();'
    broken(folder, "Main", call, f"IF 1 = 1 OR 1 = 2 THEN\n{call}\nELSE\n{call}\nEND_IF;")
    program = ProgramBench(project, folder).program
    cpu = Cpu(program)
    cpu.scan()
    counts = [
        count or int(not probe.kind.startswith("decides"))
        for probe, count in zip(program.probes, cpu.coverage, strict=True)
    ]
    (check,) = main_coverage(project, program, counts)
    assert check.diagnostic is not None
    assert check.diagnostic.code == "PG622"
    assert "an operand never decides FALSE (3 such in all)" in check.diagnostic.message


MIDDLE = """
plc: {name: Middle, family: s7-1500, toolchain: tia-v19}
drives:
  one:
    device: sinamics-g120
    hardware_id: 270
    parameters: {P3140: {type: Unsigned16, array: 150}, P3120: {type: FloatingPoint, array: 70}}
jobs:
  set: {drive: one, write: {"P3140[0..149]": 1, "P3120[0..69]": 1.5}}
"""


def test_a_middle_telegram_may_be_the_only_one_with_several_parameters(tmp_path: Path) -> None:
    """150 words and 70 numbers: two words of P3140 do not fit the first record, and go with the first of P3120."""
    project, folder = generated(tmp_path, MIDDLE)
    (plan,) = project.plans
    assert [len(telegram.parts) for telegram in plan.shapes[0].telegrams] == [1, 2, 1]
    suite = suite_of(project)
    result = run_job(suite, ProgramBench(project, folder).program, suite.jobs[0], "quick")
    assert result.run
    assert result.failures == []
