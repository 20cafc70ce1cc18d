"""What SimaticML documents beside the sources of a program tell, and types that neither they nor a source declare."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field, replace
from pathlib import Path

from plcgen.base.diagnostics import Diagnostic, Severity, Span
from plcgen.base.diagnostics.suggest import Vocabulary
from plcgen.s7.cpu.linkage import Linkage
from plcgen.s7.layout.shapes import NO_MEMORY, near_type
from plcgen.s7.scl.dialect import Dialect
from plcgen.s7.scl.dialects import is_refused
from plcgen.s7.scl.grammar.documents import IEC_CHECK
from plcgen.s7.scl.instructions import INSTRUCTIONS, SYSTEM_TYPES
from plcgen.s7.types.blocks import Block, BlockKind
from plcgen.s7.types.data_types import (
    ELEMENTARY,
    ArrayType,
    DataType,
    Elementary,
    Member,
    NamedType,
    StringType,
    StructType,
    elementary,
    innermost,
    nested,
)
from plcgen.s7.types.system import system_block
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


_LIBRARY = re.compile(
    r"SF[BC][0-9]{1,3}|IEC_\w+|CT(?:U|D|UD)_\w+|T(?:ON|OF|P|ONR)_\w+|(?:PID|MC|TO|MB|HW|OB|DB|G7)_\w+"
    r"|T(?:CON|SEND|RCV|DISCON|USEND|URCV)(?:_\w+)?|TMAIL_C|CTRL_\w+|(?:SEND|RECEIVE)_\w+|REF_TO .+|.+\..+",
    re.IGNORECASE,
)
_LIBRARY_MARKS = frozenset({"InstructionName", "OriginalPartName"})
"""Attributes of what comes from a library of the TIA Portal."""
_TYPES = frozenset({BlockKind.UDT, BlockKind.FB})


def add_unknown_types(link: Linkage) -> list[Diagnostic]:
    """Declare every missing type as one without members; PG806 for a name nobody knows, at its first use.

    PG827 tells of a type of the system libraries whose members are not known here; of those of tags nothing is said.
    """
    found: list[Diagnostic] = []
    declared = [block.name for key, block in link.types.items() if key not in link.opaque]
    known = Vocabulary([*declared, *ELEMENTARY])
    for block in [entry.block for entry in link.blocks.values()]:
        for type_, span, library in _used(block):
            key = type_.name.upper()
            refused = _is_refused(type_, link.dialect)
            if key in link.opaque or (_is_known(type_, link) and not refused):
                continue
            link.opaque.add(key)
            link.types[key] = Block(BlockKind.UDT, type_.name, ())
            problem = _report(type_, span or block.span or Span(""), known, library=library)
            if not refused and (problem.code != "PG806" or link.unknown.add(key)):
                found.append(problem)
    for _, spelled in link.tags.values():
        key = spelled.strip('"')
        if key != spelled and key not in link.types:
            link.opaque.add(key)
            link.types[key] = Block(BlockKind.UDT, key, ())
    return found


def without_refused(block: Block, dialect: Dialect) -> Block:
    """The block with the types that its target does not have as names of unknown types: PG803 has told of them."""
    sections = tuple(replace(part, members=_without_refused(part.members, dialect)) for part in block.sections)
    return block if sections == block.sections else replace(block, sections=sections)


def _without_refused(members: tuple[Member, ...], dialect: Dialect) -> tuple[Member, ...]:
    return tuple(replace(member, type=_told(member.type, dialect)) for member in members)


def _told(type_: DataType, dialect: Dialect) -> DataType:
    if isinstance(type_, ArrayType):
        return replace(type_, element=_told(type_.element, dialect))
    if isinstance(type_, StructType):
        return replace(type_, members=_without_refused(type_.members, dialect))
    return NamedType(type_.name) if _is_refused(type_, dialect) else type_


def _is_refused(type_: NamedType | Elementary | StringType, dialect: Dialect) -> bool:
    return not (isinstance(type_, NamedType) and type_.quoted) and is_refused(type_.name, dialect)


def _is_known(type_: NamedType, link: Linkage) -> bool:
    key = type_.name.upper()
    declared = link.types.get(key)
    if declared is not None and declared.kind in _TYPES:
        return True
    if not type_.quoted and (elementary(type_.name) is not None or key in NO_MEMORY):
        return True
    known = system_block(type_.name, classic=type_.quoted)
    return known is not None and known.kind in _TYPES


def _report(type_: NamedType, span: Span, known: Vocabulary, *, library: bool) -> Diagnostic:
    name = type_.name
    if library or name.upper() in SYSTEM_TYPES | INSTRUCTIONS or _LIBRARY.fullmatch(name):
        message = f"the members of {name} are not known to plcgen"
        return Diagnostic("PG827", message, span, Severity.WARNING)
    near = near_type(name, known)
    return Diagnostic("PG806", f"unknown data type {name}", span, help=near or "also name the file that declares it")


def _used(block: Block) -> Iterator[tuple[NamedType, Span | None, bool]]:
    """Named types of the members of a block and of what it is an instance of, and whether a library has them."""
    if block.instance_of is not None:
        yield NamedType(block.instance_of, quoted=True), block.span, not _LIBRARY_MARKS.isdisjoint(block.attributes)
    for member in nested(block.members):
        type_ = innermost(member.type)
        if isinstance(type_, NamedType):
            yield type_, member.span, any(name in _LIBRARY_MARKS for name, _ in member.attributes)
