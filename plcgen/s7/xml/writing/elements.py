"""Single elements of StructuredText as strings, and what the names of a block stand for, which every operand says.

``SLOT`` stands for every UId until the network is numbered: the elements of one name are the same wherever it stands.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from functools import lru_cache
from typing import TYPE_CHECKING

from plcgen.s7.scl.instructions import SYSTEM_TYPES, is_type_name
from plcgen.s7.scl.lexer import split_trivia
from plcgen.s7.types.blocks import Block, BlockKind, SectionKind
from plcgen.s7.types.data_types import DataType, NamedType, StructType, innermost
from plcgen.s7.types.system import system_block
from plcgen.s7.xml.spelling import attribute, content

if TYPE_CHECKING:
    from plcgen.s7.types.data_types import Member


@dataclass(frozen=True, slots=True)
class BlockScope:
    """Names in upper case.

    ``types`` are the local variables, ``constants`` the local constants, ``instances`` the instance DBs of the
    project with the block they are made from, ``functions`` its FCs, ``global_constants`` its user constants,
    ``blocks`` all of its blocks.
    """

    types: Mapping[str, DataType] = field(default_factory=dict)
    constants: frozenset[str] = frozenset()
    instances: Mapping[str, str] = field(default_factory=dict)
    functions: frozenset[str] = frozenset()
    global_constants: frozenset[str] = frozenset()
    blocks: Mapping[str, Block] = field(default_factory=dict)

    @classmethod
    def of(cls, block: Block, known: Iterable[Block] = (), constants: Iterable[str] = ()) -> BlockScope:
        """Scope of a block; ``known`` are the other blocks of the project."""
        types: dict[str, DataType] = {}
        local_constants = set()
        for section in block.sections:
            for member in section.members:
                if section.kind is SectionKind.CONSTANT:
                    local_constants.add(member.name.upper())
                else:
                    types[member.name.upper()] = member.type
        known = tuple(known)
        return cls(
            types,
            frozenset(local_constants),
            {b.name.upper(): b.instance_of for b in known if b.kind is BlockKind.DB and b.instance_of},
            frozenset(b.name.upper() for b in known if b.kind is BlockKind.FC),
            frozenset(name.upper() for name in constants),
            {b.name.upper(): b for b in known},
        )

    def is_local(self, name: str) -> bool:
        """Whether the block declares the name."""
        upper = name.upper()
        return upper in self.types or upper in self.constants

    def is_type(self, name: str, *, quoted: bool) -> bool:
        """Whether a name that the block does not declare is a type, in quotes one of the user."""
        if quoted:
            block = self.blocks.get(name.upper())
            return block is not None and block.kind in (BlockKind.UDT, BlockKind.FB)
        return is_type_name(name)

    def block_of(self, path: tuple[str, ...]) -> tuple[str, bool] | None:
        """Name of the block that a local instance is made from, and whether it is a system block."""
        return self._named(self.types.get(path[0].upper()) if path else None, path[1:])

    def global_block_of(self, path: tuple[str, ...]) -> tuple[str, bool] | None:
        """The same of an instance inside a data block, which is the first of the names."""
        block = self.blocks.get(path[0].upper())
        if block is None or block.kind is not BlockKind.DB:
            return None
        return self._named(NamedType(block.instance_of or block.name, quoted=True), path[1:])

    def _named(self, found: DataType | None, path: tuple[str, ...]) -> tuple[str, bool] | None:
        for name in path:
            found = next((m.type for m in self._members(found) if m.name.upper() == name.upper()), None)
        found = innermost(found) if found is not None else None
        if not isinstance(found, NamedType):
            return None
        return found.name, not found.quoted and is_system(found.name)

    def _members(self, type_: DataType | None) -> tuple[Member, ...]:
        type_ = innermost(type_) if type_ is not None else None
        if isinstance(type_, StructType):
            return type_.members
        block = self.blocks.get(type_.name.upper()) if isinstance(type_, NamedType) else None
        return () if block is None else block.members


def is_system(name: str) -> bool:
    """Whether a block belongs to the CPU or to a library of the TIA Portal."""
    return name.upper() in SYSTEM_TYPES or system_block(name) is not None


SLOT = "\0"
"""Stands for a UId until the network is numbered."""

UID = f'UId="{SLOT}"'
"""The attribute of every element."""

HAS_QUOTES = f'<BooleanAttribute Name="HasQuotes" {UID}>true</BooleanAttribute>'
"""Says of a name that it stands in quotes though it would need none."""

HAS_HASH = f'<BooleanAttribute Name="HasHash" {UID}>true</BooleanAttribute>'
"""Says of a name behind a dot that it begins with #, as in ``#a.#b``."""

