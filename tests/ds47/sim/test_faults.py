"""Every fault, its counting, and its end."""

import pytest

from plcgen.ds47.sim.behaviour import Behaviour
from plcgen.ds47.sim.drive import ChannelState, Drive
from plcgen.ds47.sim.faults import Fault, FaultKind
from plcgen.ds47.sim.parameters import DriveObject, SimulatedParameter
from plcgen.ds47.wire import formats

WORD = formats.by_name("Unsigned16")
READ = bytes.fromhex("07 01 01 01 10 01 00 01 00 00")
ANSWER = bytes.fromhex("07 01 01 01 06 01 00 05")


def drive(*faults, **behaviour):
    """Return a drive with p1 = 5 and p2 = 6 that shows these faults."""
    listed = {n: SimulatedParameter(n, WORD, [n + 4]) for n in (1, 2)}
    return Drive(Behaviour(**behaviour), [DriveObject(1, listed)], faults)


def run(unit, data=READ):
    """Write and read once; return both STATUS values and the response."""
    written = unit.write_record(47, data)
    return (written, *unit.read_record(47, 240))


DAMAGED = [
    (Fault(FaultKind.REFERENCE), "08 01 01 01 06 01 00 05"),
    (Fault(FaultKind.REFERENCE, value=0), "00 01 01 01 06 01 00 05"),
    (Fault(FaultKind.RESPONSE_ID), "07 02 01 01 06 01 00 05"),
    (Fault(FaultKind.RESPONSE_ID, value=0x81), "07 81 01 01 06 01 00 05"),
    (Fault(FaultKind.DRIVE_OBJECT), "07 01 02 01 06 01 00 05"),
    (Fault(FaultKind.COUNT), "07 01 01 02 06 01 00 05"),
    (Fault(FaultKind.FORMAT), "07 01 01 01 0E 01 00 05"),
    (Fault(FaultKind.FORMAT, value=8), "07 01 01 01 08 01 00 05"),
    (Fault(FaultKind.CUT), "07 01 01 01 06 01 00"),
    (Fault(FaultKind.CUT, value=0), ""),
    (Fault(FaultKind.CUT, value=3), "07 01 01"),
    (Fault(FaultKind.JUNK), "DE AD BE EF 00 FF 55 AA"),
    (Fault(FaultKind.JUNK, data=b"\x01\x02"), "01 02"),
    (Fault(FaultKind.STALE), "06 01 01 01 06 01 00 05"),
    (Fault(FaultKind.ERROR, number=0x6B), "07 81 01 01 44 02 00 6B 00 00"),
    (Fault(FaultKind.ERROR, number=0x03, info=5), "07 81 01 01 44 02 00 03 00 05"),
    (Fault(FaultKind.ERROR, number=0x02, words=1), "07 81 01 01 44 01 00 02"),
    (Fault(FaultKind.ERROR, number=0x19, position=0), "07 81 01 01 44 02 00 19 00 00"),
]


@pytest.mark.parametrize(("fault", "answer"), DAMAGED, ids=lambda item: getattr(item, "kind", None))
def test_spoiled_response(fault, answer):
    """The response is wrong in exactly the way asked for, once; the next one is right."""
    unit = drive(Fault(**{name: getattr(fault, name) for name in fault.__slots__}))
    assert run(unit) == (0, 0, bytes.fromhex(answer))
    assert unit.faults == []
    assert run(unit) == (0, 0, ANSWER)


def test_stale_answer_is_the_one_before():
    """A stale answer repeats the bytes delivered last; reference 1 without one comes as 255."""
    unit = drive(Fault(FaultKind.STALE, after=1))
    run(unit)
    assert run(unit, b"\x08" + READ[1:]) == (0, 0, ANSWER)
    assert run(drive(Fault(FaultKind.STALE)), b"\x01" + READ[1:])[2][0] == 255


def test_reference_wraps():
    """The wrong reference after 255 is 1, never the reserved 0."""
    assert run(drive(Fault(FaultKind.REFERENCE)), b"\xff" + READ[1:])[2][0] == 1


