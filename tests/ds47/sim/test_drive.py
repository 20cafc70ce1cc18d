"""The state machine, STATUS codes, virtual time, saving, and the manuals' examples from end to end."""

import pytest

from plcgen.ds47.sim.behaviour import Behaviour
from plcgen.ds47.sim.drive import ChannelState, Drive, RecordExchange
from plcgen.ds47.sim.parameters import DriveObject, SimulatedParameter, ValueLimits
from plcgen.ds47.wire import formats

WORD = formats.by_name("Unsigned16")
REAL = formats.by_name("FloatingPoint")
READ = bytes.fromhex("01 01 01 01 10 01 00 01 00 00")
ANSWER = bytes.fromhex("01 01 01 01 06 01 00 05")


def drive(processing=0, **behaviour):
    """Return a drive with one parameter, p1 = 5."""
    return Drive(Behaviour(processing=processing, **behaviour), [DriveObject(1, {1: SimulatedParameter(1, WORD, [5])})])


def in_state(state):
    """Return a drive in the given state: 100 ms of processing."""
    unit = drive(100)
    if state is not ChannelState.IDLE:
        unit.write_record(47, READ)
    if state is ChannelState.AVAILABLE:
        unit.advance(100)
    assert unit.state is state
    return unit


@pytest.mark.parametrize(
    ("state", "write", "after_write", "read", "after_read"),
    [
        (ChannelState.IDLE, 0, ChannelState.PROCESSING, 0xDE80B500, ChannelState.IDLE),
        (ChannelState.PROCESSING, 0xDF80B500, ChannelState.PROCESSING, 0xDE80B500, ChannelState.PROCESSING),
        (ChannelState.AVAILABLE, 0, ChannelState.PROCESSING, 0, ChannelState.IDLE),
    ],
)
def test_state_machine(state, write, after_write, read, after_read):
    """WRREC and RDREC in each state give the STATUS and the next state of the table."""
    unit = in_state(state)
    assert unit.write_record(47, READ) == write
    assert unit.state is after_write
    unit = in_state(state)
    assert unit.read_record(47, 240)[0] == read
    assert unit.state is after_read


def test_response_is_read_once():
    """The second RDREC finds nothing."""
    unit = drive()
    assert unit.write_record(47, READ) == 0
    assert unit.read_record(47, 240) == (0, ANSWER)
    assert unit.read_record(47, 240) == (0xDE80B500, b"")


def test_unread_response_is_discarded():
    """WRREC while a response is available replaces it."""
    unit = drive()
    unit.write_record(47, READ)
    unit.write_record(47, b"\x02" + READ[1:])
    assert unit.read_record(47, 240) == (0, b"\x02" + ANSWER[1:])


def test_processing_takes_its_time():
    """The response is there after exactly the processing time, and the values are those of that moment."""
    unit = drive(100)
    unit.write_record(47, READ)
    unit.advance(99)
    assert unit.read_record(47, 240)[0] == 0xDE80B500
    unit.objects[1].parameters[1].values = [6]
    unit.advance(1)
    assert unit.read_record(47, 240) == (0, ANSWER[:-1] + b"\x06")


@pytest.mark.parametrize(
    ("index", "data", "status"),
    [
        (48, READ.hex(), 0xDF80B000),
        (0xB02E, READ.hex(), 0xDF80B000),
        (47, "", 0xDF80B100),
        (47, "01 01 01", 0xDF80B100),
        (47, READ.hex()[:-2], 0xDF80B100),
        (47, "01 02 01 02" + READ.hex()[8:], 0xDF80B100),
        (47, READ.hex() + "00" * 231, 0xDF80B100),
        (47, "00" + READ.hex()[2:], 0xDF80B700),
        (47, "01 01 01 00", 0xDF80B700),
        (0xB02F, READ.hex(), 0),
        (-20433, READ.hex(), 0),
        (47, READ.hex() + "00" * 230, 0),
    ],
)
def test_write_status(index, data, status):
    """B0h for a wrong record, B1h for a wrong length, B7h for a wrong header."""
    assert drive().write_record(index, bytes.fromhex(data)) == status


