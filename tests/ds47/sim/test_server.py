"""The order of checks, with requests and answers written by hand."""

import pytest

from plcgen.ds47.sim.behaviour import Behaviour
from plcgen.ds47.sim.drive import Drive
from plcgen.ds47.sim.parameters import Condition, DriveObject, SimulatedParameter, ValueLimits
from plcgen.ds47.wire import formats

WORD = formats.by_name("Unsigned16")
BYTE = formats.by_name("Unsigned8")
REAL = formats.by_name("FloatingPoint")
TEXT = formats.by_name("VisibleString")


def parameters():
    """Return the parameters of drive object 1: one for each branch."""
    running = Condition(0x11, while_in=frozenset({"running"}))
    quick = Condition(0x70, unless_in=frozenset({"quick"}))
    secret = Condition(0x10, while_in=frozenset({"protected"}), read=True)
    listed = [
        SimulatedParameter(1, WORD, [5], limits=ValueLimits(0, 100), state_limits={"running": ValueLimits(10, 20)}),
        SimulatedParameter(2, WORD, [7], read_only=True, texts=("off", "on")),
        SimulatedParameter(3, WORD, [0], reset_only=True),
        SimulatedParameter(4, WORD, [1], allowed=frozenset({1, 2, 4})),
        SimulatedParameter(5, WORD, [10, 20, 30], array=True, limits=ValueLimits(0, 99)),
        SimulatedParameter(6, WORD, [9], conditions=(running,)),
        SimulatedParameter(7, WORD, [9], conditions=(quick,)),
        SimulatedParameter(8, REAL, [1.5], limits=ValueLimits(0.0, 100.0), name="Speed"),
        SimulatedParameter(9, TEXT, ["abcde"], described=False),
        SimulatedParameter(10, BYTE, [1, 2, 3], array=True),
        SimulatedParameter(11, WORD, [3], conditions=(secret,)),
    ]
    return {item.pnu: item for item in listed}


def drive(state="ready", **behaviour):
    """Return a drive with object 1 in this state and object 2 holding one parameter."""
    second = DriveObject(2, {1: SimulatedParameter(1, WORD, [0x2222])})
    return Drive(Behaviour(**behaviour), [DriveObject(1, parameters(), state), second])


def ask(unit, request, index=47):
    """Return the answer to a request as upper-case hex."""
    status = unit.write_record(index, bytes.fromhex(request))
    assert status == 0, f"{status:08X}"
    status, data = unit.read_record(index, 240)
    assert status == 0, f"{status:08X}"
    return data.hex(" ").upper()


