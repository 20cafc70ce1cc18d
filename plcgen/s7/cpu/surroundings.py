"""What SimaticML documents beside the sources of a program tell: blocks, types, tags, constants and the IEC check."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field, replace
from pathlib import Path

from plcgen.base.diagnostics import Diagnostic
from plcgen.s7.scl.dialect import Dialect
from plcgen.s7.scl.grammar.documents import IEC_CHECK
from plcgen.s7.types.blocks import Block, BlockKind
from plcgen.s7.xml.reading.documents import read_simaticml, read_tag_table
from plcgen.s7.xml.reading.interface import whole_number
from plcgen.s7.xml.reading.source import source

_CODE = frozenset({BlockKind.FB, BlockKind.FC, BlockKind.OB})
_UNREADABLE = frozenset({"PG802", "PG804", "PG810", "PG811"})
"""Other codes tell of a document of another kind, or of one member: not what a check of sources is about."""


@dataclass(slots=True)
class Surroundings:
    """What is known without being checked itself.

    ``interfaces`` are the declarations of blocks as texts by their files, ``tags`` names with address and type,
    ``constants`` names in upper case with type and literal, ``stated`` says of blocks whether their IEC check is on,
    ``obs`` has the numbers of organization blocks.
    """

    interfaces: list[tuple[str, str]] = field(default_factory=list)
    tags: dict[str, str | tuple[str, str]] = field(default_factory=dict)
    constants: dict[str, tuple[str, str]] = field(default_factory=dict)
    stated: dict[str, bool] = field(default_factory=dict)
    obs: set[int] = field(default_factory=set)
    diagnostics: list[Diagnostic] = field(default_factory=list)

    @classmethod
    def read(cls, documents: Iterable[Path], dialect: Dialect) -> Surroundings:
        """Read documents; what is no SimaticML is left alone, what cannot be read at all is reported."""
        found = cls()
        others = [path for path in documents if not found.add_table(path)]
        blocks: list[tuple[str, Block]] = []
        for path in others:
            own, problems = read_simaticml(path, classic=dialect.classic, constants=found.numbers)
            blocks += [(str(path), block) for block in own]
            found.diagnostics += [problem for problem in problems if problem.code in _UNREADABLE]
        types = {block.name.upper(): block for _, block in reversed(blocks)}
        for file, block in blocks:
            found.interfaces.append((file, source(replace(block, code="", title="", comment=""), types)))
            if block.kind is BlockKind.OB and block.number is not None:
                found.obs.add(block.number)
            if block.kind in _CODE:  # an export leaves out what is the default: off
                checked = block.attributes.get(IEC_CHECK, "").strip().lower() == "true"
                found.stated.setdefault(block.name.upper(), checked)
        return found

    @property
    def numbers(self) -> dict[str, int]:
        """The whole numbers among the constants, by upper-case name."""
        found = {name: whole_number(literal) for name, (_, literal) in self.constants.items()}
        return {name: number for name, number in found.items() if number is not None}

    def add_table(self, path: Path) -> bool:
        """Take over the tags and constants of a document; whether nothing else is to be read in it."""
        tables, problems = read_tag_table(path)
        for table in tables:
            self.tags.update((tag.name, (tag.address, tag.type)) for tag in table.tags)
            self.constants.update((c.name.upper(), (c.type, c.value)) for c in table.constants)
        unreadable = [problem for problem in problems if problem.code in _UNREADABLE]
        self.diagnostics += unreadable
        return bool(tables or unreadable)
