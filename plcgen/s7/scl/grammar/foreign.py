"""Constructs of other dialects of IEC 61131-3 (SIMATIC AX, CODESYS): one clear message each, then on behind them."""

from __future__ import annotations

from plcgen.s7.scl.cursor import Cursor
from plcgen.s7.scl.lexer import EOF, NAME, QUOTED, WORDS

_UNITS = frozenset({"CLASS", "INTERFACE", "METHOD", "PROPERTY", "ACTION", "PROGRAM", "CONFIGURATION", "RESOURCE"})
_INSIDE = frozenset({"METHOD", "PROPERTY", "ACTION"})
_ACCESS = frozenset({"PUBLIC", "PRIVATE", "PROTECTED", "INTERNAL", "ABSTRACT", "FINAL", "OVERRIDE"})
_INHERITANCE = frozenset({"EXTENDS", "IMPLEMENTS"})
FOREIGN_SECTIONS = frozenset({"VAR_EXTERNAL", "VAR_GLOBAL", "VAR_CONFIG", "VAR_ACCESS", "VAR_INST"})
_BLOCKS = frozenset({"END_FUNCTION_BLOCK", "END_FUNCTION", "END_DATA_BLOCK", "END_ORGANIZATION_BLOCK"})
_HELP = "that is the language of SIMATIC AX or CODESYS; plcgen reads the SCL of STEP 7 V5 and the TIA Portal"


def refuse(cursor: Cursor, index: int) -> None:
    """PG801 at a word of another dialect."""
    cursor.report(cursor.fault(f"SCL has no {cursor.texts[index].upper()}", index=index, text=_HELP))


def unit(cursor: Cursor) -> bool:
    """Step over ``CLASS .. END_CLASS`` and the like between blocks."""
    if cursor.upper() not in _UNITS or cursor.kind(1) not in WORDS:
        return False
    skip(cursor)
    return True


def member(cursor: Cursor, began: int) -> bool:
    """Step over ``METHOD .. END_METHOD`` where a statement was read from token ``began`` on."""
    if cursor.kinds[began] != NAME or cursor.texts[began].upper() not in _INSIDE or cursor.kind(0) not in WORDS:
        return False
    cursor.pos = began
    skip(cursor)
    return True


def skip(cursor: Cursor) -> None:
    """Report the word at the position and go behind its END, or to the END of the block around it."""
    refuse(cursor, cursor.pos)
    closing = "END_" + cursor.upper()
    while cursor.kinds[cursor.pos] not in _BLOCKS and cursor.kinds[cursor.pos] != EOF:
        cursor.pos += 1
        if cursor.texts[cursor.pos - 1].upper() == closing:
            return


def skip_access(cursor: Cursor) -> None:
    """Step over PUBLIC, ABSTRACT and others in front of a name; the first one is reported."""
    first = True
    while cursor.upper() in _ACCESS and cursor.kind(1) in {NAME, QUOTED}:
        if first:
            refuse(cursor, cursor.pos)
        first = False
        cursor.pos += 1


def skip_inheritance(cursor: Cursor) -> None:
    """Step over ``EXTENDS a IMPLEMENTS b, c``."""
    while cursor.upper() in _INHERITANCE:
        refuse(cursor, cursor.pos)
        cursor.rest_of_line()
