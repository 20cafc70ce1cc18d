"""Error numbers of data set 47 as text; the table is ``data/error_numbers.toml``, read when first needed.

65h..FFh belongs to the manufacturer: other vendors reuse these numbers with other meanings, so the caller
names the table that the device profile chooses.
"""

from __future__ import annotations

import tomllib
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Literal, TypeAlias, get_args

Table: TypeAlias = Literal["sinamics", "profidrive"]
TABLES: tuple[Table, ...] = get_args(Table)

MANUFACTURER_FIRST = 0x65


@dataclass(frozen=True, slots=True)
class ErrorNumber:
    """One error number: meaning, what the second word holds, where the meaning comes from."""

    number: int
    meaning: str
    info: str
    origin: str
    manufacturer: bool
    note: str = ""

    def explain(self, info: int | None = None) -> str:
        """Return the meaning with the number and, where it says something, the information word."""
        text = f"{self.number:02X}h {self.meaning}"
        if info is None or (info == 0 and self.info != "subindex"):
            return text
        return f"{text} ({'subindex' if self.info == 'subindex' else 'information word'} {info})"


@cache
def _sinamics() -> dict[int, ErrorNumber]:
    path = Path(__file__).parent / "data" / "error_numbers.toml"
    rows = tomllib.loads(path.read_text(encoding="utf-8"))["error"]
    return {row["number"]: ErrorNumber(manufacturer=row["number"] >= MANUFACTURER_FIRST, **row) for row in rows}


def known_numbers() -> tuple[int, ...]:
    """Return every number of the SINAMICS table, ascending."""
    return tuple(sorted(_sinamics()))


def error_text(number: int, table: Table = "sinamics") -> ErrorNumber:
    """Explain an error number; a number that the table does not hold is reserved or manufacturer-specific."""
    manufacturer = number >= MANUFACTURER_FIRST
    found = _sinamics().get(number)
    if table == "profidrive" and found is not None and not found.origin.startswith("PROFIdrive"):
        found = None
    if found is not None:
        return found
    meaning = "manufacturer-specific" if manufacturer else "reserved"
    return ErrorNumber(number, meaning, "unknown", "not in the table", manufacturer)
