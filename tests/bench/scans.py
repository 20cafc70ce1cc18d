"""Scans from the start of a job to its result, against WRREC and RDREC called by hand, one after the other.

By hand a record call that is busy for n scans takes n + 1 scans, a telegram two of them.
"""

from __future__ import annotations

import tempfile
from dataclasses import replace
from functools import cache
from pathlib import Path

from plcgen import api
from plcgen.ds47.plan.nouns import DrivePlan
from plcgen.ds47.sim.bench import build_drive
from plcgen.ds47.sim.drive import Drive
from plcgen.project.opening import open_spec
from plcgen.s7.cpu.cpu import Cpu
from plcgen.s7.cpu.program import Program
from plcgen.s7.cpu.sources import load_folder
from plcgen.s7.cpu.system.port import Periphery
from plcgen.s7.scl.dialect import Dialect

BUSY = (0, 1, 2, 5)
"""Scans for which a record call answers BUSY."""
GOAL = 2
"""Scans that a job may take besides those by hand: in one it asks for its unit, in one it hears the result."""
RESTORE_MS = 50
"""Length of a scan in which a job restores."""
ADDRESS = 271
PLC = "plc: {name: BENCH, family: s7-1500, toolchain: tia-v19}\n"
READ = (
    PLC
    + f"drives: {{a: {{device: sinamics-g120, hardware_id: {ADDRESS}}}}}\njobs: {{job: {{drive: a, read: [P1120]}}}}\n"
)
RESTORE = PLC + (
    f"drives: {{a: {{device: sinamics-s210, hardware_id: {ADDRESS}}}}}\n"
    "jobs: {job: {drive: a, write: {P1121: 2.0}, verify: readback, on_error: restore}}\n"
)


@cache
def _generated(spec: str) -> tuple[DrivePlan, Program]:
    """A spec as it is generated, with counters of its statements."""
    with tempfile.TemporaryDirectory() as scratch:
        file = Path(scratch) / "job.yaml"
        file.write_text(spec, encoding="utf-8")
        result = api.generate(file, Path(scratch) / "out")
        assert result.ok, result.diagnostics
        plan = open_spec(file).sound().plan(DrivePlan)
        assert plan is not None
        return plan, load_folder(Path(scratch) / "out", Dialect.TIA_1200_1500, coverage=True)


def scans(spec: str, busy: int, milliseconds: int = 10, needs: int = 0, status: int = 0) -> int:
    """Scans of a job, the one in which it starts and the one in which it ends among them.

    ``busy`` is for how many scans each record call is busy, ``needs`` how many ms the drive needs for an answer.
    """
    plan, program = _generated(spec)
    drive = _drive(plan)
    drive.behaviour = replace(drive.behaviour, processing=needs)
    cpu = Cpu(program, Periphery(write_busy=busy, read_busy=busy), family="s7-1500")
    cpu.bus.attach(ADDRESS, drive)
    cpu.scan(milliseconds, 2)
    cpu["DriveJobs.job.execute"] = True
    for count in range(1, 1000):
        cpu.scan(milliseconds)
        if not cpu["DriveJobs.job.busy"]:
            assert not cpu.misuses
            assert cpu["DriveJobs.job.status"] == status, hex(cpu["DriveJobs.job.status"])
            return count
    raise AssertionError("the job does not end")


def _drive(plan: DrivePlan) -> Drive:
    """The drive of a plan, which keeps its value of what is written by a job that restores."""
    drive = build_drive(plan, plan.drives[0])
    found = drive.objects[plan.drives[0].drive_object].parameters
    if 1121 in found:
        first = iter((1.5,))
        found[1121].keeps = lambda _index, value: next(first, value)
        found[899].values = [0]
    return drive


def idle() -> int:
    """Statements and branches of a scan of OB1 with all it calls in which no job runs."""
    _, program = _generated(READ)
    cpu = Cpu(program, Periphery(), family="s7-1500")
    cpu.scan(10, 3)
    before = sum(cpu.coverage)
    cpu.scan(10)
    return sum(cpu.coverage) - before


def main() -> None:
    """Print the table."""
    print("scans from start to result, against WRREC and RDREC by hand")
    for busy in BUSY:
        hand, ours = 2 * (busy + 1), scans(READ, busy)
        print(
            f"  busy {busy}   plcgen {ours}   by hand {hand}   ratio {ours / hand:.2f}   goal <= {1 + GOAL / hand:.2f}"
        )
    took = 10 * scans(READ, 1, needs=50)
    restored = RESTORE_MS * scans(RESTORE, 1, RESTORE_MS, status=0x8530)
    print(
        f"  a drive that needs 50 ms: {took} ms   a restore of six telegrams, scans of {RESTORE_MS} ms: {restored} ms"
    )
    print(f"  idle scan with one job: {idle()} statements and branches")


if __name__ == "__main__":
    main()