def test_refused_write_changes_nothing():
    """A refused WRREC leaves the unread response where it was."""
    unit = in_state(ChannelState.AVAILABLE)
    for index, data in ((1, READ), (47, b""), (47, bytes(4))):
        assert unit.write_record(index, data) != 0
    assert unit.read_record(47, 240) == (0, ANSWER)


def test_read_status():
    """B0h for a wrong record, B1h for too short a buffer; neither takes the response away."""
    unit = in_state(ChannelState.AVAILABLE)
    assert unit.read_record(1, 240)[0] == 0xDE80B000
    assert unit.read_record(47, 7)[0] == 0xDE80B100
    assert unit.read_record(47, 8) == (0, ANSWER)


def test_journal():
    """Every call is kept with its time, STATUS and bytes."""
    unit = drive(50)
    unit.write_record(47, READ)
    unit.read_record(47, 240)
    unit.advance(50)
    unit.read_record(47, 240)
    assert unit.journal == [
        RecordExchange(0, "write", 47, 0, READ),
        RecordExchange(0, "read", 47, 0xDE80B500, b""),
        RecordExchange(50, "read", 47, 0, ANSWER),
    ]


def test_references_wrap():
    """More than 255 jobs in a row, reference 255 followed by 1, are all mirrored."""
    unit = drive()
    for job in range(600):
        reference = job % 255 + 1
        assert unit.write_record(47, bytes((reference,)) + READ[1:]) == 0
        assert unit.read_record(47, 240)[1][0] == reference


def saving_drive():
    """Return a drive whose p971 and p977 save within 300 ms, for one object and the unit."""

    def item(number):
        own = SimulatedParameter(971, WORD, [0], clears_after=300, saves="object")
        unit = SimulatedParameter(977, WORD, [0], clears_after=300, saves="unit")
        return DriveObject(number, {1: SimulatedParameter(1, WORD, [5]), 971: own, 977: unit})

    return Drive(Behaviour(), [item(1), item(2)])


def change(unit, axis, pnu, value):
    """Change one word parameter and return the answer."""
    data = bytes((1, 2, axis, 1, 0x10, 1)) + pnu.to_bytes(2, "big") + bytes((0, 0, 6, 1))
    assert unit.write_record(47, data + value.to_bytes(2, "big")) == 0
    return unit.read_record(47, 240)[1]


@pytest.mark.parametrize(("save", "second"), [(971, 5), (977, 8)])
def test_saving(save, second):
    """Parameter 971 saves its drive object, 977 the unit; both return to 0, the unsaved is lost."""
    unit = saving_drive()
    change(unit, 1, 1, 7)
    change(unit, 2, 1, 8)
    assert change(unit, 1, save, 1) == bytes.fromhex("01 02 01 01")
    assert unit.saving
    assert change(unit, 2, 1, 9) == bytes.fromhex("01 82 02 01 44 02 00 11 00 00")
    unit.advance(299)
    assert unit.objects[1].parameters[save].values == [1]
    unit.advance(1)
    assert unit.objects[1].parameters[save].values == [0]
    assert not unit.saving
    unit.power_cycle()
    assert [unit.objects[n].parameters[1].values for n in (1, 2)] == [[7], [second]]


def test_power_cycle_without_saving():
    """Without a save the values before are back, and no response is left."""
    unit = saving_drive()
    change(unit, 1, 1, 7)
    unit.write_record(47, READ)
    unit.power_cycle()
    assert unit.objects[1].parameters[1].values == [5]
    assert unit.read_record(47, 240)[0] == 0xDE80B500


def real(pnu, *values):
    """Return a REAL parameter from 0.0 to 650.0; several values make an array."""
    return SimulatedParameter(pnu, REAL, list(values), array=len(values) > 1, limits=ValueLimits(0.0, 650.0))


