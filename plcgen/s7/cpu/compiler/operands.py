"""Operands: names, constants, slices, paths."""

from __future__ import annotations

from dataclasses import dataclass

from plcgen.s7.cpu.compiler.access import Access
from plcgen.s7.cpu.compiler.context import Context
from plcgen.s7.cpu.compiler.expressions import Expressions
from plcgen.s7.cpu.compiler.literals import classify, source_of
from plcgen.s7.cpu.compiler.places import Places
from plcgen.s7.cpu.compiler.references import References
from plcgen.s7.cpu.compiler.values import Val, unknown
from plcgen.s7.cpu.type_rules import TYPE_NAME
from plcgen.s7.scl import ast
from plcgen.s7.scl.dialects_tree import is_refused


@dataclass(slots=True, eq=False)
class Operands:
    """What an expression begins with."""

    context: Context
    access: Access
    expressions: Expressions
    places: Places
    references: References

    def name(self, node: ast.Name) -> Val:
        """Value of a variable or constant."""
        symbol = self.places.symbol(node)
        if symbol is not None and symbol.place is not None:
            return self.access.load(symbol.place)
        if symbol is not None and symbol.constant is not None:
            return symbol.constant
        if node.name.upper() in {"ENO", "OK", "EN", "NULL", "NIL"} and self.places.undeclared(node):
            if node.name.upper() in {"NULL", "NIL"}:
                return Val("(None,0,0)", "ANY")
            self.context.uses_eno = True
            return Val(self.context.enable(node.name), "BOOL")
        named = self.places.type_named(node)
        if named:
            return Val(repr(named), TYPE_NAME)
        place = self.places.named(node)
        return self.access.load(place) if place is not None else unknown()

    def literal(self, node: ast.Literal) -> Val:
        """Compile a constant."""
        if node.kind == "pointer":
            return self.references.pointer(node)
        found = classify(node.text, node.kind)
        if found is None:
            self.context.error("PG824", f"{node.text} is not a constant", node)
            return unknown()
        type_, value = found
        if is_refused(type_, self.context.link.dialect):
            return unknown()  # PG803 has told of it
        return Val(source_of(value), type_, value)

    def slice(self, node: ast.Slice) -> Val:
        """``x.%X3``: part of a bit string or integer."""
        value = self.expressions.value(node.base)
        part = self.places.slice_type(node, value)
        if part is None:
            return unknown()
        bits, type_ = part
        return Val(f"({value.wrapped}>>{node.index * bits}&{(1 << bits) - 1})", type_, pure=value.pure)

    def variable(self, node: ast.Expression) -> Val:
        """Value of a path or an address."""
        place = self.places.place(node)
        return self.access.load(place) if place is not None else unknown()

    def omitted(self, node: ast.Omitted) -> Val:
        """PG822 about ``Q => ,`` where a value is needed."""
        self.context.error("PG822", "the parameter has no value", node)
        return unknown()

    def listed(self, node: ast.Aggregate | ast.Repetition) -> Val:
        """PG827 about ``[1, 2]`` and ``3(0)``."""
        self.context.error("PG827", "a list of values is allowed in declarations only", node)
        return unknown()
