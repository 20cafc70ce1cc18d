"""What was wrong with a function block for every job and drive, each as it was met, on the blocks of the plant."""

from __future__ import annotations

import pytest

from plcgen.ds47.proof.conduct import JobConduct
from plcgen.ds47.proof.contents import held
from plcgen.ds47.proof.instances import ThreeInstances
from plcgen.ds47.proof.plant import Plant
from plcgen.ds47.proof.rig import JobRig
from plcgen.ds47.proof.scenario import DriveScenario
from plcgen.ds47.proof.stimulus import shape_fb
from plcgen.ds47.proof.words import DONE, WORDS
from plcgen.ds47.sim.bench import build_unit
from plcgen.proof.runner import Runner
from plcgen.proof.scenario import ScenarioError
from plcgen.s7.cpu.cpu import Cpu
from plcgen.s7.cpu.sources import load_folder
from plcgen.s7.cpu.system.port import Periphery
from plcgen.s7.scl.classic import Spelling, respell
from plcgen.s7.scl.dialect import Dialect

TWO_JOBS = """
drives: {mm: {device: micromaster-4, ID: 256, drive_object: 0}}
jobs:
  set: {drive: mm, write: {P1120: null, P1121: null}}
  get: {drive: mm, read: [P1120, "P2155[1..2]"]}
"""
AXES = """
units:
  cu:
    device: sinamics-s120
    drives: {unwind: {ID: 281, drive_object: 3}, rewind: {ID: 284, drive_object: 4}}
jobs:
  set: {drive: [unwind, rewind], write: {P1120: null}}
  get: {drive: [unwind, rewind], read: [P1120, r21]}
"""


@pytest.mark.parametrize("shape", ["set", "get"])
def test_two_instances_with_different_drives_keep_their_values_apart(shape: str, generate, target) -> None:
    """Two instances at once, each with a hardware identifier of its own: the values of one went into the other."""
    made = generate(TWO_JOBS, target)
    number = [job.shape for job in made.plan.shapes].index(shape) + 1
    cpu = Cpu(made.program, Periphery())
    cpu.restart("cold")
    trio = ThreeInstances(made.plan, made.program, cpu, made.plan.shapes[number - 1], number)
    assert list(trio.run(0, 0))
    seen = set()
    for one in trio.all:
        for use in trio.job.uses:
            there = held(one.drive, one.drive_object, use)
            assert there == (one.values.given[use.position] if shape == "set" else one.db.bytes(use.member, len(there)))
            seen.add((use.position, there))
    assert len(seen) == 3 * 2  # three drives with two different values each


def test_two_drive_objects_of_one_unit_never_disturb_each_other(generate, target) -> None:
    """28 start offsets of two jobs for two drive objects with hardware identifiers of their own: all end with 0000."""
    made = generate(AXES, target)
    plant = Plant(made.plan, made.program)
    keys = [(one, two) for one in ("set", "get") for two in ("set", "get")]
    for first, second in keys:
        jobs = made.job(f"{first}.unwind"), made.job(f"{second}.rewind")
        for offset in range(28):
            plant.fresh().begin()
            ended: dict[str, int] = {}
            for scan in range(120):
                if scan == 0:
                    plant.execute(jobs[0])
                if scan == offset:
                    plant.execute(jobs[1])
                plant.step()
                ended |= {job.key: status for job in jobs for over, status in [plant.result(job)] if over}
                if len(ended) == 2:
                    break
            assert list(ended.values()) == [DONE, DONE], (first, second, offset)
            exchanges = plant.exchanges(made.plan.units[0])
            for job in jobs:
                plant.check_job(job, exchanges)


CALLER = """
ORGANIZATION_BLOCK "OB35"
{ S7_Optimized_Access := 'FALSE' }
VERSION : 0.1
BEGIN
CALL;
END_ORGANIZATION_BLOCK
DATA_BLOCK "Fast"
{ S7_Optimized_Access := 'FALSE' }
VERSION : 0.1
"Get"
BEGIN
END_DATA_BLOCK
"""


