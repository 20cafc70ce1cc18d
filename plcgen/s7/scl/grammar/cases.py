"""CASE, and REGION, which may stand around its branches."""

from __future__ import annotations

from dataclasses import dataclass

from plcgen.s7.scl import ast
from plcgen.s7.scl.cursor import Cursor, SyntaxFault
from plcgen.s7.scl.grammar.expressions import Expressions
from plcgen.s7.scl.grammar.labels import CaseLabels
from plcgen.s7.scl.grammar.statements import Statements
from plcgen.s7.scl.grammar.words import CODE, STOPS


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
            return self.case_branch(regions)
        except SyntaxFault as fault:
            cursor.depth = depth
            cursor.report(fault)
            self.statements.skip_statement(began)
            self.statements.nested("END_CASE", in_case=True)
            return None

    def case_branch(self, regions: tuple[str, ...]) -> ast.CaseBranch:
        """``1, 3..5:`` and its statements."""
        cursor = self.cursor
        start = cursor.start
        labels = [self.labels.read()]
        while cursor.accept(","):
            labels.append(self.labels.read())
        cursor.expect(":")
        body = self.statements.nested("END_CASE", in_case=True)
        return ast.CaseBranch(start, cursor.last_end, tuple(labels), body, regions)

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
