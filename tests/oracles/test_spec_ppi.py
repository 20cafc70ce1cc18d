"""What a spec demands of PPI masters, stated from its YAML and the documents alone, and the telegrams of an S7-200."""

from __future__ import annotations

from typing import Any

import pytest
import yaml

from plcgen.oracles.spec.place import NotStatedError
from plcgen.oracles.spec.ppi.statement import PpiStatement, StatedPort, stated_ports
from plcgen.oracles.spec.ppi.stations import (
    AREAS,
    AnsweringMemory,
    Extent,
    HeardPoll,
    HeardRequest,
    RecordingLine,
    UndescribedError,
    heard_frame_of,
)

READ_VB100 = "68 1B 1B 68 02 00 6C 32 01 00 00 00 00 00 0E 00 00 04 01 12 0A 10 02 00 01 00 01 84 00 03 20 8B 16"
WRITE_VB100 = (
    "68 20 20 68 02 00 7C 32 01 00 00 00 00 00 0E 00 05 05 01 12 0A 10 02 00 01 00 01 84 00 03 20 00 04 00 08 0C B9 16"
)
WRITE_M0_1 = (
    "68 21 21 68 02 00 6C 32 01 00 00 00 00 00 0E 00 06 05 01 12 0A 10 01 00 01 00 00 83 00 00 01"
    " 00 03 00 01 01 00 72 16"
)
RUN = (
    "68 21 21 68 02 00 6C 32 01 00 00 00 00 00 14 00 00 28 00 00 00 00 00 00 FD 00 00 09"
    " 50 5F 50 52 4F 47 52 41 4D AA 16"
)
STOP = "68 1D 1D 68 02 00 6C 32 01 00 00 00 00 00 10 00 00 29 00 00 00 00 00 09 50 5F 50 52 4F 47 52 41 4D AA 16"
POLL = "10 02 00 5C 5E 16"
"""Telegrams between STEP 7-Micro/WIN and a CPU 226, as an article prints them."""


def framed(pdu: str) -> bytes:
    """A request from 0 to station 2 around a PDU, with function code 6Ch."""
    body = bytes.fromhex("02 00 6C") + bytes.fromhex(pdu)
    return bytes((0x68, len(body), len(body), 0x68)) + body + bytes((sum(body) & 0xFF, 0x16))


@pytest.mark.parametrize(
    ("frame", "service", "places", "data"),
    [
        (READ_VB100, 0x04, ["VB100"], b""),
        (WRITE_VB100, 0x05, ["VB100"], b"\x0c"),
        (WRITE_M0_1, 0x05, ["M0.1"], b"\x01"),
        (RUN, 0x28, [], b""),
        (STOP, 0x29, [], b""),
    ],
)
def test_published_requests_are_read(frame: str, service: int, places: list[str], data: bytes) -> None:
    """Station, service, places and values of telegrams that an article prints."""
    found = heard_frame_of(bytes.fromhex(frame))
    assert isinstance(found, HeardRequest)
    assert (found.station, found.source, found.service) == (2, 0, service)
    assert [str(item.place) for item in found.items] == places
    assert b"".join(item.data for item in found.items) == data


def test_a_poll_is_read() -> None:
    """10 DA SA FC FCS 16."""
    assert heard_frame_of(bytes.fromhex(POLL)) == HeardPoll(2, 0, 0x5C)


ITEM = "32 01 00 00 00 00 00 0E 00 00 04 01 12 0A 10"


