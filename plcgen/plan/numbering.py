"""Names and numbers of blocks: what the spec pins is kept, the rest is automatic and stable."""

from __future__ import annotations

from collections.abc import Iterable

from plcgen.plan.model import BlockRef
from plcgen.plan.target import Target
from plcgen.s7.names import shorten
from plcgen.spec.load import SpecPath

V5_SYMBOL_LENGTH = 24


class Numbering:
    """Hands out block references; automatic numbers avoid pinned ones."""

    def __init__(self, where: Target, first: dict[str, int], pinned: Iterable[tuple[str, int]]) -> None:
        self.where = where
        self.next = dict(first)
        self.pinned = set(pinned)

    def block(
        self, kind: str, name: str, path: SpecPath, number: int | None = None, *, given: bool = False
    ) -> BlockRef:
        """A block; ``given`` says that the name comes from the spec and is not shortened."""
        if not given and self.where.v5:
            name = shorten(name, V5_SYMBOL_LENGTH)
        if number is not None:
            return BlockRef(kind, name, number, pinned=True, path=path)
        candidate = self.next[kind]
        while (kind, candidate) in self.pinned:
            candidate += 1
        self.next[kind] = candidate + 1
        return BlockRef(kind, name, candidate, pinned=False, path=path)
