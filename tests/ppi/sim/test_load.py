"""A bus from YAML: what it says is there, and every mistake is told with its line."""

from __future__ import annotations

import pytest

from plcgen.base.diagnostics import DiagnosticError
from plcgen.ppi.sim.faults import Fault, FaultKind
from plcgen.ppi.sim.load import load_bus, set_address
from plcgen.ppi.sim.station import Mode, Service, Switch

PLANT = """\
stations:
  - cpu: 224
    symbols: {speed: VW100, "pump on": M0.0}
    values:
      speed: 1500
      "pump on": true
      VD104: 12.5
      VB200[8]: hello
      VW300[3]: [1, -1, 16#7FFF]
      T32: {value: 100, on: true}
      C5: 7
  - {cpu: 226, address: 3, mode: stop, switch: stop, not_ready: 2, type: CPU 226 CN, pdu: 128, frame_count: strict,
     password: {level: 3}, write_inputs: false}
  - {cpu: st20, address: 4, password: {protects: [read, run]}}
faults:
  - {kind: fcs, after: 2}
  - {kind: not_ready, times: always, station: 3}
  - {kind: item, times: 3, item: 2, code: 3}
"""


def problems(text: str) -> list[tuple[str, int, int, str]]:
    """Code, line, column and message of everything wrong."""
    with pytest.raises(DiagnosticError) as caught:
        load_bus(text, "plant.yaml")
    return [(found.code, found.span.line, found.span.column, found.message) for found in caught.value.diagnostics]


def test_everything_a_file_can_say() -> None:
    bus = load_bus(PLANT)
    first, second, third = bus.stations.values()
    assert (first.address, second.address, third.address) == (2, 3, 4)
    assert first["VW100"] == 1500
    assert first["M0.0"] is True
    assert first["VD104"] == 0x41480000
    assert first["VB200[8]"] == b"hello\0\0\0"
    assert first["VW300[3]"] == [1, 0xFFFF, 0x7FFF]
    assert (first["T32"], first["C5"]) == (100, 7)
    assert first["SYS"] == b"CPU 224         0201"
    assert (second.mode, second.cpu.switch, second.not_ready) == (Mode.STOP, Switch.STOP, 2)
    assert (second.cpu.pdu_limit, second.frame_count) == (128, "strict")
    assert second["SYS"] == b"CPU 226 CN".ljust(20)
    assert second.cpu.protected == {Service.FORCE, Service.OUTPUTS}
    assert not second.cpu.memory.write_inputs
    assert third.cpu.protected == {Service.READ, Service.RUN}
    assert third.cpu.memory.profile.title == "CPU ST20"
    assert bus.faults == [
        Fault(FaultKind.FCS, after=2),
        Fault(FaultKind.NOT_READY, times=None, station=3),
        Fault(FaultKind.ITEM, times=3, item=2, code=3),
    ]


def test_a_single_station_needs_no_list() -> None:
    bus = load_bus("cpu: 222\naddress: 5\nvalues: {VB0: 1}\nfaults: [{kind: silence}]")
    assert bus.stations[5]["VB0"] == 1
    assert bus.stations[5].cpu.memory.profile.title == "CPU 222"
    assert bus.faults == [Fault(FaultKind.SILENCE)]