@pytest.mark.parametrize(
    ("frame", "said"),
    [
        (bytes.fromhex("10 02 5C 5E 16"), "no frame"),
        (bytes.fromhex(POLL.replace("5E", "5F")), "FCS is 95, not 94"),
        (bytes.fromhex(POLL.replace("5C 5E", "6C 6E")), "6Ch of a poll"),
        (bytes.fromhex(READ_VB100.replace("8B 16", "8C 16")), "FCS is 140, not 139"),
        (bytes.fromhex(READ_VB100.replace("68 1B 1B", "68 1B 1C")), "repeated length"),
        (framed(f"{ITEM} 02 00 01 00 00 84 00 03 20"), "the data block is 0, not 1"),
        (framed(f"{ITEM} 01 00 02 00 01 84 00 03 20"), "the number of bits is 2, not 1"),
        (framed(f"{ITEM} 02 00 01 00 01 84 00 03 21"), "size 02h at bit address 801"),
        (framed(f"{ITEM} 04 00 01 00 00 1F 00 00 25"), "the transport size of elements is 4, not 31"),
        (framed(f"{ITEM} 04 00 01 00 00 07 00 00 08"), "words at even addresses"),
        (framed(f"{ITEM} 02 00 01 00 00 85 00 03 20"), "no item"),
        (framed("32 07 00 00 00 00 00 0E 00 00 04 01 12 0A 10 02 00 01 00 01 84 00 03 20"), "ROSCTR is 7, not 1"),
        (framed(RUN[21:-6].replace("FD", "FE")), "neither RUN nor STOP"),
    ],
)
def test_what_no_document_describes_is_refused(frame: bytes, said: str) -> None:
    """One field after the other is wrong, the rest is right."""
    with pytest.raises(UndescribedError, match=said):
        heard_frame_of(frame)


@pytest.mark.parametrize(
    ("request_", "reply"),
    [
        (READ_VB100, "68 16 16 68 00 02 08 32 03 00 00 00 00 00 02 00 05 00 00 04 01 FF 04 00 08 22 78 16"),
        (WRITE_VB100, "68 12 12 68 00 02 08 32 03 00 00 00 00 00 02 00 01 00 00 05 01 FF 47 16"),
        (STOP, "68 10 10 68 00 02 08 32 03 00 00 00 00 00 01 00 00 00 00 29 69 16"),
    ],
)
def test_replies_are_the_published_ones(request_: str, reply: str) -> None:
    """E5 to the request, the reply to the poll, byte for byte."""
    memory = AnsweringMemory()
    memory.put(Extent(AREAS["V"], 800, 8), b"\x22")
    line = RecordingLine({2: memory})
    line.receive(bytes.fromhex(request_), 5)
    assert (line.due(), line.transmit(5)) == (5, b"\xe5")
    line.receive(bytes.fromhex(POLL.replace("5C 5E", "7C 7E")), 9)
    assert line.transmit(9).hex(" ").upper() == reply


def test_a_repetition_is_not_executed() -> None:
    """The same frame count bit with FCV = 1 is the frame before once more; 6Ch is always a new one."""
    line = RecordingLine({2: AnsweringMemory()})
    for frame in (READ_VB100, READ_VB100, WRITE_VB100):
        line.receive(bytes.fromhex(frame), 0)
    assert [heard.again for heard in line.heard] == [False, False, True]


def port(jobs: str, **more: Any) -> StatedPort:
    """The statement of a master with one station "s", address 2."""
    station = {"address": 2, "symbols": {"Level": "VD104", "on": "M1.1"}}
    master = {"module": "cm1241", "port": 270, "stations": {"s": station}, "jobs": yaml.safe_load(jobs), **more}
    (found,) = stated_ports({"ppi": {"line": master}}, {})
    return found


def job(text: str) -> PpiStatement:
    """The statement about one job of station "s"."""
    return port(f"{{j: {{station: s, {text}}}}}").jobs[0]


