"""What the names of a block stand for: StructuredText says it at every operand."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from plcgen.s7.scl.system_types import SYSTEM_TYPES, is_type_name
from plcgen.s7.types.blocks import Block, BlockKind, SectionKind
from plcgen.s7.types.data_types import DataType, NamedType, StructType, innermost
from plcgen.s7.types.system import system_block

if TYPE_CHECKING:
    from plcgen.s7.types.data_types import Member


@dataclass(frozen=True, slots=True)
class BlockScope:
    """Names in upper case.

    ``types`` are the local variables, ``constants`` the local constants, ``instances`` the instance DBs of the
    project with the block they are made from, ``functions`` its FCs, ``global_constants`` its user constants,
    ``blocks`` all of its blocks.
    """

    types: Mapping[str, DataType] = field(default_factory=dict)
    constants: frozenset[str] = frozenset()
    instances: Mapping[str, str] = field(default_factory=dict)
    functions: frozenset[str] = frozenset()
    global_constants: frozenset[str] = frozenset()
    blocks: Mapping[str, Block] = field(default_factory=dict)

    @classmethod
    def of(cls, block: Block, known: Iterable[Block] = (), constants: Iterable[str] = ()) -> BlockScope:
        """Scope of a block; ``known`` are the other blocks of the project."""
        types: dict[str, DataType] = {}
        local_constants = set()
        for section in block.sections:
            for member in section.members:
                if section.kind is SectionKind.CONSTANT:
                    local_constants.add(member.name.upper())
                else:
                    types[member.name.upper()] = member.type
        known = tuple(known)
        return cls(
            types,
            frozenset(local_constants),
            {b.name.upper(): b.instance_of for b in known if b.kind is BlockKind.DB and b.instance_of},
            frozenset(b.name.upper() for b in known if b.kind is BlockKind.FC),
            frozenset(name.upper() for name in constants),
            {b.name.upper(): b for b in known},
        )

    def is_local(self, name: str) -> bool:
        """Whether the block declares the name."""
        upper = name.upper()
        return upper in self.types or upper in self.constants

    def is_type(self, name: str, *, quoted: bool) -> bool:
        """Whether a name that the block does not declare is a type, in quotes one of the user."""
        if quoted:
            block = self.blocks.get(name.upper())
            return block is not None and block.kind in (BlockKind.UDT, BlockKind.FB)
        return is_type_name(name)

    def block_of(self, path: tuple[str, ...]) -> tuple[str, bool] | None:
        """Name of the block that a local instance is made from, and whether it is a system block."""
        return self._named(self.types.get(path[0].upper()) if path else None, path[1:])

    def global_block_of(self, path: tuple[str, ...]) -> tuple[str, bool] | None:
        """The same of an instance inside a data block, which is the first of the names."""
        block = self.blocks.get(path[0].upper())
        if block is None or block.kind is not BlockKind.DB:
            return None
        return self._named(NamedType(block.instance_of or block.name, quoted=True), path[1:])

    def _named(self, found: DataType | None, path: tuple[str, ...]) -> tuple[str, bool] | None:
        for name in path:
            found = next((m.type for m in self._members(found) if m.name.upper() == name.upper()), None)
        found = innermost(found) if found is not None else None
        if not isinstance(found, NamedType):
            return None
        return found.name, not found.quoted and is_system(found.name)

    def _members(self, type_: DataType | None) -> tuple[Member, ...]:
        type_ = innermost(type_) if type_ is not None else None
        if isinstance(type_, StructType):
            return type_.members
        block = self.blocks.get(type_.name.upper()) if isinstance(type_, NamedType) else None
        return () if block is None else block.members


def is_system(name: str) -> bool:
    """Whether a block belongs to the CPU or to a library of the TIA Portal."""
    return name.upper() in SYSTEM_TYPES or system_block(name) is not None