ORDER = {
    # request id 05h is unknown, although the drive object 9 does not exist either: 21h wins
    "request id before drive object": ("01 05 09 01", "01 80 09 01 44 01 00 21"),
    "manufacturer's request id": ("01 40 01 01", "01 80 01 01 44 01 00 21"),
    "drive object before address": ("01 01 09 01 99 01 00 00 00 00", "01 81 09 01 44 02 00 19 00 00"),
    "drive object of a change": (
        "01 02 09 01 10 01 00 01 00 00 06 01 00 01",
        "01 82 09 01 44 02 00 19 00 00",
    ),
    "attribute": ("01 01 01 01 20 01 00 01 00 00", "01 81 01 01 44 02 00 16 00 00"),
    "attribute before unknown PNU": ("01 01 01 01 30 01 7F FF 00 00", "01 81 01 01 44 02 00 16 00 00"),
    "elements over 234": ("01 01 01 01 10 EB 00 05 00 00", "01 81 01 01 44 02 00 16 00 00"),
    "PNU 0": ("01 01 01 01 10 01 00 00 00 00", "01 81 01 01 44 02 00 16 00 00"),
    "subindex FFFF": ("01 01 01 01 10 01 00 05 FF FF", "01 81 01 01 44 02 00 16 00 00"),
    "unknown PNU before subindex": ("01 01 01 01 10 05 7F FF 00 09", "01 81 01 01 44 02 00 00 00 00"),
    "subindex of a simple parameter": ("01 01 01 01 10 01 00 01 00 01", "01 81 01 01 44 02 00 04 00 00"),
    "elements of a simple parameter": ("01 01 01 01 10 02 00 01 00 00", "01 81 01 01 44 02 00 04 00 00"),
    "first missing element": ("01 01 01 01 10 02 00 05 00 02", "01 81 01 01 44 02 00 03 00 03"),
    "subindex far behind": ("01 01 01 01 10 01 00 05 00 07", "01 81 01 01 44 02 00 03 00 07"),
    "read-only before type": (
        "01 02 01 01 10 01 00 02 00 00 08 01 00 00 00 00",
        "01 82 01 01 44 02 00 01 00 00",
    ),
    "unknown format": ("01 02 01 01 10 01 00 01 00 00 0E 01 00 01", "01 82 01 01 44 02 00 17 00 00"),
    "error format": ("01 02 01 01 10 01 00 01 00 00 44 01 00 01", "01 82 01 01 44 02 00 17 00 00"),
    "count against elements": (
        "01 02 01 01 10 01 00 01 00 00 06 02 00 01 00 02",
        "01 82 01 01 44 02 00 18 00 00",
    ),
    "elements 0 with two values": (
        "01 02 01 01 10 00 00 01 00 00 06 02 00 01 00 02",
        "01 82 01 01 44 02 00 18 00 00",
    ),
    "type of another size": (
        "01 02 01 01 10 01 00 01 00 00 08 01 00 00 00 00",
        "01 82 01 01 44 02 00 05 00 00",
    ),
    "another type of the same size": (
        "01 02 01 01 10 01 00 01 00 00 03 01 00 01",
        "01 82 01 01 44 02 00 05 00 00",
    ),
    "high limit": ("01 02 01 01 10 01 00 01 00 00 06 01 00 65", "01 82 01 01 44 02 00 02 00 00"),
    "limit of the second element": (
        "01 02 01 01 10 02 00 05 00 01 06 02 00 01 00 64",
        "01 82 01 01 44 02 00 02 00 02",
    ),
    "NaN has no place in a range": (
        "01 02 01 01 10 01 00 08 00 00 08 01 7F C0 00 00",
        "01 82 01 01 44 02 00 02 00 00",
    ),
    "low limit of a REAL": (
        "01 02 01 01 10 01 00 08 00 00 08 01 BF 80 00 00",
        "01 82 01 01 44 02 00 02 00 00",
    ),
    "value between allowed ones": (
        "01 02 01 01 10 01 00 04 00 00 06 01 00 03",
        "01 82 01 01 44 02 00 14 00 00",
    ),
    "reset only": ("01 02 01 01 10 01 00 03 00 00 06 01 00 01", "01 82 01 01 44 02 00 06 00 00"),
    "wrong commissioning state": (
        "01 02 01 01 10 01 00 07 00 00 06 01 00 01",
        "01 82 01 01 44 02 00 70 00 00",
    ),
    "string too long": (
        "01 02 01 01 10 06 00 09 00 00 09 06 61 62 63 64 65 66",
        "01 82 01 01 44 02 00 03 00 05",
    ),
    "behind a string": ("01 01 01 01 10 01 00 09 00 05", "01 81 01 01 44 02 00 03 00 05"),
    # accepted
    "read a value": ("01 01 01 01 10 01 00 01 00 00", "01 01 01 01 06 01 00 05"),
    "elements 0 reads one value": ("01 01 01 01 10 00 00 01 00 00", "01 01 01 01 06 01 00 05"),
    "elements 0 takes subindex 0": ("01 01 01 01 10 00 00 05 00 02", "01 01 01 01 06 01 00 0A"),
    "read an array": ("01 01 01 01 10 02 00 05 00 01", "01 01 01 01 06 02 00 14 00 1E"),
    "odd answer has a pad": ("01 01 01 01 10 03 00 0A 00 00", "01 01 01 01 05 03 01 02 03 00"),
    "read the second character": ("01 01 01 01 10 01 00 09 00 01", "01 01 01 01 09 01 62 00"),
    "read a string": ("01 01 01 01 10 05 00 09 00 00", "01 01 01 01 09 05 61 62 63 64 65 00"),
    "write": ("01 02 01 01 10 01 00 01 00 00 06 01 00 64", "01 02 01 01"),
    "write as word": ("01 02 01 01 10 01 00 01 00 00 42 01 00 64", "01 02 01 01"),
    "write with elements 0": ("01 02 01 01 10 00 00 01 00 00 06 01 00 64", "01 02 01 01"),
    "write REAL as double word": ("01 02 01 01 10 01 00 08 00 00 43 01 41 20 00 00", "01 02 01 01"),
    "reset": ("01 02 01 01 10 01 00 03 00 00 06 01 00 00", "01 02 01 01"),
    "write a string": ("01 02 01 01 10 02 00 09 00 00 09 02 78 79", "01 02 01 01"),
    "read where only a change is refused": ("01 01 01 01 10 01 00 07 00 00", "01 01 01 01 06 01 00 09"),
    "partly failed read": (
        "01 01 01 02 10 01 00 01 00 00 10 01 00 63 00 00",
        "01 81 01 02 06 01 00 05 44 02 00 00 00 00",
    ),
    "partly failed change": (
        "01 02 01 02 10 01 00 02 00 00 10 01 00 01 00 00 06 01 00 01 06 01 00 01",
        "01 82 01 02 44 02 00 01 00 00 40 00",
    ),
}


