"""Who calls which instance: every call of a program with what it calls, and the ways that lead there from its OBs."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator
from dataclasses import dataclass, field

from plcgen.base.diagnostics import Span
from plcgen.s7.cpu.linkage import Linkage, ProgramBlock
from plcgen.s7.scl import ast
from plcgen.s7.scl.constants import evaluate, integer
from plcgen.s7.types.blocks import Block, BlockKind, SectionKind
from plcgen.s7.types.data_types import ArrayType, DataType, Member, NamedType, StructType

MAX_CALLS = 50_000
MAX_DEPTH = 64
"""So many calls of a program are followed, so deep; what lies beyond is not looked at."""

_CODE = frozenset({BlockKind.FB, BlockKind.FC, BlockKind.OB})


@dataclass(frozen=True, slots=True)
class DataPath:
    """A place in a data block: its upper-case name and the steps inside, ``MEMBER`` or ``[1]``."""

    root: str
    steps: tuple[str, ...] = ()

    def inside(self, steps: tuple[str, ...]) -> DataPath:
        """Return a place below this one."""
        return DataPath(self.root, self.steps + steps)

    @property
    def around(self) -> list[DataPath]:
        """Every place that this one lies in, itself included, from the data block inwards."""
        return [DataPath(self.root, self.steps[:count]) for count in range(len(self.steps) + 1)]


@dataclass(frozen=True, slots=True, eq=False)
class CallSite:
    """One call: ``called`` is the upper-case name of an FB, an FC or a system block.

    ``place`` is the instance: in a data block, or, with the empty name as its root, in the instance of the caller. None
    means that it has none or that only the CPU knows it.
    """

    caller: ProgramBlock
    node: ast.Call
    called: str
    place: DataPath | None

    @property
    def span(self) -> Span:
        """Where the call stands."""
        return self.caller.result.span(self.node)

    @property
    def called_as(self) -> str:
        """What stands before the parentheses."""
        return self._written(self.node.target)

    def text(self, parameter: str) -> str:
        """The value of an argument as written; empty without one."""
        argument = self.argument(parameter)
        return "" if argument is None else self._written(argument.value)

    def _written(self, node: ast.Node) -> str:
        return " ".join(self.caller.result.tokens.source[node.start : node.end].split())

    def argument(self, name: str) -> ast.Argument | None:
        """Return the argument for a parameter, by its name in any case."""
        return next((a for a in self.node.arguments if a.name is not None and a.name.upper() == name.upper()), None)


@dataclass(frozen=True, slots=True, eq=False)
class Reached:
    """A call that is reached: through which calls, in which instance of its caller, and which instance it calls."""

    site: CallSite
    before: Reached | None
    within: DataPath | None
    instance: DataPath | None
    depth: int

    @property
    def chain(self) -> list[CallSite]:
        """The calls from the root to this one."""
        found: list[CallSite] = []
        step: Reached | None = self
        while step is not None:
            found.append(step.site)
            step = step.before
        return found[::-1]


@dataclass(slots=True)
class CallSites:
    """The calls of every block, by the index of the block."""

    link: Linkage
    by_block: dict[int, list[CallSite]] = field(default_factory=dict)
    names: dict[int, LocalNames] = field(default_factory=dict)

    @classmethod
    def of(cls, link: Linkage) -> CallSites:
        """Resolve all calls; one whose block nobody knows is left out."""
        found = cls(link)
        known = link.numbers
        for entry in link.blocks.values():
            if entry.block.kind in _CODE and not entry.skipped:
                names = found.names[entry.index] = LocalNames(link, entry.block, known)
                calls = (node for statement in entry.tree.statements for node in ast.walk(statement))
                sites = (names.site(entry, node) for node in calls if isinstance(node, ast.Call))
                found.by_block[entry.index] = [site for site in sites if site is not None]
        return found

    def __iter__(self) -> Iterator[CallSite]:
        return (site for sites in self.by_block.values() for site in sites)

    def callers_of(self, wanted: set[str]) -> set[str]:
        """Blocks that call one of these, directly or through others, by upper-case name."""
        callers: dict[str, set[str]] = {}
        for site in self:
            callers.setdefault(site.called, set()).add(site.caller.name.upper())
        found: set[str] = set()
        pending = list(wanted)
        while pending:
            new = callers.get(pending.pop(), set()) - found
            found |= new
            pending += new
        return found

    def roots(self) -> list[ProgramBlock]:
        """OBs in their order, then blocks that no other calls: something that is no SCL may do."""
        called = {site.called for site in self}
        entries = self.link.blocks.values()
        obs = [entry for entry in entries if entry.block.kind is BlockKind.OB]
        others = (entry for entry in entries if entry.block.kind in {BlockKind.FB, BlockKind.FC})
        return obs + [entry for entry in others if entry.name.upper() not in called]

    def reached(self, wanted: set[str]) -> list[tuple[ProgramBlock, Reached]]:
        """Calls of the wanted blocks with the root that leads there; every instance once for each root, outer first.

        All roots are followed at the same depth: what lies beyond ``MAX_CALLS`` is deep inside.
        """
        through = self.callers_of(wanted)
        followed = wanted | through
        found: list[tuple[int, ProgramBlock, Reached]] = []
        seen: set[tuple[int, str, DataPath | None]] = set()
        pending: deque[tuple[int, ProgramBlock, ProgramBlock, DataPath | None, Reached | None]] = deque()
        for number, root in enumerate(self.roots()):
            if root.name.upper() in through:
                start = DataPath(root.name.upper()) if root.block.kind is BlockKind.FB else None
                pending.append((number, root, root, start, None))
        count = 0
        while pending and count < MAX_CALLS:
            number, root, entry, within, before = pending.popleft()
            depth = 1 if before is None else before.depth + 1
            for site in self.by_block.get(entry.index, ()):
                if site.called not in followed:
                    continue
                count += 1
                step = Reached(site, before, within, absolute_path(site.place, within), depth)
                if site.called in wanted:
                    found.append((number, root, step))
                key = (number, site.called, step.instance)
                follow = self.link.blocks.get(site.called)
                if follow is not None and depth < MAX_DEPTH and key not in seen:
                    seen.add(key)
                    pending.append((number, root, follow, step.instance, step))
        return [(root, step) for _, root, step in sorted(found, key=lambda row: row[0])]


def absolute_path(place: DataPath | None, within: DataPath | None) -> DataPath | None:
    """A place as the CPU sees it, for one that may lie in the instance of its block."""
    if place is None or place.root:
        return place
    return within.inside(place.steps) if within is not None else None


class LocalNames:
    """What names, paths and constants mean inside one block."""

    def __init__(self, link: Linkage, block: Block, known: dict[str, int]) -> None:
        self.link = link
        self.block = block
        self.own: dict[str, tuple[SectionKind, Member]] = {
            member.name.upper(): (section.kind, member) for section in block.sections for member in section.members
        }
        constants = {m.name.upper(): integer(m.start or "") for m in block.section(SectionKind.CONSTANT)}
        self.constants = known
        if not self.own.keys().isdisjoint(known) or constants:
            self.constants = {name: value for name, value in known.items() if name not in self.own}
            self.constants |= {name: value for name, value in constants.items() if value is not None}

    def site(self, entry: ProgramBlock, node: ast.Call) -> CallSite | None:
        """Resolve a call; None for a function of the language and for what nobody knows."""
        path = self.path(node.target)
        if path is None:
            return None
        name, steps = path
        if self.is_own(name):
            kind, member = self.own[name.name.upper()]
            called = self._type(member.type, steps)
            place = DataPath("", (name.name.upper(), *steps)) if kind is SectionKind.STATIC else None
        else:
            called, place = self._outside(name.name, steps)
        if "[?]" in steps:
            place = None
        return CallSite(entry, node, called, place) if called else None

    def place(self, node: ast.Expression) -> DataPath | None:
        """Where a variable lies: in a data block, or (empty root) among the statics of the block; None: not known."""
        path = self.path(node)
        if path is None or "[?]" in path[1]:
            return None
        name, steps = path
        if self.is_own(name):
            kind = self.own[name.name.upper()][0]
            return DataPath("", (name.name.upper(), *steps)) if kind is SectionKind.STATIC else None
        found = self.link.find(name.name)
        return DataPath(found.name.upper(), steps) if found and found.block.kind is BlockKind.DB else None

    def constant(self, node: ast.Expression) -> int | str | None:
        """Value of a constant; of a system constant without a known value its upper-case name; None for a variable."""
        value = evaluate(node, self.constants)
        if value is not None or not isinstance(node, ast.Name) or node.scope != "quoted":
            return value
        known = self.is_own(node) or node.name.upper() in self.link.tags or self.link.find(node.name) is not None
        return None if known else node.name.upper()

    def is_own(self, name: ast.Name) -> bool:
        """Whether a name is declared in the block."""
        return name.scope != "quoted" and name.name.upper() in self.own

    def path(self, node: ast.Expression) -> tuple[ast.Name, tuple[str, ...]] | None:
        """First name and steps of ``a.b[1].c``; an index that is no constant is ``[?]``."""
        steps: list[str] = []
        while not isinstance(node, ast.Name):
            if isinstance(node, ast.Member):
                steps.append(node.name.upper())
            elif isinstance(node, ast.Index):
                values = [evaluate(index, self.constants) for index in node.indices]
                steps.append("[?]" if None in values else f"[{','.join(map(str, values))}]")
            elif isinstance(node, ast.Address):
                return ast.Name(node.start, node.end, node.text.lstrip("%"), "quoted"), tuple(reversed(steps))
            else:
                return None
            node = node.base
        return node, tuple(reversed(steps))

    def _outside(self, name: str, steps: tuple[str, ...]) -> tuple[str, DataPath | None]:
        """What a block of the program, or an instance in it, is called; empty for anything else."""
        found = self.link.find(name)
        if found is None or found.block.kind is BlockKind.FB:
            # "FB"."DB"(..) of STEP 7 V5; a system block by its number or its symbol
            instance = self.link.find(steps[0]) if len(steps) == 1 else None
            root = instance.name.upper() if instance is not None else "".join(steps)
            return (found.name.upper() if found is not None else name.upper(), DataPath(root)) if root else ("", None)
        key = found.name.upper()
        if found.block.kind is BlockKind.FC:
            return (key, None) if not steps else ("", None)
        if found.block.kind is not BlockKind.DB:
            return "", None
        type_ = self.link.instance_type(found)
        if not steps:  # what is called is a function block, even if nothing else is known of it
            return type_ or (found.block.instance_of or "").upper(), DataPath(key)
        members = found.block if not found.block.instance_of else self.link.types.get(found.block.instance_of.upper())
        return (self._type(StructType(members.members), steps), DataPath(key, steps)) if members else ("", None)

    def _type(self, type_: DataType, steps: tuple[str, ...]) -> str:
        """Upper-case name of the block that a member below a type is an instance of; empty if it is none."""
        for step in steps:
            if isinstance(type_, NamedType):
                declared = self.link.types.get(type_.name.upper())
                type_ = StructType(declared.members) if declared is not None else type_
            if step.startswith("["):
                if not isinstance(type_, ArrayType):
                    return ""
                type_ = type_.element
                continue
            members = type_.members if isinstance(type_, StructType) else ()
            member = next((m for m in members if m.name.upper() == step), None)
            if member is None:
                return ""
            type_ = member.type
        if not isinstance(type_, NamedType):
            return ""
        found = self.link.find(type_.name)
        return found.name.upper() if found is not None and found.block.kind is BlockKind.FB else type_.name.upper()
