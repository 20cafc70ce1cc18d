"""IF and the loops: statements around statements."""

from __future__ import annotations

from dataclasses import dataclass

from plcgen.s7.scl import ast
from plcgen.s7.scl.cursor import Cursor, SyntaxFault
from plcgen.s7.scl.grammar import mistakes
from plcgen.s7.scl.grammar.expressions import Expressions
from plcgen.s7.scl.grammar.statements import Statements
from plcgen.s7.scl.grammar.words import CODE


@dataclass(slots=True, eq=False)
class Branches:
    """IF, FOR, WHILE, REPEAT; each begins at its keyword."""

    cursor: Cursor
    expressions: Expressions
    statements: Statements

    def if_statement(self) -> ast.Statement:
        """IF .. THEN .. ELSIF .. ELSE .. END_IF."""
        cursor = self.cursor
        opener = cursor.pos
        else_if, self.statements.else_if = self.statements.else_if, False
        branches: list[ast.IfBranch] = []
        while True:
            start = cursor.start
            cursor.pos += 1
            condition = self.condition("THEN")
            self.statements.keyword("THEN", "END_IF")
            body = self.statements.nested("END_IF")
            branches.append(ast.IfBranch(start, cursor.last_end, condition, body))
            if cursor.kinds[cursor.pos] != "ELSIF":
                break
        otherwise = None
        if cursor.accept("ELSE"):
            mistakes.braces(cursor, "ELSE", "END_IF")
            self.statements.else_if = (
                cursor.kinds[cursor.pos] == "IF" and "\n" not in cursor.tokens.source[cursor.last_end : cursor.start]
            )
            otherwise = self.statements.nested("END_IF")
        self.statements.close("END_IF", opener)
        self.statements.else_if = else_if
        return ast.If(cursor.starts[opener], cursor.last_end, tuple(branches), otherwise)

    def for_statement(self) -> ast.Statement:
        """FOR i := a TO b BY c DO .. END_FOR."""
        cursor = self.cursor
        opener = cursor.pos
        cursor.pos += 1
        variable = self.expressions.variable()
        cursor.expect(":=")
        first = self.expressions.read()
        cursor.expect("TO")
        last = self.expressions.read()
        step = self.expressions.read() if cursor.accept("BY") else None
        self.statements.keyword("DO", "END_FOR")
        body = self.statements.nested("END_FOR")
        self.statements.close("END_FOR", opener)
        return ast.For(cursor.starts[opener], cursor.last_end, variable, first, last, step, body)

    def while_statement(self) -> ast.Statement:
        """WHILE .. DO .. END_WHILE."""
        cursor = self.cursor
        opener = cursor.pos
        cursor.pos += 1
        condition = self.condition("DO")
        self.statements.keyword("DO", "END_WHILE")
        body = self.statements.nested("END_WHILE")
        self.statements.close("END_WHILE", opener)
        return ast.While(cursor.starts[opener], cursor.last_end, condition, body)

    def repeat_statement(self) -> ast.Statement:
        """REPEAT .. UNTIL .. END_REPEAT."""
        cursor = self.cursor
        opener = cursor.pos
        cursor.pos += 1
        body = self.statements.nested("UNTIL")
        condition: ast.Expression = ast.Literal(cursor.start, cursor.start, "TRUE", "bool")
        if cursor.accept("UNTIL"):
            condition = self.expressions.read()
            cursor.accept(";")
        else:
            cursor.report(cursor.expected("UNTIL", "UNTIL and a condition must come before END_REPEAT"))
        self.statements.close("END_REPEAT", opener)
        return ast.Repeat(cursor.starts[opener], cursor.last_end, body, condition)

    def condition(self, closing: str) -> ast.Expression:
        """Read the condition in front of THEN or DO; a fault in it costs the condition only if these are there."""
        cursor = self.cursor
        start, depth = cursor.start, cursor.depth
        try:
            return self.expressions.read()
        except SyntaxFault as fault:
            index = cursor.pos
            while (kind := cursor.kinds[index]) not in CODE and kind not in {closing, ";"}:
                index += 1
            if kind != closing:
                raise
            cursor.depth = depth
            cursor.pos = index
            cursor.report(fault)
            return ast.Literal(start, cursor.start, "TRUE", "bool")