@pytest.mark.parametrize("name", ORDER)
def test_order_of_checks(name):
    """Each request is answered by exactly the bytes worked out by hand from the order of checks."""
    request, answer = ORDER[name]
    assert ask(drive(), request) == answer


def test_values_change():
    """A change that succeeded is read back; one that failed leaves the value as it was."""
    unit = drive()
    ask(unit, "01 02 01 02 10 01 00 01 00 00 10 02 00 05 00 01 06 01 00 2A 06 02 00 01 00 64")
    assert unit.objects[1].parameters[1].values == [42]
    assert unit.objects[1].parameters[5].values == [10, 20, 30]
    ask(unit, "02 02 01 01 10 02 00 09 00 00 09 02 78 79")
    assert unit.objects[1].parameters[9].values == ["xycde"]


def test_one_error_word():
    """A device with one-word errors leaves the information word out."""
    unit = drive(error_words=1)
    assert ask(unit, "01 01 01 01 10 02 00 05 00 02") == "01 81 01 01 44 01 00 03"
    assert ask(unit, "02 02 09 01 10 01 00 01 00 00 06 01 00 01") == "02 82 09 01 44 01 00 19"


def test_two_drive_objects():
    """The same parameter number means another parameter in each drive object."""
    unit = drive()
    assert ask(unit, "01 01 01 01 10 01 00 01 00 00").endswith("00 05")
    assert ask(unit, "02 01 02 01 10 01 00 01 00 00") == "02 01 02 01 06 01 22 22"
    ask(unit, "03 02 02 01 10 01 00 01 00 00 06 01 00 07")
    assert [unit.objects[n].parameters[1].values for n in (1, 2)] == [[5], [7]]


def test_alias_and_local_object():
    """An alias reaches its object and is mirrored; record B02Eh ignores the drive object byte."""
    unit = drive(aliases={0: 2}, local_object=2, record_indexes=(0xB02E, 0xB02F))
    assert ask(unit, "01 01 00 01 10 01 00 01 00 00", 0xB02F) == "01 01 00 01 06 01 22 22"
    assert ask(unit, "01 01 01 01 10 01 00 01 00 00", -20434) == "01 01 01 01 06 01 22 22"
    assert ask(unit, "01 01 01 01 10 01 00 01 00 00", 0xB02F) == "01 01 01 01 06 01 00 05"
    assert drive(record_indexes=(0xB02E,)).write_record(0xB02E, bytes.fromhex("01 01 01 01 10 01 00 01 00 00")) == 0


def test_multi_parameter_access():
    """23h and 22h are one single block although n is mirrored; 23h comes before the addresses and 22h."""
    two = "10 01 00 00 00 00 10 01 00 01 00 00"
    assert ask(drive(multi_supported=False), "01 01 01 02" + two) == "01 81 01 02 44 02 00 23 00 00"
    assert ask(drive(multi_supported=False, max_parameters=1), "01 01 01 02" + two).endswith("00 23 00 00")
    assert ask(drive(max_parameters=1), "01 01 01 02" + two) == "01 81 01 02 44 02 00 22 00 00"
    assert ask(drive(max_parameters=2), "01 01 01 02" + two).startswith("01 81 01 02 44 02 00 16 00 00 06")


def test_state_dependent_limits():
    """While running 5 is below and 50 above the present limits (C8h, C9h), 101 above the absolute ones."""
    unit = drive(state="running")
    head = " 02 01 01 10 01 00 01 00 00 06 01 00 "
    assert ask(unit, "01" + head + "05") == "01 82 01 01 44 02 00 C8 00 00"
    assert ask(unit, "02" + head + "32") == "02 82 01 01 44 02 00 C9 00 00"
    assert ask(unit, "03" + head + "65") == "03 82 01 01 44 02 00 02 00 00"
    assert ask(unit, "04" + head + "0F") == "04 02 01 01"
    plain = drive(state="running", error_table="profidrive")
    assert ask(plain, "01" + head + "05") == "01 82 01 01 44 02 00 02 00 00"
    assert ask(plain, "01" + head + "32") == "01 82 01 01 44 02 00 02 00 00"


