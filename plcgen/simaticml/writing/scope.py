"""What the names of a block stand for: StructuredText says it at every operand."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from plcgen.s7.blocks import Block, BlockKind, SectionKind
from plcgen.s7.system import system_block
from plcgen.s7.types import ArrayType, DataType, NamedType, StructType
from plcgen.scl.system_types import SYSTEM_TYPES

if TYPE_CHECKING:
    from plcgen.s7.types import Member


@dataclass(frozen=True, slots=True)
class BlockScope:
    """Names in upper case.

    ``types`` are the local variables, ``constants`` the local constants, ``instances`` the instance DBs of the
    project with the block they are made from, ``functions`` its FCs, ``global_constants`` its user constants.
    """

    types: Mapping[str, DataType] = field(default_factory=dict)
    constants: frozenset[str] = frozenset()
    instances: Mapping[str, str] = field(default_factory=dict)
    functions: frozenset[str] = frozenset()
    global_constants: frozenset[str] = frozenset()

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
        )

    def is_local(self, name: str) -> bool:
        """Whether the block declares the name."""
        upper = name.upper()
        return upper in self.types or upper in self.constants

    def block_of(self, path: tuple[str, ...]) -> tuple[str, bool] | None:
        """Name of the block that a local instance is made from, and whether it is a system block."""
        found = self.types.get(path[0].upper()) if path else None
        for name in path[1:]:
            found = _member(found, name)
        while isinstance(found, ArrayType):
            found = found.element
        if not isinstance(found, NamedType):
            return None
        return found.name, not found.quoted and is_system(found.name)


def is_system(name: str) -> bool:
    """Whether a block belongs to the CPU or to a library of the TIA Portal."""
    return name.upper() in SYSTEM_TYPES or system_block(name) is not None


def _member(type_: DataType | None, name: str) -> DataType | None:
    while isinstance(type_, ArrayType):
        type_ = type_.element
    if not isinstance(type_, StructType):
        return None
    members: tuple[Member, ...] = type_.members
    return next((m.type for m in members if m.name.upper() == name.upper()), None)
