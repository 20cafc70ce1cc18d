"""Which drive answers under which address, and how long a record job takes."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

from plcgen.sim.drive import Drive

Busy = int | Callable[[], int]

_OUTPUT_BIT = 0x8000


@dataclass(slots=True)
class Bus:
    """Drives by logical address or hardware identifier.

    ``write_busy`` and ``read_busy`` say how many calls of a job answer BUSY before the last one; a function is
    asked anew for every job. None keeps a job busy for ever.
    """

    drives: dict[int, Drive] = field(default_factory=dict)
    write_busy: Busy | None = 2
    read_busy: Busy | None = 2

    def attach(self, address: int, drive: Drive) -> None:
        """Put a drive at a logical address or hardware identifier."""
        self.drives[address] = drive

    def find(self, address: int) -> Drive | None:
        """Return the drive at an address; bit 15 of an output-only module is looked through."""
        return self.drives.get(address) or self.drives.get(address & ~_OUTPUT_BIT & 0xFFFFFFFF)

    def busy_calls(self, kind: str) -> int | None:
        """Busy calls of the next job."""
        chosen = self.write_busy if kind == "WRREC" else self.read_busy
        return chosen() if callable(chosen) else chosen

    def advance(self, milliseconds: int) -> None:
        """Let time pass for every drive once."""
        for drive in {id(drive): drive for drive in self.drives.values()}.values():
            drive.advance(milliseconds)
