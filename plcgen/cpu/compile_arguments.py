"""Values into places: assignment, copies, outputs, and references for ANY, VARIANT and structures."""

from __future__ import annotations

from plcgen.cpu.compile_expressions import ExpressionCompiler
from plcgen.cpu.compile_model import UNKNOWN, Place, Val
from plcgen.cpu.memory import CODECS
from plcgen.cpu.semantics_scope import scalar_name
from plcgen.cpu.semantics_types import POINTERS
from plcgen.cpu.system.interfaces import system_fbs
from plcgen.s7.address import AddressError, parse_pointer
from plcgen.s7.blocks import SectionKind
from plcgen.s7.shapes import Shape
from plcgen.s7.types import NamedType
from plcgen.scl import ast

_IN, _INOUT = SectionKind.INPUT, SectionKind.IN_OUT


class ArgumentCompiler(ExpressionCompiler):
    """What assignments and the arguments of calls have in common."""

    def pass_input(self, argument: ast.Argument, field: Place, kind: SectionKind) -> None:
        """Store one input."""
        type_ = scalar_name(field.shape)
        if type_ in {"POINTER", "ANY"} and not (
            isinstance(argument.value, ast.Name) and type_ == self.kind_of(argument)
        ):
            code = self.reference(argument.value)
            pack = "any10" if type_ == "ANY" else "ptr6"
            self.store(field, f"{pack}({code})")
            return
        if kind is _INOUT and self.place_of_argument(argument) is None:
            return
        self.assign_value(field, self.expression(argument.value), argument.value)

    def kind_of(self, argument: ast.Argument) -> str:
        """Scalar type of a variable given as an argument."""
        node = argument.value
        symbol = self.symbol(node) if isinstance(node, ast.Name) else None
        return scalar_name(symbol.place.shape) if symbol is not None and symbol.place is not None else ""

    def place_of_argument(self, argument: ast.Argument) -> Place | None:
        """Variable given to an OUT or IN_OUT parameter; PG823 if it must not be written."""
        if isinstance(argument.value, ast.Slice):
            self.error("PG827", "the soft CPU takes no slice here", argument.value)
            return None
        place = self.place(argument.value)
        if place is not None and place.section is _IN:
            self.error("PG823", f"{self.text(argument.value)} is an input", argument.value, "inputs are read only")
            return None
        return place

    def take_output(self, argument: ast.Argument, field: Place) -> None:
        """Copy an output to the variable behind ``=>``."""
        place = self.place_of_argument(argument)
        if place is not None:
            self.assign_value(place, self.load(field), argument.value)

    def assign_value(self, place: Place, value: Val, node: ast.Expression) -> None:
        """Store a value with its implicit conversion; structures are copied."""
        type_ = scalar_name(place.shape)
        if value.type == UNKNOWN:
            return
        if type_ and value.type:
            code = self.coerce(value, type_, node)
            const = value.const if isinstance(value.const, bool) else None
            self.store(place, code, const)
            return
        self.copy(place, value, node)

    def copy(self, place: Place, value: Val, node: ast.Expression) -> None:
        """Copy a structure or array byte by byte."""
        source = value.place
        if source is None or source.shape.bits != place.shape.bits or not same_type(place.shape, source.shape):
            self.error("PG821", f"{self.text(node)} has another type", node)
            return
        size = place.shape.bits // 8
        self.emit(f"cp({place.mem},{self.address(place)},{source.mem},{self.address(source)},{size})")
        self.touched(place.region if place.fixed else None, place.off, place.shape.bits)

    def watch_status(self, base: Place, name: str, node: ast.Expression) -> None:
        """Note reads of STATUS of a record block: it counts in the scan of its call only."""
        if name.upper() != "STATUS" or not isinstance(node, ast.Member):
            return
        type_ = base.shape.type.name if isinstance(base.shape.type, NamedType) else ""
        if isinstance(node.base, ast.Name) and base.mem.startswith("d"):
            found = self.link.find(node.base.name)
            type_ = self.link.instance_type(found) if found is not None else type_
        system = system_fbs(classic=self.classic).get(type_.upper())
        if system is not None and system.watched and self.link.find(type_) is None:
            self.emit(f"st({base.mem},{self.address(base)})")

    def pointer(self, node: ast.Literal) -> Val:
        """``P#DB3.DBX0.0 BYTE 10``."""
        try:
            pointer = parse_pointer(node.text)
        except AddressError as problem:
            self.error("PG827", str(problem), node)
            return self.unknown()
        region, start = pointer.region, pointer.start
        area = "P" if start.area.startswith("P") else start.area
        size = max(1, region.width_bits // 8)
        return Val(f"pt({area!r},{start.db or 0},{start.byte},{size})", "ANY")

    def reference(self, node: ast.Expression) -> str:
        """Code of a reference to a variable, for ANY, VARIANT and structured parameters."""
        if isinstance(node, ast.Literal) and node.kind == "pointer":
            return self.pointer(node).code
        if isinstance(node, ast.Literal | ast.Binary | ast.Unary | ast.Call):
            return self.value_reference(self.expression(node), node)
        if isinstance(node, ast.Name) and self.symbol(node) is None and node.name.upper() in {"NULL", "NIL"}:
            return "(None,0,0)"
        place = self.place(node)
        if place is None:
            return "(None,0,0)"
        if place.local:
            type_ = scalar_name(place.shape)
            return place.local if type_ in POINTERS else self.value_reference(self.load(place), node)
        if scalar_name(place.shape) == "ANY":
            return f"any_of({place.mem},{self.address(place)})"
        return f"({place.mem},{self.address(place)},{-(-place.shape.bits // 8)})"

    def value_reference(self, value: Val, node: ast.Expression) -> str:
        """Put a value into memory of its own."""
        type_ = {"#int": "INT", "#real": "REAL", "#text": "STRING"}.get(value.type, value.type)
        if type_ == "STRING":
            name = self.temporary()
            self.emit(f"{name}=local(256)")
            self.emit(f"w_s({name},0,254,{self.coerce(value, type_, node)})")
            return f"({name},0,256)"
        if type_ not in CODECS and type_ != "BOOL":
            if type_ != UNKNOWN:
                self.error("PG827", f"the soft CPU does not pass {type_ or 'this'} by reference", node)
            return "(None,0,0)"
        name = self.temporary()
        size = CODECS[type_].size if type_ != "BOOL" else 1
        self.emit(f"{name}=local({size})")
        code = self.coerce(value, type_, node)
        self.emit(
            f"{name}[0]=1 if {code} else 0" if type_ == "BOOL" else CODECS[type_].write.format(m=name, o=0, v=code)
        )
        return f"({name},0,{size})"


def same_type(left: Shape, right: Shape) -> bool:
    """Whether two structures may be assigned: the same name, or the same members."""
    if isinstance(left.type, NamedType) and isinstance(right.type, NamedType):
        return left.type.name.upper() == right.type.name.upper()
    if len(left.fields) != len(right.fields) or (left.element is None) != (right.element is None):
        return False
    if left.element is not None and right.element is not None:
        return left.strides == right.strides and same_type(left.element, right.element)
    if left.fields:
        return all(same_type(a.shape, b.shape) for a, b in zip(left.fields, right.fields, strict=True))
    return scalar_name(left) == scalar_name(right)
