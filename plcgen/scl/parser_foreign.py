"""Constructs of other dialects of IEC 61131-3 (SIMATIC AX, CODESYS): one clear message each, then on behind them."""

from __future__ import annotations

from plcgen.scl.cursor import Cursor
from plcgen.scl.lexer import EOF, NAME, QUOTED, WORDS

_UNITS = frozenset({"CLASS", "INTERFACE", "METHOD", "PROPERTY", "ACTION", "PROGRAM", "CONFIGURATION", "RESOURCE"})
_INSIDE = frozenset({"METHOD", "PROPERTY", "ACTION"})
_ACCESS = frozenset({"PUBLIC", "PRIVATE", "PROTECTED", "INTERNAL", "ABSTRACT", "FINAL", "OVERRIDE"})
_INHERITANCE = frozenset({"EXTENDS", "IMPLEMENTS"})
FOREIGN_SECTIONS = frozenset({"VAR_EXTERNAL", "VAR_GLOBAL", "VAR_CONFIG", "VAR_ACCESS", "VAR_INST"})
_BLOCKS = frozenset({"END_FUNCTION_BLOCK", "END_FUNCTION", "END_DATA_BLOCK", "END_ORGANIZATION_BLOCK"})
_HELP = "that is the language of SIMATIC AX or CODESYS; plcgen reads the SCL of STEP 7 V5 and the TIA Portal"


class ForeignSyntax(Cursor):
    """Recognises what no STEP 7 compiler knows and steps over it."""

    def refuse(self, index: int) -> None:
        """PG801 at a word of another dialect."""
        self.report(self.fault(f"SCL has no {self.texts[index].upper()}", index=index, text=_HELP).diagnostic)

    def foreign_unit(self) -> bool:
        """Step over ``CLASS .. END_CLASS`` and the like between blocks."""
        if self.upper() not in _UNITS or self.kind(1) not in WORDS:
            return False
        self.skip_foreign()
        return True

    def foreign_member(self, began: int) -> bool:
        """Step over ``METHOD .. END_METHOD`` where a statement was read from token ``began`` on."""
        if self.kinds[began] != NAME or self.texts[began].upper() not in _INSIDE or self.kind(0) not in WORDS:
            return False
        self.pos = began
        self.skip_foreign()
        return True

    def skip_foreign(self) -> None:
        """Report the word at the position and go behind its END, or to the END of the block around it."""
        self.refuse(self.pos)
        closing = "END_" + self.upper()
        while self.kinds[self.pos] not in _BLOCKS and self.kinds[self.pos] != EOF:
            self.pos += 1
            if self.texts[self.pos - 1].upper() == closing:
                return

    def skip_access(self) -> None:
        """Step over PUBLIC, ABSTRACT and others in front of a name; the first one is reported."""
        first = True
        while self.upper() in _ACCESS and self.kind(1) in {NAME, QUOTED}:
            if first:
                self.refuse(self.pos)
            first = False
            self.pos += 1

    def skip_inheritance(self) -> None:
        """Step over ``EXTENDS a IMPLEMENTS b, c``."""
        while self.upper() in _INHERITANCE:
            self.refuse(self.pos)
            self.rest_of_line()
