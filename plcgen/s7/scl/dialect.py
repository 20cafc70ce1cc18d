"""The three dialects of Siemens SCL that one grammar serves."""

from __future__ import annotations

import enum


class Dialect(enum.StrEnum):
    """Who compiles the source: the parser accepts all three, ``dialects.check_dialect`` tells them apart."""

    STEP7_V5 = "STEP7_V5"
    TIA_300_400 = "TIA_300_400"
    TIA_1200_1500 = "TIA_1200_1500"

    @property
    def is_tia(self) -> bool:
        """Whether the TIA Portal compiles it."""
        return self is not Dialect.STEP7_V5

    @property
    def classic(self) -> bool:
        """Whether the target is an S7-300/400."""
        return self is not Dialect.TIA_1200_1500

    @property
    def label(self) -> str:
        """How messages name the target."""
        return _LABELS[self]


_LABELS = {
    Dialect.STEP7_V5: "STEP 7 V5",
    Dialect.TIA_300_400: "TIA Portal, S7-300/400",
    Dialect.TIA_1200_1500: "TIA Portal, S7-1200/1500",
}

BY_NAME = {"v5": Dialect.STEP7_V5, "tia-300": Dialect.TIA_300_400, "tia-1500": Dialect.TIA_1200_1500}
"""Short names of the targets, for people."""
