"""Arguments of calls: inputs before, outputs behind."""

from __future__ import annotations

from dataclasses import dataclass

from plcgen.cpu.compiler.access import Access
from plcgen.cpu.compiler.assignments import Assignments
from plcgen.cpu.compiler.context import Context
from plcgen.cpu.compiler.expressions import Expressions
from plcgen.cpu.compiler.places import Places
from plcgen.cpu.compiler.references import References
from plcgen.cpu.compiler.scope import scalar_name
from plcgen.cpu.compiler.values import MemoryPlace
from plcgen.cpu.system.interfaces import SystemFb
from plcgen.diagnostics.suggest import did_you_mean
from plcgen.s7.blocks import SectionKind
from plcgen.s7.shapes import Shape
from plcgen.s7.types import Elementary, Member
from plcgen.scl import ast

_IN, _OUT, _INOUT = SectionKind.INPUT, SectionKind.OUTPUT, SectionKind.IN_OUT


@dataclass(slots=True, eq=False)
class Passed:
    """What is left to do when the inputs are stored: the outputs that are wanted, and the code of the buffer."""

    outputs: list[tuple[ast.Argument, MemoryPlace]]
    buffer: str = ""


@dataclass(slots=True, eq=False)
class Arguments:
    """Arguments of blocks of the program and of system blocks."""

    context: Context
    access: Access
    expressions: Expressions
    places: Places
    references: References
    assignments: Assignments

    def pass_arguments(
        self, node: ast.Call, place: MemoryPlace, allowed: dict[str, SectionKind], system: SystemFb | None = None
    ) -> Passed | None:
        """Store inputs; None if the call makes no sense without those that are missing."""
        passed = Passed([])
        seen: set[str] = set()
        for argument in node.arguments:
            upper = (argument.name or "").upper()
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
            if kind is not _OUT:
                self.pass_input(argument, target, kind)
            if kind is _OUT or (kind is _INOUT and scalar_name(target.shape) not in {"POINTER", "ANY", ""}):
                passed.outputs.append((argument, target))
        missing = [name for name, kind in allowed.items() if kind is _INOUT and name not in seen]
        if missing and self.context.link.dialect.is_tia:
            self.context.error("PG822", f"{missing[0]} is missing", node, "every IN_OUT parameter needs a variable")
            if system is not None:
                return None
        return passed

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
            self.context.error(
                "PG822", f"{argument.name} is an {kind.value} parameter: it goes with {wanted}", argument
            )
            return None
        return kind

    def enable(self, argument: ast.Argument, upper: str, passed: Passed) -> None:
        """EN and ENO of a call."""
        if upper == "ENO":
            passed.outputs.append((argument, MemoryPlace(Shape(Elementary("BOOL", 1), 1, 1, 1, 1), local="E[0]")))
        else:
            self.context.error("PG827", "the soft CPU does not execute EN of a call", argument, "use IF")

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

    def structured(self, argument: ast.Argument, kind: SectionKind) -> str:
        """Memory and offset of an argument passed by reference."""
        if kind is not _IN and self.place_of_argument(argument) is None:
            return "(None,0,0)"
        return self.references.reference(argument.value)

    def pass_input(self, argument: ast.Argument, target: MemoryPlace, kind: SectionKind) -> None:
        """Store one input."""
        type_ = scalar_name(target.shape)
        if type_ in {"POINTER", "ANY"} and not (
            isinstance(argument.value, ast.Name) and type_ == self.kind_of(argument)
        ):
            code = self.references.reference(argument.value)
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
            self.context.error("PG827", "the soft CPU takes no slice here", argument.value)
            return None
        place = self.places.place(argument.value)
        if place is not None and place.section is _IN:
            self.context.error(
                "PG823", f"{self.context.text(argument.value)} is an input", argument.value, "inputs are read only"
            )
            return None
        return place

    def take_output(self, argument: ast.Argument, target: MemoryPlace) -> None:
        """Copy an output to the variable behind ``=>``."""
        place = self.place_of_argument(argument)
        if place is not None:
            self.assignments.assign_value(place, self.access.load(target), argument.value)
