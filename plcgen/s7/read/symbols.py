"""Symbol tables of STEP 7 V5, exported as .sdf or .asc: symbol, address, type."""

from __future__ import annotations

import csv
import re
from pathlib import Path

from plcgen.base.diagnostics import Diagnostic, Span
from plcgen.base.files.files import read_bounded
from plcgen.s7.read.text import decode_source

SUFFIXES = frozenset({".sdf", ".asc"})
MAX_BYTES = 4 * 1024 * 1024
"""A table of 65,535 symbols has less."""

_ADDRESS = re.compile(r"(DB|FB|FC|OB|SFB|SFC|UDT)\s*([0-9]{1,5})", re.IGNORECASE)
_ROW = re.compile(r"126,(.{24})(.{12})(.{0,10})", re.DOTALL)
"""A row of an .asc table: symbol in 24 columns, address in 12, type in 10, then a comment of 80."""


def read_rows(path: Path) -> tuple[list[tuple[str, str, str]], list[Diagnostic]]:
    """Symbol, address (``I      3.0``, ``DB    54``) and type of every row of one table.

    Diagnostics: PG802 too large, PG804 unreadable or no text.
    """
    file = str(path)
    try:
        data = read_bounded(path, MAX_BYTES)
    except OSError as error:
        reason = error.strerror or type(error).__name__
        return [], [Diagnostic("PG804", f"the file cannot be read: {reason}", Span(file))]
    if len(data) > MAX_BYTES:
        return [], [Diagnostic("PG802", f"the symbol table has more than {MAX_BYTES} bytes", Span(file))]
    text = decode_source(data, file)
    if isinstance(text, Diagnostic):
        return [], [text]
    rows = _sdf(text) if path.suffix.lower() == ".sdf" else _asc(text)
    if text.strip() and not rows:
        return [], [Diagnostic("PG804", "it has no row of a STEP 7 V5 symbol table", Span(file))]
    return [(symbol.strip(), address.strip(), type_.strip()) for symbol, address, type_ in rows if symbol.strip()], []


def read_symbols(path: Path) -> tuple[dict[str, str], list[Diagnostic]]:
    """Symbol -> block (``UDT5``, ``DB3``) of one table; other addresses are left out."""
    rows, problems = read_rows(path)
    found: dict[str, str] = {}
    for symbol, address, _ in rows:
        match = _ADDRESS.fullmatch(address)
        if match:
            found[symbol] = f"{match[1].upper()}{int(match[2])}"
    return found, problems


def _sdf(text: str) -> list[tuple[str, str, str]]:
    lines = (line for line in text.splitlines() if len(line) < 1000)
    rows = (row for row in csv.reader(lines, strict=False) if len(row) >= 2)
    return [(row[0], row[1], row[2] if len(row) > 2 else "") for row in rows]


def _asc(text: str) -> list[tuple[str, str, str]]:
    return [(match[1], match[2], match[3]) for match in map(_ROW.match, text.splitlines()) if match]
