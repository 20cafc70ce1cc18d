"""Sequences: which telegrams go out and when, what is said of a step that fails, who has the unit; by hand."""

from __future__ import annotations

from pathlib import Path

import pytest

from plcgen import api
from plcgen.ds47.proof.plant import Plant
from plcgen.ds47.proof.scenario import DriveScenario
from plcgen.ds47.sim.faults import Fault, FaultKind
from plcgen.proof.execution import Work, coverage, run_job
from plcgen.proof.results import added
from plcgen.proof.rig import ProgramBench
from tests.ds47.proof.playing import job_of, sent

SPEC = """
drives:
  axis:
    device: sinamics-s120
    ID: 281
    drive_object: 3
    object_type: other
    parameters: {P10: {type: Integer16}, r722: {type: Unsigned32}, P2900: {type: FloatingPoint}}
jobs:
  steps:
    drive: axis
    sequence:
      - write: {P10: 1}
      - until: {P10: ">= -1", r722.9: 1, timeout: 2s, interval: 1s}
      - write: {P2900: {as: level, start: 2.0}}
    allow: {P10: tried out}
  look: {drive: axis, read: [r722]}
"""
WRITE = "02 03 01 10 01 00 0a 00 00 03 01 00 01"
ASK = "01 03 02 10 01 00 0a 00 00 10 01 02 d2 00 00"
LAST = "02 03 01 10 01 0b 54 00 00 08 01 40 00 00 00"
LOOK = "01 03 01 10 01 02 d2 00 00"
"""p0010 = 000Ah as Integer16 in drive object 3; asked for with r0722 = 02D2h; p2900 = 0B54h as 2.0 = 40000000h."""
SECOND = 100
"""Scans of 10 ms."""
NOT_REACHED = 0x8510


@pytest.fixture
def plant(generate, target) -> Plant:
    """A drive object that does nothing on its own, and OB1 with the jobs."""
    made = generate(SPEC, target)
    plant = Plant(made.plan, made.program).fresh()
    plant.units["axis"].asked = None
    return plant


def run(plant: Plant, inputs: dict[int, int], faults: tuple[Fault, ...] = (), look: int = 0) -> tuple[int, int]:
    """The inputs r0722 by the scan in which they change; another job is started in ``look``; scans and status."""
    plant.begin(DriveScenario(name="OB1", faults=faults), delivered=True)
    values = plant.units["axis"].objects[3].parameters[722].values
    values[:] = [0]
    plant.execute(job_of(plant, "steps"))
    for scan in range(1, 6 * SECOND):
        values[:] = [inputs.get(scan, values[0])]
        if scan == look:
            plant.execute(job_of(plant, "look"))
        plant.step()
        over, status = plant.result(job_of(plant, "steps"))
        if over:
            failed.append(tuple(plant.cpu[f'"DriveJobs".steps.{name}'] for name in ("failedStep", "failedParameter")))
            plant.execute(job_of(plant, "steps"), value=False)
            plant.step()
            return scan, status
    raise AssertionError("it has not ended")


failed: list[tuple[object, ...]] = []
"""failedStep and failedParameter of each run."""


def test_it_asks_until_all_is_there(plant: Plant) -> None:
    """Bit 9 (512) comes after 0.5 s: the question at 0 s is answered no, the one after 1 s yes."""
    scans, status = run(plant, {50: 512})
    assert (status, failed[-1]) == (0, (0, 0))
    assert sent(plant) == [WRITE, ASK, ASK, LAST]
    assert SECOND <= scans <= SECOND + 60
    assert plant.cpu['"DriveJobs".steps.r722Bit9Step2'] == 512


def test_it_waits_in_vain(plant: Plant) -> None:
    """Questions at 0 s, 1 s and, at the timeout, 2 s. All other bits are no substitute. Nothing is put back."""
    scans, status = run(plant, {1: 0xFFFFFFFF - 512})
    assert (status, failed[-1]) == (NOT_REACHED, (2, 722))
    assert sent(plant) == [WRITE, ASK, ASK, ASK]
    assert 2 * SECOND <= scans <= 2 * SECOND + 60
    assert plant.units["axis"].objects[3].parameters[10].values == [1]
    assert run(plant, {1: 512})[1] == 0  # and the next start works
    assert failed[-1] == (0, 0)