@pytest.mark.parametrize(
    ("text", "place", "kind", "count", "name"),
    [
        ("VB100", "VB100", "BYTE", 0, "VB100"),
        ("vw100", "VB100[2]", "WORD", 0, "VW100"),
        ("VD100", "VB100[4]", "DWORD", 0, "VD100"),
        ("V100.3", "V100.3", "BOOL", 0, "V100_3"),
        ("DB1.DBW100", "VB100[2]", "WORD", 0, "VW100"),
        ("DB1.DBX7.1", "V7.1", "BOOL", 0, "V7_1"),
        ("EB0", "IB0", "BYTE", 0, "IB0"),
        ("A0.1", "Q0.1", "BOOL", 0, "Q0_1"),
        ("AW4", "QB4[2]", "WORD", 0, "QW4"),
        ("AEW4", "AIB4[2]", "WORD", 0, "AIW4"),
        ("SMB34", "SMB34", "BYTE", 0, "SMB34"),
        ("SB3", "SB3", "BYTE", 0, "SB3"),
        ("S0.1", "S0.1", "BOOL", 0, "S0_1"),
        ("Z5", "C5", "INT", 0, "C5"),
        ("T32[4]", "T32[4]", "DINT", 4, "T32"),
        ("VW60[3]", "VB60[6]", "WORD", 3, "VW60"),
        ("VB7[1]", "VB7", "BYTE", 0, "VB7"),
        ("SYS", "SYSB0[20]", "CHAR", 20, "SYS0"),
        ("level", "VB104[4]", "DWORD", 0, "level"),
        ("ON", "M1.1", "BOOL", 0, "ON"),
    ],
)
def test_addresses(text: str, place: str, kind: str, count: int, name: str) -> None:
    """The table of addresses of docs/ppi.md, and symbols, whose capitals do not matter."""
    (value,) = job(f'read: ["{text}"]').values
    assert (str(value.whole), value.kind, value.count, value.name) == (place, kind, count, name)


def test_values_of_a_write() -> None:
    """Constants, inputs with and without start; a character is a blank at first, everything else 0."""
    found = job("write: {VB1: 5, VW2: null, VD4: {type: Real, start: 12.5}, VB8: {type: Char, as: c}, M0.0: true}")
    assert [(v.text, v.constant, v.start) for v in found.values] == [
        ("VB1", 5, 0), ("VW2", None, 0), ("VD4", None, 12.5), ("VB8", None, 32), ("M0.0", 1, 0),
    ]  # fmt: skip
    assert [v.text for v in found.inputs] == ["VW2", "VD4", "VB8"]
    assert [v.octets([n]) for v, n in zip(found.inputs, (258, 12.5, 65), strict=True)] == [
        b"\x01\x02", b"\x41\x48\0\0", b"A",
    ]  # fmt: skip
    assert (found.inputs[2].name, found.inputs[2].given) == ("c", True)


def test_what_is_not_explained_is_no_statement() -> None:
    """No guess about an address, a time or a text."""
    for text in ("read: [VX]", "read: [VB1], timeout: soon", 'write: {VB1: "ten"}'):
        with pytest.raises(NotStatedError):
            job(text)


def test_symbol_tables() -> None:
    """A table of Micro/WIN with a header, tabs and UTF-16: docs/ppi.md, addresses."""
    table = "Symbol\tAddress\tComment\nPump\tVW400\tits speed\n".encode("utf-16")
    master = {
        "module": "cm1241", "port": 270, "stations": {"s": {"address": 2, "symbols": "pump.csv"}},
        "jobs": {"j": {"station": "s", "read": ["pump"]}},
    }  # fmt: skip
    (found,) = stated_ports({"ppi": {"line": master}}, {"pump.csv": table})
    assert str(found.jobs[0].values[0].whole) == "VB400[2]"


def test_times() -> None:
    """docs/ppi-master.md, timeouts: what a CM and a CP 341 need at 9600 bit/s and cycles of 50 ms, in tens of ms."""
    quick, slow = port("{j: {station: s, run: true}}"), port("{j: {station: s, run: true}}", module="cp341")
    assert (quick.ack_wait(), slow.ack_wait()) == (250, 260)  # 2 + 4 + 3 * 50 + 50 = 206; 2 + 4 + 4 * 50 + 50 = 256
    assert quick.reply_wait(249) == 600  # 286 + 4 + 3 * 50 + 150 = 590
    assert slow.reply_wait(249) == 990  # 286 + 4 + 11 * 50 + 150 = 990
    given = port("{j: {station: s, run: true}}", ack_timeout="2s", reply_timeout="700ms", retry_pause="5ms")
    assert (given.ack_wait(), given.reply_wait(249), given.retry_pause) == (2000, 700, 5)
    plain = given.jobs[0]
    assert (given.retries, given.polls, given.poll_pause, plain.timeout, plain.cycle) == (3, 10, 20, 10_000, None)
