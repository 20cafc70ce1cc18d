"""How long the scans are: short while something travels, longer while all jobs wait for a time."""

from __future__ import annotations

from collections.abc import Iterable

from plcgen.ds47.sim.drive import Drive
from plcgen.s7.cpu.cpu import Cpu

SCAN = 10
"""Length of a scan in ms."""
QUIET_SCAN = 50
"""The same behind ``QUIET`` scans without a data record: jobs pause between questions, or their time runs out."""
QUIET = 12


class Pace:
    """Scan lengths of a CPU with some drives."""

    def __init__(self, cpu: Cpu, drives: Iterable[Drive]) -> None:
        self.cpu, self.journals = cpu, [drive.journal for drive in drives]
        self.seen = self.quiet = 0
        """Data records until now; scans since the last one."""

    def length(self) -> int:
        """Length of the next scan in ms."""
        seen = sum(map(len, self.journals))
        still = seen == self.seen and not self.cpu.records.jobs
        self.seen, self.quiet = seen, self.quiet + 1 if still else 0
        return QUIET_SCAN if self.quiet > QUIET else SCAN