@pytest.mark.parametrize("code", [0xB5, 0xA7, 0xC0, 0xC3])
def test_busy(code):
    """Busy n times: the calls end with the code, the next one succeeds and nothing is lost."""
    unit = drive(Fault(FaultKind.BUSY, times=2, call="write", code=code), Fault(FaultKind.BUSY, times=2, code=code))
    assert [unit.write_record(47, READ) for _ in range(3)] == [0xDF800000 | code << 8] * 2 + [0]
    assert [unit.read_record(47, 240)[0] for _ in range(3)] == [0xDE800000 | code << 8] * 2 + [0]


def test_status_for_ever():
    """Any STATUS, on one service only, forever."""
    unit = drive(Fault(FaultKind.STATUS, times=None, call="write", status=0xC0809000))
    assert {unit.write_record(47, READ) for _ in range(50)} == {0xC0809000}
    assert unit.read_record(47, 240)[0] == 0xDE80B500
    assert len(unit.faults) == 1


def test_restart_status_on_read():
    """80A0 on RDREC once: the response is still there afterwards."""
    unit = drive(Fault(FaultKind.STATUS, status=0xDE80A000))
    assert run(unit) == (0, 0xDE80A000, b"")
    assert unit.read_record(47, 240) == (0, ANSWER)


def test_after():
    """A fault with after lets that many occasions pass."""
    unit = drive(Fault(FaultKind.COUNT, after=2))
    assert [run(unit)[2][3] for _ in range(4)] == [1, 1, 2, 1]


def test_late():
    """A late response comes that many milliseconds after the processing time."""
    unit = drive(Fault(FaultKind.LATE, milliseconds=500), processing=20)
    unit.write_record(47, READ)
    unit.advance(519)
    assert unit.state is ChannelState.PROCESSING
    unit.advance(1)
    assert unit.read_record(47, 240) == (0, ANSWER)
    unit.write_record(47, READ)
    unit.advance(20)
    assert unit.state is ChannelState.AVAILABLE


def test_silence():
    """A swallowed request is acknowledged, never answered and never executed; the next one is."""
    unit = drive(Fault(FaultKind.SILENCE))
    change = bytes.fromhex("01 02 01 01 10 01 00 01 00 00 06 01 00 09")
    assert run(unit, change) == (0, 0xDE80B500, b"")
    unit.advance(3_600_000)
    assert unit.read_record(47, 240)[0] == 0xDE80B500
    assert unit.objects[1].parameters[1].values == [5]
    assert run(unit, change)[1] == 0
    assert unit.objects[1].parameters[1].values == [9]


def test_error_at_a_position():
    """An error at position 2 leaves parameter 1 written and answers 40 00 for it."""
    unit = drive(Fault(FaultKind.ERROR, number=0x11, position=2))
    change = bytes.fromhex("01 02 01 02 10 01 00 01 00 00 10 01 00 02 00 00 06 01 00 09 06 01 00 09")
    assert run(unit, change)[2] == bytes.fromhex("01 82 01 02 40 00 44 02 00 11 00 00")
    assert [unit.objects[1].parameters[n].values for n in (1, 2)] == [[9], [6]]


def test_error_behind_the_last_parameter_waits():
    """An error at position 2 does not strike a request with one parameter, it waits for one with two."""
    unit = drive(Fault(FaultKind.ERROR, number=0x11, position=2))
    assert run(unit)[2] == ANSWER
    two = bytes.fromhex("01 01 01 02 10 01 00 01 00 00 10 01 00 02 00 00")
    assert run(unit, two)[2] == bytes.fromhex("01 81 01 02 06 01 00 05 44 02 00 11 00 00")


def test_wrong_format_needs_a_block():
    """A positive change response has no block, so there is nothing to damage."""
    change = bytes.fromhex("01 02 01 01 10 01 00 01 00 00 06 01 00 09")
    assert run(drive(Fault(FaultKind.FORMAT)), change)[2] == bytes.fromhex("01 02 01 01")


def test_several_faults():
    """Two faults on one response both show."""
    unit = drive(Fault(FaultKind.DRIVE_OBJECT, value=9), Fault(FaultKind.CUT, value=4))
    assert run(unit)[2] == bytes.fromhex("07 01 09 01")


def test_silence_discards_the_unread_response():
    """The swallowed request was accepted, so the response before it is gone."""
    unit = drive(Fault(FaultKind.SILENCE, after=1))
    unit.write_record(47, READ)
    unit.write_record(47, READ)
    assert unit.read_record(47, 240) == (0xDE80B500, b"")
