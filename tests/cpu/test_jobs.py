"""Generated job blocks executed from end to end on all three targets, against simulated drives."""

import pytest

from plcgen import api
from plcgen.cpu.cpu import Cpu
from plcgen.cpu.folder import load_folder
from plcgen.cpu.system.bus import Periphery
from plcgen.protocols.ds47.sim.bench import build_drive
from plcgen.protocols.ds47.sim.faults import Fault, FaultKind
from plcgen.scl.dialect import Dialect

TARGETS = {
    "V5": ("s7-300", "step7-v5", Dialect.STEP7_V5, "address: 256"),
    "T3": ("s7-300", "tia-v16", Dialect.TIA_300_400, "address: 256"),
    "T15": ("s7-1500", "tia-v16", Dialect.TIA_1200_1500, "hardware_id: 256"),
}
SPEC = """plc: {{name: JOBS, family: {0}, toolchain: {1}}}
drives:
  dcm: {{device: sinamics-dcm, {2}, drive_object: 2, record_index: 47}}
jobs:
  read_up: {{drive: dcm, read: [P50303], trigger: {{execute: M50.0, done: M50.5}}, reference: 3}}
  write_down: {{drive: dcm, write: {{P50304: 100.0}}, trigger: {{execute: M150.0, done: M150.5}}, reference: 4}}
"""
SPEC_MM4 = """plc: {{name: JOBS, family: {0}, toolchain: {1}}}
drives:
  mm440: {{device: micromaster-4, {2}, drive_object: 0, record_index: 47}}
jobs:
  read_params: {{drive: mm440, read: [P1120, "P2155[1..2]"], trigger: {{execute: M10.0, status: MW22}}, reference: 1}}
  write_params:
    {{drive: mm440, write: {{P1120: 11.0, P1121: 22.0}}, trigger: {{execute: M10.1, status: MW24}}, reference: 2}}
"""
GIVEN_UP = (0x8101, 0x8203)
"""Time-out or too many retries, whichever comes first with the settings of the spec."""
READ_UP = "01 02 01 10 01 C4 7F 00 00"
WRITE_DOWN = "02 02 01 10 01 C4 80 00 00 08 01 42 C8 00 00"
READ_PARAMS = "01 00 02 10 00 04 60 00 00 10 02 08 6B 00 01"
WRITE_PARAMS = "02 00 02 10 01 04 60 00 00 10 01 04 61 00 00 08 01 41 30 00 00 08 01 41 B0 00 00"


class Rig:
    """A generated folder in a CPU, with the drive of its jobs."""

    def __init__(self, folder, template, target, coverage=False):
        family, toolchain, dialect, address = TARGETS[target]
        spec = folder / "job.yaml"
        spec.write_text(template.format(family, toolchain, address), "utf-8")
        result = api.generate(spec, folder / "out")
        assert result.diagnostics == ()
        project = api.check(spec).project
        self.program = load_folder(folder / "out", dialect, coverage=coverage)
        self.drive = build_drive(project, project.jobs[0].drive)
        self.bus = Periphery()
        self.bus.attach(256, self.drive)
        self.cpu = Cpu(self.program, self.bus)
        self.cpu.scan()

    def run(self, flag, instance, scans=200):
        """Raise execute until done or error; the statuses seen and the number of scans."""
        cpu = self.cpu
        cpu[flag] = True
        seen = []
        for number in range(1, scans):
            cpu.scan()
            assert cpu[f"{instance}.busy"] + cpu[f"{instance}.done"] + cpu[f"{instance}.error"] == 1
            if not seen or seen[-1] != cpu[f"{instance}.status"]:
                seen.append(cpu[f"{instance}.status"])
            if not cpu[f"{instance}.busy"]:
                return seen, number
        raise AssertionError("the job did not end")

    def wire(self):
        """Requests as the drive saw them, without their reference."""
        return [entry.data[1:].hex(" ").upper() for entry in self.drive.journal if entry.direction == "write"]


@pytest.fixture(params=TARGETS)
def target(request):
    """Every target."""
    return request.param


@pytest.mark.parametrize("template", [SPEC, SPEC_MM4], ids=["dcm", "mm440"])
def test_nothing_to_report(tmp_path, target, template):
    """The check finds nothing in generated sources."""
    rig = Rig(tmp_path, template, target)
    assert rig.program.diagnostics == []


def test_read_and_write_of_dcm(tmp_path, target):
    """10.0 is read, 100.0 is written; the telegrams are those of the manual."""
    rig = Rig(tmp_path, SPEC, target)
    seen, scans = rig.run("M50.0", "ReadUp_DB")
    assert seen == [0x7001, 0x7002, 0]
    assert scans == 11
    assert rig.cpu["ReadUp_DB.rampUpTime1"] == 10.0
    assert rig.cpu["DriveJobs.readUp.rampUpTime1"] == 10.0
    assert rig.cpu["M50.5"] is True
    rig.cpu["M50.0"] = False
    rig.cpu.scan()
    assert rig.cpu["M50.5"] is False
    assert rig.cpu["ReadUp_DB.status"] == 0x7000
    rig.run("M150.0", "WriteDown_DB")
    assert rig.drive.objects[2].parameters[50304].values[0] == 100.0
    assert rig.wire() == [READ_UP, WRITE_DOWN]
    assert rig.cpu.misuses == []


