"""LEAD_LAG, DCAT and MCAT: the values before and after a call that the help prints, and every row of its table."""

import pytest

from plcgen.s7.cpu.testing import load_scl

DIALECTS = ["tia-300", "tia-1500"]


def bench_of(kind, dialect, values):
    """An instance D.x with values in it, called once in the first scan."""
    text = f'FUNCTION_BLOCK "T"\nVAR\nx : {kind};\nEND_VAR\nBEGIN\n#x();\nEND_FUNCTION_BLOCK\n'
    bench = load_scl(f'{text}DATA_BLOCK "D"\n"T"\nBEGIN\nEND_DATA_BLOCK\n', dialect=dialect)
    for name, value in values.items():
        bench.cpu[f"D.x.{name}"] = value
    return bench


def found(bench, names):
    return {name: bench.cpu[f"D.x.{name}"] for name in names}


@pytest.mark.parametrize("dialect", DIALECTS)
def test_lead_lag(dialect):
    """Help of LEAD_LAG, example: 2.0 out of 6.0 and 2.0; a gain of 0 is error 9 and calculates nothing."""
    before = {"IN": 2.0, "SAMPLE_T": 10, "LD_TIME": 2.0, "LG_TIME": 2.0, "GAIN": 1.0, "PREV_IN": 6.0, "PREV_OUT": 6.0}
    bench = bench_of("LEAD_LAG", dialect, before)
    bench.call("D")
    after = {"OUT": 2.0, "PREV_IN": 2.0, "PREV_OUT": 2.0, "ERR_CODE": 0}
    assert found(bench, after) == after
    bench.cpu["D.x.GAIN"] = 0.0
    bench.cpu["D.x.IN"] = 9.0
    bench.call("D")
    assert found(bench, after) == {**after, "ERR_CODE": 9}


@pytest.mark.parametrize("dialect", DIALECTS)
def test_discrete_control_timer_alarm(dialect):
    """Help of DCAT, example; then 222 ms without feedback are an alarm, which the feedback ends."""
    bench = bench_of("DCAT", dialect, {"CMD": True, "ET": 12, "PT": 222})
    bench.call("D")
    after = {"Q": True, "OA": False, "CA": False, "ET": 0, "CMD_HIS": True}
    assert found(bench, after) == after
    bench.call("D", 222)
    assert found(bench, ["ET", "OA"]) == {"ET": 222, "OA": False}
    bench.call("D", 1)
    assert bench.cpu["D.x.OA"] is True
    bench.cpu["D.x.O_FB"] = True
    bench.call("D")
    assert found(bench, ["ET", "OA"]) == {"ET": 222, "OA": False}


INPUTS = "O_HIS C_HIS O_CMD C_CMD S_CMD O_FB C_FB".split()
OUTPUTS = "OO CO OA CA O_HIS C_HIS Q".split()
ROWS = [  # ET, inputs, outputs, ET behind it: the rows of the help in order, PT is 22, 10 ms pass in the second scan
    (5, "1100000", "0011000", 22), (5, "0000011", "0011000", 22), (5, "1011100", "0000001", 5),
    (5, "0011000", "0000001", 5), (5, "0010000", "1000101", 0), (5, "1000000", "1000101", 15),
    (5, "1000010", "0000101", 22), (22, "1000000", "0010100", 22), (5, "0001000", "0100011", 0),
    (5, "0100000", "0100011", 15), (5, "0100001", "0000011", 22), (22, "0100000", "0001010", 22),
    (5, "0000000", "0000001", 5),
]  # fmt: skip


@pytest.mark.parametrize("dialect", DIALECTS)
@pytest.mark.parametrize("row", ROWS, ids=[row[1] for row in ROWS])
def test_motor_control_timer_alarm(row, dialect):
    """Each row of the table in the help of MCAT."""
    elapsed, inputs, outputs, behind = row
    bench = bench_of("MCAT", dialect, {})
    bench.call("D")
    for name, state in zip(INPUTS, inputs, strict=True):
        bench.cpu[f"D.x.{name}"] = state == "1"
    bench.cpu["D.x.ET"], bench.cpu["D.x.PT"] = elapsed, 22
    bench.call("D", 10)
    assert "".join("1" if bench.cpu[f"D.x.{name}"] else "0" for name in OUTPUTS) == outputs
    assert bench.cpu["D.x.ET"] == behind