def test_a_job_in_a_fast_ob_does_not_starve_another(generate, target) -> None:
    """OB35 comes ten times for each OB1, and starts its job again at once: the job of OB1 has its turn as often."""
    made = generate(TWO_JOBS, target)
    dialect = made.plan.target.dialect
    v5 = dialect is Dialect.STEP7_V5
    call = '"Get"."Fast"' if v5 else '"Fast"'
    text = CALLER.replace("CALL;", f'{call}(unit := "MmUnit".unit, diagnosis := "DriveJobs".get.diagnosis);')
    if v5:
        text = respell(text, Spelling.STEP7_V5).replace(
            "BEGIN\n", "VAR_TEMP\n i : ARRAY[0..19] OF BYTE;\nEND_VAR\nBEGIN\n", 1
        )
        text = text.replace('DATA_BLOCK "Fast"\n"Get"', 'DATA_BLOCK "Fast" "Get"')
    program = load_folder(made.folder, dialect, more=[("fast.scl", text)])
    assert program.ok, program.diagnostics
    cpu = Cpu(program, Periphery(write_busy=1, read_busy=1))
    cpu.bus.attach(256, build_unit(made.plan.units[0].device, {0: made.job("set").uses + made.job("get").uses}))
    cpu.restart("cold")
    cpu["Fast.slot"] = 2
    cpu["Fast.driveAddress" if made.plan.target.classic else "Fast.hardwareId"] = 256
    cpu.scan(10)
    ended = {"slow": 0, "fast": 0}
    for tick in range(3000):
        if tick % 10 == 9:
            cpu["DriveJobs.set.execute"] = not cpu["DriveJobs.set.done"]
            cpu.scan(10)
            assert not cpu["DriveJobs.set.error"], cpu["DriveJobs.set.status"]
            ended["slow"] += bool(cpu["DriveJobs.set.done"])
        else:
            cpu["Fast.execute"] = not cpu["Fast.done"]
            cpu.call("OB35", 10)
            assert not cpu["Fast.error"], cpu["Fast.status"]
            ended["fast"] += bool(cpu["Fast.done"])
    assert not cpu.misuses
    assert min(ended.values()) > 5
    assert max(ended.values()) - min(ended.values()) <= 1


@pytest.mark.parametrize("scan", range(4, 10))
def test_a_lost_request_is_sent_again(scan: int, generate, target) -> None:
    """The drive is switched off and on in the middle of a job: one new request, and the job ends well."""
    made = generate(TWO_JOBS, target)
    rig = JobRig(made.plan, made.program, made.plan.shapes[1], 2)
    runner = Runner(JobConduct(rig))
    failure = runner.try_run(DriveScenario(name="off and on", happens={scan: "off"}, busy=(2, 2), again=None))
    assert failure is None, failure
    sent = [exchange for exchange in rig.drive.journal if exchange.direction == "write"]
    assert len(sent) <= 2


def test_a_missing_parameter_costs_its_own_value_only(generate, target) -> None:
    """The drive has no P2155: P1120 is delivered, errors[2] says error 00h; P1120 as an integer: which type came."""
    made = generate(TWO_JOBS, target)
    rig = JobRig(made.plan, made.program, made.plan.shapes[1], 2)
    runner = Runner(JobConduct(rig))
    rig.next_values("next")
    rig.drive.begin(DriveScenario(name="by hand"))
    p1120 = held(rig.drive, 0, made.plan.shapes[1].uses[0])
    missing = rig.drive.objects[0].parameters.pop(2155)

    def run() -> int:
        rig.db.set("execute", 1)
        for _ in range(100):
            rig.cpu.call(f"{shape_fb(2)}_DB", 10)
            if not rig.db.flag("busy"):
                break
        return rig.db.get("status")

    assert run() == WORDS["PARAMETER_ERROR"]
    assert rig.words("errors") == [0x0000, 0x8000]
    assert rig.db.bytes("rampUpTime") == p1120
    rig.drive.objects[0].parameters[2155] = missing
    rig.db.set("execute", 0)
    rig.cpu.call(f"{shape_fb(2)}_DB", 10)
    edit = {1: lambda answer: answer[:4] + b"\x04" + answer[5:]}  # Integer32, format 04h
    assert runner.try_run(
        DriveScenario(
            name="another type", reads=edit, generic=False,
            status=(WORDS["RESPONSE_FORMAT"],), errors={(1, 1): (0x8104, 1)}, follow=False,
        )
    ) is None  # fmt: skip
    assert rig.words("errors") == [0x8104, 0x0000]


def test_two_jobs_that_read_the_same_are_right_when_another_writes_it_between_them(generate, target) -> None:
    """The first reads the old value, the second the new one; their telegrams are the same, reference aside."""
    jobs = "{one: {drive: mm, read: [P1120]}, set: {drive: mm, write: {P1120: null}}, two: {drive: mm, read: [P1120]}}"
    made = generate(f"drives: {{mm: {{device: micromaster-4, ID: 256, drive_object: 0}}}}\njobs: {jobs}\n", target)
    plant = Plant(made.plan, made.program).fresh()
    plant.begin()
    plant.start()
    plant.until(lambda _, status: status == DONE, plant.patience)
    shown = [plant.control(made.job(key)).bytes(f"{made.job(key).member}.rampUpTime", 4) for key in ("one", "two")]
    assert shown[0] != shown[1]
    plant.check()
    plant.control(made.job("two")).put(f"{made.job('two').member}.rampUpTime", bytes(4))
    with pytest.raises(ScenarioError, match="00 00 00 00"):
        plant.check()
