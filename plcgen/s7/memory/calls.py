"""What it takes to call a block: preparing its parameters, the call itself, taking its outputs."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from plcgen.s7.memory import costs
from plcgen.s7.memory.names import BlockNames, CodeOperand, OperandArea
from plcgen.s7.scl import ast
from plcgen.s7.types.blocks import Block, BlockKind, SectionKind
from plcgen.s7.types.data_types import DataType, StringType

_WORD = 16
_BY_ANY = frozenset({"SFC14", "SFC15", "SFC20", "SFC21", "BLKMOV", "FILL", "DPRD_DAT", "DPWR_DAT", "UBLKMOV", "SFC81"})
"""Functions whose parameters are of type ANY; of other functions the interface says so."""


@dataclass(frozen=True, slots=True)
class CallCost:
    """Calls of one block; ``load`` gives the bytes of a value (for a width), ``access`` those of a place."""

    names: BlockNames
    load: Callable[..., int]
    access: Callable[[CodeOperand], int]

    def function(self, node: ast.Call) -> tuple[int, int]:
        """Bytes of a call of an FC or SFC without taking its result, and the bits of that result."""
        name = _name(node.target)
        block = self.names.find(name) if name else None
        size = costs.CALL + costs.POINTER + (costs.SAVE_REGISTERS if self.names.has_instance else 0)
        for argument in node.arguments:
            if isinstance(argument.value, ast.Omitted):
                continue
            declared = _parameter_of(block, argument.name)[1]
            size += costs.POINTER + self._argument(argument.value, declared, by_any=name in _BY_ANY)
        returned = block.section(SectionKind.RETURN) if block is not None else ()
        width = self.names.width(returned[0].type) if returned else _WORD
        return size, 32 if width is None or name == "SFC64" else width

    def _argument(self, node: ast.Expression, declared: DataType | None, *, by_any: bool) -> int:
        """Bytes that make an argument of a function ready: its address is handed over."""
        if isinstance(node, ast.Literal) and node.kind == "pointer":
            return costs.ANY
        place = self.names.place(node)
        if place is not None and not place.indices and place.area is OperandArea.TEMP and self._direct(place.type):
            return 0
        if by_any or self.names.name(declared) == "ANY":
            return costs.ANY
        if place is not None and not self.names.is_elementary(place.type):
            return costs.STRUCTURE
        return self.load(node, self.names.width(declared)) + costs.ACCESS

    def _direct(self, type_: DataType | None) -> bool:
        return self.names.is_elementary(type_) or self.names.name(type_) == "ANY"

    def block(self, node: ast.Call) -> int | None:
        """Bytes of a call of an FB by its instance; None if what is called is no FB."""
        found = self._instance(node.target)
        if found is None:
            return None
        block, own = found
        size = costs.MULTI_INSTANCE_CALL if own else costs.INSTANCE_CALL
        for argument in node.arguments:
            if not isinstance(argument.value, ast.Omitted):
                size += self._parameter(argument, block, own=own)
        return size

    def _instance(self, target: ast.Expression) -> tuple[Block | None, bool] | None:
        """The FB behind an instance and whether it lies in the caller's own data; None if it is no instance."""
        if isinstance(target, ast.Member):
            base = _name(target.base)
            block = self.names.find(base, quoted=True) if base else None
            if block is not None and block.kind is BlockKind.FB and self._of_block(target.base):
                return block, False
        place = self.names.place(target)
        if place is None or place.area in {OperandArea.FAR, OperandArea.NEAR}:
            return None
        type_ = place.type
        name = getattr(type_, "name", "")
        block = self.names.blocks.get(name.upper()) if place.area is OperandArea.DB else None
        if block is not None and block.instance_of:
            return self.names.find(block.instance_of, quoted=True), False
        block = self.names.find(name, quoted=True) if name else None
        if place.area is OperandArea.DB or (block is not None and block.kind is BlockKind.FB):
            return block, place.area is not OperandArea.DB
        return None

    def _of_block(self, node: ast.Expression) -> bool:
        """Whether a name stands for a block, not for a variable."""
        return isinstance(node, ast.Name) and (node.scope == "quoted" or node.name.upper() not in self.names.variables)

    def _parameter(self, argument: ast.Argument, block: Block | None, *, own: bool) -> int:
        kind, declared = _parameter_of(block, argument.name)
        place = self.names.place(argument.value)
        if argument.operator == "=>":
            return costs.ACCESS + (self.access(place) if place is not None else costs.ACCESS)
        if self.names.name(declared) == "ANY" or getattr(declared, "name", "").upper() == "VARIANT":
            return costs.ANY
        structured = not self.names.is_elementary(declared)
        if kind is SectionKind.IN_OUT:
            return costs.STRUCTURE if structured else self.load(argument.value) + costs.IN_OUT
        if structured:
            return costs.STRUCTURE if isinstance(declared, StringType) else costs.COPY
        foreign = not own and place is not None and place.area is OperandArea.STATIC
        size = self.load(argument.value, self.names.width(declared)) + costs.ACCESS
        return size + (costs.FROM_OTHER_INSTANCE if foreign else 0)


def _name(node: ast.Expression) -> str:
    return node.name.upper() if isinstance(node, ast.Name) else ""


def _parameter_of(block: Block | None, name: str | None) -> tuple[SectionKind | None, DataType | None]:
    if block is None or name is None:
        return None, None
    wanted = name.upper()
    for section in block.sections:
        for member in section.members:
            if member.name.upper() == wanted:
                return section.kind, member.type
    return None, None
