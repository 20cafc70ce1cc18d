"""How clients that others wrote speak, telegram by telegram: none of them keeps to the whole standard.

libnodave sends 6Ch on every request, in two pieces, polls with 5Ch and after E5 with 7Ch, 5Ch, ...; HslCommunication
reads with 6Ch, writes with 7Ch and polls with 5Ch only; programs after the seed document send 6Ch and one fixed poll.
"""

from __future__ import annotations

import pytest

from plcgen.ppi.sim import Bus, Station
from plcgen.ppi.sim.station import Mode
from tests.s7_200_talk import E5


class Client:
    """Builds frames from hex without the codec; ``station`` is their destination, 0 their source."""

    def __init__(self, bus: Bus, station: int = 2) -> None:
        self.bus, self.station = bus, station

    def frame(self, function: int, pdu: str) -> bytes:
        """SD2 frame around a PDU."""
        body = bytes((self.station, 0, function)) + bytes.fromhex(pdu)
        return bytes((0x68, len(body), len(body), 0x68)) + body + bytes((sum(body) & 0xFF, 0x16))

    def poll(self, function: int) -> bytes:
        """SD1 frame."""
        return bytes((0x10, self.station, 0, function, (self.station + function) & 0xFF, 0x16))

    def libnodave(self, pdu: str, polls: int = 10) -> str:
        """PDU of the answer."""
        frame = self.frame(0x6C, pdu)
        assert self.bus.exchange(frame[:4]) + self.bus.exchange(frame[4:]) == E5
        alternate = 0x5C
        for _ in range(polls):
            poll = self.poll(alternate)
            answer = self.bus.exchange(poll[:1]) + self.bus.exchange(poll[1:])
            if answer != E5:
                assert answer[4:7] == bytes((0, self.station, 8))
                return answer[7:-2].hex(" ").upper()
            alternate = 0x7C if alternate == 0x5C else 0x5C
        return "E5"

    def hsl(self, pdu: str, *, write: bool) -> bytes:
        """Whole frame of the answer; a second E5 is its end."""
        assert self.bus.exchange(self.frame(0x7C if write else 0x6C, pdu)) == E5
        return self.bus.exchange(self.poll(0x5C))


@pytest.fixture
def station() -> Station:
    return Station(values={"VB100": 0x22, "M0.3": True, "T32": {"value": 5, "on": True}, "C5": 7, "IB0": 0x81})


def test_libnodave_connects_reads_and_writes(station: Station) -> None:
    """It asks for PDUs of 960 bytes, then reads and writes bytes and bits."""
    client = Client(Bus([station]))
    assert client.libnodave("32 01 00 00 00 00 00 08 00 00 F0 00 00 01 00 01 03 C0") == (
        "32 03 00 00 00 00 00 08 00 00 00 00 F0 00 00 01 00 01 00 F0"
    )
    assert client.libnodave("32 01 00 00 00 01 00 0E 00 00 04 01 12 0A 10 02 00 01 00 01 84 00 03 20") == (
        "32 03 00 00 00 01 00 02 00 05 00 00 04 01 FF 04 00 08 22"
    )
    write = "32 01 00 00 00 02 00 0E 00 06 05 01 12 0A 10 02 00 02 00 01 84 00 03 20 00 04 00 10 AB CD"
    assert client.libnodave(write) == "32 03 00 00 00 02 00 02 00 01 00 00 05 01 FF"
    assert station["VW100"] == 0xABCD
    bit = "32 01 00 00 00 03 00 0E 00 05 05 01 12 0A 10 01 00 01 00 00 82 00 00 0A 00 03 00 01 01"
    assert client.libnodave(bit) == "32 03 00 00 00 03 00 02 00 01 00 00 05 01 FF"
    assert station["Q1.2"] is True


