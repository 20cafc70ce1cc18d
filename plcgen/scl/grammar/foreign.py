"""Constructs of other dialects of IEC 61131-3 (SIMATIC AX, CODESYS): one clear message each, then on behind them."""

from __future__ import annotations

from dataclasses import dataclass

from plcgen.scl.cursor import Cursor
from plcgen.scl.lexer import EOF, NAME, QUOTED, WORDS

_UNITS = frozenset({"CLASS", "INTERFACE", "METHOD", "PROPERTY", "ACTION", "PROGRAM", "CONFIGURATION", "RESOURCE"})
_INSIDE = frozenset({"METHOD", "PROPERTY", "ACTION"})
_ACCESS = frozenset({"PUBLIC", "PRIVATE", "PROTECTED", "INTERNAL", "ABSTRACT", "FINAL", "OVERRIDE"})
_INHERITANCE = frozenset({"EXTENDS", "IMPLEMENTS"})
FOREIGN_SECTIONS = frozenset({"VAR_EXTERNAL", "VAR_GLOBAL", "VAR_CONFIG", "VAR_ACCESS", "VAR_INST"})
_BLOCKS = frozenset({"END_FUNCTION_BLOCK", "END_FUNCTION", "END_DATA_BLOCK", "END_ORGANIZATION_BLOCK"})
_HELP = "that is the language of SIMATIC AX or CODESYS; plcgen reads the SCL of STEP 7 V5 and the TIA Portal"


@dataclass(slots=True, eq=False)
class Foreign:
    """Recognises what no STEP 7 compiler knows and steps over it."""

    cursor: Cursor

    def refuse(self, index: int) -> None:
        """PG801 at a word of another dialect."""
        cursor = self.cursor
        cursor.report(cursor.fault(f"SCL has no {cursor.texts[index].upper()}", index=index, text=_HELP))

    def unit(self) -> bool:
        """Step over ``CLASS .. END_CLASS`` and the like between blocks."""
        if self.cursor.upper() not in _UNITS or self.cursor.kind(1) not in WORDS:
            return False
        self.skip()
        return True

    def member(self, began: int) -> bool:
        """Step over ``METHOD .. END_METHOD`` where a statement was read from token ``began`` on."""
        cursor = self.cursor
        if cursor.kinds[began] != NAME or cursor.texts[began].upper() not in _INSIDE or cursor.kind(0) not in WORDS:
            return False
        cursor.pos = began
        self.skip()
        return True

    def skip(self) -> None:
        """Report the word at the position and go behind its END, or to the END of the block around it."""
        cursor = self.cursor
        self.refuse(cursor.pos)
        closing = "END_" + cursor.upper()
        while cursor.kinds[cursor.pos] not in _BLOCKS and cursor.kinds[cursor.pos] != EOF:
            cursor.pos += 1
            if cursor.texts[cursor.pos - 1].upper() == closing:
                return

    def skip_access(self) -> None:
        """Step over PUBLIC, ABSTRACT and others in front of a name; the first one is reported."""
        cursor = self.cursor
        first = True
        while cursor.upper() in _ACCESS and cursor.kind(1) in {NAME, QUOTED}:
            if first:
                self.refuse(cursor.pos)
            first = False
            cursor.pos += 1

    def skip_inheritance(self) -> None:
        """Step over ``EXTENDS a IMPLEMENTS b, c``."""
        cursor = self.cursor
        while cursor.upper() in _INHERITANCE:
            self.refuse(cursor.pos)
            cursor.rest_of_line()
