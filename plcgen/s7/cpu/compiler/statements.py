"""Lists of statements; the parts that compile the statements stand in a table."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from plcgen.s7.cpu.compiler.access import Access
from plcgen.s7.cpu.compiler.context import Context, Listing
from plcgen.s7.scl import ast

MAX_INDENT = 90


@dataclass(slots=True, eq=False)
class Statements:
    """Code behind BEGIN; ``parts`` maps a class of nodes to what compiles it and returns False if it jumps away."""

    context: Context
    out: Listing
    access: Access
    parts: dict[type[ast.Statement], Callable[[Any], bool | None]] = field(default_factory=dict)

    def body(self, statements: ast.Body) -> bool:
        """Compile statements one level deeper; False if the end of it is never reached."""
        if len(self.out.indent) > MAX_INDENT and statements:
            self.context.error("PG802", "the statements are nested too deeply", statements[0])
            self.out.emit("pass")
            return True
        reached = True
        before = len(self.out.lines)
        for statement in statements:
            reached = self.statement(statement) and (reached or isinstance(statement, ast.Label))
        if len(self.out.lines) == before:
            self.out.emit("pass")
        return reached

    def statement(self, node: ast.Statement) -> bool:
        """Compile one statement; False if it jumps away."""
        self.context.move_to(node)
        if isinstance(node, ast.Region):
            reached = [self.statement(inner) for inner in node.body]
            return all(reached)
        self.context.point("statement", node)
        self.context.probe(node, "statement")
        begin, indent = len(self.out.lines), self.out.indent
        if isinstance(node, ast.Label):
            self.context.error("PG827", f"the label {node.name} is inside another statement", node)
            goes_on = True
        else:
            goes_on = self.parts[type(node)](node) is not False
        if self.context.unsupported:
            self.out.cut(begin)
            self.out.indent = indent
            self.context.move_to(node)
            self.out.emit(f"unsupported({self.context.unsupported[0]!r})")
            self.context.unsupported.clear()
            self.access.forget()
            return True
        return goes_on
