"""WRREC and RDREC call by call: STATUS, one-call flags, snapshot, limits, restart, misuse."""

import pytest

from plcgen.ds47.sim.behaviour import Behaviour
from plcgen.ds47.sim.drive import Drive
from plcgen.ds47.sim.parameters import DriveObject, SimulatedParameter
from plcgen.ds47.wire import formats
from plcgen.s7.cpu.cpu import Cpu
from plcgen.s7.cpu.program import Program
from plcgen.s7.cpu.system.port import Periphery
from plcgen.s7.cpu.system.record import PLACES, RecordPlaces
from plcgen.s7.scl.dialect import Dialect
from tests.s7.cpu.support import load

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


def bench(case=None, *, busy=2, limit=None, request=True):
    """CPU, bus and a drive with p1 = 5 at 271."""
    drive = Drive(Behaviour(), [DriveObject(1, {1: SimulatedParameter(1, formats.by_name("Unsigned16"), [5])})])
    bus = Periphery(write_busy=busy, read_busy=busy)
    bus.attach(271, drive)
    cpu = Cpu(load(case or CASE), bus, job_limit=limit)
    cpu.scan(0)
    if request:
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


@pytest.mark.parametrize(("dialect", "expected"), [("T3", ["PG830"]), ("T15", [])])
def test_changed_target(dialect, expected):
    """S7-300/400: what RDREC reads into must not change meanwhile either (help of RDREC); of others nothing is said."""
    modern = dialect == "T15"
    case = {
        "dialect": dialect, "in": "read : Bool;", "vars": "r : RDREC; a : Array[0..19] of Byte;",
        "code": f"#r(REQ := #read, ID := {'271' if modern else 'DW#16#10F'}, INDEX := 47, MLEN := 20, RECORD := #a);",
    }  # fmt: skip
    cpu, _, _ = bench(case, request=False)
    cpu.call("Test_DB", 10, read=True)
    cpu["Test_DB.a[3]"] = 2
    cpu.call("Test_DB", 10, read=False)
    assert [misuse.code for misuse in cpu.misuses] == expected


def test_request_held():
    """REQ starts a job only when none runs; held, it starts the next one right behind the end (help, parameter REQ)."""
    cpu, _, drive = bench()
    found = []
    for _ in range(5):
        cpu.call("Test_DB", 10, write=True)
        found.append(outputs(cpu)[3])
    assert found == ["00700100", "00700200", "00000000", "00700100", "00700200"]
    assert len(drive.journal) == 1
    assert cpu.misuses == []


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
    """Record jobs at once, entry 15364459: in total on small CPUs, of WRREC and RDREC each on large ones."""
    figures = {name: (places.total, places.each) for name, places in PLACES.items()}
    assert figures == {
        "s7-300": (4, None), "s7-317": (8, None), "s7-400": (None, 8), "s7-1200": (4, None), "s7-1500": (None, 10),
        "s7-1500-v2": (None, 20),
    }  # fmt: skip
    program = load(TWO)
    assert all(Cpu(program, family=name).records.places is PLACES[name] for name in PLACES if name in FAMILIES)


FAMILIES = ("s7-300", "s7-400", "s7-1200", "s7-1500")


@pytest.mark.parametrize(
    ("places", "read"),
    [(RecordPlaces(total=1), "C080C300"), (RecordPlaces(each=1), "00700100"), (RecordPlaces(total=2), "00700100")],
)
def test_places(places, read):
    """A place in total is taken by either block, one of each kind only by its own."""
    case = {**CASE, "code": CASE["code"].replace("VALID => #valid", "STATUS => #status, VALID => #valid")}
    cpu, _, _ = bench(case, limit=places)
    cpu.call("Test_DB", 10, write=True, read=True)
    assert f"{cpu['Test_DB.status']:08X}" == read


