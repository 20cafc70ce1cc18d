"""Assignments: a value into a place."""

from __future__ import annotations

from dataclasses import dataclass

from plcgen.base.diagnostics import Severity
from plcgen.s7.cpu.compiler.access import Access
from plcgen.s7.cpu.compiler.context import Context, Listing
from plcgen.s7.cpu.compiler.conversions import coerce
from plcgen.s7.cpu.compiler.places import Places
from plcgen.s7.cpu.compiler.scope import UNKNOWN, Expressions, MemoryPlace, Val, same_type, scalar_name
from plcgen.s7.cpu.type_rules import BITS, NUMBERED
from plcgen.s7.layout.shapes import bare_shape
from plcgen.s7.scl import ast
from plcgen.s7.types.blocks import BlockKind, SectionKind
from plcgen.s7.types.data_types import ArrayType

_BOOL = bare_shape("BOOL")
_COMBINED = {"+=": "+", "-=": "-", "*=": "*", "/=": "/", "&=": "AND", "**=": "**"}


@dataclass(slots=True, eq=False)
class Assignments:
    """``:=`` in statements, and whatever else stores a value that SCL sees."""

    context: Context
    out: Listing
    access: Access
    expressions: Expressions
    places: Places

    def assign(self, node: ast.Assign) -> None:
        """``target := value``, also combined and chained: ``a := b := c`` is ``b := c; a := b``."""
        value_node = node.value
        if node.operator in _COMBINED:
            value_node = ast.Binary(node.start, node.end, _COMBINED[node.operator], node.target, node.value)
        elif node.operator != ":=":
            self.context.error("PG827", f"the soft CPU does not execute {node.operator}", node)
            return
        for target in reversed((node.target, *node.also)):
            if isinstance(target, ast.Slice):
                self.assign_slice(target, value_node)
            else:
                place = self.target(target)
                value = self.expressions.value(value_node)
                if place is not None:
                    self.assign_value(place, value, value_node)
            value_node = target if node.operator == ":=" else value_node

    def target(self, node: ast.Expression) -> MemoryPlace | None:
        """Place left of ``:=``; PG823 if it must not be written. Computed offsets are evaluated first."""
        if isinstance(node, ast.Name) and node.name.upper() in {"ENO", "OK"} and self.places.undeclared(node):
            self.context.uses_eno = True
            return MemoryPlace(_BOOL, local=self.context.enable(node.name))
        place = self.places.place(node)
        if place is None:
            return None
        if (place.mem, place.off, place.dyn, place.local) in self.context.run_tags and not place.dynbit:
            # does not compile for S7-1200/1500; on S7-300/400 the result is undefined (help of both families, FOR)
            severity = Severity.WARNING if self.context.classic else Severity.ERROR
            message = f"{self.context.text(node)} is the loop variable of the FOR around it"
            self.context.error("PG823", message, node, "leave a loop with EXIT, or count with WHILE", severity)
        if place.section is SectionKind.INPUT:
            # STEP 7 V5 lets an FB write its inputs: public libraries reset their commands that way
            # so do exports of the TIA Portal, in functions too
            tolerated = self.context.link.dialect.is_tia or self.context.scope.block.kind is BlockKind.FB
            self.input_written(node, "copy it to a variable of its own", tolerated=tolerated)
        if "(" in place.dyn:
            name = self.out.temporary()
            self.out.emit(f"{name}={place.dyn}")
            place.dyn = name
        if place.dynbit:
            name = self.out.temporary()
            self.out.emit(f"{name}={place.dynbit}")
            place.dynbit = name
        return place

    def input_written(self, node: ast.Expression, text: str, *, tolerated: bool) -> None:
        """An input gets a value in its own block (PG823)."""
        severity = Severity.WARNING if tolerated else Severity.ERROR
        self.context.error("PG823", f"{self.context.text(node)} is an input", node, text, severity)

    def assign_slice(self, node: ast.Slice, value_node: ast.Expression) -> None:
        """``x.%X3 := value``: the rest of x stays."""
        place = self.target(node.base)
        value = self.expressions.value(value_node)
        if place is None or value.type == UNKNOWN:
            return
        old = self.access.load(place)
        part = self.places.slice_type(node, old)
        if part is None:
            return
        bits, type_ = part
        code = coerce(self.context, value, type_, value_node)
        code = f"(1 if {code} else 0)" if type_ == "BOOL" else code
        mask = (1 << bits) - 1 << node.index * bits
        whole = scalar_name(place.shape)
        result = Val(f"({old.code}&{~mask}|{code}<<{node.index * bits})", whole, raw=whole not in BITS)
        if whole in BITS:
            result = Val(f"({old.code}&{(1 << BITS[whole]) - 1 & ~mask}|{code}<<{node.index * bits})", whole)
        self.access.store(place, result.wrapped)

    def assign_value(self, place: MemoryPlace, value: Val, node: ast.Expression) -> None:
        """Store a value with its implicit conversion; structures are copied."""
        type_ = scalar_name(place.shape)
        if value.type == UNKNOWN or self.context.is_opaque(place.shape):
            return
        if type_ == "VARIANT" and not (place.local and value.type == type_):
            self.point(value, node)
            return
        if type_ in {"ANY", "POINTER"} and value.place is not None and value.type != type_:
            self.context.error("PG827", f"the soft CPU does not assign a variable to a pointer of type {type_}", node)
            return
        if type_ and (value.type or type_ in NUMBERED):
            code = coerce(self.context, value, type_, node)
            const = value.const if isinstance(value.const, bool) else None
            self.access.store(place, code, const)
            return
        self.copy(place, value, node)

    def point(self, value: Val, node: ast.Expression) -> None:
        """Assign to a VARIANT: it takes no variable outside of a call (help of the TIA Portal, "Initializing VARIANT").

        Nothing says so of NULL, another pointer and a reference; they are not executed.
        """
        if self.places.pointer_type(value):
            self.context.error("PG827", "the soft CPU does not assign to a VARIANT", node)
            return
        help_ = "hand the variable to a VARIANT parameter in a call"
        self.context.error("PG821", f"{self.context.text(node)} is not assigned to a VARIANT", node, help_)

    def copy(self, place: MemoryPlace, value: Val, node: ast.Expression) -> None:
        """Copy a structure or array byte by byte."""
        source = value.place
        if source is not None and isinstance(place.shape.type, ArrayType) and self.is_open(place, source):
            self.context.error("PG827", "the soft CPU does not copy arrays of unknown length", node)
            return
        if source is None or source.shape.bits != place.shape.bits or not same_type(place.shape, source.shape):
            self.context.error("PG821", f"{self.context.text(node)} has another type", node)
            return
        size = place.shape.bits // 8
        target, origin = self.access.address(place), self.access.address(source)
        between = f",lambda:{self.context.point_code('copy', node)}" if self.context.preemptive else ""
        self.out.emit(f"copy({place.mem},{target},{source.mem},{origin},{size}{between})")
        self.access.touched(place.region if place.fixed else None, place.off, place.shape.bits)

    def is_open(self, *places: MemoryPlace) -> bool:
        """Whether the length of an array is not known: ``ARRAY[*]``, or a bound that stands elsewhere."""
        bounds = [place.shape.type.bounds for place in places if isinstance(place.shape.type, ArrayType)]
        guessed = self.context.link.guessed_bounds
        return any(not rows or (guessed and any(low == high for low, high in rows)) for rows in bounds)
