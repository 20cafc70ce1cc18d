"""A block as a text source of the TIA Portal and as SIMATIC SD: the way back from the block model.

Nothing of it has been imported by a TIA Portal: what no document shows is not written (docs/simaticml.md#simatic-sd).
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from types import MappingProxyType

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
from plcgen.s7.types.names import is_identifier
from plcgen.s7.xml.spelling import BREAKS, datatype, declared_name, default_literal
from plcgen.s7.xml.writing.documents import INSTRUCTION, LIBRARY_VERSION, SEEN_BY_OPC_UA, library_element
from plcgen.s7.xml.writing.starts import Path, Starts, single_values

SUFFIXES = MappingProxyType(
    {BlockKind.UDT: ".udt", BlockKind.DB: ".db", BlockKind.FB: ".scl", BlockKind.FC: ".scl", BlockKind.OB: ".scl"}
)
"""File name ending of a source by kind of block."""

KEYWORDS = {
    BlockKind.UDT: "TYPE", BlockKind.DB: "DATA_BLOCK", BlockKind.FB: "FUNCTION_BLOCK", BlockKind.FC: "FUNCTION",
    BlockKind.OB: "ORGANIZATION_BLOCK",
}  # fmt: skip
"""Keyword that opens a source by kind of block."""

_SECTIONS = {
    SectionKind.INPUT: "VAR_INPUT", SectionKind.OUTPUT: "VAR_OUTPUT", SectionKind.IN_OUT: "VAR_IN_OUT",
    SectionKind.STATIC: "VAR", SectionKind.TEMP: "VAR_TEMP", SectionKind.CONSTANT: "VAR CONSTANT",
}  # fmt: skip
_LIBRARY = (INSTRUCTION, LIBRARY_VERSION)
_PROPERTIES = ("AUTHOR", "FAMILY", "NAME", "VERSION")
_DEFAULT_VERSION = "0.1"
_NUMBER = re.compile(r"[0-9]+\.[0-9]+", re.ASCII)


def source(block: Block, types: Mapping[str, Block] | None = None) -> str:
    """Text of a source with one block; its lines end in LF.

    ``types`` are the known blocks by upper-case name: an instance DB has the access of its function block, and
    only the start values in which it differs from it.
    """
    of = (types or {}).get((block.instance_of or "").upper())
    if of is not None and block.optimized is None and of.kind is BlockKind.FB:
        block = replace(block, optimized=of.optimized)
    keyword = KEYWORDS[block.kind]
    lines = [f"{keyword} {quoted(block.name)}{_result(block)}", *_header(block)]
    if block.kind is BlockKind.UDT:
        lines += ["  STRUCT", *_members(block.section(SectionKind.STATIC), 4), "  END_STRUCT;"]
    elif block.kind is BlockKind.DB:
        lines += _data(block, of)
    else:
        lines += _code(block)
    return "\n".join([*lines, f"END_{keyword}", ""])


def is_array_db(block: Block) -> bool:
    """Whether a data block is one array and nothing else."""
    members = block.members if block.kind is BlockKind.DB else ()
    return len(members) == 1 and members[0].name == "THIS" and isinstance(members[0].type, ArrayType)


def quoted(name: str) -> str:
    """A block name in quotes, on one line."""
    return '"' + BREAKS.sub(" ", name).replace('"', "_") + '"'


def _value(text: str) -> str:
    """Value of an attribute: nothing in it ends or escapes its quotes."""
    return _one_line(text).replace("'", "_").replace("$", "_")


def _one_line(text: str) -> str:
    return BREAKS.sub(" ", text).strip()


def _result(block: Block) -> str:
    if block.kind is not BlockKind.FC:
        return ""
    found = block.section(SectionKind.RETURN)
    return f" : {datatype(found[0].type) if found else 'Void'}"


def _header(block: Block) -> list[str]:
    lines = [f"TITLE = {_one_line(block.title)}"] if block.title else []
    pairs = [f"{name} := '{_value(block.attributes[name])}'" for name in _LIBRARY if name in block.attributes]
    if block.optimized is not None and block.kind is not BlockKind.UDT:
        pairs.append(f"S7_Optimized_Access := '{str(block.optimized).upper()}'")
    if block.kind is BlockKind.DB and block.attributes.get(SEEN_BY_OPC_UA, "").lower() == "false":
        pairs.append("DB_Accessible_From_OPC_UA := 'FALSE'")
    if pairs:
        lines.append(f"{{ {'; '.join(pairs)} }}")
    for name in _PROPERTIES:
        value = block.attributes.get(name) or (_DEFAULT_VERSION if name == "VERSION" else "")
        if value:
            plain = is_identifier(value) or (name == "VERSION" and _NUMBER.fullmatch(value))
            lines.append(f"{name} : {value}" if plain else f"{name} : '{_value(value)}'")
    if block.kind is BlockKind.DB and block.non_retain and not is_retentive(block):
        lines.append("NON_RETAIN")
    lines += [f"// {line}".rstrip() for line in block.comment.splitlines()]
    return lines


# --- code blocks -----------------------------------------------------------------------------------------


def _code(block: Block) -> Iterator[str]:
    sections = [s for s in block.sections if s.members and s.kind in _SECTIONS]
    if block.comment or not sections:
        yield ""
    for section in sections:
        yield f"{_SECTIONS[section.kind]} {section.retain}".rstrip()
        yield from _members(section.members, 2)
        yield "END_VAR"
        yield ""
    yield "BEGIN"
    if block.code:
        yield block.code


# --- members ---------------------------------------------------------------------------------------------


def _members(members: Sequence[Member], indent: int) -> Iterator[str]:
    for member in members:
        yield from _member(member, indent)


def _member(member: Member, indent: int) -> Iterator[str]:
    pad = " " * indent
    pairs = "; ".join(f"{name} := '{_value(value)}'" for name, value in member.attributes)
    attributes = f" {{{pairs}}}" if pairs else ""
    at = f" AT {declared_name(member.at)}" if member.at else ""
    comment = f"  // {_one_line(member.comment)}" if member.comment else ""
    head = f"{pad}{declared_name(member.name)}{attributes}{at} : "
    inner = innermost(member.type)
    if isinstance(inner, StructType):
        dimensions = datatype(member.type).removesuffix("Struct")
        yield f"{head}{dimensions}STRUCT{comment}"
        yield from _members(inner.members, indent + 2)
        yield f"{pad}END_STRUCT;"
        return
    start = f" := {_one_line(member.start)}" if member.start is not None else ""
    yield f"{head}{datatype(member.type)}{start};{comment}"


# --- data blocks -----------------------------------------------------------------------------------------


def _data(block: Block, of: Block | None) -> Iterator[str]:
    if block.instance_of:
        yield block.instance_of if of is None and library_element(block) else quoted(block.instance_of)
        yield "BEGIN"
        # start values of an instance DB that its function block has otherwise
        declared = _values(of) if of is not None else {}
        for key, (path, literal) in _values(block).items():
            if declared.get(key, ("", ""))[1] != literal:
                yield f"  {path} := {literal};"
        return
    if is_array_db(block):
        yield f"  {datatype(block.members[0].type)};"
        yield ""
        yield "BEGIN"
        return
    assigned: list[Assignment] = []
    groups = [replace(s, members=tuple(bare(m, (), assigned) for m in s.members)) for s in block.sections]
    yield from _body(groups, whole=is_retentive(block))
    yield ""
    yield "BEGIN"
    for assignment in (*assigned, *block.assignments):
        yield f"  {_one_line(assignment.path)} := {_one_line(assignment.literal)};"


def _body(groups: Sequence[Section], *, whole: bool) -> Iterator[str]:
    """Members; in sections if only some of them are retentive, which else the header says."""
    if {group.retain for group in groups if group.members} <= {""} or whole:
        yield "  STRUCT"
        for group in groups:
            yield from _members(group.members, 4)
        yield "  END_STRUCT;"
        return
    for group in groups:
        yield f"  VAR {group.retain}".rstrip()
        yield from _members(group.members, 4)
        yield "  END_VAR"


def bare(member: Member, path: Path, assigned: list[Assignment]) -> Member:
    """A member whose array values stand behind BEGIN instead, one line each."""
    here = (*path, declared_name(member.name))
    if isinstance(member.type, StructType):
        inner = tuple(bare(m, here, assigned) for m in member.type.members)
        return replace(member, type=StructType(inner))
    if not isinstance(member.type, ArrayType) or member.start is None:
        return member
    starts = Starts()
    starts.declare(member, (member.name.upper(),))
    values = starts.of((member.name.upper(),))
    if starts.lost or not values or any(";" in index for index in values):
        return member
    default = default_literal(member.type.element)
    name = ".".join(here)
    assigned += [Assignment(f"{name}[{index}]", text) for index, text in values.items() if text != default]
    return replace(member, start=None)


def _values(block: Block) -> dict[str, tuple[str, str]]:
    """Start values one by one with their paths, by path without quotes and case; assigned ones replace others."""
    members = (m for s in block.sections if s.kind is not SectionKind.CONSTANT for m in s.members)
    singles = single_values(members)
    found = [(".".join(declared_name(name) + index for name, index in way), value) for way, value in singles]
    found += [(_one_line(assignment.path), assignment.literal) for assignment in block.assignments]
    return {path.replace('"', "").upper(): (path, _one_line(literal)) for path, literal in found}


VERSIONS = ("V20", "V21")
"""Versions of the TIA Portal whose documents have been seen; code in SCL in those of the last one only."""

_SD_SECTIONS = {
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
            if section.kind in _SD_SECTIONS:
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
