"""IF and CASE."""

from __future__ import annotations

from dataclasses import dataclass

from plcgen.s7.cpu.compiler.access import Access, Key
from plcgen.s7.cpu.compiler.context import Context, Listing
from plcgen.s7.cpu.compiler.conversions import truth
from plcgen.s7.cpu.compiler.expressions import Expressions
from plcgen.s7.cpu.compiler.statements import Statements
from plcgen.s7.cpu.compiler.values import UNKNOWN
from plcgen.s7.cpu.type_rules import BITS, INT_CONST, INTEGERS, TYPE_NAME
from plcgen.s7.scl import ast
from plcgen.s7.types.values import RANGES


@dataclass(slots=True, eq=False)
class Branches:
    """Branches, each with what it knows of the memory."""

    context: Context
    out: Listing
    access: Access
    expressions: Expressions
    statements: Statements

    def branch(self, body: ast.Body, exits: list[dict[Key, str]], node: ast.Node, kind: str) -> bool:
        """One branch with its own copy of the cache; what is known at its end goes to ``exits``."""
        saved = self.access.cache
        self.access.cache = dict(saved)
        self.out.indent += " "
        with self.context.apart():
            self.context.probe(node, kind)
            reached = self.statements.body(body)
        self.out.indent = self.out.indent[:-1]
        if reached:
            exits.append(self.access.cache)
        self.access.cache = saved
        return reached

    def if_statement(self, node: ast.If) -> bool:
        """IF, ELSIF, ELSE; a condition that needs lines of its own goes one level deeper."""
        exits: list[dict[Key, str]] = []
        indent = self.out.indent
        for position, branch in enumerate(node.branches):
            self.context.move_to(branch)
            start = len(self.out.lines)
            if position:
                self.out.indent += " "
                self.context.point("condition", branch.condition)
            code = truth(self.context, self.expressions.value(branch.condition), branch.condition)
            if position:
                if len(self.out.lines) > start:
                    self.out.insert(start, self.out.indent[:-1] + "else:", self.out.line)
                    self.out.emit(f"if {code}:")
                else:
                    self.out.indent = self.out.indent[:-1]
                    self.out.emit(f"elif {code}:")
            else:
                self.out.emit(f"if {code}:")
            self.branch(branch.body, exits, branch, "branch")
        if node.otherwise is not None or self.context.link.coverage:
            self.out.emit("else:")
            self.branch(node.otherwise or (), exits, node, "else")
        else:
            exits.append(self.access.cache)
        self.out.indent = indent
        self.access.merge(exits)
        return bool(exits)

    def case_statement(self, node: ast.Case) -> bool:
        """CASE as a chain of comparisons with the selector in a local."""
        value = self.expressions.value(node.selector)
        if value.type == TYPE_NAME:
            pass
        elif value.type not in INTEGERS and value.type not in BITS and value.type not in {UNKNOWN, "CHAR", INT_CONST}:
            self.context.error("PG821", f"a selector is an integer, not {value.type or 'a structure'}", node.selector)
        name = self.out.temporary()
        self.out.emit(f"{name}={value.wrapped}")
        exits: list[dict[Key, str]] = []
        seen: dict[int, ast.CaseRange] = {}
        word = "if"
        for branch in node.branches:
            self.context.move_to(branch)
            tests = [self.label_test(name, label, value.type, seen) for label in branch.labels]
            self.out.emit(f"{word} {' or '.join(tests)}:")
            self.branch(branch.body, exits, branch, "branch")
            word = "elif"
        if node.otherwise is not None or self.context.link.coverage:
            self.out.emit("else:" if node.branches else "if True:")
            self.branch(node.otherwise or (), exits, node, "else")
        else:
            exits.append(self.access.cache)
        self.access.merge(exits)
        return bool(exits)

    def label_test(self, name: str, label: ast.CaseRange, type_: str, seen: dict[int, ast.CaseRange]) -> str:
        """Condition of one label of a CASE."""
        ends = []
        for end in (label.low, label.high):
            if end is None:
                continue
            value = self.expressions.value(end)
            if value.type == UNKNOWN:
                return "False"
            if value.type == type_ == TYPE_NAME and label.high is None:
                return f"{name}=={value.code}"
            const = ord(value.const) if isinstance(value.const, str) and len(value.const) == 1 else value.const
            if not isinstance(const, int):
                self.context.error("PG821", f"the label {self.context.text(end)} is not a constant", end)
                return "False"
            low, high = RANGES.get(type_, (const, const))
            if not low <= const <= high:
                self.context.error("PG824", f"the label {const} is outside {type_} ({low}..{high})", end)
            ends.append(const)
        if len(ends) == 1:
            if ends[0] in seen:
                self.context.error("PG824", f"the label {ends[0]} appears twice", label)
            seen[ends[0]] = label
            return f"{name}=={ends[0]}"
        return f"{ends[0]}<={name}<={ends[1]}"
