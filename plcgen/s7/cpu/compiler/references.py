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
from plcgen.s7.cpu.compiler.scope import is_open, scalar_name
from plcgen.s7.cpu.compiler.values import UNKNOWN, MemoryPlace, Val, unknown
from plcgen.s7.cpu.kinds import Kind
from plcgen.s7.cpu.memory import CODECS
from plcgen.s7.cpu.type_rules import POINTERS, TEXTS
from plcgen.s7.layout.shapes import Shape
from plcgen.s7.scl import ast
from plcgen.s7.types.address import AddressError, parse_pointer

_ROOM = 254
"""Characters of a text constant that is passed by reference."""
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

    def typed(self, node: ast.Expression) -> str:
        """Code of a reference that knows the type of its variable, for VARIANT and ``ARRAY[*]``."""
        return self.reference(node, typed=True)

    def kind(self, shape: Shape) -> str:
        """Code of the kind of a variable."""
        return f"K[{self.context.link.kind(shape)}]"

    def reference(self, node: ast.Expression, *, typed: bool = False) -> str:
        """Code of a reference to a variable, for ANY, VARIANT and structured parameters."""
        if isinstance(node, ast.Literal) and node.kind == "pointer":
            return self.pointer(node).code
        if isinstance(node, ast.Literal | ast.Binary | ast.Unary | ast.Call) or self.is_constant(node):
            return self.value_reference(self.expressions.value(node), node, typed=typed)
        if self.is_null(node):
            return "(None,0,0)"
        place = self.places.place(node)
        if place is None:
            return "(None,0,0)"
        if place.local:
            type_ = scalar_name(place.shape)
            if type_ in POINTERS:
                return place.local
            return self.borrow(place, node, typed=typed)
        if is_open(place.shape) and place.mem.endswith("_m"):
            return f"{place.mem.removesuffix('_m')}_r"
        if scalar_name(place.shape) == "ANY":
            return f"any_of({place.mem},{self.access.address(place)})"
        if typed and place.shape.bits == 1:
            return self.borrow(place, node, typed=True)
        size = -(-place.shape.bits // 8)
        if typed:
            return f"typed({place.mem},{self.access.address(place)},{size},{self.kind(place.shape)})"
        return f"({place.mem},{self.access.address(place)},{size})"

    def bit(self, node: ast.Expression) -> str:
        """Memory and number of a bit, of a variable or behind a ``P#`` constant."""
        if isinstance(node, ast.Literal) and node.kind == "pointer":
            code = self.pointer(node).code
            start = parse_pointer(node.text).start if code != "0" else None
            bit = start.offset if start is not None else 0
            return f"({code}[0],{bit})"
        place = self.places.place(node)
        if place is None or place.local:
            if place is not None:
                self.context.error("PG827", "the soft CPU has no address of this variable", node)
            return "(None,0)"
        bits = f"{place.off % 8}+{place.dynbit}" if place.dynbit else str(place.off % 8)
        return f"({place.mem},({self.access.address(place)})*8+{bits})"

    def tail(self, node: ast.Expression) -> str:
        """Memory, begin of an array, an element of it and its end, and the bits of an element; all counted in bits.

        Of a structure with nothing but BOOL it is all of it.
        """
        array = self.places.place(node.base if isinstance(node, ast.Index) else node)
        element = self.places.place(node)
        if array is None or element is None or array.local or is_open(array.shape):
            self.context.error("PG827", "the soft CPU needs an element of an array here", node)
            return "(None,0,0,0,1)"
        begin = f"({self.access.address(array)})*8"
        bit = f"{element.off % 8}+{element.dynbit}" if element.dynbit else str(element.off % 8)
        width = element.shape.bits if isinstance(node, ast.Index) else 1
        at = f"({self.access.address(element)})*8+{bit}"
        return f"({element.mem},{begin},{at},{begin}+{array.shape.bits},{width})"

    def borrow(self, place: MemoryPlace, node: ast.Expression, *, typed: bool) -> str:
        """A variable that has no bytes of its own in memory for the call; it takes over what is there in the end."""
        copy = self.value_reference(self.access.load(place), node, typed=typed)
        if copy != "(None,0,0)":
            self.context.borrowed.append((copy[copy.index("(") + 1 : copy.index(",")], place))
        return copy

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

    def value_reference(self, value: Val, node: ast.Expression, *, typed: bool = False) -> str:
        """Put a value into memory of its own."""
        type_ = {"#int": "INT", "#real": "REAL", "#text": "STRING"}.get(value.type, value.type)
        if type_ not in CODECS and type_ not in {"BOOL", *TEXTS}:
            if type_ != UNKNOWN:
                self.context.error("PG827", f"the soft CPU does not pass {type_ or 'this'} by reference", node)
            return "(None,0,0)"
        name = self.out.temporary()
        code = coerce(self.context, value, type_, node)
        if type_ in TEXTS:
            kind = Kind(type_, 0, room=_ROOM)
            size = _ROOM + 2 if type_ == "STRING" else 2 * _ROOM + 4
            store = f"{'w_s' if type_ == 'STRING' else 'w_ws'}({name},0,{_ROOM},{code})"
        else:
            kind = Kind(type_, 1 if type_ == "BOOL" else 8 * CODECS[type_].size)
            size = -(-kind.bits // 8)
            bit = f"{name}[0]=1 if {code} else 0"
            store = bit if type_ == "BOOL" else CODECS[type_].write.format(m=name, o=0, v=code)
        self.out.emit(f"{name}=local({size})")
        self.out.emit(store)
        return f"typed({name},0,{size},K[{self.context.link.number(kind)}])" if typed else f"({name},0,{size})"
