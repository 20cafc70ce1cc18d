"""Return codes of items, error codes of headers and function codes of frames as text.

The table is ``data/codes.toml``, read when first needed.
"""

from __future__ import annotations

import tomllib
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from plcgen.ppi.wire.model import FCB, FCV, FIRST, REQUEST


@dataclass(frozen=True, slots=True)
class Meaning:
    """What a code says, and what to do about it (empty if there is nothing to do)."""

    text: str
    help: str = ""


@cache
def _table() -> dict[str, dict[int, Meaning]]:
    path = Path(__file__).parent / "data" / "codes.toml"
    rows = tomllib.loads(path.read_text(encoding="utf-8"))
    return {
        kind: {int(code, 16): Meaning(row["meaning"], row.get("help", "")) for code, row in entries.items()}
        for kind, entries in rows.items()
    }


def return_code(code: int) -> Meaning:
    """Explain the return code of an item."""
    return _table()["return_code"].get(code, Meaning(f"unknown return code {code:02X}h"))


def return_codes() -> dict[int, Meaning]:
    """Every return code of an item that is known."""
    return _table()["return_code"]


def header_error(code: int) -> Meaning:
    """Explain error class and code of a header (8104h); of D6xxh the class says it."""
    known = _table()["header"]
    return known.get(code) or known.get(code >> 8) or Meaning(f"unknown error {code:04X}h")


_REQUESTS = {
    0x0: "time event", 0x3: "SDA low", 0x4: "SDN low", 0x5: "SDA high", 0x6: "SDN high", 0x7: "multicast",
    0x9: "FDL status", 0xC: "SRD low", 0xD: "SRD high", 0xE: "identification", 0xF: "LSAP status",
}  # fmt: skip
_ANSWERS = {
    0x0: "ok", 0x1: "user error", 0x2: "no resource", 0x3: "service not activated", 0x8: "data", 0x9: "no data",
    0xA: "data, high priority", 0xC: "data, no resource", 0xD: "data high, no resource",
}  # fmt: skip
_STATIONS = {0x00: "", 0x10: ", master not ready", 0x20: ", master ready", 0x30: ", master in the ring"}


def function_text(function: int) -> str:
    """Explain the function code of a frame: ``request SRD low, first of a sequence``."""
    low = function & 0x0F
    if function & 0x80:
        return "reserved"
    if not function & REQUEST:
        return f"answer: {_ANSWERS.get(low, 'reserved')}{_STATIONS[function & 0x30]}"
    name = f"request: {_REQUESTS.get(low, 'reserved')}"
    if function & FCV:
        return f"{name}, frame count bit {1 if function & FCB else 0}"
    if function == FIRST:
        return f"{name}, first of a sequence (FCB 1, FCV 0)"
    return f"{name}, FCB {1 if function & FCB else 0}, FCV 0"
