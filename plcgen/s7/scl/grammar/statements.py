"""Statements with recovery: a fault costs one statement, a wrong END costs one message."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

from plcgen.base.diagnostics import Note
from plcgen.s7.scl import ast
from plcgen.s7.scl.cursor import Cursor, SyntaxFault
from plcgen.s7.scl.grammar import mistakes
from plcgen.s7.scl.grammar.expressions import Expressions, InitialValues
from plcgen.s7.scl.grammar.mistakes import CLOSERS, CODE, SECTIONS, STARTS, STOPS
from plcgen.s7.scl.lexer import ADDRESS, EOF, INT, LOCAL, NAME, QUOTED, REAL, STRING, TYPED

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
        if mistakes.member(cursor, began) or mistakes.misspelt_statement(cursor, began):
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
            # STEP 7 V5 knows no REGION: there it may be a variable. A member of a DB may have any name.
            if cursor.texts[cursor.pos][0].isalpha():
                cursor.kinds[cursor.pos] = NAME
            return self.simple()
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


@dataclass(slots=True, eq=False)
class Cases:
    """CASE and REGION; ``case_depth`` is the depth of the innermost CASE, whose ``open_regions`` wait for their END."""

    cursor: Cursor
    expressions: Expressions
    labels: CaseLabels
    statements: Statements
    case_depth: int = -1
    open_regions: int = 0

    def case_statement(self) -> ast.Statement:
        """CASE .. OF labels: statements .. ELSE .. END_CASE."""
        cursor = self.cursor
        opener = cursor.pos
        cursor.pos += 1
        selector = self.expressions.read()
        self.statements.keyword("OF", "END_CASE")
        outer = self.case_depth, self.open_regions
        self.case_depth, self.open_regions = cursor.depth + 1, 0
        branches = self.case_branches()
        otherwise = None
        if cursor.accept("ELSE"):
            cursor.accept(":")
            otherwise = self.statements.nested("END_CASE")
        while self.open_regions and cursor.kinds[cursor.pos] == "END_REGION":
            self.open_regions -= 1
            self.end_region()
        if self.open_regions:
            cursor.report(cursor.expected("END_REGION"))
        self.case_depth, self.open_regions = outer
        self.statements.close("END_CASE", opener)
        return ast.Case(cursor.starts[opener], cursor.last_end, selector, branches, otherwise)

    def case_branches(self) -> tuple[ast.CaseBranch, ...]:
        """Everything up to ELSE or END_CASE; what has no label is reported once and left out."""
        cursor = self.cursor
        branches: list[ast.CaseBranch] = []
        regions: list[str] = []
        while True:
            kind = cursor.kinds[cursor.pos]
            if kind == "REGION" and self.labels.begins_at(cursor.pos):
                cursor.pos += 1
                regions.append(cursor.rest_of_line())
                self.open_regions += 1
            elif kind == "END_REGION" and self.open_regions:
                self.open_regions -= 1
                self.end_region()
            elif kind == ";":
                cursor.pos += 1
            elif kind in STOPS:
                return tuple(branches)
            elif self.labels.begins_at(cursor.pos):
                if branch := self.recover_branch(tuple(regions)):
                    branches.append(branch)
                regions.clear()
            else:
                cursor.report(cursor.expected("a CASE label, ELSE or END_CASE"))
                self.statements.nested("END_CASE", in_case=True)

    def recover_branch(self, regions: tuple[str, ...]) -> ast.CaseBranch | None:
        """One branch; a fault in its labels costs the branch."""
        cursor = self.cursor
        began, depth = cursor.pos, cursor.depth
        try:
            # ``1, 3..5:`` and its statements.
            start = cursor.start
            labels = [self.labels.read()]
            while cursor.accept(","):
                labels.append(self.labels.read())
            cursor.expect(":")
            body = self.statements.nested("END_CASE", in_case=True)
            return ast.CaseBranch(start, cursor.last_end, tuple(labels), body, regions)
        except SyntaxFault as fault:
            cursor.depth = depth
            cursor.report(fault)
            self.statements.skip_statement(began)
            self.statements.nested("END_CASE", in_case=True)
            return None

    def region(self) -> ast.Statement:
        """REGION title .. END_REGION; inside CASE it may end behind a later label."""
        cursor = self.cursor
        opener = cursor.pos
        cursor.pos += 1
        title = cursor.rest_of_line()
        in_case = self.case_depth == cursor.depth
        body = self.statements.nested("END_REGION", in_case=in_case)
        if in_case and cursor.kinds[cursor.pos] not in STOPS and self.labels.begins_at(cursor.pos):
            self.open_regions += 1
            return ast.Region(cursor.starts[opener], cursor.last_end, title, body)
        if cursor.kinds[cursor.pos] == "END_REGION":
            self.end_region(title)
        else:
            self.statements.close("END_REGION", opener)
        return ast.Region(cursor.starts[opener], cursor.last_end, title, body)

    def end_region(self, title: str = "") -> None:
        """Step over END_REGION and a title behind it.

        What has a ``;`` or begins like a statement is none, unless it repeats the ``title`` of the REGION.
        """
        cursor = self.cursor
        cursor.pos += 1
        begin = cursor.last_end
        source = cursor.tokens.source
        end = source.find("\n", begin)
        end = len(source) if end < 0 else end
        line = source[begin:end].partition("//")[0]
        repeated = bool(title) and line.strip() == title.partition("//")[0].strip()
        if cursor.start < end and (repeated or (cursor.kinds[cursor.pos] not in CODE and ";" not in line)):
            cursor.skip_to(end)
        cursor.accept(";")