@pytest.mark.parametrize(("reported", "second"), [(True, True), (False, False)])
def test_when_a_place_is_free_again(reported, second):
    """Until a call has reported the end (BUSY is 1 till then), or until the job has been processed."""
    calls = """IF #first THEN
#a(REQ := TRUE, ID := 271, INDEX := 47, LEN := 10, RECORD := #q);
END_IF;
#b(REQ := NOT #first, ID := 271, INDEX := 47, LEN := 10, ERROR => #eb, RECORD := #q);"""
    case = {**TWO, "in": "first : Bool;", "code": calls}
    cpu, _, _ = bench(case, limit=RecordPlaces(each=1, until_reported=reported))
    cpu.call("Test_DB", 10, first=True)
    for _ in range(3):
        cpu.scan(10)
    cpu.call("Test_DB", 10, first=False)
    assert cpu["Test_DB.eb"] is second


@pytest.mark.parametrize(("family", "status"), [("s7-1500", "C080C300"), ("s7-1200", "00700000")])
def test_no_place_for_a_call_without_request(family, status):
    """An S7-1500 answers 80C3 to REQ = 0 too while all places are taken (help, note on REQ = 0)."""
    case = {**CASE, "code": CASE["code"].replace("VALID => #valid", "STATUS => #status, VALID => #valid")}
    cpu = Cpu(load(case), bench()[1], family=family, job_limit=RecordPlaces(total=1))
    cpu.call("Test_DB", 10, write=True)
    assert f"{cpu['Test_DB.status']:08X}" == status


def test_a_job_goes_on_without_calls():
    """The CPU ends a job on its own; the next call, whenever it comes, reports that once."""
    cpu, _, drive = bench(busy=2)
    cpu.call("Test_DB", 10, write=True)
    found = []
    for _ in range(4):
        cpu.scan(10)
        found.append(len(drive.journal))
    assert found == [0, 1, 1, 1]
    for expected in [(1, 0, 0, "00000000"), (0, 0, 0, "00700000")]:
        cpu.call("Test_DB", 10, write=False)
        assert outputs(cpu) == expected


def test_calls_do_not_end_a_job():
    """Five calls in one scan: the job takes as long as before."""
    cpu, _, drive = bench(busy=2)
    cpu.call("Test_DB", 10, write=True)
    cpu["Test_DB.write"] = False
    for _ in range(5):
        cpu.function("Test")(cpu.db("Test_DB"))
        assert outputs(cpu) == (0, 1, 0, "00700200")
    assert drive.journal == []


def test_a_read_answers_when_it_ends():
    """What the drive has when the job ends comes into RECORD at the call that reports it, not before."""
    cpu, _, drive = bench(busy=0)
    cpu.call("Test_DB", 10, write=True)
    cpu.call("Test_DB", 10, write=False)
    cpu.bus.read_busy = 2
    cpu.call("Test_DB", 10, read=True)
    cpu.scan(10, 3)
    assert [exchange.direction for exchange in drive.journal] == ["write", "read"]
    assert bytes(cpu["Test_DB.a"][:8]) == bytes(8)
    cpu.call("Test_DB", 10, read=False)
    assert bytes(cpu["Test_DB.a"][:8]) == ANSWER


def test_jobs_in_milliseconds():
    """25 ms are over in the third scan of 10 ms, or in the first of 30 ms."""
    for length, scans in ((10, 3), (30, 1)):
        cpu, bus, drive = bench()
        bus.write_time = 25
        cpu.call("Test_DB", 10, write=True)
        cpu["Test_DB.write"] = False
        found = 0
        while not drive.journal:
            cpu.scan(length)
            found += 1
        assert found == scans


