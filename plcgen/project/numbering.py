"""Names and numbers of blocks: what the spec pins is kept, the rest is automatic and stable."""

from __future__ import annotations

import re
from collections.abc import Iterable

from plcgen.project.nouns import BlockRef
from plcgen.project.spec import SpecPath
from plcgen.project.target import Target
from plcgen.s7.types.names import shorten

V5_SYMBOL_LENGTH = 24
_ROLE = re.compile(r"(?:_Request[0-9]*|_Response[0-9]*|_Diagnosis|_DB|_WrRec|_RdRec|_Send|_Receive|_Buffer|Token)\Z")


class Numbering:
    """Hands out block references; automatic numbers avoid pinned ones."""

    def __init__(
        self, where: Target, first: dict[str, int], pinned: Iterable[tuple[str, int]], prefix: str = ""
    ) -> None:
        self.where = where
        self.prefix = prefix
        self.next = dict(first)
        self.pinned = set(pinned)

    def apart(self) -> Numbering:
        """Numbers for blocks that are named but not made."""
        return Numbering(self.where, dict.fromkeys(self.next, 1), (), self.prefix)

    def block(
        self,
        kind: str,
        name: str,
        path: SpecPath,
        number: int | None = None,
        *,
        given: bool = False,
        derived: bool = False,
    ) -> BlockRef:
        """A block; ``given`` says that the name comes from the spec, which is neither shortened nor gets the prefix.

        ``derived`` says that the name is made from that of another block, which has its prefix.
        """
        if not given:
            name = name if derived else self.prefixed(name)
            name = _shortened(name) if self.where.v5 else name
        if number is not None:
            return BlockRef(kind, name, number, pinned=True, path=path)
        candidate = self.next[kind]
        while (kind, candidate) in self.pinned:
            candidate += 1
        self.next[kind] = candidate + 1
        return BlockRef(kind, name, candidate, pinned=False, path=path)

    def fixed(self, kind: str, name: str) -> BlockRef:
        """A block of every project: the longest of their names leaves room for the prefix in a symbol of STEP 7 V5."""
        return self.block(kind, self.prefixed(name), ("plc",), given=True)

    def prefixed(self, name: str) -> str:
        """``DriveJobs`` -> ``L2_DriveJobs``, ``typeDriveUnit`` -> ``typeL2_DriveUnit``."""
        kind = "type" if name.startswith("type") else ""
        return f"{kind}{self.prefix}{name.removeprefix(kind)}"


def _shortened(name: str) -> str:
    """A symbol of at most 24 characters that keeps what it is for: prefix ``type``, suffix ``_Request``, ``_DB``, .."""
    prefix = "type" if name.startswith("type") else ""
    match = _ROLE.search(name)
    suffix = match[0] if match else ""
    stem = name[len(prefix) : len(name) - len(suffix)]
    return prefix + shorten(stem, V5_SYMBOL_LENGTH - len(prefix) - len(suffix)) + suffix
