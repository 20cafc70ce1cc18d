"""Frames as one line of text: what they say, in words, with the items of the request named in the answer."""

from __future__ import annotations

import pytest

from plcgen.base.display.view import PLAIN, View
from plcgen.ppi.sim import Bus, Station, Traffic
from plcgen.ppi.sim.station import Switch
from plcgen.ppi.texts import TrafficText
from plcgen.ppi.wire.areas import Area
from plcgen.ppi.wire.model import (
    Item,
    ItemWrite,
    ReadRequest,
    Request,
    RunRequest,
    SetupRequest,
    StopRequest,
    WriteRequest,
)
from plcgen.ppi.wire.telegram import encode_poll, encode_request


def exchange(pdu: Request, *faults: str, station: Station | None = None) -> list[Traffic]:
    """Request, acknowledgement, poll, answer."""
    bus = Bus([station or Station(values={"VB100": 0x22, "T5": 9})], faults)
    bus.exchange(encode_request(pdu), 1000)
    bus.exchange(encode_poll(function=0x5C), 1500)
    return list(bus.journal)


def words(entries: list[Traffic]) -> list[str]:
    text = TrafficText()
    return [text.words(entry) for entry in entries]


def test_a_read() -> None:
    items = (Item.memory(Area.V, 100), Item.memory(Area.V, 9000), Item.element(Area.T, 5), Item.memory(Area.V, 0, 20))
    assert words(exchange(ReadRequest(1, items))) == [
        "read request, station 0 to 2 (6C): VB100, VB9000, T5, VB0[20]",
        "acknowledgement",
        "poll, station 0 to 2 (5C)",
        (
            "read reply, station 2 to 0 (08): VB100 = 22, VB9000 = 05h address out of range, T5 = 00 00 00 00 09,"
            " VB0[20] = 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 .. 20 bytes"
        ),
    ]


def test_a_write() -> None:
    entries = exchange(
        WriteRequest(1, (ItemWrite(Item.memory(Area.V, 0), b"\x0c"), ItemWrite(Item.memory(Area.SM, 0), b"\x01")))
    )
    assert words(entries)[::3] == [
        "write request, station 0 to 2 (6C): VB0 = 0C, SMB0 = 01",
        "write reply, station 2 to 0 (08): VB0 = ok, SMB0 = 03h access denied",
    ]


@pytest.mark.parametrize(
    ("pdu", "request_words", "answer"),
    [
        (SetupRequest(1, 960), "negotiation request, station 0 to 2 (6C): PDU size 960", "PDU size 240"),
        (StopRequest(1), "STOP request, station 0 to 2 (6C)", "STOP reply, station 2 to 0 (08)"),
        (RunRequest(1), "RUN request, station 0 to 2 (6C)", "8001h the mode selector forbids this"),
    ],
)
def test_services(pdu: Request, request_words: str, answer: str) -> None:
    found = words(exchange(pdu, station=Station(switch=Switch.STOP)))
    assert found[0] == request_words
    assert found[3].endswith(answer)


def test_an_answer_without_its_request_names_no_items() -> None:
    """The log may begin in the middle."""
    assert words(exchange(ReadRequest(1, (Item.memory(Area.V, 100),)))[3:]) == ["read reply, station 2 to 0 (08): 22"]


def test_lines_have_time_direction_fault_and_bytes() -> None:
    entries = exchange(ReadRequest(1, (Item.memory(Area.V, 100),)), "fcs")
    text = TrafficText()
    assert text.line(entries[2], PLAIN) == "   1.500  ->  poll, station 0 to 2 (5C)  10 02 00 5C 5E 16"
    line = text.line(entries[3], PLAIN)
    assert line.startswith("   1.500  <-  read reply, station 2 to 0  [fcs]  68 16 16 68 00 02 08")
    assert line.endswith("7A 16")
    assert text.data(entries[3])["fault"] == "fcs"
    assert text.data(entries[3])["time"] == 1500
    assert text.data(entries[3])["direction"] == "answer"


def test_a_terminal_gets_lines_that_fit_and_colours() -> None:
    entry = exchange(ReadRequest(1, (Item.memory(Area.V, 0, 222),)))[3]
    assert len(TrafficText().line(entry, View(width=150, target="screen"))) == 150
    assert TrafficText().line(entry, View(width=150, target="screen")).endswith("...")
    assert TrafficText().line(entry, PLAIN).endswith(entry.data[-8:].hex(" ").upper())
    assert "\x1b[2m" in TrafficText().line(entry, View(color=True))
    assert "\x1b" not in TrafficText().line(entry, PLAIN)


def test_noise_is_counted() -> None:
    bus = Bus([Station()])
    bus.exchange(b"\x68\x1b", 0)
    bus.exchange(b"\xff" + encode_poll(function=0x5C), 900)
    assert words(list(bus.journal)) == [
        "2 bytes of an unfinished frame",
        "1 byte without a frame",
        "poll, station 0 to 2 (5C)",
        "acknowledgement",
    ]


def test_a_broken_frame_is_told_at_once_and_why() -> None:
    """A master with a wrong checksum sees its mistake, not only silence; nothing waits for the next frame."""
    good = encode_request(ReadRequest(0, (Item.memory(Area.V, 100),)))
    bus = Bus([Station()])
    for time, frame in enumerate((good[:-2] + b"\x8a\x16", b"\x68\xff\xff\x68" + bytes(256) + b"\x16", good)):
        bus.exchange(frame, 300 * time)
        assert bus.journal[-1].time == 300 * time
    assert words(list(bus.journal))[:3] == [
        "33 bytes without a frame: the checksum FCS is 8Ah, the bytes add up to 8Bh",
        "261 bytes without a frame: the length LE is 255; it is 4 to 249",
        "read request, station 0 to 2 (6C): VB100",
    ]
