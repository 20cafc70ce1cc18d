"""Start values of members as SimaticML keeps them: one literal per elementary value, with the indices of its arrays.

SCL may give an array or a structure one value as a whole, ``[1, 2(0)]`` or ``(a := 1)``, and a data block may
assign single elements behind BEGIN; both become the same entries here.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from itertools import product
from typing import TYPE_CHECKING

from plcgen.s7.blocks import Block, SectionKind
from plcgen.s7.initializers import Group, InitialItem, Node, flatten, parse_initializer
from plcgen.s7.literals import LiteralError
from plcgen.s7.types import ArrayType, DataType, Member, NamedType, StructType

if TYPE_CHECKING:
    from collections.abc import Iterator

MAX_VALUES = 100_000
"""Single start values of one block."""

_STEP = re.compile(r'\s*(?:"([^"\n]+)"|#?([^\W\d]\w*))\s*((?:\[[^\]]*\]\s*)*)(\.|$)')
_INDEX = re.compile(r"\[([^\]]*)\]")

Path = tuple[str, ...]


class Starts:
    """Entries by member path (names in upper case): indices as in a Subelement's Path, and the literal.

    ``entries`` come from declarations, ``assigned`` from the lines behind BEGIN, which replace them.
    """

    def __init__(self, types: Mapping[str, Block] | None = None) -> None:
        self.types = types or {}
        self.entries: dict[Path, dict[str, str]] = {}
        self.assigned: dict[Path, dict[str, str]] = {}
        self._into = self.entries
        self._above: set[Path] = set()
        self.lost: list[str] = []
        self.count = 0

    def declare(self, member: Member, path: Path) -> None:
        """Take the start value of a declaration apart."""
        if member.start is None:
            return
        type_ = member.type
        if not isinstance(type_, ArrayType | StructType) and not member.start.lstrip().startswith("("):
            self._add(path, (), member.start)
            return
        try:
            items = parse_initializer(member.start)
        except LiteralError:
            self.lost.append(f"the start value {member.start} of {member.name}")
            return
        self._spread(type_, items, path, ())

    def assign(self, path: str, literal: str, members: Sequence[Member]) -> None:
        """Take one line behind BEGIN: it replaces what was declared."""
        names: list[str] = []
        groups: list[str] = []
        position = 0
        while match := _STEP.match(path, position):
            names.append((match[1] or match[2]).upper())
            groups += [re.sub(r"\s+", "", index) for index in _INDEX.findall(match[3])]
            position = match.end()
            if not match[4]:
                break
        type_ = self._type(members, names)
        self._into = self.assigned
        inner = self._inside(type_, len(groups), names, members) if type_ is not None else None
        if position < len(path) or inner is None:
            self.lost.append(f"the start value of {path}")
        elif isinstance(inner, ArrayType | StructType) or literal.lstrip()[:1] in {"[", "("}:
            try:
                self._spread(inner, parse_initializer(literal), tuple(names), tuple(groups))
            except LiteralError:
                self.lost.append(f"the start value of {path}")
        else:
            self._add(tuple(names), tuple(groups), literal)
        self._into = self.entries

    def of(self, path: Path) -> dict[str, str]:
        """Indices (empty for a single value) to literal of one member."""
        declared, assigned = self.entries.get(path), self.assigned.get(path)
        return {**(declared or {}), **(assigned or {})}

    def below(self, path: Path) -> bool:
        """Whether a member inside the member at ``path`` has an entry."""
        return path in self._above

    def _inside(self, type_: DataType, groups: int, names: Sequence[str], members: Sequence[Member]) -> DataType:
        """Type of what the indices of a path have chosen: the arrays above are counted from the front."""
        above = sum(_depth(self._type(members, names[:n])) for n in range(1, len(names)))
        for _ in range(groups - above):
            type_ = type_.element if isinstance(type_, ArrayType) else type_
        return type_

    def _type(self, members: Sequence[Member], names: Sequence[str]) -> DataType | None:
        found: DataType | None = None
        for name in names:
            found = next((m.type for m in members if m.name.upper() == name), None)
            if found is None:
                return None
            members = self.members(found)
        return found

    def members(self, type_: DataType) -> tuple[Member, ...]:
        """Members inside a structure, a known user type, or an array of them."""
        while isinstance(type_, ArrayType):
            type_ = type_.element
        if isinstance(type_, StructType):
            return type_.members
        block = self.types.get(type_.name.upper()) if isinstance(type_, NamedType) else None
        return block.section(SectionKind.STATIC) if block is not None else ()

    def _add(self, path: Path, groups: tuple[str, ...], literal: str) -> None:
        self.count += 1
        if self.count > MAX_VALUES:
            if self.count == MAX_VALUES + 1:
                self.lost.append(f"start values: the block has more than {MAX_VALUES}")
            return
        self._above.update(path[:n] for n in range(len(path)))
        self._into.setdefault(path, {})[";".join(groups)] = literal

    def _spread(self, type_: DataType, items: Sequence[InitialItem], path: Path, groups: tuple[str, ...]) -> None:
        """Give the values of a list to the elements of an array or the members of a structure."""
        if isinstance(type_, ArrayType):
            if len(items) == 1 and isinstance(items[0].value, Group) and items[0].value.kind == "[":
                items = items[0].value.items
            indices = _indices(type_)
            for index, node in zip(indices, flatten(tuple(items), MAX_VALUES), strict=False):
                self._node(type_.element, node, path, (*groups, index))
            return
        inner = self.members(type_)
        if not inner:
            self.lost.append(f"the start value of {'.'.join(path)}: its type is not among the files")
            return
        if len(items) == 1 and isinstance(items[0].value, Group) and items[0].value.kind == "(":
            items = items[0].value.items
        by_name = {m.name.upper(): m for m in inner}
        for position, item in enumerate(items):
            member = by_name.get(item.name.upper()) if item.name else inner[position] if position < len(inner) else None
            if member is not None:
                self._node(member.type, item.value, (*path, member.name.upper()), groups)

    def _node(self, type_: DataType, node: Node, path: Path, groups: tuple[str, ...]) -> None:
        if node is None or node == "":
            return
        if isinstance(node, str):
            self._add(path, groups, node)
        else:
            self._spread(type_, (InitialItem(node),), path, groups)


def _indices(type_: ArrayType) -> Iterator[str]:
    ranges = (range(low, high + 1) for low, high in type_.bounds)
    return (",".join(map(str, index)) for index in product(*ranges))


def _depth(type_: DataType | None) -> int:
    depth = 0
    while isinstance(type_, ArrayType):
        depth, type_ = depth + 1, type_.element
    return depth
