"""Areas, sizes and return codes: every item is judged on its own."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from plcgen.ppi.sim import Bus, Station
from plcgen.ppi.sim.station import BY_LEVEL, Mode, Service
from plcgen.ppi.wire.address import PpiAddressError
from plcgen.ppi.wire.areas import Area, ReturnCode, TransportSize
from plcgen.ppi.wire.codes import header_error
from plcgen.ppi.wire.model import (
    AckReply,
    ErrorReply,
    ForceRequest,
    Item,
    ItemWrite,
    ReadRequest,
    RunRequest,
    StopRequest,
    WriteRequest,
)
from plcgen.ppi.wire.profiles import profile, profiles
from tests.s7_200_talk import Talk

OK, DENIED, RANGE, TYPE, SIZE, MISSING = 0xFF, 0x03, 0x05, 0x06, 0x07, 0x0A


@pytest.fixture
def talk() -> Talk:
    return Talk(Bus([Station()]))


LAST = {
    # S7-200 system manual A5E00307987, "Memory ranges and features"; SMART: A5E03822230
    "221": {"I": "IB15", "Q": "QB15", "M": "MB31", "V": "VB2047", "S": "SB31", "SM": "SMB179", "AI": "AIW30"},
    "222": {"V": "VB2047", "SM": "SMB299", "AI": "AIW30", "AQ": "AQW30"},
    "224R1": {"V": "VB5119"},  # seen by an owner
    "224": {"V": "VB8191", "SM": "SMB549", "AI": "AIW62", "AQ": "AQW62", "T": "T255", "C": "C255", "HC": "HC5"},
    "224XP": {"V": "VB10239"},
    "226": {"V": "VB10239", "SM": "SMB549", "S": "SB31"},
    "ST20": {"I": "IB31", "Q": "QB31", "V": "VB12287", "SM": "SMB1535", "AI": "AIW110", "HC": "HC3"},
    "ST40": {"V": "VB16383", "AQ": "AQW110", "T": "T255"},
}  # fmt: skip


@pytest.mark.parametrize(("cpu", "address"), [(cpu, last) for cpu, areas in LAST.items() for last in areas.values()])
def test_the_last_address_of_an_area_is_there_and_the_next_one_is_not(cpu: str, address: str) -> None:
    talk = Talk(Bus([Station(cpu)]))
    last = Station("ST40").item(address) if cpu.startswith("ST") else Station(cpu).item(address)
    step = 1 if last.by_element else last.octets * 8
    beyond = Item(last.area, last.size, 1, last.address + step, last.db)
    assert [code for code, _ in talk.read(last, beyond)] == [OK, RANGE]


def test_a_word_may_begin_anywhere_but_must_end_inside() -> None:
    """VW101 is as good as VW100; VW8191 of a CPU 224 would need VB8192."""
    talk = Talk(Bus([Station(values={"VB101": 0xAB, "VB102": 0xCD})]))
    assert talk.read("VW101", "VW8190", "VW8191", "VD8188", "VD8189") == [
        (OK, b"\xab\xcd"),
        (OK, b"\0\0"),
        (RANGE, b""),
        (OK, b"\0\0\0\0"),
        (RANGE, b""),
    ]


def test_every_profile_says_its_type_in_20_characters() -> None:
    for key, found in profiles().items():
        assert Talk(Bus([Station(key)])).read("SYS") == [(OK, found.type.encode())]
        assert len(found.type) == 20
        assert set(found.sizes) == set(Area)
        assert set(found.unchecked) <= {area.name for area in Area} | {"type"}
    assert Talk(Bus([Station(type_="CPU 226 CN")])).read("SYS") == [(OK, b"CPU 226 CN".ljust(20))]


def test_a_cpu_is_found_by_the_ways_people_call_it() -> None:
    assert profile("cpu 224xp") is profile("224XP")
    with pytest.raises(KeyError):
        profile("315")


@pytest.mark.parametrize(
    ("item", "code"),
    [
        (Item(0x99, TransportSize.BYTE, 1, 0), MISSING),
        (Item(Area.V, TransportSize.BYTE, 1, 0, 2), MISSING),
        (Item(Area.V, TransportSize.BYTE, 1, 0, 0), MISSING),
        (Item(Area.M, TransportSize.BYTE, 1, 0, 1), OK),
        (Item(Area.V, 0x33, 1, 0, 1), TYPE),
        (Item(Area.V, TransportSize.TIMER, 1, 0, 1), TYPE),
        (Item(Area.T, TransportSize.WORD, 1, 0), DENIED),
        (Item(Area.C, TransportSize.TIMER, 1, 0), DENIED),
        (Item(Area.HC, TransportSize.DWORD, 1, 0), DENIED),
        (Item(Area.T, TransportSize.BYTE, 4, 40 * 8), DENIED),
        (Item(Area.AI, TransportSize.BIT, 1, 0), TYPE),
        (Item(Area.SYS, TransportSize.WORD, 1, 0), TYPE),
        (Item(Area.M, TransportSize.BIT, 2, 0), TYPE),
        (Item(Area.M, TransportSize.BYTE, 0, 0), SIZE),
        (Item(Area.M, TransportSize.BYTE, 1, 3), RANGE),
        (Item(Area.AI, TransportSize.WORD, 1, 8), RANGE),
        (Item(Area.M, TransportSize.BIT, 1, 256), RANGE),
        (Item(Area.SYS, TransportSize.BYTE, 196, 0), OK),
        (Item(Area.SYS, TransportSize.BYTE, 197, 0), RANGE),
        (Item(Area.V, TransportSize.BYTE, 1, 0xFFFFFF & ~7, 1), RANGE),
        (Item(Area.T, TransportSize.TIMER, 2, 255), RANGE),
        (Item(Area.V, TransportSize.REAL, 1, 0, 1), OK),
        (Item(Area.V, TransportSize.CHAR, 3, 0, 1), OK),
    ],
)
def test_return_codes(talk: Talk, item: Item, code: int) -> None:
    """One bad item leaves its neighbour alone, in reads and in writes."""
    from plcgen.ppi.wire.pdu import encode_pdu

    good = Item.memory(Area.M, 5)
    request = bytearray(encode_pdu(ReadRequest(7, (good, good))))
    request[15:24] = (
        item.size.to_bytes(1)
        + item.count.to_bytes(2)
        + item.db.to_bytes(2)
        + item.area.to_bytes(1)
        + item.address.to_bytes(3)
    )
    body = bytes((2, 0, 0x6C)) + bytes(request)
    talk.send(bytes((0x68, len(body), len(body), 0x68)) + body + bytes((sum(body) & 0xFF, 0x16)))
    answer = talk.poll(0x5C)
    assert answer[21] == code
    assert answer[-6:-2] == b"\x04\x00\x08\x00"


def test_timers_counters_and_high_speed_counters_are_status_and_value() -> None:
    """5 bytes (status, 32 bits) and 3 bytes (status, 16 bits), big-endian, size code 09 with the length in bytes."""
    values = {"T32": {"value": 1000, "on": True}, "T33": 5, "C5": {"value": -2}, "HC1": 70000}
    talk = Talk(Bus([Station(values=values)]))
    assert talk.read("T32", "C5", "HC1", "T32[2]") == [
        (OK, bytes.fromhex("02 00 00 03 E8")),
        (OK, bytes.fromhex("00 FF FE")),
        (OK, bytes.fromhex("00 00 01 11 70")),
        (OK, bytes.fromhex("02 00 00 03 E8 00 00 00 00 05")),
    ]
    talk.request(ReadRequest(1, (Item.element(Area.T, 32),)))
    assert talk.poll()[21:25] == bytes.fromhex("FF 09 00 05")


@pytest.mark.parametrize(
    ("address", "data", "code"),
    [
        ("VB100", b"\x01", OK), ("QB0", b"\x01", OK), ("MB0", b"\x01", OK), ("SB0", b"\x01", OK), ("IB0", b"\x01", OK),
        ("AQW0", b"\x01\x02", OK), ("SMB30", b"\x01", OK), ("SMB29", b"\x01", DENIED), ("AIW0", b"\x01\x02", DENIED),
        ("SYS0", b"\x01", DENIED), ("T0", bytes(5), OK), ("C0", bytes(3), OK), ("HC0", bytes(5), DENIED),
        ("VB8192", b"\x01", RANGE),
    ],
)  # fmt: skip
def test_what_can_be_written(talk: Talk, address: str, data: bytes, code: int) -> None:
    before = talk.read(address)
    assert talk.write((address, data)) == [code]
    assert talk.read(address) == ([(OK, data)] if code == OK else before)


def test_a_new_cpu_is_zero_but_for_sm0_0(talk: Talk) -> None:
    """SM0.0 is always on (S7-200 system manual, special memory)."""
    assert talk.read("SM0.0", "SMB0", "SMB1", "VD0", "T0") == [
        (OK, b"\1"),
        (OK, b"\1"),
        (OK, b"\0"),
        (OK, bytes(4)),
        (OK, bytes(5)),
    ]


def test_inputs_can_be_protected() -> None:
    station = Station(write_inputs=False)
    assert Talk(Bus([station])).write(("IB0", b"\x01"), ("I0.0", b"\x01"), ("QB0", b"\x01")) == [DENIED, DENIED, OK]
    assert station["IB0"] == 0


def test_a_refused_item_does_not_stop_the_others(talk: Talk) -> None:
    assert talk.write(("VB0", b"\x11"), ("AIW0", b"\0\0"), ("VB2", b"\x22")) == [OK, DENIED, OK]
    assert talk.read("VB0", "VB2") == [(OK, b"\x11"), (OK, b"\x22")]


def test_a_value_of_the_wrong_size_is_refused(talk: Talk) -> None:
    """The item says word, the value has one byte."""
    from plcgen.ppi.wire.pdu import encode_pdu

    request = bytearray(encode_pdu(WriteRequest(7, (ItemWrite(Item.memory(Area.V, 0), b"\x55"),))))
    request[15] = TransportSize.WORD
    body = bytes((2, 0, 0x6C)) + bytes(request)
    talk.send(bytes((0x68, len(body), len(body), 0x68)) + body + bytes((sum(body) & 0xFF, 0x16)))
    assert talk.poll(0x5C)[-3] == SIZE
    assert talk.read("VB0") == [(OK, b"\0")]


def test_writing_a_bit_leaves_its_byte_alone() -> None:
    station = Station(values={"MB0": 0b1010_0000})
    talk = Talk(Bus([station]))
    assert talk.write(("M0.0", b"\x01"), ("M0.7", b"\x00")) == [OK, OK]
    assert station["MB0"] == 0b0010_0001
    assert station["M0.0"] is True
    assert talk.read("M0.0", "M0.7") == [(OK, b"\x01"), (OK, b"\x00")]


def test_timers_are_written_and_outputs_forced() -> None:
    """As the seed document says; what cannot be forced is "not supported" as a whole."""
    item = Item.memory(Area.Q, 0)
    station = Station()
    talk = Talk(Bus([station]))
    assert talk.write(("T5", bytes(4) + b"\x07")) == [OK]
    assert talk.ask(ForceRequest(1, item, b"\xff")) == AckReply(1)
    assert talk.write(("QB0", b"\x00")) == [OK]
    assert station["QB0"] == 0xFF
    assert talk.ask(ForceRequest(2, item, None)) == AckReply(2)
    assert talk.write(("QB0", b"\x00")) == [OK]
    assert station["QB0"] == 0
    assert talk.ask(ForceRequest(3, Item.memory(Area.Q, 99), b"\xff")) == ErrorReply(3, 0x81, 0x04)


def test_a_password_protects_what_its_level_says() -> None:
    """S7-200 system manual, "Restricting access": data, RUN and STOP are free; outputs in STOP and forcing are not."""
    station = Station(protected=BY_LEVEL[2])
    talk = Talk(Bus([station]))
    denied = ErrorReply(7, 0xD6, 0x02)
    write = WriteRequest(7, (ItemWrite(Item.memory(Area.Q, 0), b"\x01"),))
    assert talk.write(("QB0", b"\x01"), ("VB0", b"\x01")) == [OK, OK]
    assert talk.ask(ForceRequest(7, Item.memory(Area.Q, 0), b"\x01")) == denied
    assert talk.ask(StopRequest(1)) == AckReply(1, 0x29)
    assert talk.ask(write) == denied
    assert talk.write(("VB0", b"\x02")) == [OK]
    assert talk.ask(RunRequest(2)) == AckReply(2, 0x28)


def test_any_service_can_be_protected() -> None:
    station = Station(protected=frozenset(Service))
    talk = Talk(Bus([station]))
    jobs = (
        ReadRequest(7, (Item.memory(Area.V, 0),)),
        WriteRequest(7, (ItemWrite(Item.memory(Area.V, 0), b"\x01"),)),
        RunRequest(7),
        StopRequest(7),
    )
    for job in jobs:
        assert talk.ask(job) == ErrorReply(7, 0xD6, 0x02)
    assert station.mode is Mode.RUN
    assert station["VB0"] == 0


# ---- Values as Python data -----------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("address", "value", "data", "back"),
    [
        ("VW0", -1, b"\xff\xff", 0xFFFF), ("VW0", 0x1234, b"\x12\x34", 0x1234),
        ("VD0", 1.5, b"\x3f\xc0\0\0", 0x3FC00000),
        ("VB0[4]", "AB", b"AB\0\0", b"AB\0\0"), ("VB0[2]", [1, 255], b"\x01\xff", b"\x01\xff"),
        ("VW0[2]", [1, 2], b"\0\1\0\2", [1, 2]), ("V0.3", True, b"\x01", True), ("C1", 300, b"\0\x01\x2c", 300),
        ("VB0[3]", b"\x00\x01\x02", b"\x00\x01\x02", b"\x00\x01\x02"),
    ],
)  # fmt: skip
def test_values(address: str, value: object, data: bytes, back: object) -> None:
    station = Station()
    station[address] = value
    assert Talk(Bus([station])).read(address) == [(OK, data)]
    assert station[address] == back


@pytest.mark.parametrize(
    ("address", "value", "words"),
    [
        ("VB0", 256, "256 does not fit into 8 bits"), ("VB0", -129, "does not fit into 8 bits"),
        ("VW0", 1.5, "real number"), ("VD0", 1e39, "does not fit into 32 bits"), ("V0.0", 2, "a bit is true or false"),
        ("V0.0", "x", "text goes into bytes"), ("VB0[2]", [1], "1 values for 2"), ("VB0[2]", 5, "as a list"),
        ("VB0[2]", "abc", "3 characters for 2"), ("VB0[2]", "\u4e2d", "no byte of its own"),
        ("VB0", True, "number is needed"),
        ("T0", {"x": 1}, "keys are value and on"), ("T0", 1.5, "whole number"), ("C0", 70000, "16 bits"),
        ("VW0[2]", "ab", "text"),
    ],
)  # fmt: skip
def test_values_that_do_not_fit(address: str, value: object, words: str) -> None:
    with pytest.raises(ValueError, match=words):
        Station()[address] = value


def test_names() -> None:
    """Symbols are names of addresses; what is none raises."""
    station = Station(symbols={"speed": "VW200"}, values={"speed": 77})
    assert station["VW200"] == station["speed"] == 77
    with pytest.raises(PpiAddressError):
        station["speeed"]
    with pytest.raises(IndexError, match="CPU 224"):
        station["VB9000"]
    with pytest.raises(ValueError, match="0 to 126"):
        Station(address=127)


@given(st.integers(0, 8191), st.binary(min_size=1, max_size=212))
def test_what_is_written_is_read(start: int, data: bytes) -> None:
    """Any bytes at any place of V, or nothing at all if the end is beyond the CPU."""
    station = Station()
    talk = Talk(Bus([station]))
    fits = start + len(data) <= 8192
    address = f"VB{start}[{len(data)}]"
    assert talk.write((address, data)) == [OK if fits else RANGE]
    assert talk.read(address) == [(OK, data) if fits else (RANGE, b"")]
    assert isinstance(talk.read("VB0[222]")[0][1], bytes)
    if not fits:
        assert not any(station.cpu.memory.read(Item.memory(Area.V, 8192 - 212, 212)).data)
    assert ReturnCode.OK == OK


def test_help_about_a_password_is_something_that_can_be_done() -> None:
    """No command takes a password."""
    assert "lower the protection level" in header_error(0xD602).help
    assert "give the password, or" not in header_error(0xD602).help
