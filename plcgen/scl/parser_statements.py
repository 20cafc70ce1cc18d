"""Statements with recovery: a fault costs one statement, a wrong END costs one message."""

from __future__ import annotations

from typing import TYPE_CHECKING

from plcgen.diagnostics import Note
from plcgen.scl import ast
from plcgen.scl.cursor import Fault
from plcgen.scl.lexer import ADDRESS, EOF, INT, LOCAL, NAME, QUOTED
from plcgen.scl.parser_declarations import SECTIONS, UNIT_ENDS, UNIT_KEYWORDS
from plcgen.scl.parser_recovery import RecoveryParser

if TYPE_CHECKING:
    from collections.abc import Callable

_CLOSERS = frozenset({"END_IF", "END_CASE", "END_FOR", "END_WHILE", "END_REPEAT", "END_REGION", "UNTIL"})
_STOPS = _CLOSERS | {"ELSIF", "ELSE", EOF} | UNIT_ENDS | UNIT_KEYWORDS
_STARTS = frozenset({"IF", "CASE", "FOR", "WHILE", "REPEAT", "EXIT", "CONTINUE", "RETURN", "GOTO", "REGION"})
_CODE = _STOPS | _STARTS
_VARIABLES = frozenset({LOCAL, NAME, QUOTED, ADDRESS})
_ASSIGNMENTS = frozenset({":=", "+=", "-=", "*=", "/=", "&=", "**=", "?="})
_NOT_A_REGION = _ASSIGNMENTS | {".", "[", "(", ":", ";", ",", ")"}
_NAME_FOLLOWS = frozenset({":=", "."})
"""Behind a keyword they show that it is the name of a member, as in the assignments of a data block."""


