"""PPI: the client against python-snap7's PPI client on the same simulator, exchanges in memory, telegrams saved."""

from __future__ import annotations

import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

from plcgen.protocols.ppi.wire.model import Item

GOAL = 1.0
"""Reads per second as a multiple of snap7's: over it we are faster."""

SIZE = 222
_ROUNDS, _ROUND = 31, 0.08

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
    from plcgen.protocols.ppi.client import Client

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
    """Best round of ours and of snap7's client, in turns on the same simulator: reads a second, microseconds a read.

    Most of the time is the simulator's and the system's; other load only ever slows a round, so the best ones compare.
    """
    rounds: tuple[list[tuple[float, float]], list[tuple[float, float]]] = ([], [])
    with simulator(*options) as name:
        for number in range(_ROUNDS):
            for which in (0, 1) if number % 2 else (1, 0):
                read, close = (_ours, _snap7)[which](name)
                read()
                rounds[which].append(_round(read))
                close()
    ours, theirs = ((max(rate for rate, _ in row), min(used for _, used in row)) for row in rounds)
    return ours, theirs


def in_memory(seconds: float = 1.0) -> float:
    """Exchanges per second of client, codec and simulated station in one process: 222 bytes each."""
    from plcgen.line.endpoint import EndpointLine
    from plcgen.protocols.ppi.client import Client
    from plcgen.protocols.ppi.sim import Bus, Station

    line = EndpointLine(Bus([Station("226")]))
    client = Client(line, now=lambda: line.clock.now / 1000)
    place = client.place(f"VB0[{SIZE}]")
    count, start = 0, time.perf_counter()
    while time.perf_counter() - start < seconds:
        client.read(place)
        count += 1
    return count / (time.perf_counter() - start)


SCATTERED = (
    [f"VW{2 * n}" for n in range(20)]
    + [f"VD{200 + 10 * n}" for n in range(10)]
    + [f"M{n // 8}.{n % 8}" for n in range(24)]
    + ["I0.0", "I0.5", "Q0.0", "Q1.7", "SMB34", "SMW28", "T32", "T37", "C0", "AIW0", "AIW2", "VB4000", "VB5000[30]"]
)
"""67 values as an operator panel shows them: neighbours, a table with gaps, bits, single ones."""


def telegrams() -> tuple[int, int, int, float, float]:
    """Items, telegrams used, telegrams with 19 items each as asked; seconds at 9600 bit/s packed and one by one."""
    from plcgen.protocols.ppi.wire.address import parse_address
    from plcgen.protocols.ppi.wire.pack import pack_read

    items = [parse_address(text) for text in SCATTERED]
    plan = pack_read(items)
    packed = sum(_seconds([entry.item for entry in telegram]) for telegram in plan.telegrams)
    alone = sum(_seconds([item]) for item in items)
    return len(items), len(plan.telegrams), len(pack_read(items, merge=False).telegrams), packed, alone


def _seconds(items: list[Item]) -> float:
    """Time on the line: request, E5, poll, answer; 11 bits a character at 9600 bit/s, no pauses."""
    from plcgen.protocols.ppi.wire.pdu import reply_size

    characters = (9 + 10 + 2 + 12 * len(items)) + 1 + 6 + (9 + reply_size(items))
    return characters * 11 / 9600


def main() -> None:
    """Print the figures."""
    print(f"PPI: {SIZE}-byte reads a second against python-snap7's PPI client on the same simulator, in turns")
    for title, options in (("pseudo terminal", ()), ("TCP", ("--tcp", "127.0.0.1:0"))):
        (ours, used), (theirs, their_used) = against_snap7(*options)
        rates = f"plcgen {ours:6,.0f}/s   snap7 {theirs:6,.0f}/s   ratio {ours / theirs:.2f}   goal > {GOAL:.0f}"
        print(f"  {title:<16} {rates}   own time {used:.0f} us, snap7 {their_used:.0f} us")
    print(f"  in memory        {in_memory():,.0f} exchanges/s (client, codec and simulated station)")
    count, used, plain, packed, alone = telegrams()
    print(f"  {count} scattered values: {used} telegrams, {plain} without joining neighbours, {count} one by one")
    print(f"  that is {packed:.2f} s instead of {alone:.2f} s at 9600 bit/s, {alone / packed:.1f} times as fast")


if __name__ == "__main__":
    main()
