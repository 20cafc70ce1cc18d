"""Start values of members as SimaticML keeps them: one literal per elementary value, with the indices of its arrays.

SCL may give an array or a structure one value as a whole, ``[1, 2(0)]`` or ``(a := 1)``, and a data block may
assign single elements behind BEGIN; both become the same entries here.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING

from plcgen.s7.layout.shapes import INSTANCE_SECTIONS
from plcgen.s7.types.blocks import Block, BlockKind, SectionKind
from plcgen.s7.types.data_types import ArrayType, DataType, Member, NamedType, StructType, innermost
from plcgen.s7.types.literals import Group, InitialItem, LiteralError, Node, flatten, parse_initializer

if TYPE_CHECKING:
    from collections.abc import Iterator

MAX_VALUES = 100_000
"""Single start values of one block."""

_STEP = re.compile(r'\s*(?:"([^"\n]+)"|#?([^\W\d]\w*))\s*((?:\[[^\]]*\]\s*)*)(\.|$)')
_INDEX = re.compile(r"\[([^\]]*)\]")

Path = tuple[str, ...]
Steps = tuple[tuple[str, str], ...]
"""The way to one value: every name with its indices in brackets."""
_Way = tuple[tuple[str, tuple[ArrayType, ...]], ...]


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

    def declare(self, member: Member, path: Path, around: Sequence[ArrayType] = (), *, apart: bool = False) -> None:
        """Take the start value of a declaration apart; ``around`` are the arrays that the member lies in.

        Every element of those has a list, or the members of a structure, of its own; a single value is stated once for
        all of them unless ``apart``.
        """
        if member.start is None:
            return
        type_ = member.type
        if not isinstance(type_, ArrayType | StructType) and not member.start.lstrip().startswith("("):
            self._each(type_, member.start, path, around if apart else ())
            return
        try:
            items = parse_initializer(member.start)
        except LiteralError:
            self.lost.append(f"the start value {member.start} of {member.name}")
            return
        self._each(type_, Group("", items), path, around)

    def _each(self, type_: DataType, node: Node, path: Path, around: Sequence[ArrayType]) -> None:
        """Give a value to the member in every element of the arrays around it."""
        for groups in _groups(around):
            before = self.count
            self._node(type_, node, path, groups)
            if self.count == before or self.count > MAX_VALUES:
                return

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
        above = sum(len(arrays(self._type(members, names[:n]))) for n in range(1, len(names)))
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
        type_ = innermost(type_)
        if isinstance(type_, StructType):
            return type_.members
        return tuple(member for _, members in self.sections(type_) for member in members)

    def sections(self, type_: DataType) -> tuple[tuple[str, tuple[Member, ...]], ...]:
        """Members of a known type by the section that a document has them in: None of a user type."""
        block = self.types.get(type_.name.upper()) if isinstance(type_, NamedType) else None
        if block is None:
            return ()
        if block.kind is not BlockKind.FB:
            return (("None", block.section(SectionKind.STATIC)),)
        return tuple((kind.value, block.section(kind)) for kind in INSTANCE_SECTIONS)

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
            for index, node in zip(_indices(type_.bounds), flatten(tuple(items), MAX_VALUES), strict=False):
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
            self._spread(type_, node.items if not node.kind else (InitialItem(node),), path, groups)


def single_values(members: Iterable[Member]) -> Iterator[tuple[Steps, str]]:
    """Every value that declarations state, with the way to it; those of arrays and structures one by one."""
    starts = Starts()
    for way, member in _declared(members, ()):
        path = tuple(name for name, _ in way)
        starts.declare(member, path, [array for _, own in way[:-1] for array in own], apart=True)
        for index, literal in starts.of(path).items():
            groups = iter(index.split(";"))
            yield tuple((name, "".join(f"[{next(groups)}]" for _ in own)) for name, own in way), literal


def _declared(members: Iterable[Member], above: _Way) -> Iterator[tuple[_Way, Member]]:
    """Members and those of structures in them, with the names and arrays on the way."""
    for member in members:
        way = (*above, (member.name, arrays(member.type)))
        yield way, member
        inner = innermost(member.type)
        if isinstance(inner, StructType):
            yield from _declared(inner.members, way)


def arrays(type_: DataType | None) -> tuple[ArrayType, ...]:
    """An array and the arrays that are its elements, from the outermost in."""
    found = []
    while isinstance(type_, ArrayType):
        found.append(type_)
        type_ = type_.element
    return tuple(found)


def _groups(around: Sequence[ArrayType]) -> Iterator[tuple[str, ...]]:
    """Indices of every element of arrays in arrays; one by one, for bounds may be anything."""
    if not around:
        yield ()
        return
    for index in _indices(around[0].bounds):
        for inner in _groups(around[1:]):
            yield (index, *inner)


def _indices(bounds: Sequence[tuple[int, int]]) -> Iterator[str]:
    """Indices of every element of one array, the last counting fastest."""
    (low, high), *rest = bounds
    for index in range(low, high + 1):
        if rest:
            yield from (f"{index},{inner}" for inner in _indices(rest))
        else:
            yield str(index)
