"""The count of loop passes, which the loops of all blocks share."""

from __future__ import annotations

from dataclasses import dataclass

from plcgen.cpu.compiler.listing import Listing


@dataclass(slots=True, eq=False)
class Watchdog:
    """Inside loops the count is a Python local, ``n``; ``depth`` is how many loops are open."""

    out: Listing
    depth: int = 0

    def hand_over(self) -> None:
        """Hand the count of loop passes to what is called."""
        if self.depth:
            self.out.emit("W[0]=n")

    def take_back(self) -> None:
        """Take the count of loop passes back."""
        if self.depth:
            self.out.emit("n=W[0]")
