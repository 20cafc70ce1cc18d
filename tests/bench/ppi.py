"""PPI: the client against python-snap7's PPI client on the same simulator, exchanges in memory, telegrams saved."""

from __future__ import annotations

import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from statistics import median
from typing import Any

from plcgen.base.line.endpoint import EndpointLine
from plcgen.ppi.client import Client
from plcgen.ppi.sim import Bus, Station
from plcgen.ppi.wire.model import Item

GOAL = 1.0
"""Reads per second as a multiple of snap7's: over it we are faster."""
TIME_GOAL = 1.3
"""Processor time of a read with snap7's client as a multiple of ours."""

SIZE = 222
_ROUNDS, _ROUND = 7, 0.4
SIMULATOR_GOAL = 40.0
"""Microseconds of the simulated station's own time for an exchange in memory."""

Read = Callable[[], object]


@contextmanager
def simulator(*options: str) -> Iterator[str]:
    """Run ``plcgen ppi serve`` as a process of its own and return the name of its line."""
    command = [sys.executable, "-m", "plcgen", "ppi", "serve", "--cpu", "226", *options]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
    try:
        yield process.stdout.readline().split()[0] if process.stdout else ""
    finally:
        process.terminate()
        process.wait()


def _ours(name: str) -> tuple[Read, Callable[[], object]]:
    client = Client.open(name)
    place = client.place(f"VB0[{SIZE}]")
    return lambda: client.read(place), client.close


def _snap7(name: str) -> tuple[Read, Callable[[], object]]:
    import serial
    from snap7.ppi import PPIClient, PPITransport

    port: Any = serial.serial_for_url(name, timeout=0.5) if name.startswith("socket:") else None
    transport = PPITransport(name, timeout=0.5, serial_port=port)
    client = PPIClient(name, transport=transport).connect()

    def close() -> None:
        client.disconnect()
        if port is not None:
            port.close()

    return lambda: client.v_read(0, SIZE), close


def _round(read: Read) -> tuple[float, float]:
    """Reads per second of one round, and our own processor time for each in microseconds."""
    count, start, used = 0, time.perf_counter(), time.process_time()
    while time.perf_counter() - start < _ROUND:
        read()
        count += 1
    return count / (time.perf_counter() - start), (time.process_time() - used) / count * 1e6


def against_snap7(*options: str) -> tuple[tuple[float, float], tuple[float, float]]:
    """Medians of seven rounds of ours and of snap7's client, in turns on the same simulator: reads a second,
    microseconds of own time a read.
    """
    rounds: tuple[list[tuple[float, float]], list[tuple[float, float]]] = ([], [])
    with simulator(*options) as name:
        for number in range(_ROUNDS):
            for which in (0, 1) if number % 2 else (1, 0):
                read, close = (_ours, _snap7)[which](name)
                read()
                rounds[which].append(_round(read))
                close()
    ours, theirs = ((median(rate for rate, _ in row), median(used for _, used in row)) for row in rounds)
    return ours, theirs


class _Timed:
    """A bus with a stopwatch around all that it does."""

    def __init__(self, bus: Bus) -> None:
        self.bus, self.used = bus, 0.0

    def receive(self, data: bytes, now: int) -> None:
        start = time.process_time()
        self.bus.receive(data, now)
        self.used += time.process_time() - start

    def transmit(self, now: int) -> bytes:
        start = time.process_time()
        found = self.bus.transmit(now)
        self.used += time.process_time() - start
        return found

    def due(self) -> int | None:
        return self.bus.due()


def in_memory(count: int = 2000) -> tuple[float, float]:
    """Exchanges per second of client, codec and simulated station in one process, 222 bytes each, and microseconds of
    the station alone; medians of seven rounds.
    """
    timed = _Timed(Bus([Station("226")]))
    line = EndpointLine(timed)
    client = Client(line, now=lambda: line.clock.now / 1000)
    place = client.place(f"VB0[{SIZE}]")
    rates, own = [], []
    for _ in range(_ROUNDS):
        timed.used, start = 0.0, time.perf_counter()
        for _ in range(count):
            client.read(place)
        rates.append(count / (time.perf_counter() - start))
        own.append(timed.used / count * 1e6)
    return median(rates), median(own)


SCATTERED = (
    [f"VW{2 * n}" for n in range(20)]
    + [f"VD{200 + 10 * n}" for n in range(10)]
    + [f"M{n // 8}.{n % 8}" for n in range(24)]
    + ["I0.0", "I0.5", "Q0.0", "Q1.7", "SMB34", "SMW28", "T32", "T37", "C0", "AIW0", "AIW2", "VB4000", "VB5000[30]"]
)
"""67 values as an operator panel shows them: neighbours, a table with gaps, bits, single ones."""


def telegrams() -> tuple[int, int, int, float, float]:
    """Items, telegrams used, telegrams with 19 items each as asked; seconds at 9600 bit/s packed and one by one."""
    from plcgen.ppi.wire.address import parse_item
    from plcgen.ppi.wire.pack import pack_read

    items = [parse_item(text) for text in SCATTERED]
    plan = pack_read(items)
    packed = sum(_seconds([entry.item for entry in telegram]) for telegram in plan.telegrams)
    alone = sum(_seconds([item]) for item in items)
    return len(items), len(plan.telegrams), len(pack_read(items, merge=False).telegrams), packed, alone


def _seconds(items: list[Item]) -> float:
    """Time on the line: request, E5, poll, answer; 11 bits a character at 9600 bit/s, no pauses."""
    from plcgen.ppi.wire.pdu import reply_size

    characters = (9 + 10 + 2 + 12 * len(items)) + 1 + 6 + (9 + reply_size(items))
    return characters * 11 / 9600


def main() -> None:
    """Print the figures."""
    print(f"PPI: {SIZE}-byte reads a second against python-snap7's PPI client on the same simulator, in turns")
    for title, options in (("pseudo terminal", ()), ("TCP", ("--tcp", "127.0.0.1:0"))):
        (ours, used), (theirs, their_used) = against_snap7(*options)
        rates = f"plcgen {ours:6,.0f}/s   snap7 {theirs:6,.0f}/s   ratio {ours / theirs:.2f}   goal > {GOAL:.0f}"
        print(f"  {title:<16} {rates}")
        times = f"{used:.0f} us, snap7 {their_used:.0f} us   ratio {their_used / used:.2f}   goal > {TIME_GOAL}"
        print(f"  {'':<16} processor time of a read {times}")
    rate, own = in_memory()
    print(f"  in memory        {rate:,.0f} exchanges/s (client, codec and simulated station)")
    print(f"  the station      {own:.0f} us of its own for an exchange   goal < {SIMULATOR_GOAL:.0f}")
    count, used, plain, packed, alone = telegrams()
    print(f"  {count} scattered values: {used} telegrams, {plain} without joining neighbours, {count} one by one")
    print(f"  that is {packed:.2f} s instead of {alone:.2f} s at 9600 bit/s, {alone / packed:.1f} times as fast")


if __name__ == "__main__":
    main()
