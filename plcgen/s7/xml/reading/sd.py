"""A block as SIMATIC SD (``.s7dcl`` and ``.s7res``), as far as public documents of V20 and V21 show how it is said.

Nothing of it has been imported by a TIA Portal: what no document shows is not written (docs/simaticml.md#simatic-sd).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace

from plcgen.s7.scl.grammar.documents import IEC_CHECK
from plcgen.s7.scl.parser import parse
from plcgen.s7.types.blocks import Assignment, Block, BlockKind, Section, SectionKind, is_retentive
from plcgen.s7.types.data_types import (
    ArrayType,
    DataType,
    Member,
    NamedType,
    StructType,
    inner_members,
    innermost,
    nested,
)
from plcgen.s7.xml.reading.source import KEYWORDS, bare, is_array_db, quoted
from plcgen.s7.xml.spelling import BREAKS, datatype, declared_name
from plcgen.s7.xml.writing.documents import library_element

VERSIONS = ("V20", "V21")
"""Versions of the TIA Portal whose documents have been seen; code in SCL in those of the last one only."""

_SECTIONS = {
    SectionKind.INPUT: "VAR_INPUT", SectionKind.OUTPUT: "VAR_OUTPUT", SectionKind.IN_OUT: "VAR_IN_OUT",
    SectionKind.STATIC: "VAR", SectionKind.TEMP: "VAR_TEMP",
}  # fmt: skip
_CODE = frozenset({BlockKind.FB, BlockKind.FC, BlockKind.OB})
_HEADER = {"AUTHOR": "S7_Author", "FAMILY": "S7_Family"}
_MEMBER = {
    ("S7_SETPOINT", "TRUE"): 'S7_Setpoint := "True"',
    ("S7_SETPOINT", "FALSE"): 'S7_Setpoint := "False"',
    ("EXTERNALWRITABLE", "FALSE"): 'S7_Access := "ReadOnly := External"',
    ("EXTERNALVISIBLE", "FALSE"): 'S7_Visibility := "Hidden := External"',
}


@dataclass(slots=True)
class Written:
    """Both texts, the second one empty without comments; ``unseen`` says what keeps the block from being written."""

    document: str = ""
    texts: str = ""
    unseen: str = ""


def sd_document(block: Block, version: str, culture: str = "en-US") -> Written:
    """The block as ``version`` has it, with comments in the language ``culture``; lines end in LF."""
    if what := unseen(block, version):
        return Written(unseen=what)
    writer = _Writer(culture)
    text = "\n".join([*writer.block(block), ""])
    result = parse(text, "x.s7dcl")
    if result.diagnostics or len(result.units) != 1 or len(result.units[0].networks) > 1:
        return Written(unseen="code that ends its network or its block")
    listed = "\n".join(["MultiLingualTexts:", *writer.texts, ""]) if writer.texts else ""
    return Written(text, listed)


def unseen(block: Block, version: str) -> str:
    """What of a block no public document of this version shows; empty if there is nothing."""
    if block.kind in _CODE and version != VERSIONS[-1]:
        return "code in SCL, which SIMATIC SD has from V21 on"
    if block.kind is BlockKind.OB:
        return "an organization block in SCL"
    if library_element(block):
        return "an instance of a library"
    for name, value in block.attributes.items():
        if name.upper() not in {*_HEADER, "VERSION", IEC_CHECK.upper()}:
            return f"the attribute {name}"
        if '"' in value or BREAKS.search(value):
            return f"the value of {name}"
    if block.section(SectionKind.CONSTANT):
        return "constants of a block"
    code = block.kind in _CODE
    if any(section.retain not in {"", "RETAIN"} or (section.retain and code) for section in block.sections):
        return "retentivity of single members of a function block"
    if code and block.assignments:
        return "start values inside of other types in a function block"
    for member in nested(block.members):
        if member.at is not None:
            return "views (AT)"
        if code and isinstance(member.type, ArrayType) and member.start is not None:
            return "start values of an array in a function block"
        unknown = [name for name, value in member.attributes if (name.upper(), value.upper()) not in _MEMBER]
        if unknown:
            return f"the attribute {unknown[0]} of a member"
        if isinstance(inner := innermost(member.type), NamedType) and inner.name.upper().startswith("REF_TO "):
            return "references"
    return ""


@dataclass(slots=True)
class _Writer:
    """The lines of a document, and those of the texts that it names."""

    culture: str
    texts: list[str] = field(default_factory=list)
    count: int = 0

    def key(self, text: str) -> str:
        """The key of a text, which is kept on one line."""
        self.count += 1
        one = " ".join(BREAKS.split(text)).strip().replace("'", "''")
        self.texts += [f"  - id: MLC_{self.count}", f"    {self.culture}: '{one}'"]
        return f'"MLC_{self.count}"'

    def block(self, block: Block) -> Iterator[str]:
        """All lines."""
        keyword = KEYWORDS[block.kind]
        if block.kind is BlockKind.UDT:
            yield "TYPE"
            yield f"    {declared_name(block.name)} : STRUCT"
            yield from self.members(block.members, 8)
            yield "    END_STRUCT;"
        else:
            yield "{"
            yield from (f"    {line}" for line in self.header(block))
            yield "}"
            yield f"{keyword} {self.name(block)}"
            yield from self.data(block) if block.kind is BlockKind.DB else self.code(block)
        yield f"END_{keyword}"

    def header(self, block: Block) -> Iterator[str]:
        """Attributes of a block in alphabetical order, as exports have them."""
        pairs = {name: f'"{block.attributes[key]}"' for key, name in _HEADER.items() if key in block.attributes}
        if block.title:
            pairs["S7_BlockTitle"] = self.key(block.title)
        if block.comment:
            pairs["S7_BlockComment"] = self.key(block.comment)
        if block.number is not None:
            pairs["S7_BlockNumber"] = f'"{block.number}"'
        if block.kind is BlockKind.DB:
            pairs["S7_StandardRetain"] = f'"{str(is_retentive(block)).upper()}"'
        else:
            pairs["S7_EditorMode"] = '"SCL"'
        if block.attributes.get(IEC_CHECK, "").lower() == "true":
            pairs["S7_IECCheck"] = '"TRUE"'
        pairs["S7_Optimized"] = f'"{str(block.optimized is not False).upper()}"'
        pairs["S7_Version"] = f'"{block.attributes.get("VERSION") or "0.1"}"'
        last = max(pairs)
        for name in sorted(pairs):
            yield f"{name} := {pairs[name]}{'' if name == last else ';'}"

    def name(self, block: Block) -> str:
        """The name with what stands behind it: the type of a result, what a data block is made from."""
        if block.kind is BlockKind.FC:
            result = block.section(SectionKind.RETURN)
            return f"{quoted(block.name)} : {_type(result[0].type) if result else 'Void'}"
        if block.kind is not BlockKind.DB:
            return quoted(block.name)
        if is_array_db(block):
            return f"{declared_name(block.name)} : {_type(block.members[0].type)}"
        of = f" : {declared_name(block.instance_of)}" if block.instance_of else ""
        return f"{declared_name(block.name)}{of}"

    def data(self, block: Block) -> Iterator[str]:
        """Sections and start values of a data block."""
        assigned: list[Assignment] = []
        if not block.instance_of and not is_array_db(block):
            for section in block.sections:
                members = tuple(bare(member, (), assigned) for member in section.members)
                yield from self.section(replace(section, members=members))
        for assignment in (*assigned, *block.assignments):
            yield f"    {assignment.path} := {assignment.literal};"

    def code(self, block: Block) -> Iterator[str]:
        """Sections and the network of a function or function block."""
        for section in block.sections:
            if section.kind in _SECTIONS:
                yield from self.section(section)
        yield ""
        yield '    { S7_Language := "SCL" }'
        yield "    NETWORK"
        yield from (f"        {line}" if line.strip() else "" for line in (block.code or "").split("\n"))
        yield "    END_NETWORK"

    def section(self, section: Section) -> Iterator[str]:
        """One section; none for one without members."""
        if section.members:
            yield f"    {_SECTIONS[section.kind]} {section.retain}".rstrip()
            yield from self.members(section.members, 8)
            yield "    END_VAR"

    def members(self, members: Sequence[Member], indent: int) -> Iterator[str]:
        """Declarations, each behind its attributes."""
        pad = " " * indent
        for member in members:
            pairs = [_MEMBER[name.upper(), value.upper()] for name, value in member.attributes]
            if member.comment:
                pairs.append(f"S7_MLC := {self.key(member.comment)}")
            if pairs:
                yield f"{pad}{{ {'; '.join(pairs)} }}"
            head = f"{pad}{declared_name(member.name)} : "
            if isinstance(innermost(member.type), StructType):
                yield f"{head}{_type(member.type)}"
                yield from self.members(inner_members(member.type), indent + 4)
                yield f"{pad}END_STRUCT;"
            else:
                start = f" := {BREAKS.sub(' ', member.start).strip()}" if member.start is not None else ""
                yield f"{head}{_type(member.type)}{start};"


def _type(type_: DataType) -> str:
    """A type as exports spell it: ``_.Motor`` for one of the user's."""
    if isinstance(type_, ArrayType):
        return f"Array[{type_.bounds_text}] of {_type(type_.element)}"
    if isinstance(type_, NamedType) and type_.quoted:
        return f"_.{declared_name(type_.name)}"
    return "STRUCT" if isinstance(type_, StructType) else datatype(type_)