class StatementParser(RecoveryParser):
    """The code behind BEGIN."""

    has_regions = False
    """Whether the file has an END_REGION: then the title of a REGION may begin with any sign."""
    else_if = False
    """Whether the open IF has an ELSE with another IF on the same line."""
    data = False
    """Whether the statements are those of a data block: start values, not expressions."""

    def body(self, *, in_case: bool = False) -> ast.Body:
        """Statements up to a keyword that closes something, or up to the next label of a CASE."""
        found: list[ast.Statement] = []
        kinds = self.kinds
        self.enter()
        depth = self.depth
        while True:
            pos = self.pos
            kind = kinds[pos]
            if kind in _STOPS and self.kind(1) not in _NAME_FOLLOWS:
                break
            if in_case and self.at_case_label():
                break
            try:
                if kind == LOCAL or (kind in _VARIABLES and kinds[pos + 1] != ":"):
                    if statement := self.simple():
                        found.append(statement)
                elif kind == ";":
                    self.pos = pos + 1
                elif statement := self.other(kind):
                    found.append(statement)
            except Fault as fault:
                if type(fault) is not Fault:
                    raise
                self.depth = depth
                self.report(fault.diagnostic)
                self.skip_statement(pos)
        self.depth -= 1
        return tuple(found)

    def skip_statement(self, began: int) -> None:
        """Go behind the next semicolon or to the next keyword of a statement; at least one token on."""
        if self.pos == began and self.kinds[began] not in _STOPS:
            self.pos += 1
        while (kind := self.kinds[self.pos]) not in _STOPS and kind not in _STARTS:
            self.pos += 1
            if kind == ";":
                break

    # --- simple statements ----------------------------------------------------------------------------

    def simple(self) -> ast.Statement | None:
        """Read an assignment or a call; None for what was reported and left out as a whole."""
        began = self.pos
        start = self.starts[began]
        self.operators = 0
        self.call_depth = self.depth + 1
        target = self.variable()
        kind = self.kinds[self.pos]
        if kind == ":=" or kind in _ASSIGNMENTS:
            self.pos += 1
            value = self.initial_value() if self.data else self.expression()
            if self.kinds[self.pos] == ":=":
                return self.chained(start, target, kind, value)
            self.semicolon()
            return ast.Assign(start, value.end, target, kind, value)
        if isinstance(target, ast.Call):
            self.semicolon()
            return ast.CallStatement(start, target.end, target)
        if self.foreign_member(began) or self.misspelt_statement(began):
            return None
        raise self.wrong_assignment()

    def chained(self, start: int, first: ast.Expression, operator: str, value: ast.Expression) -> ast.Statement:
        """Read ``a := b := c := value;``."""
        also: list[ast.Expression] = []
        while self.accept(":="):
            also.append(value)
            value = self.expression()
        self.semicolon()
        return ast.Assign(start, value.end, first, operator, value, tuple(also))

    def semicolon(self) -> None:
        """Read the end of a statement; a missing one at the end of a line costs one message."""
        if self.kinds[self.pos] == ";":
            self.pos += 1
            return
        end = self.last_end
        if "\n" in self.tokens.source[end : self.start] or self.kinds[self.pos] in _STOPS:
            self.report(self.diagnostic("expected ';' at the end of the statement", end, end + 1))
            return
        raise self.no_end()

    def other(self, kind: str) -> ast.Statement | None:
        """Statements that begin with a keyword, labels and attributes."""
        if self.kind(1) in (_NOT_A_REGION if kind == "REGION" and not self.has_regions else _NAME_FOLLOWS):
            return self.keyword_as_name()
        if handler := _COMPOUND.get(kind):
            return handler(self)
        if kind in {NAME, QUOTED, INT} and self.kind(1) == ":":
            start = self.start
            name = self.texts[self.pos].strip('"')
            self.pos += 2
            return ast.Label(start, self.last_end, name)
        if kind == "{":
            self.attributes()
            return None
        if kind in SECTIONS:
            self.late_section()
            return None
        raise self.expected("a statement")

    def late_section(self) -> None:
        """Step over declarations between the statements."""
        fault = self.fault(f"{self.kinds[self.pos]} behind the first statement", text="declarations stand before BEGIN")
        while (kind := self.kinds[self.pos]) not in _STOPS:
            self.pos += 1
            if kind in {"END_VAR", "END_CONST", "END_LABEL"}:
                break
        self.report(fault.diagnostic)

    def keyword_as_name(self) -> ast.Statement | None:
        """STEP 7 V5 knows no REGION: there it may be a variable. A member of a DB may have any name."""
        if self.texts[self.pos][0].isalpha():
            self.kinds[self.pos] = NAME
        return self.simple()

    def jump(self) -> ast.Statement:
        """EXIT, CONTINUE, RETURN."""
        start, keyword = self.start, self.kinds[self.pos]
        self.pos += 1
        end = self.last_end
        self.semicolon()
        return ast.Jump(start, end, keyword)

    def goto(self) -> ast.Statement:
        """GOTO label."""
        start = self.start
        self.pos += 1
        label = self.texts[self.pos] if self.kinds[self.pos] == INT else self.word("a label")
        if self.kinds[self.pos] == INT:
            self.pos += 1
        end = self.last_end
        self.semicolon()
        return ast.Goto(start, end, label)

    # --- compound statements --------------------------------------------------------------------------

    def close(self, closer: str, opener: int, title: str = "") -> None:
        """Step over the END of a statement; another one in its place is reported together with the opener."""
        if self.accept(closer):
            if closer == "END_REGION":
                self.closing_title(_CODE, title)
            self.accept(";")
            return
        name = self.kinds[opener]
        span = self.tokens.span(self.starts[opener], self.tokens.end(opener))
        fault = self.expected(closer, self.help_for(opener))
        self.report(
            self.diagnostic(
                fault.diagnostic.message,
                self.start,
                self.tokens.end(self.pos),
                text=fault.diagnostic.help,
                notes=(Note(f"this {name} is open", span),),
            )
        )
        if self.kinds[self.pos] in _CLOSERS and self.kinds[self.pos] not in self.open:
            self.pos += 1
            self.accept(";")

    def help_for(self, opener: int) -> str:
        """Tell what to do about an open statement."""
        otherwise = self.kinds[opener] == "IF" and bool(opener) and self.kinds[opener - 1] == "ELSE"
        return "ELSE IF opens another IF: write ELSIF" if otherwise or self.else_if else ""

    def nested(self, closer: str, *, in_case: bool = False) -> ast.Body:
        """Read a body whose closing keyword is known."""
        self.open.append(closer)
        found = self.body(in_case=in_case)
        self.open.pop()
        return found

    def if_statement(self) -> ast.Statement:
        """IF .. THEN .. ELSIF .. ELSE .. END_IF."""
        opener = self.pos
        else_if, self.else_if = self.else_if, False
        branches: list[ast.IfBranch] = []
        while True:
            start = self.start
            self.pos += 1
            condition = self.condition("THEN", _CODE)
            self.keyword("THEN", "END_IF")
            body = self.nested("END_IF")
            branches.append(ast.IfBranch(start, self.last_end, condition, body))
            if self.kinds[self.pos] != "ELSIF":
                break
        otherwise = None
        if self.accept("ELSE"):
            self.braces("ELSE", "END_IF")
            self.else_if = self.kinds[self.pos] == "IF" and "\n" not in self.tokens.source[self.last_end : self.start]
            otherwise = self.nested("END_IF")
        self.close("END_IF", opener)
        self.else_if = else_if
        return ast.If(self.starts[opener], self.last_end, tuple(branches), otherwise)

    def keyword(self, kind: str, closer: str) -> None:
        """THEN, DO, OF: if it is missing the body is read all the same."""
        if self.accept(kind) or self.braces(kind, closer):
            return
        fault = self.expected(kind)
        if self.kinds[self.pos] in {":=", ")", "]", "="}:
            raise fault
        self.report(fault.diagnostic)
        if self.accept(";"):
            self.accept(kind)

    def for_statement(self) -> ast.Statement:
        """FOR i := a TO b BY c DO .. END_FOR."""
        opener = self.pos
        self.pos += 1
        variable = self.variable()
        self.expect(":=")
        first = self.expression()
        self.expect("TO")
        last = self.expression()
        step = self.expression() if self.accept("BY") else None
        self.keyword("DO", "END_FOR")
        body = self.nested("END_FOR")
        self.close("END_FOR", opener)
        return ast.For(self.starts[opener], self.last_end, variable, first, last, step, body)

    def while_statement(self) -> ast.Statement:
        """WHILE .. DO .. END_WHILE."""
        opener = self.pos
        self.pos += 1
        condition = self.condition("DO", _CODE)
        self.keyword("DO", "END_WHILE")
        body = self.nested("END_WHILE")
        self.close("END_WHILE", opener)
        return ast.While(self.starts[opener], self.last_end, condition, body)

    def repeat_statement(self) -> ast.Statement:
        """REPEAT .. UNTIL .. END_REPEAT."""
        opener = self.pos
        self.pos += 1
        body = self.nested("UNTIL")
        condition: ast.Expression = ast.Literal(self.start, self.start, "TRUE", "bool")
        if self.accept("UNTIL"):
            condition = self.expression()
            self.accept(";")
        else:
            self.report(self.expected("UNTIL", "UNTIL and a condition stand before END_REPEAT").diagnostic)
        self.close("END_REPEAT", opener)
        return ast.Repeat(self.starts[opener], self.last_end, body, condition)

    def region(self) -> ast.Statement:
        """REGION title .. END_REGION; inside CASE it may end behind a later label."""
        opener = self.pos
        self.pos += 1
        title = self.rest_of_line()
        in_case = self.case_depth == self.depth
        body = self.nested("END_REGION", in_case=in_case)
        if in_case and self.kinds[self.pos] not in _STOPS and self.at_case_label():
            self.open_regions += 1
            return ast.Region(self.starts[opener], self.last_end, title, body)
        self.close("END_REGION", opener, title)
        return ast.Region(self.starts[opener], self.last_end, title, body)

    def end_region(self) -> None:
        """Step over the END of a REGION around CASE labels."""
        self.pos += 1
        self.closing_title(_CODE)
        self.accept(";")
        self.open_regions -= 1

    # --- CASE -----------------------------------------------------------------------------------------

    def case_statement(self) -> ast.Statement:
        """CASE .. OF labels: statements .. ELSE .. END_CASE."""
        opener = self.pos
        self.pos += 1
        selector = self.expression()
        self.keyword("OF", "END_CASE")
        outer = self.case_depth, self.open_regions
        self.case_depth, self.open_regions = self.depth + 1, 0
        branches = self.case_branches()
        otherwise = None
        if self.accept("ELSE"):
            self.accept(":")
            otherwise = self.nested("END_CASE")
        while self.open_regions and self.kinds[self.pos] == "END_REGION":
            self.end_region()
        if self.open_regions:
            self.report(self.expected("END_REGION").diagnostic)
        self.case_depth, self.open_regions = outer
        self.close("END_CASE", opener)
        return ast.Case(self.starts[opener], self.last_end, selector, branches, otherwise)

    def case_branches(self) -> tuple[ast.CaseBranch, ...]:
        """Everything up to ELSE or END_CASE; what has no label is reported once and left out."""
        branches: list[ast.CaseBranch] = []
        regions: list[str] = []
        while True:
            kind = self.kinds[self.pos]
            if kind == "REGION" and self.at_case_label():
                self.pos += 1
                regions.append(self.rest_of_line())
                self.open_regions += 1
            elif kind == "END_REGION" and self.open_regions:
                self.end_region()
            elif kind == ";":
                self.pos += 1
            elif kind in _STOPS:
                return tuple(branches)
            elif self.at_case_label():
                if branch := self.recover_branch(tuple(regions)):
                    branches.append(branch)
                regions.clear()
            else:
                self.report(self.expected("a CASE label, ELSE or END_CASE").diagnostic)
                self.nested("END_CASE", in_case=True)

    def recover_branch(self, regions: tuple[str, ...]) -> ast.CaseBranch | None:
        """One branch; a fault in its labels costs the branch."""
        began, depth = self.pos, self.depth
        try:
            return self.case_branch(regions)
        except Fault as fault:
            if type(fault) is not Fault:
                raise
            self.depth = depth
            self.report(fault.diagnostic)
            self.skip_statement(began)
            self.nested("END_CASE", in_case=True)
            return None

    def case_branch(self, regions: tuple[str, ...]) -> ast.CaseBranch:
        """``1, 3..5:`` and its statements."""
        start = self.start
        labels = [self.case_range()]
        while self.accept(","):
            labels.append(self.case_range())
        self.expect(":")
        body = self.nested("END_CASE", in_case=True)
        return ast.CaseBranch(start, self.last_end, tuple(labels), body, regions)


_COMPOUND: dict[str, Callable[[StatementParser], ast.Statement]] = {
    "IF": StatementParser.if_statement,
    "CASE": StatementParser.case_statement,
    "FOR": StatementParser.for_statement,
    "WHILE": StatementParser.while_statement,
    "REPEAT": StatementParser.repeat_statement,
    "EXIT": StatementParser.jump,
    "CONTINUE": StatementParser.jump,
    "RETURN": StatementParser.jump,
    "GOTO": StatementParser.goto,
    "REGION": StatementParser.region,
}
