"""Where the parts of the compiler meet that compile each other's operands."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from plcgen.s7.cpu.compiler.values import Val
from plcgen.s7.scl import ast


@dataclass(slots=True, eq=False)
class Expressions:
    """Values and their types; a problem is reported once and gives the type UNKNOWN.

    ``parts`` maps a class of nodes to what compiles it; ``watch`` is shown every value.
    """

    parts: dict[type[ast.Expression], Callable[[Any], Val]] = field(default_factory=dict)
    watch: Callable[[ast.Expression, Val], None] | None = None

    def value(self, node: ast.Expression) -> Val:
        """Compile an expression."""
        return self.shown(node, self.parts[type(node)](node))

    def shown(self, node: ast.Expression, value: Val) -> Val:
        """The value of a node, shown to who watches."""
        if self.watch is not None:
            self.watch(node, value)
        return value