TAB = "    "
"""What a tab becomes: StructuredText has blanks only."""


@lru_cache(maxsize=4096)
def trivia(gap: str, culture: str) -> str:
    """Elements of a gap between two tokens: blanks, line breaks and comments in a language."""
    out: list[str] = []
    begin = breaks = 0
    for comment in split_trivia(gap, 0):
        blank = gap[begin : comment.start]
        begin = comment.start + len(comment.text)
        if breaks and (blank or comment.text != "\n"):
            out.append(_new_line(breaks))
            breaks = 0
        if blank:
            out.append(_blank(blank))
        if comment.text == "\n":
            breaks += 1
        else:
            out.append(_comment(comment.text, culture))
    if breaks:
        out.append(_new_line(breaks))
    if begin < len(gap):
        out.append(_blank(gap[begin:]))
    return "".join(out)


def _new_line(count: int) -> str:
    return f'<NewLine Num="{count}" {UID} />\n' if count > 1 else f"<NewLine {UID} />\n"


def _blank(gap: str) -> str:
    count = len(gap.replace("\t", TAB))
    return f'<Blank Num="{count}" {UID} />' if count > 1 else f"<Blank {UID} />"


def _comment(text: str, culture: str) -> str:
    """``// text`` ends with its line, ``(* text *)`` is inserted, ``(/* text */)`` can be translated."""
    if text.startswith("//"):
        return f"<LineComment {UID}><Text {UID}>{content(text[2:])}</Text></LineComment>"
    if text.startswith("(/*"):
        inner = content(text[3:].removesuffix("*/)"))
        language = f'<MultiLanguageText Lang="{culture}" {UID}>{inner}</MultiLanguageText>'
        return f'<Comment Inserted="true" {UID}>{language}</Comment>'
    inner = content(text[2:].removesuffix("*)").removesuffix("*/"))
    return f'<LineComment Inserted="true" {UID}><Text {UID}>{inner}</Text></LineComment>'


@lru_cache(maxsize=1024)
def token(text: str) -> str:
    """A keyword, operator or other sign."""
    return f'<Token Text="{attribute(text)}" {UID} />'


@lru_cache(maxsize=4096)
def constant(scope: str, text: str) -> str:
    """An operand that is its own value."""
    value = f"<ConstantValue {UID}>{content(text)}</ConstantValue>"
    return f'<Access Scope="{scope}" {UID}><Constant {UID}>{value}</Constant></Access>'


@lru_cache(maxsize=4096)
def named_constant(scope: str, name: str, *, quoted: bool) -> str:
    """A constant by its name."""
    return f'<Access Scope="{scope}" {UID}>{_named("Constant", name, quoted=quoted)}</Access>'


@lru_cache(maxsize=4096)
def simple_symbol(scope: str, name: str, *, quoted: bool) -> str:
    """A variable of one component."""
    return f'<Access Scope="{scope}" {UID}><Symbol {UID}>{_named("Component", name, quoted=quoted)}</Symbol></Access>'


def _named(tag: str, name: str, *, quoted: bool) -> str:
    head = f'<{tag} Name="{attribute(name)}" {UID}'
    return f"{head}>{HAS_QUOTES}</{tag}>" if quoted else f"{head} />"
