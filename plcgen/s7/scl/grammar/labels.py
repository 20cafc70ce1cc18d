"""Where a label of CASE begins, and what it consists of."""

from __future__ import annotations

from dataclasses import dataclass

from plcgen.s7.scl import ast
from plcgen.s7.scl.cursor import Cursor
from plcgen.s7.scl.grammar.expressions import Expressions
from plcgen.s7.scl.lexer import EOF, INT, LOCAL, NAME, QUOTED, REAL, STRING, TYPED

_LITERAL_LABELS = frozenset({INT, REAL, STRING, TYPED, "-", "+", "TRUE", "FALSE"})
_NAMES = frozenset({LOCAL, NAME, QUOTED})
_BEHIND_LABEL = frozenset({":", ",", ".."})
_COMPUTED = frozenset({".", "+", "-", "*", "/", "DIV", "MOD", "["})
"""What follows the first name of a label that is computed or a member, if it is one."""
_NO_LABEL = frozenset({";", ":=", "+=", "-=", "*=", "/=", "&=", "**=", "?=", "=>", "THEN", "DO", "OF", EOF})
_REGIONS_AHEAD = 16
_LONGEST = 64
"""Tokens of the longest label that is looked for."""


@dataclass(slots=True, eq=False)
class CaseLabels:
    """Labels of CASE: constants, ranges, and names told apart from statements and from ``jump_labels`` (upper case)."""

    cursor: Cursor
    expressions: Expressions
    jump_labels: frozenset[str]

    def read(self) -> ast.CaseRange:
        """One value or ``low..high``."""
        low = self.expressions.read()
        high = self.expressions.read() if self.cursor.accept("..") else None
        return ast.CaseRange(low.start, (high or low).end, low, high)

    def begins_at(self, pos: int) -> bool:
        """Whether a label of the CASE begins at a token; a REGION belongs to what it begins with."""
        cursor = self.cursor
        kind = cursor.kinds[pos]
        if kind == "REGION":
            return self.region_opens(pos)
        if kind in _LITERAL_LABELS:
            return True
        if kind not in _NAMES:
            return kind == "(" and self.computed_at(pos)
        following = cursor.kinds[pos + 1]
        if following == ":":
            return cursor.texts[pos].upper() not in self.jump_labels
        return following in {",", ".."} or (following in _COMPUTED and self.computed_at(pos))

    def computed_at(self, pos: int) -> bool:
        """Whether an expression up to a colon begins here: ``Unit.Mode#RUN``, ``"DB".x``, ``#BASE + 1``."""
        depth = 0
        for index in range(pos, min(pos + _LONGEST, len(self.cursor.kinds))):
            kind = self.cursor.kinds[index]
            if kind in _NO_LABEL:
                return False
            if kind in {"(", "["}:
                depth += 1
            elif kind in {")", "]"}:
                depth -= 1
            elif not depth and kind in _BEHIND_LABEL:
                return not (kind == ":" and self.expressions.at_periphery(index))
        return False

    def region_opens(self, pos: int) -> bool:
        """Whether the first token below ``REGION title`` and further REGION lines is a label."""
        cursor = self.cursor
        for _ in range(_REGIONS_AHEAD):
            end = cursor.tokens.source.find("\n", cursor.starts[pos])
            while cursor.kinds[pos] != EOF and cursor.starts[pos] < end:
                pos += 1
            if cursor.kinds[pos] != "REGION":
                return self.begins_at(pos)
        return False