def test_operating_state():
    """11h while running, 70h outside quick commissioning; a protected parameter cannot even be read."""
    assert ask(drive("running"), "01 02 01 01 10 01 00 06 00 00 06 01 00 01") == "01 82 01 01 44 02 00 11 00 00"
    assert ask(drive("running"), "01 01 01 01 10 01 00 06 00 00") == "01 01 01 01 06 01 00 09"
    assert ask(drive("quick"), "01 02 01 01 10 01 00 07 00 00 06 01 00 01") == "01 02 01 01"
    assert ask(drive("protected"), "01 01 01 01 10 01 00 0B 00 00") == "01 81 01 01 44 02 00 10 00 00"


@pytest.mark.parametrize(
    "request_",
    [
        "01 02 01 01 10 01 00 01 00 00 06 01 00 09 00 00",
        "01 02 01 01 10 01 00 01 00 00 06 01 00",
        "01 02 01 01 10 01 00 01 00 00",
        "01 02 01 01 10 01 00 01 00 00 06",
    ],
)
def test_strict_length(request_):
    """A change longer or shorter than its contents answers 18h and writes nothing."""
    unit = drive()
    assert ask(unit, request_) == "01 82 01 01 44 02 00 18 00 00"
    assert unit.objects[1].parameters[1].values == [5]


def test_strict_length_concerns_every_parameter():
    """One byte too many: no parameter of the request is written, and the address errors still come first."""
    unit = drive()
    request = "01 02 01 02 10 01 00 01 00 00 10 01 00 63 00 00 06 01 00 09 06 01 00 09 00"
    assert ask(unit, request) == "01 82 01 02 44 02 00 18 00 00 44 02 00 00 00 00"
    assert ask(unit, "02 01 01 01 10 01 00 01 00 00 00") == "02 81 01 01 44 02 00 18 00 00"


def test_tolerant_length():
    """A tolerant device ignores trailing bytes; missing values are 18h for their own parameter only."""
    unit = drive(strict_length=False)
    assert ask(unit, "01 02 01 01 10 01 00 01 00 00 06 01 00 09 00 00") == "01 02 01 01"
    assert ask(unit, "02 01 01 01 10 01 00 01 00 00 FF FF") == "02 01 01 01 06 01 00 09"
    short = "03 02 01 02 10 01 00 01 00 00 10 01 00 04 00 00 06 01 00 0A 06 01 00"
    assert ask(unit, short) == "03 82 01 02 40 00 44 02 00 18 00 00"
    assert unit.objects[1].parameters[1].values == [10]


def test_nothing_is_known_behind_an_unknown_format():
    """The parameter with the unknown format answers 17h, those behind it 18h."""
    request = "01 02 01 02 10 01 00 01 00 00 10 01 00 04 00 00 0E 01 00 01 06 01 00 01"
    assert ask(drive(), request) == "01 82 01 02 44 02 00 17 00 00 44 02 00 18 00 00"


def test_generic_answers():
    """A device that answers sizes sends 43h for REAL, 42h for words, 41h for bytes, strings as they are."""
    unit = drive(answer_format="size")
    request = "01 01 01 04 10 01 00 08 00 00 10 01 00 01 00 00 10 01 00 0A 00 00 10 05 00 09 00 00"
    assert ask(unit, request) == "01 01 01 04 43 01 3F C0 00 00 42 01 00 05 41 01 01 00 09 05 61 62 63 64 65 00"


def test_response_too_long():
    """What does not fit the record any more answers 15h; 234 bytes still fit: 4 + 2 + 234 = 240."""
    big = {n: SimulatedParameter(n, BYTE, [0] * 234, array=True) for n in (1, 2)}
    unit = Drive(Behaviour(), [DriveObject(1, big)])
    assert len(bytes.fromhex(ask(unit, "01 01 01 01 10 EA 00 01 00 00"))) == 240
    answer = ask(unit, "01 01 01 02 10 EA 00 01 00 00 10 01 00 02 00 00")
    assert answer == "01 81 01 02 44 02 00 15 00 00 05 01 00 00"


