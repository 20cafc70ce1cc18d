"""What SimaticML documents beside the sources of a program tell: blocks, types, tags, constants and the IEC check."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field, replace
from pathlib import Path

from plcgen.diagnostics import Diagnostic
from plcgen.s7.blocks import Block
from plcgen.scl.dialect import Dialect
from plcgen.simaticml.reading.documents import read_simaticml, read_tag_table
from plcgen.simaticml.reading.source import source

IEC_CHECK = "IsIECCheckEnabled"
_UNREADABLE = frozenset({"PG802", "PG804", "PG810", "PG811"})
"""Other codes tell of a document of another kind, or of one member: not what a check of sources is about."""


@dataclass(slots=True)
class Surroundings:
    """What is known without being checked itself.

    ``interfaces`` are the declarations of blocks as texts by their files, ``tags`` names with address and type,
    ``constants`` names in upper case with type and literal, ``stated`` says of blocks whether their IEC check is on.
    """

    interfaces: list[tuple[str, str]] = field(default_factory=list)
    tags: dict[str, str | tuple[str, str]] = field(default_factory=dict)
    constants: dict[str, tuple[str, str]] = field(default_factory=dict)
    stated: dict[str, bool] = field(default_factory=dict)
    diagnostics: list[Diagnostic] = field(default_factory=list)

    @classmethod
    def read(cls, documents: Iterable[Path], dialect: Dialect) -> Surroundings:
        """Read documents; what is no SimaticML is left alone, what cannot be read at all is reported."""
        found = cls()
        blocks: list[tuple[str, Block]] = []
        classic = dialect is not Dialect.TIA_1200_1500
        for path in documents:
            tables, problems = read_tag_table(path)
            for table in tables:
                found.tags.update((tag.name, (tag.address, tag.type)) for tag in table.tags)
                found.constants.update((c.name.upper(), (c.type, c.value)) for c in table.constants)
            if not tables and not any(problem.code in _UNREADABLE for problem in problems):
                own, problems = read_simaticml(path, classic=classic)
                blocks += [(str(path), block) for block in own]
            found.diagnostics += [problem for problem in problems if problem.code in _UNREADABLE]
        types = {block.name.upper(): block for _, block in reversed(blocks)}
        for file, block in blocks:
            found.interfaces.append((file, source(replace(block, code="", title="", comment=""), types)))
            if IEC_CHECK in block.attributes:
                found.stated.setdefault(block.name.upper(), block.attributes[IEC_CHECK].strip().lower() == "true")
        return found
