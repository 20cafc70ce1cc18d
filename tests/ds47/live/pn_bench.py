"""A simulated drive as a PROFINET device without a network: a link that carries datagrams, and loses some."""

from __future__ import annotations

import contextlib
import socket
import threading
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field
from typing import Any

from plcgen.ds47.device import Device
from plcgen.ds47.devices import find_device
from plcgen.ds47.live.channel import PnParameters
from plcgen.ds47.live.profinet import PnConnection, PnPartner
from plcgen.ds47.sim.behaviour import Behaviour
from plcgen.ds47.sim.drive import Drive
from plcgen.ds47.sim.faults import Fault
from plcgen.ds47.sim.parameters import DriveObject, SimulatedParameter, ValueLimits
from plcgen.ds47.sim.pn_device import PnDevice, serve_udp
from plcgen.ds47.wire import formats
from plcgen.ds47.wire.model import RequestId

PLACE = PnPartner("127.0.0.1")
S120 = find_device("sinamics-s120")


def drive(*faults: Fault, processing: int = 0, **others: Any) -> Drive:
    """Drive object 2 of a drive that behaves as ``others`` says.

    Ramps of two data sets (0 to 100), a display, a text, an array of 120 words, a signal source.
    """
    real, word = formats.by_name("FloatingPoint"), formats.by_name("Unsigned16")
    limits = ValueLimits(0, 100)
    parameters = [
        SimulatedParameter(1120, real, [10.0, 5.5], array=True, limits=limits),
        SimulatedParameter(1121, real, [20.0, 6.5], array=True, limits=limits),
        SimulatedParameter(52, word, [1000], read_only=True),
        SimulatedParameter(59900, word, list(range(120)), array=True),
        SimulatedParameter(59901, formats.by_name("VisibleString"), ["pump 7  "]),
        SimulatedParameter(840, formats.by_name("Unsigned32"), [722 << 16 | 0xFC00 | 2]),
    ]
    behaviour = Behaviour(record_indexes=(47, 0xB02E, 0xB02F), local_object=2, processing=processing, **others)
    return Drive(behaviour, [DriveObject(2, {one.pnu: one for one in parameters})], faults)


def changes(one: Drive) -> int:
    """Requests to change something that have reached the drive."""
    return sum(call.direction == "write" and call.data[1] == RequestId.CHANGE for call in one.journal)


Damage = Callable[[int, bytes], Iterable[bytes]]
"""What becomes of a datagram, by its number in its direction from 0."""


def intact(_number: int, data: bytes) -> Iterable[bytes]:
    """It comes as it was sent."""
    return (data,)


@dataclass
class Wire:
    """A link to a device in the same process; its clock runs when somebody waits. ``seen`` is all that was on it."""

    device: PnDevice
    there: Damage = intact
    back: Damage = intact
    time: float = 0.0
    seen: list[tuple[str, bytes]] = field(default_factory=list)
    waiting: list[bytes] = field(default_factory=list)
    counts: dict[str, int] = field(default_factory=lambda: {"there": 0, "back": 0})

    def send(self, data: bytes) -> None:
        """To the device, whose answers are there at once."""
        self.seen.append(("there", data))
        for request in self._passed("there", self.there, data):
            for answer in self.device.receive(request):
                self.seen.append(("back", answer))
                self.waiting += self._passed("back", self.back, answer)

    def _passed(self, way: str, damage: Damage, data: bytes) -> Iterable[bytes]:
        self.counts[way] += 1
        return damage(self.counts[way] - 1, data)

    def receive(self, until: float) -> bytes | None:
        """The next datagram, or the time is over."""
        if self.waiting:
            return self.waiting.pop(0)
        self.pause(max(0.0, until - self.time))
        return None

    def now(self) -> float:
        """The time."""
        return self.time

    def pause(self, seconds: float) -> None:
        """Let time pass for both ends."""
        self.time += seconds
        self.device.advance(int(seconds * 1000))


@contextlib.contextmanager
def channel(wire: Wire, order: str = "little", index: int = 0xB02F, known: Device = S120) -> Iterator[PnParameters]:
    """A connection over a wire."""
    with PnConnection(PLACE, index, 5.0, wire, order) as connection:  # type: ignore[arg-type]
        yield PnParameters(connection, known)


@contextlib.contextmanager
def served(one: Drive) -> Iterator[str]:
    """The drive on a UDP port of this machine, and its address."""
    ended = threading.Event()
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as where:
        where.bind(("127.0.0.1", 0))
        port = where.getsockname()[1]
        thread = threading.Thread(target=serve_udp, args=(PnDevice(one, port=port), where, ended.is_set))
        thread.start()
        try:
            yield f"pn://127.0.0.1:{port}"
        finally:
            ended.set()
            thread.join()