def test_others_have_the_unit_meanwhile(plant: Plant) -> None:
    """A job that is started 0.7 s behind the start reads before the second question."""
    assert run(plant, {90: 512}, look=70)[1] == 0
    assert sent(plant) == [WRITE, ASK, LOOK, ASK, LAST]


@pytest.mark.parametrize(
    ("after", "position", "says"),
    [(0, 1, (1, 10)), (1, 1, (2, 10)), (1, 2, (2, 722)), (2, 2, (2, 722)), (3, 1, (3, 2900))],
)
def test_a_refusal_names_step_and_parameter(plant: Plant, after: int, position: int, says: tuple[int, int]) -> None:
    """The request behind so many that have so many parameters; the second question is refused, too."""
    count = {0: 0, 1: 1 if position == 1 else 0, 2: 1, 3: 3}[after]
    fault = Fault(FaultKind.ERROR, after=count, number=0x11, position=position, words=1)
    assert run(plant, {50: 512}, (fault,))[1] == 0x8401
    assert failed[-1] == says


ALIKE = f"""{SPEC.partition("jobs:")[0]}
jobs:
  twice:
    drive: axis
    sequence:
      - until: {{P2900: "<> 1.5", timeout: 3s}}
      - write: {{P10: 1}}
      - until: {{P2900: "<= 0.5", timeout: 3s}}
    allow: {{P10: tried out}}
  once: {{drive: axis, sequence: [{{read: [r722]}}]}}
"""


@pytest.mark.slow
@pytest.mark.parametrize("where", ["v5", "t15"])
def test_the_proof_holds_of_steps_that_ask_the_same_and_of_one_step_alone(generate, where: str) -> None:
    """NaN is <> 1.5 on every CPU, S7-300/400 say that it is not; behind a restart both questions look alike.

    And every operand decides: of one step with one parameter errors is never 0 when the job has failed.
    """
    made = generate(ALIKE, where)
    work = Work(ProgramBench(made.project, made.folder), "quick")
    (suite,) = work.suites
    results = {job.key: run_job(suite, work.bench.program, job, "quick") for job in suite.jobs}
    assert [str(failure) for result in results.values() for failure in result.failures] == []
    counts = added(work.bench.program, results.values())
    for block in suite.blocks():
        if block.jobs:
            assert coverage(work.bench.program, block, counts, results).missing == ()


WAITS = {
    "two values of one parameter": (
        "a: {drive: axis, sequence: [{until: {P2900: 1.0}}, {until: {P2900: 2.0}}, {until: {P2900: 1.0}}]}"
    ),
    "both directions": 'a: {drive: axis, sequence: [{until: {P2900: "> 100.0"}}, {until: {P2900: "< 1.0"}}]}',
    "several bits of one word, and the word": (
        "a: {drive: axis, sequence: [{until: {r722.0: 1, r722.1: 1, r722.2: 0}}, {until: {r722.0: 0, r722.2: 1}}]}"
    ),
    "two jobs wait for opposite values": (
        "a: {drive: axis, sequence: [{until: {r722.0: 1}}]}\n  b: {drive: axis, sequence: [{until: {r722.0: 0}}]}"
    ),
    "one waits for what another reads back": (
        "a: {drive: axis, write: {P2900: 7.0}, verify: readback, on_error: restore}\n"
        "  b: {drive: axis, sequence: [{until: {P2900: 12.0, timeout: 4s}}]}"
    ),
    "six minutes, asked ten times a second": (
        "a: {drive: axis, timeout: 450ms, sequence: [{until: {r722.0: 1, timeout: 6min, interval: 100ms}}, "
        "{read: r722}]}"
    ),
}


@pytest.mark.slow
@pytest.mark.parametrize("jobs", WAITS.values(), ids=WAITS)
def test_whatever_is_waited_for_the_proof_holds(jobs: str, tmp_path: Path) -> None:
    """A value comes for the one that waits for it, whoever reads besides: nothing is wrong with such jobs."""
    spec = tmp_path / "job.yaml"
    head = "plc: {name: Plant, family: s7-1500, toolchain: tia-v19}"
    spec.write_text(f"{head}{SPEC.partition('jobs:')[0].replace('ID', 'hardware_id')}jobs:\n  {jobs}\n", "utf-8")
    assert api.generate(spec).ok
    assert [str(problem) for problem in api.verify(spec).problems] == []
