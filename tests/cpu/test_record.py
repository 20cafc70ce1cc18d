"""WRREC and RDREC call by call: STATUS, one-call flags, snapshot, limits, restart, misuse."""

import pytest
from cpu.support import load

from plcgen.cpu.cpu import Cpu
from plcgen.cpu.system.bus import Periphery
from plcgen.protocols.ds47.sim.behaviour import Behaviour
from plcgen.protocols.ds47.sim.drive import Drive
from plcgen.protocols.ds47.sim.parameters import DriveObject, SimulatedParameter
from plcgen.protocols.ds47.wire import formats

REQUEST = bytes.fromhex("01 01 01 01 10 01 00 01 00 00")
ANSWER = bytes.fromhex("01 01 01 01 06 01 00 05")
CASE = {
    "in": "write : Bool; read : Bool; id : HW_IO := 271; length : UInt := 10;",
    "out": "done : Bool; busy : Bool; error : Bool; status : DWord; valid : Bool; count : UInt;",
    "vars": "w : WRREC; r : RDREC; q : Array[0..9] of Byte; a : Array[0..19] of Byte;",
    "code": """#w(REQ := #write, ID := #id, INDEX := 47, LEN := #length, DONE => #done, BUSY => #busy,
   ERROR => #error, STATUS => #status, RECORD := #q);
#r(REQ := #read, ID := #id, INDEX := 47, MLEN := 20, VALID => #valid, LEN => #count, RECORD := #a);""",
}


def bench(case=None, *, busy=2, limit=None):
    """CPU, bus and a drive with p1 = 5 at 271."""
    drive = Drive(Behaviour(), [DriveObject(1, {1: SimulatedParameter(1, formats.by_name("Unsigned16"), [5])})])
    bus = Periphery(write_busy=busy, read_busy=busy)
    bus.attach(271, drive)
    cpu = Cpu(load(case or CASE), bus, job_limit=limit)
    cpu.scan(0)
    cpu["Test_DB.q"] = list(REQUEST) if case is None else [0] * 10
    return cpu, bus, drive


def outputs(cpu):
    """DONE, BUSY, ERROR and STATUS of the last call."""
    return (*(int(cpu[f"Test_DB.{name}"]) for name in ("done", "busy", "error")), f"{cpu['Test_DB.status']:08X}")


def test_write_call_by_call():
    """No job, started, running, done for one call, no job."""
    cpu, _, drive = bench()
    found = []
    for requested in (0, 1, 0, 0, 0):
        cpu.call("Test_DB", 10, write=bool(requested))
        found.append(outputs(cpu))
    assert found == [
        (0, 0, 0, "00700000"),
        (0, 1, 0, "00700100"),
        (0, 1, 0, "00700200"),
        (1, 0, 0, "00000000"),
        (0, 0, 0, "00700000"),
    ]
    assert [entry.data for entry in drive.journal] == [REQUEST]
    assert cpu.misuses == []


def test_read_stores_at_valid():
    """The answer comes with VALID, with its length; the buffer is untouched before."""
    cpu, _, _ = bench()
    for requested in (1, 0, 0):
        cpu.call("Test_DB", 10, write=bool(requested))
    found = []
    for requested in (1, 0, 0, 0):
        cpu.call("Test_DB", 10, read=bool(requested), write=False)
        found.append((cpu["Test_DB.valid"], bytes(cpu["Test_DB.a"][:8]) == ANSWER))
    assert found == [(False, False), (False, False), (True, True), (False, True)]
    assert cpu["Test_DB.count"] == len(ANSWER)


def test_error_for_one_call():
    """A refusing drive: ERROR and its STATUS for one call."""
    cpu, _, _ = bench(busy=0)
    cpu["Test_DB.q"] = [0] * 10
    cpu.call("Test_DB", 10, write=True)
    assert outputs(cpu) == (0, 0, 1, "DF80B700")
    cpu.call("Test_DB", 10, write=False)
    assert outputs(cpu) == (0, 0, 0, "00700000")


def test_no_drive():
    """An address without a module."""
    cpu, _, _ = bench()
    cpu.call("Test_DB", 10, write=True, id=5)
    assert outputs(cpu) == (0, 0, 1, "C0809000")


def test_output_bit():
    """Bit 15 of an output-only module leads to the same drive."""
    cpu, _, drive = bench(busy=0)
    cpu.call("Test_DB", 10, write=True, id=271 | 0x8000)
    assert outputs(cpu)[0] == 1
    assert len(drive.journal) == 1


def test_snapshot_and_changed_contents():
    """WRREC sends what RECORD held at REQ; changing it meanwhile is a misuse."""
    cpu, _, drive = bench()
    cpu.call("Test_DB", 10, write=True)
    cpu["Test_DB.q[1]"] = 2
    for _ in range(2):
        cpu.call("Test_DB", 10, write=False)
    assert [entry.data for entry in drive.journal] == [REQUEST]
    assert [(misuse.code, misuse.line) for misuse in cpu.misuses] == [("PG830", 13)]


def test_changed_length():
    """LEN must stay the same."""
    cpu, _, _ = bench()
    cpu.call("Test_DB", 10, write=True)
    cpu.call("Test_DB", 10, write=False, length=8)
    assert [misuse.code for misuse in cpu.misuses] == ["PG830"]


