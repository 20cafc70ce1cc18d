"""Stand-ins for tags and data blocks of the user's program that a spec names: blocks run without that program."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from plcgen.project.nouns import OwnSymbol, Project

_LAST_FLAG = 65_534
"""Flags of no CPU: the soft CPU has them all."""


@dataclass(frozen=True, slots=True)
class StandIns:
    """``tags`` are address and type by name, ``sources`` file name and text by the name of a data block."""

    tags: dict[str, tuple[str, str]]
    sources: dict[str, tuple[str, str]]


NO_STAND_INS = StandIns({}, {})


def stand_ins(project: Project) -> StandIns:
    """What the triggers of a project name besides flags and generated blocks."""
    tags: dict[str, tuple[str, str]] = {}
    members: dict[str, _Tree] = {}
    for job in project.jobs:
        for signal, symbol in job.trigger.symbols():
            type_ = "WORD" if signal == "status" else "BOOL"
            if symbol.members:
                members.setdefault(symbol.name, _Tree()).add(symbol, type_)
            elif symbol.name not in tags:
                byte = _LAST_FLAG - 2 * len(tags)
                tags[symbol.name] = (f"MW{byte}" if type_ == "WORD" else f"M{byte}.0", type_)
    mark = "" if project.target.v5 else ";"
    sources = {
        name: (
            f"stand-in for {name}.scl",
            f'DATA_BLOCK "{name}"\nSTRUCT\n{"".join(tree.lines())}END_STRUCT{mark}\nBEGIN\nEND_DATA_BLOCK\n',
        )
        for name, tree in members.items()
    }
    return StandIns(tags, sources)


class _Tree:
    """Members of a data block as far as they are named; in ``last`` the highest index of each array."""

    def __init__(self) -> None:
        self.below: dict[str, _Tree | str] = {}
        self.last: dict[str, int] = {}

    def add(self, symbol: OwnSymbol, type_: str) -> None:
        """Note a member on its way down."""
        tree = self
        *above, last = symbol.members
        for member in above:
            below = tree.below.setdefault(tree.named(member), _Tree())
            if isinstance(below, str):
                return  # a bit is named as a structure, too: the compiler says so
            tree = below
        tree.below.setdefault(tree.named(last), type_)

    def named(self, member: str) -> str:
        """The name of a member without its index, which is noted."""
        name, _, index = member.partition("[")
        if index:
            self.last[name] = max(int(index.rstrip("]")), self.last.get(name, 0))
        return name

    def lines(self) -> Iterator[str]:
        """Declarations."""
        for name, below in self.below.items():
            array = f"ARRAY[0..{self.last[name]}] OF " if name in self.last else ""
            if isinstance(below, str):
                yield f"{name} : {array}{below};\n"
            else:
                yield from (f"{name} : {array}STRUCT\n", *below.lines(), "END_STRUCT;\n")
