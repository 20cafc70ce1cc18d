"""What names in a block stand for: where a variable lies, of which type it is, and which indices lead to it."""

from __future__ import annotations

import enum
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache

from plcgen.s7.layout.shapes import TypeTable
from plcgen.s7.read.blocks import SourceBlock
from plcgen.s7.scl import ast
from plcgen.s7.types.address import AddressError, parse_address
from plcgen.s7.types.blocks import Block, BlockKind, SectionKind
from plcgen.s7.types.data_types import (
    ELEMENTARY,
    ArrayType,
    DataType,
    Elementary,
    Member,
    NamedType,
    StructType,
    elementary,
)
from plcgen.s7.types.system import system_block


class OperandArea(enum.Enum):
    """Where an operand lies, as far as the machine code differs."""

    TEMP = "temporary variable of the block"
    STATIC = "instance data"
    PARAMETER = "parameter of an FC"
    POINTED = "component of a structured IN_OUT"
    DB = "global data block"
    NEAR = "flag, input or output with a short address"
    FAR = "other address or tag"


@dataclass(frozen=True, slots=True)
class CodeOperand:
    """An operand: its type (None if unknown), its data block, the index expressions that are no constants.

    ``lows`` are the lower bounds of the dimensions of these indices, ``offset`` says that a member of the element is
    meant.
    """

    area: OperandArea
    type: DataType | None
    db: str = ""
    number: int | None = None
    indices: tuple[ast.Expression, ...] = ()
    lows: tuple[int, ...] = ()
    offset: bool = False


_SHORT = {"I": 128, "Q": 128, "M": 256}
"""Addresses below have instructions of 2 bytes."""


