"""Telegrams of real lines that others published, each with its source: codec and simulated station against them."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from plcgen.ppi.sim import Bus, Station
from plcgen.ppi.wire.address import parse_item
from plcgen.ppi.wire.model import (
    ItemWrite,
    ReadReply,
    ReadRequest,
    StopRequest,
    VariableFrame,
    WriteReply,
    WriteRequest,
)
from plcgen.ppi.wire.pdu import encode_pdu
from plcgen.ppi.wire.telegram import decode_telegram
from tests.yaml_files import read_yaml

TRACES = read_yaml((Path(__file__).parents[1] / "vectors" / "ppi_traces.yaml").read_text(encoding="utf-8"))
POLL = bytes.fromhex("10 02 00 5C 5E 16")


def pdus(trace: dict[str, Any]) -> tuple[Any, Any]:
    """The PDUs of request and reply; their frames are right."""
    found = [decode_telegram(bytes.fromhex(trace[name])) for name in ("request", "reply")]
    return found[0].pdu, found[1].pdu


def named(trace: dict[str, Any], key: str) -> list[tuple[Any, bytes]]:
    return [(parse_item(address), bytes.fromhex(data)) for address, data in trace[key].items()]


@pytest.mark.parametrize("trace", TRACES, ids=lambda trace: trace["request"][-50:])
def test_a_trace_says_what_was_read_from_it_by_hand(trace: dict[str, Any]) -> None:
    """Addresses and values, and the bytes again from them."""
    request, reply = pdus(trace)
    if "read" in trace:
        assert request == ReadRequest(request.reference, tuple(item for item, _ in named(trace, "read")))
        assert isinstance(reply, ReadReply)
        assert [(result.code, result.data) for result in reply.results] == [
            (0xFF, data) for _, data in named(trace, "read")
        ]
    elif "write" in trace:
        entries = tuple(ItemWrite(item, data) for item, data in named(trace, "write"))
        assert request == WriteRequest(request.reference, entries)
        assert reply == WriteReply(request.reference, (0xFF,))
    else:
        assert request == StopRequest(0)
    assert reply.reference == request.reference
    for name, pdu in (("request", request), ("reply", reply)):
        frame = decode_telegram(bytes.fromhex(trace[name])).frame
        assert isinstance(frame, VariableFrame)
        assert encode_pdu(pdu) == frame.pdu


@pytest.mark.parametrize("trace", TRACES, ids=lambda trace: trace["request"][-50:])
def test_the_simulated_station_answers_like_the_real_one(trace: dict[str, Any]) -> None:
    """With the same values: E5 to the request, the same bytes to the poll."""
    station = Station()
    for item, data in named(trace, "read") if "read" in trace else ():
        station.cpu.memory.put(item, data)
    bus = Bus([station])
    assert bus.exchange(bytes.fromhex(trace["request"])) == b"\xe5"
    assert bus.exchange(POLL) == bytes.fromhex(trace["reply"])
    for item, data in named(trace, "write") if "write" in trace else ():
        assert station.cpu.memory.read(item).data == data


def test_a_timer_at_its_end_has_the_status_of_the_capture() -> None:
    """T32 at 32767, the highest value of a timer, has its bit on."""
    station = Station(values={"T32": {"value": 32767, "on": True}})
    (trace,) = (trace for trace in TRACES if "T32[3]" in trace.get("read", {}))
    assert station.cpu.memory.read(parse_item("T32")).data == bytes.fromhex(trace["read"]["T32[3]"])[:5]