def test_description():
    """Attribute 20h answers 46 octets for subindex 0 and one element otherwise."""
    unit = drive(attributes=frozenset({0x10, 0x20, 0x30}))
    whole = bytes.fromhex(ask(unit, "01 01 01 01 20 01 00 08 00 00"))
    # identifier 0108h (no scale, FloatingPoint), no elements, factor 1.0, name, limits 0.0 and 100.0
    expected = "01 01 01 01 0A 2E 0108 0000 3F800000 0000 00000000 5370656564" + "20" * 11 + "00000000 42C80000"
    assert whole == bytes.fromhex(expected) + bytes(8)
    assert ask(unit, "02 01 01 01 20 01 00 05 00 02") == "02 01 01 01 06 01 00 03"
    assert ask(unit, "03 01 01 01 20 01 00 02 00 01") == "03 01 01 01 73 01 07 06"
    assert ask(unit, "04 01 01 01 20 01 00 05 00 0D") == "04 81 01 01 44 02 00 03 00 0D"
    assert ask(unit, "05 01 01 01 20 02 00 05 00 01") == "05 81 01 01 44 02 00 16 00 00"
    assert ask(unit, "06 01 01 01 20 01 00 09 00 00") == "06 81 01 01 44 02 00 09 00 00"
    assert ask(unit, "07 02 01 01 20 01 00 08 00 01 06 01 00 01") == "07 82 01 01 44 02 00 07 00 01"


def test_changed_value_shows_in_the_description():
    """Bit 12 of the identifier says that the value differs from the factory setting."""
    unit = drive(attributes=frozenset({0x10, 0x20}))
    assert ask(unit, "01 01 01 01 20 01 00 01 00 01") == "01 01 01 01 73 01 01 06"
    ask(unit, "02 02 01 01 10 01 00 01 00 00 06 01 00 09")
    assert ask(unit, "03 01 01 01 20 01 00 01 00 01") == "03 01 01 01 73 01 11 06"


def test_texts():
    """Attribute 30h answers texts of 16 characters; writing one is 20h, without texts 0Fh."""
    unit = drive(attributes=frozenset({0x10, 0x30}))
    assert ask(unit, "01 01 01 01 30 01 00 02 00 01") == "01 01 01 01 09 10 6F 6E" + " 20" * 14
    assert ask(unit, "02 01 01 01 30 02 00 02 00 01") == "02 81 01 01 44 02 00 03 00 02"
    assert ask(unit, "03 01 01 01 30 01 00 01 00 00") == "03 81 01 01 44 02 00 0F 00 00"
    assert ask(unit, "04 02 01 01 30 01 00 02 00 01 09 01 61 00") == "04 82 01 01 44 02 00 20 00 01"
    assert ask(unit, "05 02 01 01 30 01 00 01 00 00 09 01 61 00") == "05 82 01 01 44 02 00 0F 00 00"


def test_single_access_without_multi_parameter_access():
    """A device without multi-parameter access still serves one parameter."""
    assert ask(drive(multi_supported=False), "01 01 01 01 10 01 00 01 00 00") == "01 01 01 01 06 01 00 05"


def test_room_is_kept_for_the_errors_behind():
    """4 + 232 bytes and a possible 6-byte error behind them are 242, over 240: the array answers 15h."""
    unit = Drive(Behaviour(), [DriveObject(1, {1: SimulatedParameter(1, BYTE, [0] * 230, array=True)})])
    request = "01 01 01 02 10 E6 00 01 00 00 10 01 00 63 00 00"
    assert ask(unit, request) == "01 81 01 02 44 02 00 15 00 00 44 02 00 00 00 00"


def test_change_with_a_pad_inside():
    """The block behind an odd one starts behind its pad: 2Ah and 0100h are found."""
    unit = drive()
    request = "01 02 01 02 10 01 00 0A 00 01 10 01 00 0B 00 00 05 01 2A 00 06 01 01 00"
    assert ask(unit, request) == "01 02 01 02"
    assert [unit.objects[1].parameters[n].values for n in (10, 11)] == [[1, 42, 3], [0x0100]]


def test_parameter_before_an_unknown_format_is_written():
    """What stands before the unknown format is written, the format answers 17h, the rest 18h."""
    request = "01 02 01 03 10 01 00 01 00 00 10 01 00 04 00 00 10 01 00 06 00 00"
    values = "06 01 00 09 0E 01 00 01 06 01 00 01"
    expected = "01 82 01 03 40 00 44 02 00 17 00 00 44 02 00 18 00 00"
    assert ask(drive(), f"{request} {values}") == expected