class BlockNames:
    """The names that the code of one block can use."""

    def __init__(self, source: SourceBlock, blocks: Mapping[str, Block], types: TypeTable, *, classic: bool) -> None:
        block = source.block
        self.block = block
        self.blocks = blocks
        self.types = types
        self.classic = classic
        self.variables: dict[str, tuple[SectionKind, Member]] = {
            member.name.upper(): (section.kind, member)
            for section in block.sections
            if section.kind is not SectionKind.CONSTANT
            for member in section.members
        }
        self.constants: dict[str, ast.Expression] = _constants(source.unit)

    @property
    def has_instance(self) -> bool:
        """Whether the block works on an instance: it must then save its registers around calls."""
        return self.block.kind is BlockKind.FB

    def constant(self, node: ast.Expression) -> ast.Expression | None:
        """The value behind the name of a constant; a literal or a sum of literals as it is; else None."""
        if isinstance(node, ast.Literal):
            return node
        if isinstance(node, ast.Unary) and node.operator in "+-" and self.constant(node.operand) is not None:
            return node
        if isinstance(node, ast.Name) and node.scope != "quoted":
            return self.constants.get(node.name.upper())
        return None

    def find(self, name: str, *, quoted: bool = False) -> Block | None:
        """The block or type of this name, a system block if the program has none."""
        return self.types.get(name.upper()) or self.blocks.get(name.upper()) or _system(name, self.classic or quoted)

    # --- operands --------------------------------------------------------------------------------------------

    def place(self, node: ast.Expression) -> CodeOperand | None:
        """Where an operand lies; None if it is none."""
        if isinstance(node, ast.Name):
            return self._name(node)
        if isinstance(node, ast.Address):
            # the place of an absolute address; short ones have short instructions
            try:
                address = parse_address(node.text.lstrip("%"))
            except AddressError:
                return CodeOperand(OperandArea.FAR, None)
            type_ = ELEMENTARY.get(address.type_name)
            if address.area == "DB":
                return CodeOperand(OperandArea.DB, type_, f"DB{address.db}", address.db)
            near = address.byte < _SHORT.get(address.area, 0)
            return CodeOperand(OperandArea.NEAR if near else OperandArea.FAR, type_)
        if isinstance(node, ast.Member):
            base = self.place(node.base)
            if base is None:
                return None
            return replace(base, type=self.member(base.type, node.name), offset=bool(base.indices))
        if isinstance(node, ast.Index):
            return self._element(node)
        if isinstance(node, ast.Slice | ast.Peripheral | ast.Dereference):
            base = self.place(node.base)
            width = _SLICES.get(node.width) if isinstance(node, ast.Slice) else None
            return base if base is None or width is None else replace(base, type=ELEMENTARY[width])
        return None

    def _name(self, node: ast.Name) -> CodeOperand:
        found = None if node.scope == "quoted" else self.variables.get(node.name.upper())
        if found is None:
            block = self.blocks.get(node.name.upper())
            if block is not None and block.kind is BlockKind.DB:
                return CodeOperand(OperandArea.DB, NamedType(block.name, quoted=True), block.name.upper(), block.number)
            return CodeOperand(OperandArea.FAR, None)
        kind, member = found
        if kind is SectionKind.TEMP or self.block.kind is BlockKind.OB:
            return CodeOperand(OperandArea.TEMP, member.type)
        structured = kind is SectionKind.IN_OUT and not self.is_elementary(member.type)
        if structured:
            return CodeOperand(OperandArea.POINTED, member.type)
        if self.block.kind is BlockKind.FC:
            return CodeOperand(OperandArea.TEMP if kind is SectionKind.STATIC else OperandArea.PARAMETER, member.type)
        return CodeOperand(OperandArea.STATIC, member.type)

    def _element(self, node: ast.Index) -> CodeOperand | None:
        base = self.place(node.base)
        if base is None:
            return None
        array = base.type if isinstance(base.type, ArrayType) else None
        lows = [low for low, _ in array.bounds] if array else [0] * len(node.indices)
        moving = [(index, low) for index, low in zip(node.indices, lows, strict=False) if self.constant(index) is None]
        return replace(
            base,
            type=array.element if array else None,
            indices=(*base.indices, *(index for index, _ in moving)),
            lows=(*base.lows, *(low for _, low in moving)),
        )

    # --- types -----------------------------------------------------------------------------------------------

    def member(self, type_: DataType | None, name: str) -> DataType | None:
        """Type of a member of a structure, type, instance or data block."""
        members: Sequence[Member] = ()
        if isinstance(type_, StructType):
            members = type_.members
        elif isinstance(type_, NamedType):
            block = self.blocks.get(type_.name.upper()) if type_.quoted else None
            block = block or self.find(type_.name, quoted=type_.quoted)
            if block is not None and block.instance_of and not block.members:
                block = self.find(block.instance_of, quoted=True)
            members = block.members if block is not None else ()
        wanted = name.upper()
        return next((member.type for member in members if member.name.upper() == wanted), None)

    def is_elementary(self, type_: DataType | None) -> bool:
        """Whether a value of the type goes through an accumulator; a type that is not known is taken to do so."""
        return self.width(type_) is not None

    def width(self, type_: DataType | None) -> int | None:
        """Bits of an elementary value, 16 if the type is not known; None for structures, arrays and strings."""
        if type_ is None:
            return 16
        if isinstance(type_, NamedType) and not type_.quoted:
            type_ = elementary(type_.name) or type_
        if isinstance(type_, Elementary):
            return type_.bits if type_.name not in {"ANY", "POINTER", "DTL"} else None
        return None

    def name(self, type_: DataType | None) -> str:
        """Upper-case name of an elementary type; empty for others."""
        if isinstance(type_, NamedType) and not type_.quoted:
            type_ = elementary(type_.name) or type_
        return type_.name if isinstance(type_, Elementary) else ""


_SLICES = {"X": "BOOL", "B": "BYTE", "W": "WORD", "D": "DWORD"}


@lru_cache(maxsize=512)
def _system(name: str, classic: bool) -> Block | None:  # noqa: FBT001 - the cache tells them apart by position
    return system_block(name, classic=classic)


def _constants(unit: ast.Unit | None) -> dict[str, ast.Expression]:
    """Constants of a block: those of CONST, those of VAR CONSTANT."""
    if unit is None:
        return {}
    return {
        name.name.upper(): declaration.initial
        for section in unit.sections
        if section.keyword == "CONST" or "CONSTANT" in section.modifiers
        for declaration in section.declarations
        if declaration.initial is not None
        for name in declaration.names
    }
