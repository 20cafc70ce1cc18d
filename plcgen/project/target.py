"""What a CPU family and an engineering tool allow: dialect, encoding, number ranges."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cache
from typing import TYPE_CHECKING

from plcgen.s7.scl.dialect import Dialect

if TYPE_CHECKING:
    from plcgen.project.cpus import CpuType


@dataclass(frozen=True, slots=True)
class Target:
    """A CPU family together with the tool that compiles for it.

    ``max_numbers`` holds the highest block number per kind (CPU data sheets: the largest CPU of the family);
    ``flag_bytes`` the size of the bit memory M in bytes; ``cpu`` is the CPU type if the spec names one.
    """

    family: str
    toolchain: str
    dialect: Dialect
    encoding: str
    xml_version: str | None
    max_numbers: dict[str, int]
    flag_bytes: int
    cpu: CpuType | None = None

    @property
    def v5(self) -> bool:
        """Whether STEP 7 V5 compiles the sources."""
        return self.dialect is Dialect.STEP7_V5

    @property
    def t15(self) -> bool:
        """Whether the CPU is an S7-1200 or S7-1500."""
        return not self.dialect.classic

    @property
    def classic(self) -> bool:
        """Whether the CPU is an S7-300 or S7-400."""
        return not self.t15


XML_VERSIONS = {
    "tia-v14sp1": "V14 SP1", "tia-v15": "V15", "tia-v15.1": "V15.1", "tia-v16": "V16", "tia-v17": "V17",
    "tia-v18": "V18", "tia-v19": "V19", "tia-v20": "V20", "tia-v21": "V21",
}  # fmt: skip
"""``Engineering@version`` by toolchain; STEP 7 V5, V13 SP1 and V14 get text sources only: they know no SCL as XML."""

_NUMBERS = {
    "s7-300": {"FB": 7999, "DB": 16000, "UDT": 65535},
    "s7-400": {"FB": 7999, "DB": 16000, "UDT": 65535},
    "s7-1200": {"FB": 65535, "DB": 59999, "UDT": 65535},
    "s7-1500": {"FB": 65535, "DB": 59999, "UDT": 65535},
}
_FLAGS = {"s7-300": 8192, "s7-400": 16384, "s7-1200": 8192, "s7-1500": 16384}


def toolchain_id(text: str) -> str:
    """The id of a toolchain in any of its spellings: ``TIA-V19``, ``V19`` and ``v14 sp1`` are ids of the TIA Portal."""
    plain = text.strip().lower().replace(" ", "")
    return f"tia-{plain}" if plain.startswith("v") else plain


def target(family: str, toolchain: str, cpu: CpuType | None = None) -> Target:
    """Describe a target; the combination has been checked by :func:`combination_problem`."""
    return _target(family, toolchain) if cpu is None else replace(_target(family, toolchain), cpu=cpu)


@cache
def _target(family: str, toolchain: str) -> Target:
    new = family in {"s7-1200", "s7-1500"}
    v5 = toolchain == "step7-v5"
    dialect = Dialect.TIA_1200_1500 if new else Dialect.STEP7_V5 if v5 else Dialect.TIA_300_400
    xml = XML_VERSIONS.get(toolchain)
    return Target(family, toolchain, dialect, "cp1252" if v5 else "utf-8-sig", xml, _NUMBERS[family], _FLAGS[family])


def combination_problem(family: str, toolchain: str) -> str | None:
    """Why a family cannot be programmed with a tool, or None."""
    if toolchain == "step7-v5" and family in {"s7-1200", "s7-1500"}:
        return f"STEP 7 V5 does not support the {family.upper()}"
    return None
