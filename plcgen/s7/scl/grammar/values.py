"""Initial values of declarations and of data blocks."""

from __future__ import annotations

from dataclasses import dataclass, replace

from plcgen.s7.scl import ast
from plcgen.s7.scl.cursor import Cursor, unquote
from plcgen.s7.scl.grammar.expressions import PRECEDENCE, Expressions
from plcgen.s7.scl.lexer import INT, NAME, WORDS

_NUMBERED = frozenset({"T", "Z", "C", "DB", "FB", "FC", "SDB"})
"""Timers, counters and blocks as start values; statement lists put a blank before the number."""


@dataclass(slots=True, eq=False)
class InitialValues:
    """Expressions, aggregates, repetitions, and the bare lists of STEP 7 V5."""

    cursor: Cursor
    expressions: Expressions

    def read(self) -> ast.Expression:
        """Read an initial value: an expression, an aggregate, or a bare list of STEP 7 V5."""
        cursor = self.cursor
        start = cursor.start
        first = self.item()
        if cursor.kinds[cursor.pos] != ",":
            return first.value
        items = [first]
        while cursor.accept(","):
            items.append(self.item())
        return ast.Aggregate(start, items[-1].end, "", tuple(items))

    def item(self) -> ast.Argument:
        """One value of a list: plain, named, repeated or an aggregate itself."""
        cursor = self.cursor
        self.expressions.restart()
        pos = cursor.pos
        start = cursor.start
        if cursor.kinds[pos] in WORDS and cursor.kinds[pos + 1] == ":=":
            cursor.pos = pos + 2
            value = self.item().value
            return ast.Argument(start, value.end, unquote(cursor.texts[pos]), ":=", value)
        value = self.operand()
        return ast.Argument(start, value.end, None, "", value)

    def operand(self) -> ast.Expression:
        """Read an aggregate, a repetition, or any expression."""
        cursor = self.cursor
        start = cursor.start
        kind = cursor.kinds[cursor.pos]
        if kind in {"[", "("}:
            cursor.pos += 1
            items = self.items("]" if kind == "[" else ")")
            if kind == "(" and len(items) == 1 and cursor.kinds[cursor.pos] in PRECEDENCE:
                group = replace(items[0].value, start=start, end=cursor.last_end)
                return self.expressions.climb(group, 0)
            return ast.Aggregate(start, cursor.last_end, kind, items)
        if kind == NAME and cursor.kinds[cursor.pos + 1] == INT and cursor.upper() in _NUMBERED:
            cursor.pos += 2
            return ast.Address(start, cursor.last_end, cursor.tokens.source[start : cursor.last_end])
        if kind == INT and cursor.kinds[cursor.pos + 1] == "(":
            count = ast.Literal(start, cursor.tokens.end(cursor.pos), cursor.texts[cursor.pos], "int")
            cursor.pos += 2
            items = self.items(")")
            return ast.Repetition(start, cursor.last_end, count, items)
        return self.expressions.binary(0)

    def items(self, closing: str) -> tuple[ast.Argument, ...]:
        """Items up to the closing bracket."""
        cursor = self.cursor
        if cursor.accept(closing):
            return ()
        cursor.enter()
        items = [self.item()]
        while cursor.accept(","):
            items.append(self.item())
        cursor.expect(closing)
        cursor.depth -= 1
        return tuple(items)
