"""Hours on a bad line, in virtual time: no read is missed, no value is wrong, nothing is executed twice or in secret.

The line damages every byte with a probability of 1 in 10,000, which is 2.5 % of the answers of 240 bytes, and loses one
frame in 200 in either direction. A read needs two attempts to fail as a whole, and each of them four lost requests in a
row or eleven polls: that is far less than once in a year. A damaged byte changes the sum, so a wrong value needs at
least two of them whose changes add up to a multiple of 256: 28,800 answers x 3 in 10,000 x 1 in 255 is 0.03 in 8 hours.
"""

from __future__ import annotations

import random

import pytest

from plcgen.base.line.endpoint import EndpointLine
from plcgen.ppi.client import Client, ClientError, Settings
from plcgen.ppi.sim import Bus, Station

EXECUTED = "may have been executed"


class NoisyBus(Bus):
    """A bus on a line with noise."""

    def __init__(self, stations: list[Station], seed: int, byte: float = 1e-4, frame: float = 1 / 200) -> None:
        super().__init__(stations)
        self.random, self.byte, self.frame = random.Random(seed), byte, frame  # noise

    def noisy(self, data: bytes) -> bytes:
        """What arrives of bytes that were sent."""
        if not data or self.random.random() < self.frame:
            return b""
        if self.random.random() > len(data) * self.byte:
            return data
        damaged = bytearray(data)
        damaged[self.random.randrange(len(data))] ^= self.random.randrange(1, 256)
        return bytes(damaged)

    def receive(self, data: bytes, now: int) -> None:
        """Bytes of the client."""
        super().receive(self.noisy(data), now)

    def transmit(self, now: int) -> bytes:
        """Bytes of the station."""
        return self.noisy(super().transmit(now))


def line(seed: int, **noise: float) -> tuple[Client, Station, EndpointLine]:
    """A client, its station and the line, whose clock is the time."""
    station = Station("226")
    ends = EndpointLine(NoisyBus([station], seed, **noise))
    return Client(ends, Settings(), now=lambda: ends.clock.now / 1000), station, ends


@pytest.mark.parametrize("seed", [pytest.param(1), *(pytest.param(seed, marks=pytest.mark.slow) for seed in (2, 3))])
def test_eight_hours_of_reading(seed: int) -> None:
    """One read of 222 bytes a second: 28,800 reads, 0 are missed, and every value is that of this second."""
    client, station, ends = line(seed)
    place = client.place("VB0[222]")
    for second in range(8 * 3600):
        ends.clock.now = max(ends.clock.now, second * 1000)
        station["VD100"] = second
        assert client.read(place)[0].data[100:104] == second.to_bytes(4)
    count = client.exchange.count
    assert count.repeats > 600, "the line was not bad: 1 in 100 exchanges has a frame that is lost, 1 in 40 damage"


@pytest.mark.parametrize("seed", [4, pytest.param(5, marks=pytest.mark.slow)])
def test_hours_of_writing_and_stopping(seed: int) -> None:
    """On a line that loses a third of all frames: what is not told to have failed is done, what may have been executed
    is told so, what was refused to be so was not; and each is executed once at most.
    """
    client, station, ends = line(seed, frame=1 / 3)
    told = {"done": 0, "unknown": 0, "not": 0}
    done = []
    original = station.cpu.memory.write

    def write(item, data):
        done.append(data)
        return original(item, data)

    station.cpu.memory.write = write
    for number in range(3000):
        ends.clock.now += 1000
        value = number.to_bytes(2)
        try:
            client.write({"VW0": number})
        except ClientError as problem:
            text = problem.diagnostics[0].message
            told["unknown" if EXECUTED in text else "not"] += 1
            assert EXECUTED in text or value not in done, text
        else:
            told["done"] += 1
            assert value in done
        assert done.count(value) <= 1
    assert min(told.values()) > 10, told
