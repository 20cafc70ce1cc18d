"""Arguments of calls, inputs before and outputs behind; references to memory for ANY, VARIANT and structures."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TypeVar

from plcgen.base.diagnostics.suggest import did_you_mean
from plcgen.s7.cpu.compiler.access import Access
from plcgen.s7.cpu.compiler.assignments import Assignments
from plcgen.s7.cpu.compiler.context import Context, Listing
from plcgen.s7.cpu.compiler.conversions import coerce
from plcgen.s7.cpu.compiler.places import Places
from plcgen.s7.cpu.compiler.scope import UNKNOWN, Expressions, MemoryPlace, Val, is_open, scalar_name, unknown
from plcgen.s7.cpu.kinds import Kind
from plcgen.s7.cpu.linkage import ProgramBlock
from plcgen.s7.cpu.memory import CODECS
from plcgen.s7.cpu.system.interfaces import SystemFb
from plcgen.s7.cpu.type_rules import POINTERS, TEXTS
from plcgen.s7.layout.shapes import Shape
from plcgen.s7.scl import ast
from plcgen.s7.types.address import AddressError, parse_pointer
from plcgen.s7.types.blocks import SectionKind
from plcgen.s7.types.data_types import ArrayType, DataType, Elementary, Member

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


_IN, _OUT, _INOUT = SectionKind.INPUT, SectionKind.OUTPUT, SectionKind.IN_OUT
_OWN_MEMORY = re.compile(r"\((m|t|d[0-9]+),")
"""A reference to memory whose access setting is known when it is compiled."""
_POINTED = frozenset("tIQMP")
"""Local data, inputs, outputs, flags and peripherals."""


@dataclass(slots=True, eq=False)
class Passed:
    """What is left to do when the inputs are stored: outputs that are wanted, code of the buffer or PT, copies."""

    outputs: list[tuple[ast.Argument, MemoryPlace]]
    buffer: str = ""
    lent: list[tuple[str, str]] = field(default_factory=list)
    """References to structured IN_OUT parameters, and to what was handed over instead."""


@dataclass(slots=True, eq=False)
class Arguments:
    """Arguments of blocks of the program and of system blocks."""

    context: Context
    access: Access
    expressions: Expressions
    places: Places
    references: References
    assignments: Assignments
    out: Listing

    def pass_arguments(
        self,
        node: ast.Call,
        place: MemoryPlace,
        allowed: dict[str, SectionKind],
        called: SystemFb | ProgramBlock,
    ) -> Passed | None:
        """Store inputs; None if the call makes no sense without those that are missing."""
        system = called if isinstance(called, SystemFb) else None
        passed = Passed([])
        seen: set[str] = set()
        alone = next(iter(allowed), "") if len(node.arguments) == len(allowed) == 1 else ""
        for argument in node.arguments:
            upper = (argument.name or alone).upper()
            if upper in {"EN", "ENO"} and upper not in allowed:
                self.enable(argument, upper, passed)
                continue
            kind = self.parameter(argument, upper, allowed, seen)
            if kind is None or isinstance(argument.value, ast.Omitted):
                continue
            if system is not None and upper == system.buffer:
                passed.buffer = self.references.reference(argument.value)
                continue
            target = self.places.field(place, upper, argument.value)
            if target is None:
                continue
            if system is not None and upper == "PT" and system.takes_over:
                passed.buffer = self.out.temporary()
                code = coerce(
                    self.context, self.expressions.value(argument.value), scalar_name(target.shape), argument.value
                )
                self.out.emit(f"{passed.buffer}={code}")
                continue
            if scalar_name(target.shape) == "VARIANT":
                code = self.references.typed(argument.value)
                self.out.emit(f"keep({place.mem},{self.access.address(place)},{upper!r},{code})")
                continue
            if kind is not _OUT:
                lender = called if isinstance(called, ProgramBlock) and kind is _INOUT else None
                self.pass_input(argument, target, kind, lender, passed.lent)
            if kind is _OUT or (kind is _INOUT and scalar_name(target.shape) not in {"POINTER", "ANY", "VARIANT", ""}):
                passed.outputs.append((argument, target))
        missing = [name for name, kind in allowed.items() if kind is _INOUT and name not in seen]
        if system is None:  # one of an elementary type keeps its value
            missing = [name for name in missing if self.is_structured(place, name)]
        if missing and system is not None and self.context.link.dialect.is_tia:  # Siemens' LAcycCom calls WRREC so
            self.context.error("PG827", f"the soft CPU does not accept a call without {missing[0]}", node)
            return None
        if missing and self.context.link.dialect.is_tia:
            self.context.error("PG822", f"{missing[0]} is missing", node, "every IN_OUT parameter needs a variable")
        return passed

    def is_structured(self, place: MemoryPlace, name: str) -> bool:
        """Whether a parameter of an instance is a pointer to a structure, an array or a text."""
        field = place.shape.index.get(name)
        return field is None or not isinstance(field.member.type, Elementary)

    def look_at(self, node: ast.Call) -> None:
        """Check the arguments of a call that is not compiled: what they are for is not known."""
        for argument in node.arguments:
            if argument.operator == "=>":
                pointer = isinstance(argument.value, ast.Literal) and argument.value.kind == "pointer"
                if not pointer and not isinstance(argument.value, ast.Omitted | ast.Slice):
                    self.places.place(argument.value)
            elif not isinstance(argument.value, ast.Omitted) and not self.references.is_null(argument.value):
                self.expressions.value(argument.value)

    def parameter(
        self, argument: ast.Argument, upper: str, allowed: dict[str, SectionKind], seen: set[str]
    ) -> SectionKind | None:
        """Section of a named parameter; PG822 if it is none or the operator is wrong."""
        kind = allowed.get(upper)
        if kind is None:
            shown = argument.name or self.context.text(argument)
            near = did_you_mean(shown, list(allowed))
            self.context.error("PG822", f"the block has no parameter {shown}", argument, near)
            return None
        if upper in seen:
            self.context.error("PG822", f"{argument.name} is given twice", argument)
            return None
        seen.add(upper)
        if (argument.operator == "=>") != (kind is _OUT):
            wanted = "=>" if kind is _OUT else ":="
            self.context.error("PG822", f"{argument.name} is an {kind.value} parameter: use {wanted}", argument)
            return None
        return kind

    def enable(self, argument: ast.Argument, upper: str, passed: Passed) -> None:
        """EN and ENO of a call."""
        if upper == "ENO":
            self.out.emit("E[0]=True")
            passed.outputs.append((argument, MemoryPlace(Shape(Elementary("BOOL", 1), 1, 1, 1, 1), local="E[0]")))
        else:
            self.context.error("PG827", "the soft CPU does not execute EN of a call", argument, "use IF")
            self.expressions.value(argument.value)

    def named_arguments(
        self, node: ast.Call, parameters: list[tuple[SectionKind, Member, str]], allowed: dict[str, SectionKind]
    ) -> dict[str, ast.Argument]:
        """Arguments by upper-case parameter name; a single one may go without a name."""
        if len(node.arguments) == 1 and node.arguments[0].name is None and len(allowed) == 1:
            return {parameters[0][1].name.upper(): node.arguments[0]}
        seen: set[str] = set()
        given: dict[str, ast.Argument] = {}
        for argument in node.arguments:
            upper = (argument.name or "").upper()
            if upper in {"EN", "ENO"} and upper not in allowed:
                given[upper] = argument
                continue
            v5_output = (
                allowed.get(upper) is _OUT and argument.operator == ":=" and not self.context.link.dialect.is_tia
            )
            kind = allowed[upper] if v5_output and upper not in seen else self.parameter(argument, upper, allowed, seen)
            if kind is not None:
                seen.add(upper)
                if not isinstance(argument.value, ast.Omitted):
                    given[upper] = argument
        return given

    def structured(self, argument: ast.Argument, kind: SectionKind, type_: DataType) -> str:
        """Memory and offset of an argument passed by reference."""
        if kind is not _IN and self.place_of_argument(argument) is None:
            return "(None,0,0)"
        return self.references.reference(argument.value, typed=isinstance(type_, ArrayType) and not type_.bounds)

    def lend(self, code: str, called: ProgramBlock, lent: list[tuple[str, str]]) -> str:
        """Reference to hand over for a structured IN_OUT: a copy, if the access settings of both sides differ."""
        link = self.context.link
        wanted = link.optimized(called)
        known = _OWN_MEMORY.match(code)
        moving = known is not None and known[1] == "m" and self.context.dynamic
        if not link.mixed or (known and not moving and self.memory_optimized(known[1]) == wanted):
            return code
        names = self.out.temporary(), self.out.temporary()
        self.out.emit(f"{names[0]}={code};{names[1]}=lend({names[0]},{wanted})")
        lent.append(names)
        return names[1]

    def memory_optimized(self, memory: str) -> bool:
        """Whether a generated memory has optimised access: instance or local data of the block, a data block."""
        link = self.context.link
        if memory in {"m", "t"}:
            return link.optimized(self.context.owner)
        return any(link.optimized(block) for block in link.blocks.values() if f"d{block.index}" == memory)

    def give_back(self, lent: list[tuple[str, str]], node: ast.Call) -> None:
        """Copy back what was lent as a copy."""
        for reference, copy in lent:
            self.context.point("output", node)
            between = f",lambda:{self.context.point_code('copy', node)}" if self.context.preemptive else ""
            self.out.emit(f"give_back({reference},{copy}{between})")
        if lent:
            self.access.forget()

    def pass_input(
        self,
        argument: ast.Argument,
        target: MemoryPlace,
        kind: SectionKind,
        called: ProgramBlock | None,
        lent: list[tuple[str, str]],
    ) -> None:
        """Store one input; a structured IN_OUT of ``called`` may be lent as a copy."""
        type_ = scalar_name(target.shape)
        if type_ in {"POINTER", "ANY"} and not (
            isinstance(argument.value, ast.Name) and type_ == self.kind_of(argument)
        ):
            if kind is _INOUT and self.references.is_constant(argument.value):
                self.place_of_argument(argument)
                return
            member = target.member.type if target.member is not None else None
            is_open = isinstance(member, ArrayType) and not member.bounds
            code = self.references.reference(argument.value, typed=is_open)
            if type_ == "POINTER" and called is not None:
                code = self.lend(code, called, lent)
            pack = "any10" if type_ == "ANY" else "ptr6"
            self.access.store(target, f"{pack}({code})")
            return
        if kind is _INOUT and self.place_of_argument(argument) is None:
            return
        self.assignments.assign_value(target, self.expressions.value(argument.value), argument.value)

    def kind_of(self, argument: ast.Argument) -> str:
        """Scalar type of a variable given as an argument."""
        node = argument.value
        symbol = self.places.symbol(node) if isinstance(node, ast.Name) else None
        return scalar_name(symbol.place.shape) if symbol is not None and symbol.place is not None else ""

    def place_of_argument(self, argument: ast.Argument) -> MemoryPlace | None:
        """Variable given to an OUT or IN_OUT parameter; PG823 if it must not be written."""
        if isinstance(argument.value, ast.Slice):
            self.context.error("PG827", "the soft CPU does not accept a slice here", argument.value)
            return None
        place = self.places.place(argument.value)
        if place is not None and place.section is _IN:
            # the TIA Portal warns that the declaration of the actual parameter does not match that of the formal one
            tolerated = self.context.link.dialect.is_tia
            self.assignments.input_written(argument.value, "inputs are read only", tolerated=tolerated)
            return place if tolerated else None
        return place

    def found_in_output(self, argument: ast.Argument, type_: str) -> str:
        """What an FC of an S7-300/400 finds in an output: the value of its variable, if the output is a pointer to it.

        Otherwise the default (help of the TIA Portal, "Parameter transfer with S7-300/400": operands of I, Q, M, P and
        L are pointers; "Parameter assignment to functions": an output that is not written).
        """
        place = self.places.place(argument.value) if not isinstance(argument.value, ast.Slice) else None
        if place is not None and (place.local or place.mem in _POINTED) and scalar_name(place.shape) == type_:
            return self.access.load(place).wrapped
        return CODECS[type_].default if type_ in CODECS else "False"

    def take_output(self, argument: ast.Argument, target: MemoryPlace) -> None:
        """Copy an output to the variable behind ``=>``."""
        place = self.place_of_argument(argument)
        if place is not None:
            self.assignments.assign_value(place, self.access.load(target), argument.value)
