"""GOTO and labels."""

from __future__ import annotations

from dataclasses import dataclass, field

from plcgen.cpu.compiler.access import Access
from plcgen.cpu.compiler.context import Context
from plcgen.cpu.compiler.listing import Listing
from plcgen.cpu.compiler.statements import Statements
from plcgen.cpu.compiler.watchdog import Watchdog
from plcgen.scl import ast


@dataclass(slots=True, eq=False)
class Labels:
    """A block with labels is a loop over the parts between them; ``numbers`` are those of its labels."""

    context: Context
    out: Listing
    access: Access
    watchdog: Watchdog
    statements: Statements
    numbers: dict[str, int] = field(default_factory=dict)

    def goto(self, node: ast.Goto) -> bool:
        """GOTO a label that stands at the top level of the block."""
        number = self.numbers.get(node.label.upper())
        if number is None:
            self.context.error("PG820", f"there is no label {node.label} at the top level of the block", node)
            self.out.emit("pass")
        elif self.watchdog.depth:
            self.out.emit(f"pc={number};g=1;break")
        else:
            self.out.emit(f"pc={number};continue")
        return False

    def segments(self, statements: ast.Body) -> None:
        """Compile a block with labels: a loop over the parts between them."""
        parts: list[list[ast.Statement]] = [[]]
        for statement in _flat(statements):
            if isinstance(statement, ast.Label):
                self.numbers[statement.name.upper()] = len(parts)
                parts.append([])
            else:
                parts[-1].append(statement)
        self.context.move_to(statements[0])
        self.out.emit("pc=g=0;k=W[0]")
        self.out.emit("while True:")
        self.out.indent += " "
        self.out.emit("k+=1")
        self.out.emit("if k>W[1]:late()")
        self.out.emit("W[0]=k")
        for number, part in enumerate(parts):
            self.access.forget()
            self.out.emit(f"if pc<={number}:")
            self.out.indent += " "
            self.statements.body(tuple(part))
            self.out.indent = self.out.indent[:-1]
        self.out.emit("break")
        self.out.indent = self.out.indent[:-1]
        self.access.forget()


def _flat(statements: ast.Body) -> list[ast.Statement]:
    """Statements with regions opened, so that labels inside regions count as top level."""
    found: list[ast.Statement] = []
    for statement in statements:
        if isinstance(statement, ast.Region):
            found += _flat(statement.body)
        else:
            found.append(statement)
    return found


def has_labels(statements: ast.Body) -> bool:
    """Whether a block has labels at its top level."""
    return any(isinstance(statement, ast.Label) for statement in _flat(statements))
