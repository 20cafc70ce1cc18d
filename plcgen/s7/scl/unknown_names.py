"""Names of a program that nobody declares: each is reported once, in a declaration or in code."""

from __future__ import annotations

from dataclasses import dataclass, field

from plcgen.base.diagnostics import Span
from plcgen.s7.scl import ast


@dataclass(slots=True)
class UnknownNames:
    """What has been reported, whatever it was taken for: a type, a tag, a constant, a block.

    ``warned`` are names of bounds and lengths, and where a warning tells of them: in code the same name is an error.
    """

    reported: set[str] = field(default_factory=set)
    warned: dict[str, Span] = field(default_factory=dict)

    def add(self, *names: str) -> bool:
        """Whether none of the keys of a name has been reported; now they have."""
        keys = {name.upper() for name in names}
        if not self.reported.isdisjoint(keys):
            return False
        self.reported |= keys
        return True

    def warn(self, span: Span, *names: str) -> bool:
        """Whether nothing has been said of any of the keys of a name; now there is a warning."""
        keys = {name.upper() for name in names}
        if not keys.isdisjoint(self.reported | self.warned.keys()):
            return False
        self.warned |= dict.fromkeys(keys, span)
        return True

    def replaced(self) -> set[Span]:
        """Places of the warnings whose name is an error elsewhere."""
        return {span for key, span in self.warned.items() if key in self.reported}


def keys_of(node: ast.Name, block: str) -> tuple[str, ...]:
    """Keys of a name: with ``#`` it is another one in every block, without ``#`` and quotes it may be either."""
    local = f"{block}#{node.name}"
    return (local,) if node.scope == "local" else (node.name, local) if node.scope == "bare" else (node.name,)