def test_request_held():
    """REQ is TRUE in the first call only."""
    cpu, _, _ = bench()
    cpu.call("Test_DB", 10, write=True)
    cpu.call("Test_DB", 10)
    assert [misuse.code for misuse in cpu.misuses] == ["PG833"]
    assert "WRREC" in cpu.misuses[0].message


def test_changed_record():
    """Another buffer during a job is a misuse."""
    vars_ = CASE["vars"] + " other : Array[0..9] of Byte; f : Bool;"
    code = CASE["code"].split(";\n")[0].replace("RECORD := #q", "RECORD := #q")
    case = {**CASE, "vars": vars_, "code": f"IF #f THEN {code.replace('#q)', '#other)')}; ELSE {code}; END_IF;"}
    cpu, _, _ = bench(case)
    cpu.call("Test_DB", 10, write=True)
    cpu["Test_DB.f"] = True
    cpu.call("Test_DB", 10, write=False)
    assert [misuse.code for misuse in cpu.misuses] == ["PG830"]


def test_local_data_as_record():
    """VAR_TEMP is gone before the job ends."""
    case = {
        **CASE,
        "temp": "local : Array[0..9] of Byte;",
        "code": CASE["code"].replace("RECORD := #q", "RECORD := #local"),
    }
    cpu, _, _ = bench(case)
    cpu.call("Test_DB", 10, write=True)
    assert [misuse.code for misuse in cpu.misuses] == ["PG831"]


def test_status_after_its_scan():
    """STATUS counts in the call only."""
    call = "#w(REQ := TRUE, ID := 271, INDEX := 47, LEN := 10, RECORD := #q);"
    code = f"IF #write THEN\n{call}\nEND_IF;\n#status := #w.STATUS;"
    cpu, _, _ = bench({**CASE, "code": code})
    cpu.call("Test_DB", 10, write=True)
    assert cpu.misuses == []
    cpu.call("Test_DB", 10, write=False)
    assert [misuse.code for misuse in cpu.misuses] == ["PG832"]


def test_record_shorter_than_len():
    """LEN beyond RECORD is refused."""
    cpu, _, drive = bench()
    cpu.call("Test_DB", 10, write=True, length=11)
    assert outputs(cpu)[2] == 1
    assert drive.journal == []


def test_len_cuts_the_record():
    """A buffer longer than LEN: LEN bytes go out."""
    cpu, _, drive = bench()
    cpu.call("Test_DB", 10, write=True, length=8)
    for _ in range(2):
        cpu.call("Test_DB", 10, write=False)
    assert [len(entry.data) for entry in drive.journal] == [8]


TWO = {
    "in": "go : Bool;",
    "vars": "a : WRREC; b : WRREC; q : Array[0..9] of Byte; ea : Bool; eb : Bool; s : DWord;",
    "code": """#a(REQ := #go, ID := 271, INDEX := 47, LEN := 10, ERROR => #ea, RECORD := #q);
#b(REQ := #go, ID := 271, INDEX := 47, LEN := 10, ERROR => #eb, STATUS => #s, RECORD := #q);""",
}


@pytest.mark.parametrize(("limit", "expected"), [(1, (False, True, 0xC080C300)), (2, (False, False, 0x00700100))])
def test_job_limit(limit, expected):
    """One job too many ends with 80C3."""
    cpu, _, _ = bench(TWO, limit=limit)
    cpu.call("Test_DB", 10, go=True)
    assert (cpu["Test_DB.ea"], cpu["Test_DB.eb"], cpu["Test_DB.s"]) == expected
    assert cpu.jobs == limit


def test_limits_of_the_families():
    """Small CPUs run few jobs at once."""
    program = load(TWO)
    found = {name: Cpu(program, family=name).job_limit for name in ("s7-300", "s7-400", "s7-1200", "s7-1500")}
    assert found == {"s7-300": 4, "s7-400": 8, "s7-1200": 4, "s7-1500": 10}


def test_restart_drops_jobs():
    """After a restart the block answers that no job is active."""
    cpu, _, drive = bench()
    cpu.call("Test_DB", 10, write=True)
    cpu.restart("warm")
    assert cpu.jobs == 0
    cpu.call("Test_DB", 10, write=False)
    assert outputs(cpu) == (0, 0, 0, "00700000")
    assert drive.journal == []


def test_busy_for_ever_and_by_function():
    """None never ends; a function is asked for every job."""
    cpu, bus, _ = bench(busy=None)
    cpu.call("Test_DB", 10, write=True)
    for _ in range(100):
        cpu.call("Test_DB", 10, write=False)
    assert outputs(cpu)[1] == 1
    cpu.restart("cold")
    cpu["Test_DB.q"] = list(REQUEST)
    waits = iter([3, 0])
    bus.write_busy = lambda: next(waits)
    found = []
    for requested in (1, 0, 0, 0, 1):
        cpu.call("Test_DB", 10, write=bool(requested))
        found.append(outputs(cpu)[0])
    assert found == [0, 0, 0, 1, 1]


def test_the_clock_of_the_drive():
    """The drive's time is the CPU's."""
    cpu, _, drive = bench()
    for _ in range(3):
        cpu.scan(7)
    assert drive.time == 21
    assert cpu.clock == 21