def test_libnodave_reads_several_items_timers_and_counters(station: Station) -> None:
    client = Client(Bus([station]))
    items = (
        "12 0A 10 1F 00 01 00 00 1F 00 00 20",
        "12 0A 10 1E 00 01 00 00 1E 00 00 05",
        "12 0A 10 02 00 01 00 00 81 00 00 00",
        "12 0A 10 01 00 01 00 00 83 00 00 03",
    )
    assert client.libnodave("32 01 00 00 00 04 00 32 00 00 04 04" + "".join(items)) == (
        "32 03 00 00 00 04 00 02 00 1D 00 00 04 04"
        " FF 09 00 05 02 00 00 00 05 00 FF 09 00 03 00 00 07 00 FF 04 00 08 81 00 FF 03 00 01 01"
    )


def test_libnodave_starts_and_stops(station: Station) -> None:
    client = Client(Bus([station]))
    assert client.libnodave("32 01 00 00 00 05 00 10 00 00 29 00 00 00 00 00 09 50 5F 50 52 4F 47 52 41 4D").endswith(
        "29"
    )
    assert station.mode is Mode.STOP
    run = "32 01 00 00 00 06 00 14 00 00 28 00 00 00 00 00 00 FD 00 00 09 50 5F 50 52 4F 47 52 41 4D"
    assert client.libnodave(run).endswith("28")
    assert station.mode is Mode.RUN


@pytest.mark.parametrize("rule", ["standard", "strict"])
def test_libnodave_waits_as_long_as_the_cpu_is_not_ready(rule: str) -> None:
    """It alternates its polls, so even the strict rule serves it."""
    client = Client(Bus([Station(not_ready=6, frame_count=rule)]))  # type: ignore[arg-type]
    read = "32 01 00 00 00 01 00 0E 00 00 04 01 12 0A 10 02 00 01 00 01 84 00 03 20"
    for _ in range(2):
        assert client.libnodave(read).startswith("32 03")


@pytest.mark.parametrize("number", [2, 3, 126])
def test_hsl_reads_and_writes_in_any_order(number: int) -> None:
    """The polls (5C) lie between requests (6C, 7C): the frame count bit alternates without its knowing."""
    station = Station(address=number, values={"VB100": 0x22})
    client = Client(Bus([station]), number)
    read = "32 01 00 00 00 00 00 0E 00 00 04 01 12 0A 10 02 00 01 00 01 84 00 03 20"
    write = "32 01 00 00 00 00 00 0E 00 05 05 01 12 0A 10 02 00 01 00 01 84 00 03 20 00 04 00 08 "
    for value in ("0C", "0D", "0E"):
        assert client.hsl(write + value, write=True)[21] == 0xFF
        assert client.hsl(write + value, write=True)[21] == 0xFF
        assert client.hsl(read, write=False)[25] == int(value, 16)
    assert station.executed == 9


def test_a_program_after_the_seed_document_polls_without_looking(station: Station) -> None:
    """It sends request and poll and takes whatever comes: E5 and the answer in one read."""
    bus = Bus([station])
    request = bytes.fromhex(
        "68 1B 1B 68 02 00 6C 32 01 00 00 00 00 00 0E 00 00 04 01 12 0A 10 02 00 01 00 01 84 00 03 20 8B 16"
    )
    answer = bytes.fromhex("68 16 16 68 00 02 08 32 03 00 00 00 00 00 02 00 05 00 00 04 01 FF 04 00 08 22 78 16")
    for _ in range(3):
        assert bus.exchange(request + bytes.fromhex("10 02 00 5C 5E 16")) == E5 + answer


def test_a_multi_master_tool_passes_tokens_and_looks_for_stations(station: Station) -> None:
    """Tokens to itself, FDL status requests to all addresses, then a request in between."""
    bus = Bus([station])
    found = []
    for address in range(32):
        assert bus.exchange(bytes((0xDC, 0, 0))) == b""
        status = bytes((0x10, address, 0, 0x49, (address + 0x49) & 0xFF, 0x16))
        if bus.exchange(status):
            found.append(address)
    assert found == [2]
    assert (
        Client(bus).libnodave("32 01 00 00 00 01 00 0E 00 00 04 01 12 0A 10 02 00 01 00 01 84 00 03 20").endswith("22")
    )
