"""Where a label of CASE begins, and what it consists of."""

from __future__ import annotations

from plcgen.scl import ast
from plcgen.scl.lexer import EOF, INT, LOCAL, NAME, QUOTED, REAL, STRING, TYPED
from plcgen.scl.parser_expressions import ExpressionParser

_LITERAL_LABELS = frozenset({INT, REAL, STRING, TYPED, "-", "+", "TRUE", "FALSE"})
_NAMES = frozenset({LOCAL, NAME, QUOTED})
_BEHIND_LABEL = frozenset({":", ",", ".."})
_COMPUTED = frozenset({".", "+", "-", "*", "/", "DIV", "MOD", "["})
"""What follows the first name of a label that is computed or a member, if it is one."""
_NO_LABEL = frozenset({";", ":=", "+=", "-=", "*=", "/=", "&=", "**=", "?=", "=>", "THEN", "DO", "OF", EOF})
_REGIONS_AHEAD = 16
_LONGEST = 64
"""Tokens of the longest label that is looked for."""


class LabelParser(ExpressionParser):
    """Labels of CASE: constants, ranges, and names told apart from jump labels and statements."""

    jump_labels: frozenset[str] = frozenset()

    def case_range(self) -> ast.CaseRange:
        """One value or ``low..high``."""
        low = self.expression()
        high = self.expression() if self.accept("..") else None
        return ast.CaseRange(low.start, (high or low).end, low, high)

    def at_case_label(self) -> bool:
        """Whether a label of the CASE begins here; a REGION belongs to what it begins with."""
        pos = self.pos
        kind = self.kinds[pos]
        if kind == "REGION":
            return self.region_opens_label(pos)
        if kind in _LITERAL_LABELS:
            return True
        if kind not in _NAMES:
            return kind == "(" and self.at_computed_label(pos)
        following = self.kinds[pos + 1]
        if following == ":":
            return self.texts[pos].upper() not in self.jump_labels
        return following in {",", ".."} or (following in _COMPUTED and self.at_computed_label(pos))

    def at_computed_label(self, pos: int) -> bool:
        """Whether an expression up to a colon begins here: ``Unit.Mode#RUN``, ``"DB".x``, ``#BASE + 1``."""
        depth = 0
        for index in range(pos, min(pos + _LONGEST, len(self.kinds))):
            kind = self.kinds[index]
            if kind in _NO_LABEL:
                return False
            if kind in {"(", "["}:
                depth += 1
            elif kind in {")", "]"}:
                depth -= 1
            elif not depth and kind in _BEHIND_LABEL:
                return not (kind == ":" and self.at_periphery(index))
        return False

    def region_opens_label(self, pos: int) -> bool:
        """Whether the first token below ``REGION title`` and further REGION lines is a label."""
        for _ in range(_REGIONS_AHEAD):
            end = self.tokens.source.find("\n", self.starts[pos])
            while self.kinds[pos] != EOF and self.starts[pos] < end:
                pos += 1
            if self.kinds[pos] != "REGION":
                saved, self.pos = self.pos, pos
                found = self.at_case_label()
                self.pos = saved
                return found
        return False