def test_mm4_examples():
    """The MM4 guide's two requests produce exactly the guide's answers, byte for byte."""
    listed = [real(1120, 10.0), real(1121, 10.0), real(2155, 20.0, 30.0, 30.0)]
    behaviour = Behaviour(answer_format="size", error_words=1, aliases={1: 0})
    unit = Drive(behaviour, [DriveObject(0, {item.pnu: item for item in listed})])
    read = "01 01 00 02 10 00 04 60 00 00 10 02 08 6B 00 01"
    assert unit.write_record(47, bytes.fromhex(read)) == 0
    answer = "01 01 00 02 43 01 41 20 00 00 43 02 41 F0 00 00 41 F0 00 00"
    assert unit.read_record(47, 40) == (0, bytes.fromhex(answer))
    write = "02 02 00 02 10 01 04 60 00 00 10 01 04 61 00 00 08 01 41 30 00 00 08 01 41 B0 00 00"
    assert unit.write_record(47, bytes.fromhex(write)) == 0
    assert unit.read_record(47, 40) == (0, bytes.fromhex("02 02 00 02"))
    assert [item.values for item in listed[:2]] == [[11.0], [22.0]]


def test_dcm_examples():
    """The DCM FAQ's read of P50303 answers 10.0; its write of P50304 = 100.0 is acknowledged and kept."""
    listed = [real(50303, 10.0), real(50304, 10.0)]
    unit = Drive(Behaviour(), [DriveObject(2, {item.pnu: item for item in listed})])
    assert unit.write_record(47, bytes.fromhex("03 01 02 01 10 01 C4 7F 00 00")) == 0
    assert unit.read_record(47, 10) == (0, bytes.fromhex("03 01 02 01 08 01 41 20 00 00"))
    assert unit.write_record(47, bytes.fromhex("04 02 02 01 10 01 C4 80 00 00 08 01 42 C8 00 00")) == 0
    assert unit.read_record(47, 10) == (0, bytes.fromhex("04 02 02 01"))
    assert listed[1].values == [100.0]


def test_dcm_negative_answer_overruns_four_bytes():
    """A limit violation answers 10 bytes, so the FAQ's 4-byte DB6 ends RDREC with B1h."""
    unit = Drive(Behaviour(), [DriveObject(2, {50304: real(50304, 10.0)})])
    # 1000.0 = 447A0000h is over 650.0
    unit.write_record(47, bytes.fromhex("04 02 02 01 10 01 C4 80 00 00 08 01 44 7A 00 00"))
    assert unit.read_record(47, 4) == (0xDE80B100, b"")
    assert unit.read_record(47, 10) == (0, bytes.fromhex("04 82 02 01 44 02 00 02 00 00"))


def test_time_does_not_run_backwards():
    """A negative step is refused."""
    with pytest.raises(ValueError, match="-1 ms"):
        drive().advance(-1)


@pytest.mark.parametrize(("remaining", "present"), [(0, [0, 0]), (1, [7, 0])])
def test_acknowledging(remaining, present):
    """Each fault case becomes that of the one before it (S210: r0945); what has its cause still is present again."""
    codes = [7, 8, *[0] * 6, 9, *[0] * 7]
    acknowledges = SimulatedParameter(3981, WORD, [0], clears_after=300, acknowledges=True, remaining=remaining)
    changes, buffer = SimulatedParameter(944, WORD, [0xFFFF]), SimulatedParameter(945, WORD, codes, array=True)
    unit = Drive(Behaviour(), [DriveObject(1, {944: changes, 945: buffer, 3981: acknowledges})])
    change(unit, 1, 3981, 1)
    assert (acknowledges.values, buffer.values) == ([1], codes)
    unit.advance(300)
    assert (acknowledges.values, changes.values) == ([0], [0])
    assert buffer.values == [*present, *[0] * 6, 7, 8, *[0] * 6]
