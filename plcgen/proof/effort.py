"""How much a verification runs."""

from __future__ import annotations

from typing import Literal, get_args

Faults = Literal["none", "quick", "full"]
"""How much of the fault matrix runs: nothing, everything once, or every combination."""
FAULTS: tuple[Faults, ...] = get_args(Faults)
