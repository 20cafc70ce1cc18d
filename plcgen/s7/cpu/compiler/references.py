"""References to memory, for ANY, VARIANT and structured parameters."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeVar

from plcgen.s7.cpu.compiler.access import Access
from plcgen.s7.cpu.compiler.context import Context, Listing
from plcgen.s7.cpu.compiler.conversions import coerce
from plcgen.s7.cpu.compiler.expressions import Expressions
from plcgen.s7.cpu.compiler.places import Places
from plcgen.s7.cpu.compiler.scope import scalar_name
from plcgen.s7.cpu.compiler.values import UNKNOWN, Val, unknown
from plcgen.s7.cpu.memory import CODECS
from plcgen.s7.cpu.type_rules import POINTERS
from plcgen.s7.scl import ast
from plcgen.s7.types.address import AddressError, parse_pointer

_Node = TypeVar("_Node", ast.Call, ast.CallStatement)
_Result = TypeVar("_Result")


@dataclass(slots=True, eq=False)
class References:
    """Generated tuples of memory, first byte and size in bytes."""

    context: Context
    out: Listing
    access: Access
    expressions: Expressions
    places: Places

    def pointer(self, node: ast.Literal) -> Val:
        """``P#DB3.DBX0.0 BYTE 10``."""
        try:
            pointer = parse_pointer(node.text)
        except AddressError as problem:
            self.context.error("PG827", str(problem), node)
            return unknown()
        region, start = pointer.region, pointer.start
        area = "P" if start.area.startswith("P") else start.area
        size = max(1, region.width_bits // 8)
        return Val(f"pt({area!r},{start.db or 0},{start.byte},{size})", "ANY")

    def reference(self, node: ast.Expression) -> str:
        """Code of a reference to a variable, for ANY, VARIANT and structured parameters."""
        if isinstance(node, ast.Literal) and node.kind == "pointer":
            return self.pointer(node).code
        if isinstance(node, ast.Literal | ast.Binary | ast.Unary | ast.Call) or self.is_constant(node):
            return self.value_reference(self.expressions.value(node), node)
        if self.is_null(node):
            return "(None,0,0)"
        place = self.places.place(node)
        if place is None:
            return "(None,0,0)"
        if place.local:
            type_ = scalar_name(place.shape)
            if type_ in POINTERS:
                return place.local
            copy = self.value_reference(self.access.load(place), node)
            if copy != "(None,0,0)":
                self.context.borrowed.append((copy.strip("(").partition(",")[0], place))
            return copy
        if scalar_name(place.shape) == "ANY":
            return f"any_of({place.mem},{self.access.address(place)})"
        return f"({place.mem},{self.access.address(place)},{-(-place.shape.bits // 8)})"

    def lending(self, compile_call: Callable[[_Node], _Result]) -> Callable[[_Node], _Result]:
        """Compile a call; behind it, Python locals take over what was written to the memory lent for them."""

        def compiled(node: _Node) -> _Result:
            lent = self.context.borrowed
            before = len(lent)
            result = compile_call(node)
            for copy, place in lent[before:]:
                type_ = scalar_name(place.shape)
                read = CODECS[type_].read if type_ in CODECS else "{m}[{o}]!=0"
                self.access.store(place, read.format(m=copy, o=0))
            del lent[before:]
            return result

        return compiled

    def is_null(self, node: ast.Expression) -> bool:
        """Whether it is the word for a pointer to nothing."""
        if not isinstance(node, ast.Name) or node.name.upper() not in {"NULL", "NIL"}:
            return False
        return self.places.symbol(node) is None

    def is_constant(self, node: ast.Expression) -> bool:
        """Whether it is the name of a constant."""
        symbol = self.places.symbol(node) if isinstance(node, ast.Name) else None
        return symbol is not None and symbol.constant is not None

    def value_reference(self, value: Val, node: ast.Expression) -> str:
        """Put a value into memory of its own."""
        type_ = {"#int": "INT", "#real": "REAL", "#text": "STRING"}.get(value.type, value.type)
        if type_ == "STRING":
            name = self.out.temporary()
            self.out.emit(f"{name}=local(256)")
            self.out.emit(f"w_s({name},0,254,{coerce(self.context, value, type_, node)})")
            return f"({name},0,256)"
        if type_ not in CODECS and type_ != "BOOL":
            if type_ != UNKNOWN:
                self.context.error("PG827", f"the soft CPU does not pass {type_ or 'this'} by reference", node)
            return "(None,0,0)"
        name = self.out.temporary()
        size = CODECS[type_].size if type_ != "BOOL" else 1
        self.out.emit(f"{name}=local({size})")
        code = coerce(self.context, value, type_, node)
        bit = f"{name}[0]=1 if {code} else 0"
        self.out.emit(bit if type_ == "BOOL" else CODECS[type_].write.format(m=name, o=0, v=code))
        return f"({name},0,{size})"