def test_options_go_before_the_file() -> None:
    bus = load_bus("cpu: 222\naddress: 5", cpu="226", address=7)
    assert bus.stations[7].cpu.memory.profile.title == "CPU 226"
    assert load_bus("{}").stations[2].cpu.memory.profile.title == "CPU 224"


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("cpu: 225", ("PG107", 1, 6, 'there is no CPU "225"')),
        ("cpus: 224", ("PG104", 1, 1, 'unknown key "cpus" in the file')),
        ("address: 127", ("PG107", 1, 10, '"address": must be less than or equal to 126, not "127"')),
        ("address: two", ("PG106", 1, 10, 'expected a whole number instead of "two"')),
        ("mode: term", ("PG107", 1, 7, '"term" is not a value of "mode"')),
        ("type: a text of more than twenty", ("PG107", 1, 7, "a type is at most 20 ASCII characters")),
        ("pdu: 241", ("PG107", 1, 6, '"pdu": must be less than or equal to 240, not "241"')),
        ("password: {level: 5}", ("PG107", 1, 19, '"level": must be less than or equal to 4, not "5"')),
        ("password: {protects: [all]}", ("PG107", 1, 23, '"all" is not a value of "protects"')),
        ("values: {VB8192: 1}", ("PG724", 1, 10, "VB8192 is beyond the memory of a CPU 224")),
        ("values: {VB100: 256}", ("PG107", 1, 17, "VB100: 256 does not fit into 8 bits")),
        ("values: {XB100: 1}", ("PG711", 1, 10, '"XB100": there is no memory area "X"')),
        ("values: {V100.8: true}", ("PG712", 1, 10, '"V100.8": bit 8 is outside 0..7')),
        ("values: [1]", ("PG106", 1, 9, "expected a mapping instead of a list")),
        ("symbols: {a: b}", ("PG711", 1, 14, '"b": there is no memory area "B"')),
        ("symbols: {a: VB9000}", ("PG724", 1, 14, "VB9000 is beyond the memory of a CPU 224")),
        ("stations: []", ("PG107", 1, 11, '"stations": must have at least 1 item')),
        ("stations: [{}, {}]", ("PG107", 1, 16, "two stations have the address 2")),
        ("faults: [{kind: fast}]", ("PG107", 1, 17, '"fast" is not a value of "kind"')),
        ("faults: [{kind: fcs, station: 3}]", ("PG107", 1, 31, "there is no station 3")),
        ("faults: [{times: 1}]", ("PG105", 1, 10, 'faults.0 lacks the key "kind"')),
        ("cpu: 224\n  x: 1", ("PG101", 2, 4, "")),
        ("", ("PG101", 1, 1, "the file is empty")),
    ],
)
def test_mistakes_are_told_with_their_place(text: str, expected: tuple[str, int, int, str]) -> None:
    code, line, column, message = problems(text)[0]
    assert (code, line, column) == expected[:3]
    assert message.startswith(expected[3])


def test_all_mistakes_are_told_at_once() -> None:
    text = "cpu: 225\naddress: 200\nvalues:\n  VB1: 300\n  VB9999: 1\nfaults:\n  - {kind: x}\n"
    assert [(code, line) for code, line, *_ in problems(text)] == [
        ("PG107", 1),
        ("PG107", 2),
        ("PG107", 4),
        ("PG724", 5),
        ("PG107", 7),
    ]


WRONG = """\
stations:
  - {cpu: 225, address: 127, mode: running, switch: on_, type: a text of more than twenty, pdu: 31, not_ready: -1}
  - cpu: 224
    addres: 3
    frame_count: strickt
    password: {level: 5, protects: [all, read], user: x}
    write_inputs: 1
    symbols: {a: XB1, b: VB9999, c: 5}
  - address: 3
    symbols: [a]
  - address: 4
    values:
      VB1: 256
      VB9999: 1
      V1.8: true
      VB10[2]: [1, 2, 3]
      M0.0: 2
      T32: {value: 1, one: true}
      VD0: text
      nothing: 1
  - {address: 4}
  - 5
faults:
  - {kind: not_ready, station: 127}
  - {kind: slow}
  - {times: twice}
  - {kind: item, code: 255, item: 20}
  - {kind: garbage, data: [1]}
  - {kind: garbage, data: 1x, at: reply}
station: {}
"""

