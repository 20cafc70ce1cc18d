"""Restart, download in mid job, and the state of a CPU taken and put back."""

import pytest

from plcgen.s7.cpu.cpu import Cpu
from plcgen.s7.cpu.state import freeze, thaw
from plcgen.s7.cpu.testing import load_scl
from tests.s7.cpu.support import load
from tests.s7.cpu.test_record import REQUEST, bench, outputs

TICKS = {"dialect": "V5", "vars": "t : TIME; n : INT;", "code": "t := TIME_TCK(); n := n + 1;"}


@pytest.mark.parametrize(("kind", "kept"), [("warm", 4), ("cold", 1)])
def test_restart_of_a_classic_cpu(kind, kept):
    """Every value of a data block stays in a warm restart; TIME_TCK is deleted in both (help of TIME_TCK)."""
    cpu = Cpu(load(TICKS))
    cpu.call("Test_DB", 1000)
    assert cpu["Test_DB.t"] == 1000
    cpu.call("Test_DB", 1000)
    cpu.call("Test_DB", 1000)
    cpu.restart(kind)
    cpu.call("Test_DB", 10)
    assert (cpu["Test_DB.t"], cpu["Test_DB.n"]) == (10, kept)


def test_a_record_job_is_gone_after_a_warm_restart():
    """The instance of SFB53 keeps its bytes, BUSY too; the job does not exist any more: REQ = 0 gives 7000."""
    case = {
        "dialect": "V5",
        "in": "go : BOOL;",
        "out": "busy : BOOL; status : DWORD;",
        "vars": "w : SFB53; q : ARRAY[0..9] OF BYTE;",
        "code": "w(REQ := go, ID := DW#16#10F, INDEX := 47, LEN := 10, RECORD := q);\n"
        "busy := w.BUSY; status := w.STATUS;",
    }
    _, bus, drive = bench()
    cpu = Cpu(load(case), bus)
    cpu.call("Test_DB", 10, go=True)
    assert cpu["Test_DB.busy"]
    cpu.restart("warm")
    assert cpu["Test_DB.w.BUSY"]
    cpu.call("Test_DB", 10, go=False)
    assert (cpu["Test_DB.busy"], cpu["Test_DB.status"]) == (False, 0x00700000)
    cpu.scan(10, 5)
    assert drive.journal == []


MODERN = """DATA_BLOCK "Some"
{ S7_Optimized_Access := 'TRUE' }
VAR
a : Bool := TRUE; b : Int := 3;
END_VAR
VAR RETAIN
c : Bool := TRUE; d : Int := 4;
END_VAR
BEGIN
END_DATA_BLOCK
FUNCTION_BLOCK "Fb"
{ S7_Optimized_Access := 'TRUE' }
VAR_OUTPUT
o : Int;
END_VAR
VAR RETAIN
r : Int := 5;
END_VAR
VAR
s : Int := 6;
END_VAR
BEGIN
#o := 1;
END_FUNCTION_BLOCK
DATA_BLOCK "Fb_DB"
{ S7_Optimized_Access := 'TRUE' }
"Fb"
BEGIN
s := 7;
END_DATA_BLOCK
"""


def test_retentive_sections():
    """Where sections are RETAIN only these stay; a block's own start value of an instance counts."""
    cpu = load_scl(MODERN).cpu
    for path, value in {"Some.a": False, "Some.b": 1, "Some.c": False, "Some.d": 1, "Fb_DB.r": 1, "Fb_DB.s": 1}.items():
        cpu[path] = value
    cpu.restart("warm")
    found = [cpu[path] for path in ("Some.a", "Some.b", "Some.c", "Some.d", "Fb_DB.r", "Fb_DB.s")]
    assert found == [True, 3, False, 1, 1, 7]


def test_download_in_mid_job():
    """An instance is loaded again while its WRREC runs: start values, no job; the telegram still arrives."""
    cpu, _, drive = bench(busy=3)
    cpu.call("Test_DB", 10, write=True)
    cpu.download("Test_DB")
    assert cpu["Test_DB.w.BUSY"] is False
    cpu.call("Test_DB", 10, write=False)
    assert outputs(cpu) == (0, 0, 0, "00700000")
    cpu.scan(10, 3)
    assert [exchange.data for exchange in drive.journal] == [REQUEST]
    cpu.call("Test_DB", 10)
    assert outputs(cpu) == (0, 0, 0, "00700000")


def test_what_was_left_takes_a_place_until_it_is_processed():
    """A job without an instance has nobody to report to."""
    cpu, _, _ = bench(busy=3, limit=1)
    cpu.call("Test_DB", 10, write=True)
    cpu.download("Test_DB")
    cpu["Test_DB.q"] = list(REQUEST)
    found = []
    for _ in range(3):
        cpu.call("Test_DB", 10, write=True)
        found.append(outputs(cpu)[3])
    assert found == ["C080C300", "C080C300", "00700100"]


def test_download_of_several_blocks():
    """Blocks named together have their start values before anything runs; an unknown one leaves all as they are."""
    cpu = load_scl(MODERN).cpu
    cpu["Some.b"], cpu["Fb_DB.s"] = 1, 1
    with pytest.raises(KeyError, match="Nobody"):
        cpu.download("Some", "Nobody")
    assert cpu["Some.b"] == 1
    cpu.download("Some", "Fb_DB")
    assert (cpu["Some.b"], cpu["Fb_DB.s"]) == (3, 7)


def test_a_state_is_put_back():
    """Memory, clock, running jobs and misuses are those of before; the job ends again."""
    cpu, _, drive = bench(busy=2)
    cpu.call("Test_DB", 10, write=True)
    state = freeze(cpu)
    for _ in range(2):
        cpu.call("Test_DB", 10, write=False)
        assert cpu.clock > 10
        cpu.call("Test_DB", 10)
        assert outputs(cpu)[:2] == (1, 0)
        thaw(cpu, state)
        assert (cpu.clock, cpu.jobs, cpu["Test_DB.w.BUSY"]) == (10, 1, True)
    assert len(drive.journal) == 2
