"""Statements with recovery: a fault costs one statement, a wrong END costs one message."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

from plcgen.base.diagnostics import Note
from plcgen.s7.scl import ast
from plcgen.s7.scl.cursor import Cursor, SyntaxFault
from plcgen.s7.scl.grammar import foreign, mistakes
from plcgen.s7.scl.grammar.expressions import Expressions
from plcgen.s7.scl.grammar.labels import CaseLabels
from plcgen.s7.scl.grammar.values import InitialValues
from plcgen.s7.scl.grammar.words import CLOSERS, SECTIONS, STARTS, STOPS
from plcgen.s7.scl.lexer import ADDRESS, INT, LOCAL, NAME, QUOTED

_VARIABLES = frozenset({LOCAL, NAME, QUOTED, ADDRESS})
_ASSIGNMENTS = frozenset({":=", "+=", "-=", "*=", "/=", "&=", "**=", "?="})
_NOT_A_REGION = _ASSIGNMENTS | {".", "[", "(", ":", ";", ",", ")"}
_NAME_FOLLOWS = frozenset({":=", "."})
"""Behind a keyword they show that it is the name of a member, as in the assignments of a data block."""


@dataclass(slots=True, eq=False)
class Statements:
    """Lists of statements, and the statements without others inside.

    ``compound`` maps a keyword to what reads the statement it begins; ``data`` says that the statements are those
    of a data block: start values, not expressions. ``has_regions``: the file has an END_REGION, so that the title of a
    REGION may begin with any sign. ``else_if``: the open IF has an ELSE with another IF on its line. ``open`` are the
    ENDs that are still to come.
    """

    cursor: Cursor
    expressions: Expressions
    values: InitialValues
    labels: CaseLabels
    has_regions: bool
    compound: dict[str, Callable[[], ast.Statement]] = field(default_factory=dict)
    data: bool = False
    else_if: bool = False
    open: list[str] = field(default_factory=list)

    def body(self, *, in_case: bool = False) -> ast.Body:
        """Statements up to a keyword that closes something, or up to the next label of a CASE."""
        cursor = self.cursor
        found: list[ast.Statement] = []
        kinds = cursor.kinds
        cursor.enter()
        depth = cursor.depth
        while True:
            pos = cursor.pos
            kind = kinds[pos]
            if kind in STOPS and cursor.kind(1) not in _NAME_FOLLOWS:
                break
            if in_case and self.labels.begins_at(pos):
                break
            try:
                if kind == LOCAL or (kind in _VARIABLES and kinds[pos + 1] != ":"):
                    if statement := self.simple():
                        found.append(statement)
                elif kind == ";":
                    cursor.pos = pos + 1
                elif statement := self.other(kind):
                    found.append(statement)
            except SyntaxFault as fault:
                cursor.depth = depth
                cursor.report(fault)
                self.skip_statement(pos)
        cursor.depth -= 1
        return tuple(found)

    def skip_statement(self, began: int) -> None:
        """Go behind the next semicolon or to the next keyword of a statement; at least one token on."""
        cursor = self.cursor
        if cursor.pos == began and cursor.kinds[began] not in STOPS:
            cursor.pos += 1
        while (kind := cursor.kinds[cursor.pos]) not in STOPS and kind not in STARTS:
            cursor.pos += 1
            if kind == ";":
                break

    def simple(self) -> ast.Statement | None:
        """Read an assignment or a call; None for what was reported and left out as a whole."""
        cursor = self.cursor
        began = cursor.pos
        start = cursor.starts[began]
        target = self.expressions.target()
        kind = cursor.kinds[cursor.pos]
        if kind in _ASSIGNMENTS:
            cursor.pos += 1
            value = self.values.read() if self.data else self.expressions.read()
            if cursor.kinds[cursor.pos] == ":=":
                return self.chained(start, target, kind, value)
            self.semicolon()
            return ast.Assign(start, value.end, target, kind, value)
        if isinstance(target, ast.Call):
            self.semicolon()
            return ast.CallStatement(start, target.end, target)
        if foreign.member(cursor, began) or mistakes.misspelt_statement(cursor, began):
            return None
        raise mistakes.wrong_assignment(cursor)

    def chained(self, start: int, first: ast.Expression, operator: str, value: ast.Expression) -> ast.Statement:
        """Read ``a := b := c := value;``."""
        also: list[ast.Expression] = []
        while self.cursor.accept(":="):
            also.append(value)
            value = self.expressions.read()
        self.semicolon()
        return ast.Assign(start, value.end, first, operator, value, tuple(also))

    def semicolon(self) -> None:
        """Read the end of a statement; a missing one at the end of a line costs one message."""
        cursor = self.cursor
        if cursor.kinds[cursor.pos] == ";":
            cursor.pos += 1
            return
        end = cursor.last_end
        if "\n" in cursor.tokens.source[end : cursor.start] or cursor.kinds[cursor.pos] in STOPS:
            cursor.report(cursor.diagnostic("expected ';' at the end of the statement", end, end + 1))
            return
        raise mistakes.no_end(cursor)

    def other(self, kind: str) -> ast.Statement | None:
        """Statements that begin with a keyword, labels and attributes."""
        cursor = self.cursor
        if cursor.kind(1) in (_NOT_A_REGION if kind == "REGION" and not self.has_regions else _NAME_FOLLOWS):
            return self.keyword_as_name()
        if handler := self.compound.get(kind):
            return handler()
        if kind in {NAME, QUOTED, INT, "LABEL"} and cursor.kind(1) == ":":  # the help of GET_ERROR has LABEL: itself
            start = cursor.start
            name = cursor.texts[cursor.pos].strip('"')
            cursor.pos += 2
            return ast.Label(start, cursor.last_end, name)
        if kind == "{":
            cursor.attributes()
            return None
        if kind in SECTIONS:
            self.late_section()
            return None
        raise cursor.expected("a statement")

    def late_section(self) -> None:
        """Step over declarations between the statements."""
        cursor = self.cursor
        fault = cursor.fault(
            f"{cursor.kinds[cursor.pos]} after the first statement", text="declarations must come before BEGIN"
        )
        while (kind := cursor.kinds[cursor.pos]) not in STOPS:
            cursor.pos += 1
            if kind in {"END_VAR", "END_CONST", "END_LABEL"}:
                break
        cursor.report(fault)

    def keyword_as_name(self) -> ast.Statement | None:
        """STEP 7 V5 knows no REGION: there it may be a variable. A member of a DB may have any name."""
        cursor = self.cursor
        if cursor.texts[cursor.pos][0].isalpha():
            cursor.kinds[cursor.pos] = NAME
        return self.simple()

    def close(self, closer: str, opener: int) -> None:
        """Step over the END of a statement; another one in its place is reported together with the opener."""
        cursor = self.cursor
        if cursor.accept(closer):
            cursor.accept(";")
            return
        name = cursor.kinds[opener]
        span = cursor.tokens.span(cursor.starts[opener], cursor.tokens.end(opener))
        fault = cursor.expected(closer, self.help_for(opener))
        cursor.report(
            cursor.diagnostic(
                fault.diagnostic.message,
                cursor.start,
                cursor.tokens.end(cursor.pos),
                text=fault.diagnostic.help,
                notes=(Note(f"this {name} is open", span),),
            )
        )
        if cursor.kinds[cursor.pos] in CLOSERS and cursor.kinds[cursor.pos] not in self.open:
            cursor.pos += 1
            cursor.accept(";")

    def help_for(self, opener: int) -> str:
        """Tell what to do about an open statement."""
        otherwise = self.cursor.kinds[opener] == "IF" and bool(opener) and self.cursor.kinds[opener - 1] == "ELSE"
        return "ELSE IF opens another IF: write ELSIF" if otherwise or self.else_if else ""

    def nested(self, closer: str, *, in_case: bool = False) -> ast.Body:
        """Read a body whose closing keyword is known."""
        self.open.append(closer)
        found = self.body(in_case=in_case)
        self.open.pop()
        return found

    def keyword(self, kind: str, closer: str) -> None:
        """THEN, DO, OF: if it is missing the body is read all the same."""
        cursor = self.cursor
        if cursor.accept(kind) or mistakes.braces(cursor, kind, closer):
            return
        fault = cursor.expected(kind)
        if cursor.kinds[cursor.pos] in {":=", ")", "]", "="}:
            raise fault
        cursor.report(fault)
        if cursor.accept(";"):
            cursor.accept(kind)

    def jump(self) -> ast.Statement:
        """EXIT, CONTINUE, RETURN."""
        cursor = self.cursor
        start, keyword = cursor.start, cursor.kinds[cursor.pos]
        cursor.pos += 1
        end = cursor.last_end
        self.semicolon()
        return ast.Jump(start, end, keyword)

    def goto(self) -> ast.Statement:
        """GOTO label."""
        cursor = self.cursor
        start = cursor.start
        cursor.pos += 1
        if cursor.kinds[cursor.pos] in {INT, "LABEL"}:
            label = cursor.texts[cursor.pos]
            cursor.pos += 1
        else:
            label = cursor.word("a label")
        end = cursor.last_end
        self.semicolon()
        return ast.Goto(start, end, label)
