"""Names of a program that nobody declares: each is reported once, in a declaration or in code."""

from __future__ import annotations

from dataclasses import dataclass, field

from plcgen.scl import ast


@dataclass(slots=True)
class UnknownNames:
    """What has been reported, whatever it was taken for: a type, a tag, a constant, a block."""

    reported: set[str] = field(default_factory=set)

    def add(self, *names: str) -> bool:
        """Whether none of the keys of a name has been reported; now they have."""
        keys = {name.upper() for name in names}
        if not self.reported.isdisjoint(keys):
            return False
        self.reported |= keys
        return True


def keys_of(node: ast.Name, block: str) -> tuple[str, ...]:
    """Keys of a name: with ``#`` it is another one in every block, without ``#`` and quotes it may be either."""
    local = f"{block}#{node.name}"
    return (local,) if node.scope == "local" else (node.name, local) if node.scope == "bare" else (node.name,)