@pytest.mark.parametrize(
    ("network", "length", "status"),
    [("profinet", 40, 0), ("profibus", 40, 20), ("profibus", 15, 15), ("profibus", 20, 0), ("profibus", 8, 0)],
)
def test_lengths_of_a_read(network, length, status):
    """MLEN longer than RECORD (20 bytes) is a misuse, no error; on PROFIBUS STATUS[4] is the RECORD's length then.

    Help, RDREC: "Select the target range RECORD at least MLEN bytes long". STATUS[4] is MLEN if the record (8 bytes) is
    shorter and RECORD longer than MLEN (help, "Field element STATUS[4]").
    """
    code = CASE["code"].replace("VALID => #valid", "STATUS => #readStatus, VALID => #valid")
    case = {**CASE, "out": CASE["out"] + " readStatus : DWord;", "code": code.replace("MLEN := 20", "MLEN := #mlen")}
    case["in"] += " mlen : UInt;"
    cpu, bus, _ = bench(case, busy=0)
    bus.network, bus.read_busy = network, 2
    cpu["Test_DB.q"] = list(REQUEST)
    cpu.call("Test_DB", 10, write=True, mlen=length)
    cpu.call("Test_DB", 10, write=False, read=True)
    for _ in range(2):
        cpu.call("Test_DB", 10, read=False)
    assert (cpu["Test_DB.valid"], cpu["Test_DB.readStatus"], cpu["Test_DB.count"]) == (True, status, 8)
    assert [misuse.code for misuse in cpu.misuses] == (["PG658"] if length > 20 else [])


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


RECORDS = """DATA_BLOCK DB13
STRUCT q : ARRAY[0..19] OF BYTE; a : ARRAY[0..19] OF BYTE; END_STRUCT
BEGIN
END_DATA_BLOCK
FUNCTION_BLOCK FB1
VAR_INPUT
buffer : BLOCK_DB; write : BOOL; read : BOOL;
END_VAR
VAR
w : SFB53; r : SFB52;
END_VAR
VAR_TEMP
p : ANY;
v AT p : STRUCT id : BYTE; typ : BYTE; n : INT; db : WORD; adr : DWORD; END_STRUCT;
END_VAR
BEGIN
v.id := B#16#10; v.typ := B#16#02; v.n := 10; v.db := BLOCK_DB_TO_WORD(buffer); v.adr := DW#16#84000000;
w(REQ := write, ID := DW#16#10F, INDEX := 47, LEN := 10, RECORD := p);
v.n := 20; v.adr := SHL(IN := DW#16#14, N := 3) OR DW#16#84000000;
r(REQ := read, ID := DW#16#10F, INDEX := 47, MLEN := 20, RECORD := p);
END_FUNCTION_BLOCK
FUNCTION_BLOCK FB2
VAR_INPUT
buffer : BLOCK_DB; write : BOOL; read : BOOL;
END_VAR
VAR
pad : BOOL; one : FB1;
END_VAR
BEGIN
one(buffer := buffer, write := write, read := read);
END_FUNCTION_BLOCK
DATA_BLOCK DB2 FB2
BEGIN
END_DATA_BLOCK
ORGANIZATION_BLOCK OB1
BEGIN
FB2.DB2(buffer := DB13);
END_ORGANIZATION_BLOCK
"""


@pytest.mark.parametrize("interrupt", [None, {}])
def test_a_built_any_as_record(interrupt):
    """An ANY in VAR_TEMP with the number of the buffer's block, in a multi-instance in a multi-instance.

    DB13 holds the request from byte 0 on; the answer comes to byte 20 (14h) on.
    """
    _, bus, drive = bench()
    cpu = Cpu(Program.load([("t.scl", RECORDS)], Dialect.STEP7_V5, litter=True), bus)
    cpu["DB13.q"] = list(REQUEST)
    for write, read in [(1, 0), (0, 0), (0, 0), (0, 1), (0, 0), (0, 0)]:
        cpu["DB2.write"], cpu["DB2.read"] = bool(write), bool(read)
        cpu.run("OB1", 10, interrupt)
    assert [exchange.direction for exchange in drive.journal] == ["write", "read"]
    assert drive.journal[0].data == REQUEST
    assert bytes(cpu.db(13)[20:28]) == ANSWER
    assert (cpu["DB2.one.r.VALID"], cpu["DB2.one.r.LEN"], cpu.misuses) == (True, 8, [])