def test_read_and_write_of_mm440(tmp_path, target):
    """10.0, 30.0, 30.0 are read, 11.0 and 22.0 written."""
    rig = Rig(tmp_path, SPEC_MM4, target)
    rig.run("M10.0", "ReadParams_DB")
    assert rig.cpu["ReadParams_DB.rampUpTime"] == 10.0
    assert rig.cpu["ReadParams_DB.thresholdFrequency1"] == [30.0, 30.0]
    assert rig.cpu["MW22"] == 0
    rig.run("M10.1", "WriteParams_DB")
    parameters = rig.drive.objects[0].parameters
    assert (parameters[1120].values[0], parameters[1121].values[0]) == (11.0, 22.0)
    assert rig.wire() == [READ_PARAMS, WRITE_PARAMS]
    assert rig.cpu.misuses == []


def test_two_jobs_at_once(tmp_path, target):
    """Both jobs started in one scan: one request after the other, both end well."""
    rig = Rig(tmp_path, SPEC, target)
    rig.cpu["M50.0"] = rig.cpu["M150.0"] = True
    rig.cpu.scan(count=60)
    assert (rig.cpu["ReadUp_DB.done"], rig.cpu["WriteDown_DB.done"]) == (True, True)
    assert [entry.direction for entry in rig.drive.journal] == ["write", "read", "write", "read"]


def test_reference_wraps(tmp_path):
    """300 jobs in a row: the reference goes from 255 to 1, never to 0."""
    rig = Rig(tmp_path, SPEC, "T15")
    for _ in range(300):
        rig.run("M50.0", "ReadUp_DB")
        rig.cpu["M50.0"] = False
        rig.cpu.scan()
    references = [entry.data[0] for entry in rig.drive.journal if entry.direction == "write"]
    assert references == [number % 255 + 1 for number in range(300)]


@pytest.mark.parametrize(
    ("fault", "status", "drive_status"),
    [
        (Fault(FaultKind.ERROR, number=0x02), 0x8401, 0),
        (Fault(FaultKind.STATUS, call="write", status=0xDF80A900), 0x8201, 0xDF80A900),
        (Fault(FaultKind.STATUS, call="read", status=0xDE80A900), 0x8202, 0xDE80A900),
        (Fault(FaultKind.BUSY, times=3), 0, 0),
        (Fault(FaultKind.STALE), GIVEN_UP, 0xDE80B500),
        (Fault(FaultKind.RESPONSE_ID), 0x8302, 0),
        (Fault(FaultKind.DRIVE_OBJECT), 0x8303, 0),
        (Fault(FaultKind.COUNT), 0x8304, 0),
        (Fault(FaultKind.FORMAT), 0x8305, 0),
        (Fault(FaultKind.CUT), 0x8305, 0),
        (Fault(FaultKind.SILENCE), GIVEN_UP, 0xDE80B500),
    ],
    ids=lambda value: value.kind.value if isinstance(value, Fault) else "",
)
def test_faults(tmp_path, target, fault, status, drive_status):
    """Every fault ends as it should, outputs stay as they were, and the next job works."""
    rig = Rig(tmp_path, SPEC, target)
    rig.drive.faults.append(
        Fault(
            **{name: getattr(fault, name) for name in ("kind", "times", "after", "call", "status", "number", "value")}
        )
    )
    rig.cpu["ReadUp_DB.rampUpTime1"] = -1.0
    seen, scans = rig.run("M50.0", "ReadUp_DB", 2000)
    assert seen[-1] in {*status} if isinstance(status, tuple) else seen[-1] == status
    assert rig.cpu["ReadUp_DB.rampUpTime1"] == (-1.0 if status else 10.0)
    if drive_status:
        assert rig.cpu["ReadUp_DB.diagnostics.recordStatus"] == drive_status
    assert scans <= 1001 + 5
    rig.drive.faults.clear()
    rig.cpu["M50.0"] = False
    rig.cpu.scan()
    seen, _ = rig.run("M50.0", "ReadUp_DB")
    assert seen[-1] == 0
    assert rig.cpu["ReadUp_DB.rampUpTime1"] == 10.0


def test_restart_in_mid_job(tmp_path, target):
    """A CPU restart in mid-job: afterwards the job runs again when it is started again."""
    rig = Rig(tmp_path, SPEC, target)
    rig.cpu["M50.0"] = True
    rig.cpu.scan(count=5)
    rig.cpu.restart("warm")
    rig.cpu.scan(count=400)
    seen, _ = rig.run("M50.0", "ReadUp_DB", 2000)
    assert seen[-1] == 0


def test_coverage_of_a_nominal_run(tmp_path, target):
    """Statements and branches are counted; error branches are still missing after a good run."""
    rig = Rig(tmp_path, SPEC, target, coverage=True)
    before = len(rig.cpu.uncovered())
    rig.run("M50.0", "ReadUp_DB")
    missing = rig.cpu.uncovered()
    assert 0 < len(missing) < before
    source = next(path for path in (tmp_path / "out").rglob("ReadUp.scl")).read_text("utf-8-sig").splitlines()
    lines = {probe.line for probe in missing if probe.file.endswith("ReadUp.scl") and probe.kind == "statement"}
    assert all("STATUS_DONE" not in source[line - 1] or "tempResult" in source[line - 1] for line in lines)
    assert any("STATUS_RESPONSE_ID" in source[line - 1] for line in lines)
