"""Symbol tables of STEP 7 V5 (.sdf and .asc exports): which symbol is which block number."""

from __future__ import annotations

import csv
import re
from pathlib import Path

from plcgen.diagnostics import Diagnostic, Span
from plcgen.input.files import read_bounded
from plcgen.sources.text import decode

SUFFIXES = frozenset({".sdf", ".asc"})
MAX_BYTES = 4 * 1024 * 1024
"""A table of 65,535 symbols has less."""

_ADDRESS = re.compile(r"(DB|FB|FC|OB|SFB|SFC|UDT)\s*([0-9]{1,5})", re.IGNORECASE)
_ROW = re.compile(r"126,(.{24})(.{12})", re.DOTALL)
"""A row of an .asc table: symbol in 24 columns, address in 12, then type and comment."""


def read_symbols(path: Path) -> tuple[dict[str, str], list[Diagnostic]]:
    """Symbol -> block (``UDT5``, ``DB3``) of one table; other addresses are left out.

    Diagnostics: PG802 too large, PG804 unreadable or no text.
    """
    file = str(path)
    try:
        data = read_bounded(path, MAX_BYTES)
    except OSError as error:
        reason = error.strerror or type(error).__name__
        return {}, [Diagnostic("PG804", f"the file cannot be read: {reason}", Span(file))]
    if len(data) > MAX_BYTES:
        return {}, [Diagnostic("PG802", f"the symbol table has more than {MAX_BYTES} bytes", Span(file))]
    text = decode(data, file)
    if isinstance(text, Diagnostic):
        return {}, [text]
    rows = _sdf(text) if path.suffix.lower() == ".sdf" else _asc(text)
    found: dict[str, str] = {}
    for symbol, address in rows:
        match = _ADDRESS.fullmatch(address.strip())
        if match and symbol.strip():
            found[symbol.strip()] = f"{match[1].upper()}{int(match[2])}"
    return found, []


def _sdf(text: str) -> list[tuple[str, str]]:
    lines = (line for line in text.splitlines() if len(line) < 1000)
    return [(row[0], row[1]) for row in csv.reader(lines, strict=False) if len(row) >= 2]


def _asc(text: str) -> list[tuple[str, str]]:
    return [(match[1], match[2]) for match in map(_ROW.match, text.splitlines()) if match]