MISTAKES = [
    ("PG107", 2, 11, 'there is no CPU "225"'),
    ("PG107", 2, 25, '"address": must be less than or equal to 126, not "127"'),
    ("PG107", 2, 36, '"running" is not a value of "mode"'),
    ("PG107", 2, 53, '"on_" is not a value of "switch"'),
    ("PG107", 2, 64, "a type is at most 20 ASCII characters"),
    ("PG107", 2, 97, '"pdu": must be greater than or equal to 32, not "31"'),
    ("PG107", 2, 112, '"not_ready": must be greater than or equal to 0, not "-1"'),
    ("PG104", 4, 5, 'unknown key "addres" in stations.1'),
    ("PG107", 5, 18, '"strickt" is not a value of "frame_count"'),
    ("PG107", 6, 23, '"level": must be less than or equal to 4, not "5"'),
    ("PG107", 6, 37, '"all" is not a value of "protects"'),
    ("PG104", 6, 49, 'unknown key "user" in stations.1.password'),
    ("PG106", 7, 19, 'expected true or false instead of "1"'),
    ("PG711", 8, 18, '"XB1": there is no memory area "X"'),
    ("PG724", 8, 26, "VB9999 is beyond the memory of a CPU 224"),
    ("PG106", 8, 37, "an address is a text such as VW100"),
    ("PG106", 10, 14, "expected a mapping instead of a list"),
    ("PG107", 13, 12, "VB1: 256 does not fit into 8 bits"),
    ("PG724", 14, 7, "VB9999 is beyond the memory of a CPU 224"),
    ("PG712", 15, 7, '"V1.8": bit 8 is outside 0..7'),
    ("PG107", 16, 16, "VB10[2]: 3 values for 2 elements"),
    ("PG107", 17, 13, "M0.0: a bit is true or false, not 2"),
    ("PG107", 18, 12, "T32: the keys are value and on"),
    ("PG107", 19, 12, "VD0: text goes into bytes"),
    ("PG711", 20, 7, '"nothing": there is no memory area "NOTHING"'),
    ("PG107", 21, 15, "two stations have the address 4"),
    ("PG106", 22, 5, 'expected a mapping instead of "5"'),
    ("PG107", 24, 32, '"station": must be less than or equal to 126, not "127"'),
    ("PG107", 25, 12, '"slow" is not a value of "kind"'),
    ("PG105", 26, 5, 'faults.2 lacks the key "kind"'),
    ("PG107", 26, 13, '"twice" is not a value of "times"'),  # a whole number or forever
    ("PG107", 27, 24, "the return code of an item is 1 to 254, not 255"),
    ("PG107", 27, 35, '"item": must be less than or equal to 19, not "20"'),
    ("PG106", 28, 27, "expected hexadecimal text in quotes instead of a list"),
    ("PG107", 29, 27, "bytes are hexadecimal text"),
    ("PG107", 29, 35, '"reply" is not a value of "at"'),
    ("PG104", 30, 1, 'unknown key "station" in the file'),
]
"""Written by hand, next to the text: code, line, column, how the message begins."""


def test_every_mistake_is_told_in_one_run() -> None:
    found = problems(WRONG)
    assert [entry[:3] for entry in found] == [entry[:3] for entry in MISTAKES]
    for (*_, said), (*_, start) in zip(found, MISTAKES, strict=True):
        assert said.startswith(start)


def test_options_for_one_station_do_not_suit_several() -> None:
    with pytest.raises(DiagnosticError, match="--cpu and --station are for a single station"):
        load_bus("stations: [{}]", cpu="224")


@pytest.mark.parametrize(
    ("text", "address", "name", "value"),
    [
        ("VW100=1234", 2, "VW100", 1234),
        (" speed = -1 ", 2, "VW100", 0xFFFF),
        ("3:VB0=16#FF", 3, "VB0", 0xFF),
        ("M0.0=true", 2, "M0.0", True),
        ("VB0[4]=abc", 2, "VB0[4]", b"abc\0"),
        ("VD0=1.5", 2, "VD0", 0x3FC00000),
        ("VB0[3]=1, 16#FF,3", 2, "VB0[3]", b"\x01\xff\x03"),
        ("VW0[2]=-1,2", 2, "VW0[2]", [0xFFFF, 2]),
        ("VB0[4]=1,ab", 2, "VB0[4]", b"1,ab"),
    ],
)
def test_values_of_the_command_line(text: str, address: int, name: str, value: object) -> None:
    bus = load_bus(PLANT)
    set_address(bus, text)
    assert bus.stations[address][name] == value


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("VW100", "an address and its value"), ("=1", "an address and its value"),
        ("VW100=", "an address and its value"),
        ("9:VB0=1", "there is no station 9"), ("x:VB0=1", "there is no station x"), ("VB0=256", "does not fit"),
        ("VB9000=1", "beyond the memory"), ("YB0=1", "no memory area"),
        ("VB0=[1", "2 characters for 1"), ("VB0[3]=1,2", "2 values for 3"), ("VW0[2]=1,70000", "does not fit"),
        ("VB0=1,2", "2 values for 1"),
    ],
)  # fmt: skip
def test_values_of_the_command_line_that_are_none(text: str, words: str) -> None:
    with pytest.raises(DiagnosticError, match=words) as caught:
        set_address(load_bus(PLANT), text)
    assert {found.code for found in caught.value.diagnostics} == {"PG901"}
    assert caught.value.diagnostics[0].span.file == f"--set {text}"
