"""Which drive answers under which address, how long a record job takes, and which serial ports there are."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Literal, Protocol

from plcgen.s7.cpu.system.port import Port


class RecordServer(Protocol):
    """What answers WRREC and RDREC at an address: a simulated drive."""

    def write_record(self, index: int, data: bytes) -> int:
        """Take a data record; returns the STATUS, 0 if it is good."""

    def read_record(self, index: int, max_length: int) -> tuple[int, bytes]:
        """Return STATUS and the bytes of a data record."""

    def advance(self, milliseconds: int) -> None:
        """Let time pass."""


Busy = int | Callable[[], int]

_OUTPUT_BIT = 0x8000


@dataclass(slots=True)
class Periphery:
    """Drives by logical address or hardware identifier.

    ``write_busy`` and ``read_busy`` say how many scans a job takes: as many calls, one a scan, answer BUSY. A function
    is asked anew for every job. None keeps a job busy forever. ``write_time`` and ``read_time`` say it in ms instead.
    ``network`` is that of the drives: on PROFIBUS a good RDREC may set STATUS[4]. ``ports`` are serial ports by
    hardware identifier (S7-1200/1500) or address of their module (S7-300/400).
    """

    drives: dict[int, RecordServer] = field(default_factory=dict)
    write_busy: Busy | None = 2
    read_busy: Busy | None = 2
    ports: dict[int, Port] = field(default_factory=dict)
    write_time: Busy | None = None
    read_time: Busy | None = None
    network: Literal["profinet", "profibus"] = "profinet"

    def attach(self, address: int, drive: RecordServer) -> None:
        """Put a drive at a logical address or hardware identifier."""
        self.drives[address] = drive

    def find(self, address: int) -> RecordServer | None:
        """Return the drive at an address; bit 15 of an output-only module is looked through."""
        return self.drives.get(address) or self.drives.get(address & ~_OUTPUT_BIT & 0xFFFFFFFF)

    def duration(self, kind: str) -> tuple[int | None, int | None]:
        """Scans and milliseconds that the next job takes; milliseconds are None unless they decide."""
        time = self.write_time if kind == "WRREC" else self.read_time
        if time is not None:
            return None, time() if callable(time) else time
        chosen = self.write_busy if kind == "WRREC" else self.read_busy
        return chosen() if callable(chosen) else chosen, None

    def advance(self, milliseconds: int) -> None:
        """Let time pass for every drive once."""
        if self.drives:
            for drive in {id(drive): drive for drive in self.drives.values()}.values():
                drive.advance(milliseconds)
        for port in self.ports.values():
            port.advance(milliseconds)
