"""STATUS of the WRREC and RDREC blocks: taken apart, explained, and what a caller should do next.

The table is ``data/status_codes.toml``, read when first needed.
"""

from __future__ import annotations

import enum
import tomllib
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any, Literal, TypeAlias

Direction: TypeAlias = Literal["read", "write"]

FUNCTION_READ, FUNCTION_WRITE = 0xDE, 0xDF


class Retry(enum.Enum):
    """What a caller does after this STATUS."""

    NONE = "none"
    WAIT = "wait"
    TEMPORARY = "temporary"
    RESTART = "restart"
    PERMANENT = "permanent"


@dataclass(frozen=True, slots=True)
class Status:
    """One STATUS: its four bytes, a text, whether it is an error, and the retry class."""

    value: int
    function_num: int
    error_decode: int
    code1: int
    code2: int
    text: str
    retry: Retry

    @property
    def error(self) -> bool:
        """Whether the block's ERROR output belongs to this STATUS."""
        return self.error_decode >= 0x80


def status_of(direction: Direction, code1: int, code2: int = 0) -> int:
    """Return the STATUS DWORD a drive's negative acknowledgement becomes, for example DF80B500h."""
    function = FUNCTION_READ if direction == "read" else FUNCTION_WRITE
    return function << 24 | 0x80 << 16 | code1 << 8 | code2


@cache
def _tables() -> dict[str, Any]:
    path = Path(__file__).parent / "data" / "status_codes.toml"
    tables = tomllib.loads(path.read_text(encoding="utf-8"))
    for name in ("function", "call_state", "local", "parameter"):
        tables[name] = {int(key, 16): text for key, text in tables[name].items()}
    tables["code"] = {
        code: row for row in tables["code"] for code in range(row["code"], row.get("last", row["code"]) + 1)
    }
    return tables


def known_words() -> list[int]:
    """Every middle word that has a text, ascending: 8090h .. 80FFh."""
    tables = _tables()
    return sorted({*tables["local"], *(0x8000 | code for code in tables["code"])})


def known_codes() -> tuple[tuple[int, str], ...]:
    """Return every error code with a name of its own, ascending, and its text for a read."""
    rows = _tables()["code"].items()
    return tuple((code, _explain_code(code, 0, "read")[0]) for code, row in sorted(rows) if row["name"] != "reserved")


def _direction(function_num: int, direction: Direction | None) -> Direction | None:
    known: dict[int, Direction] = {FUNCTION_READ: "read", FUNCTION_WRITE: "write"}
    return known.get(function_num, direction)


def _explain_code(code1: int, code2: int, direction: Direction | None) -> tuple[str, Retry]:
    tables = _tables()
    local = tables["local"].get(0x8000 | code1)
    if local is not None:
        return str(local), Retry.PERMANENT
    row = tables["code"].get(code1)
    if row is None:
        return f"unknown error code {code1:02X}h", Retry.PERMANENT
    text = row.get(f"text_{direction}", row["text"])
    detail = row.get(f"details_{direction or 'write'}", {})
    text += detail.get(f"{code2:02X}", detail.get("any", "").format(code2)) if code2 else ""
    retry = row.get(f"retry_{direction}", row["retry"])
    label = row["name"] if row["name"] in {text, "reserved"} else f"{row['name']}: {text}"
    return (text if row["name"] == "reserved" else label), Retry(retry)


def _meaning(decode: int, code1: int, code2: int, direction: Direction | None) -> tuple[str, Retry]:
    if decode == 0x70:
        retry = Retry.WAIT if code1 in {1, 2} else Retry.NONE
        return _tables()["call_state"].get(decode << 8 | code1, f"call state {code1:02X}h"), retry
    if decode < 0x80:
        return "no error", Retry.NONE
    if decode == 0x80:
        return _explain_code(code1, code2, direction)
    if decode <= 0x8F:
        text = _tables()["parameter"].get(code1, f"error {code1:02X}h")
        return f"call parameter {decode - 0x80}: {text}", Retry.PERMANENT
    profile = "profile-specific error" if decode >= 0xFE else f"unknown error class {decode:02X}h"
    return f"{profile} {code1:02X}h", Retry.PERMANENT


def explain_status(value: int, direction: Direction | None = None) -> Status:
    """Explain a STATUS DWORD; ``direction`` says which block gave it where DEh/DFh does not.

    The retry class follows data set 47 practice: A2h..A4h, A7h, B5h, C0h..C6h and A1h of WRREC are temporary,
    A0h of RDREC means starting again at WRREC, everything else is permanent (the S7 manual lists B5h as permanent).
    """
    function_num, decode, code1, code2 = value.to_bytes(4, "big")
    text, retry = _meaning(decode, code1, code2, _direction(function_num, direction))
    if decode >= 0x80 and function_num:
        function = _tables()["function"].get(function_num, f"function {function_num:02X}h")
        text = f"{function}: {text}"
    return Status(value, function_num, decode, code1, code2, text, retry)


def explain_word(word: int, direction: Direction | None = None) -> Status:
    """Explain the middle word of a STATUS, as older blocks report it: 7001h, 80B5h, 8090h."""
    return explain_status(word << 8, direction)


def explain_codes(word: int) -> Status:
    """Explain the lower word of a STATUS, Error_Code_1 and Error_Code_2: E102h, B500h."""
    return explain_status(0x80 << 16 | word)


@cache
def _pnio() -> dict[str, dict[int, str]]:
    path = Path(__file__).parent / "data" / "pnio_status.toml"
    tables = tomllib.loads(path.read_text(encoding="utf-8"))
    return {name: {int(key, 16): text for key, text in table.items()} for name, table in tables.items()}


def explain_pnio(value: int) -> str:
    """What a PNIO status other than 0 means, as PROFINET answers it: a record's is that of WRREC or RDREC."""
    function_num, decode, code1, code2 = value.to_bytes(4, "big")
    if decode != 0x81:
        return explain_status(value).text
    tables = _pnio()
    if code1 == 0x40:
        return tables["cmrpc"].get(code2, f"its part for calls has the error {code2:02X}h")
    if code1 in tables["faulty"]:
        return f"field {code2} of the {tables['faulty'][code1]} is not what it accepts"
    service = tables["service"].get(function_num, f"service {function_num:02X}h")
    return f"error {code1:02X}h {code2:02X}h of the {service}"
