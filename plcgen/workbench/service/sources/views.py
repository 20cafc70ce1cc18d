"""What an editor shows of a source: problems, hover, outline, colours, the parameters of a call."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from functools import lru_cache
from typing import TYPE_CHECKING
from weakref import WeakKeyDictionary

from plcgen.base.diagnostics import Span
from plcgen.base.display.page import Page
from plcgen.s7.cpu.system.interfaces import system_fbs
from plcgen.s7.cpu.system.library import ROWS, parts
from plcgen.s7.scl import ast
from plcgen.s7.scl.instructions import INSTRUCTIONS, parameters
from plcgen.s7.scl.lexer import (
    ADDRESS,
    ERROR,
    INT,
    KEYWORDS,
    LOCAL,
    NAME,
    POINTER,
    QUOTED,
    REAL,
    STRING,
    TYPED,
    Comment,
    Tokens,
)
from plcgen.s7.tables.tables import PanelTag, panel_tag, size_text
from plcgen.s7.types.blocks import Block, BlockKind, SectionKind, block_title
from plcgen.s7.types.data_types import elementary
from plcgen.s7.types.literals import type_text
from plcgen.workbench.service.results import (
    Hover,
    Painted,
    Signature,
    SignaturePart,
    Symbol,
    SymbolKind,
    Token,
    TokenKind,
)
from plcgen.workbench.service.sources.names import Meant, entry_of, meaning, meant_at, system_block

if TYPE_CHECKING:
    from plcgen.workbench.service.sources.version import SourceState

_PASSED = (SectionKind.INPUT, SectionKind.OUTPUT, SectionKind.IN_OUT)
MOST_MEMBERS = 2_000
"""Members of an outline; an editor shows no more."""


def hover(state: SourceState, line: int, column: int) -> Hover | None:
    """Type, offset, start value and comment of a member; interface of a block; parameters of an instruction."""
    offset = state.offset(line, column)
    found = meant_at(state, offset)
    if found is not None:
        meant, span = found
        return Hover(span, _member(state, meant) if meant.member is not None else _block(meant.root))
    at = state.token_at(offset)
    if at is None or state.tokens.kinds[at] not in {NAME, QUOTED}:
        return None
    text = state.tokens.texts[at].strip('"')
    shown = signature_of(state, text)
    if shown is None:
        return None
    span = state.tokens.span(state.tokens.starts[at], state.tokens.end(at))
    return Hover(span, Page(text, shown.text, (("Call", shown.label),)))


def _member(state: SourceState, meant: Meant) -> Page:
    member = meant.member
    assert member is not None  # the caller asks for members only
    root, facts = meant.root, [f"type: {type_text(member.type)}"]
    if meant.section is not None and root.kind not in {BlockKind.UDT, BlockKind.DB}:
        facts.append(f"section: {meant.section.value}")
    entry = None if meant.section in {SectionKind.TEMP, SectionKind.CONSTANT} else entry_of(meant, state.types)
    if entry is not None and root.optimized:
        facts.append("optimized access: no offset")
    elif entry is not None:
        facts.append(f"offset: {entry.byte}.{entry.bit} in {block_title(root.kind, root.number, root.name)}")
        facts.append(f"size: {size_text(entry.size)}")
    facts += [f"start value: {member.start}"] if member.start is not None else []
    sections = [("Facts", "\n".join(facts))]
    if entry is not None and root.kind is BlockKind.DB:
        sections.append(("In a panel", "\n".join(_reached(root, panel_tag(root, entry)))))
    sections += [("Comment", member.comment)] if member.comment else []
    return Page(member.name, type_text(member.type), tuple(sections))


def _reached(root: Block, tag: PanelTag) -> list[str]:
    """How a panel reaches a member."""
    why = "none: optimized access" if root.optimized else "none: this source gives the block no number"
    return [f"symbolic (S7-1200/1500): {tag.symbolic}", f"absolute: {tag.absolute or why}"]


def _block(block: Block) -> Page:
    sections = [("Interface", _label(block))] if block.kind in {BlockKind.FB, BlockKind.FC} else []
    sections += [("Comment", block.comment)] if block.comment else []
    of = f" of {block.instance_of}" if block.instance_of else ""
    return Page(block_title(block.kind, block.number, block.name), f"{block.title}{of}".strip(), tuple(sections))


# --- calls -----------------------------------------------------------------------------------------------------------


def _label(block: Block) -> str:
    return f"{block.name}({', '.join(part.text for part in _parts(block))})"


def _parts(block: Block) -> tuple[SignaturePart, ...]:
    return tuple(
        SignaturePart(
            f"{member.name} {'=>' if section.kind is SectionKind.OUTPUT else ':='} {type_text(member.type)}",
            section.kind.value,
        )
        for section in block.sections
        if section.kind in _PASSED
        for member in section.members
    )


def signature_of(state: SourceState, name: str) -> Signature | None:
    """Parameters of a block or instruction by its name."""
    upper = name.upper()
    block = state.types.get(upper)
    if block is not None and block.kind in {BlockKind.FB, BlockKind.FC}:
        return Signature(_label(block), block.comment, _parts(block), 0)
    function = _function(upper)
    if function is not None:
        return function
    for classic in (False, True):
        known = system_fbs(classic=classic).get(upper)
        if known is not None:
            members = {m.name.upper(): type_text(m.type) for s in known.block.sections for m in s.members}
            known_parts = tuple(
                SignaturePart(
                    f"{key} {'=>' if kind is SectionKind.OUTPUT else ':='} {members.get(key, '')}".strip(), kind.value
                )
                for key, kind in known.parameters.items()
            )
            label = f"{upper}({', '.join(part.text for part in known_parts)})"
            return Signature(label, "system function block", known_parts, 0)
    return None


def _function(name: str) -> Signature | None:
    """Parameters of a function, ``NORM_X`` or ``NORM_X_REAL``, by name in upper case."""
    base = _untyped(name)
    if base is None:
        return None
    row = ROWS.get(base)
    if row is None:
        found = tuple(SignaturePart(one, SectionKind.INPUT.value) for one in parameters()[base])
    else:
        kinds = ((row.inputs, SectionKind.INPUT, ":="), (row.outputs, SectionKind.OUTPUT, "=>"))
        found = tuple(
            SignaturePart(f"{one.name} {sign} {_type_of(one.type)}".strip(), kind.value)
            for text, kind, sign in kinds
            for one in parts(text)
        )
    return Signature(f"{name}({', '.join(one.text for one in found)})", "instruction", found, 0)


_GROUPS = {
    "num": "number", "int": "integer", "real": "REAL or LREAL", "bits": "bit string", "text": "text",
    "time": "time or date", "stamp": "date and time", "same": "any type", "ref": "variable", "bit": "bit",
    "tail": "element of an array", "timer": "T", "counter": "C", "s5": "S5TIME",
}  # fmt: skip


def _type_of(text: str) -> str:
    """Type of a parameter, or a word for a group of types."""
    return _GROUPS.get(text, text)


def _untyped(name: str) -> str | None:
    """The name of a function as tables have it; a type may stand behind it."""
    while name not in ROWS and name not in parameters():
        name, _, type_ = name.rpartition("_")
        if not name or (elementary(type_) is None and type_ not in {"STRING", "WSTRING", "OF", "DAY", "AND"}):
            return None
    return name


def signature(state: SourceState, line: int, column: int) -> Signature | None:
    """What is called where the cursor is between brackets, and the parameter that is being given."""
    tokens, offset = state.tokens, state.offset(line, column)
    last = max((n for n, start in enumerate(tokens.starts) if start < offset), default=-1)
    depth = commas = 0
    named = ""
    for at in range(last, max(last - 2000, -1), -1):
        kind = tokens.kinds[at]
        if kind in {")", "]"}:
            depth += 1
        elif kind in {"(", "["} and depth:
            depth -= 1
        elif kind == "(":
            return _called(state, at - 1, commas, named)
        elif kind == ";" and not depth:
            return None
        elif kind == "," and not depth:
            commas += 1
        elif kind in {":=", "=>"} and not depth and not commas and at > 0:
            named = named or tokens.texts[at - 1].strip('"').upper()
    return None


def _called(state: SourceState, at: int, commas: int, named: str) -> Signature | None:
    if at < 0 or state.tokens.kinds[at] not in {NAME, LOCAL, QUOTED}:
        return None
    meant = meaning(state, at)
    found: Signature | None = None
    if meant is not None and meant.member is not None:
        found = signature_of(state, type_text(meant.member.type).strip('"'))
    elif meant is not None and meant.root.instance_of:
        found = signature_of(state, meant.root.instance_of)
    found = found or signature_of(state, state.tokens.texts[at].strip('"').removeprefix("#"))
    if found is None:
        return None
    number = next((n for n, part in enumerate(found.parameters) if part.text.split(" ")[0].upper() == named), commas)
    return Signature(found.label, found.text, found.parameters, min(number, max(len(found.parameters) - 1, 0)))


# --- outline ---------------------------------------------------------------------------------------------------------


def outline(state: SourceState) -> tuple[Symbol, ...]:
    """Blocks with their members, regions left out."""
    room = [MOST_MEMBERS]
    found = []
    for unit in state.result.units:
        kind: SymbolKind = "type" if unit.keyword == "TYPE" else "block"
        lists = [section.declarations for section in unit.sections]
        if isinstance(unit.body_type, ast.StructSpec):
            lists.append(unit.body_type.members)
        members = tuple(one for each in lists for one in _members(state, each, room, 0))
        whole = state.tokens.span(unit.start, unit.end)
        found.append(
            Symbol(unit.name, kind, unit.keyword.replace("_", " ").lower(), whole, state.name_place(unit), members)
        )
    return tuple(found)


def _members(
    state: SourceState, declarations: tuple[ast.Declaration, ...], room: list[int], depth: int
) -> Iterator[Symbol]:
    for one in declarations:
        spec = one.type
        text = "" if spec is None else " ".join(state.tokens.source[spec.start : spec.end].split())[:60]
        while isinstance(spec, ast.ArraySpec):
            spec = spec.element
        inside = spec.members if isinstance(spec, ast.StructSpec) and depth < 8 else ()
        for name in one.names:
            room[0] -= 1
            if room[0] < 0:
                return
            place = state.tokens.span(name.start, name.start + len(name.name) + 2 * name.quoted)
            detail = "Struct" if inside else text
            below = tuple(_members(state, inside, room, depth + 1))
            yield Symbol(name.name, "member", detail, state.tokens.span(one.start, one.end), place, below)


# --- colours ---------------------------------------------------------------------------------------------------------

_KINDS: Mapping[str, TokenKind] = {
    **dict.fromkeys(KEYWORDS, "keyword"),
    LOCAL: "variable", QUOTED: "namespace", STRING: "string", INT: "number", REAL: "number", TYPED: "number",
    ADDRESS: "variable", POINTER: "number",
}  # fmt: skip
_WORD_OPERATORS = {"AND", "OR", "XOR", "NOT", "MOD", "DIV"}


_PAINTED: WeakKeyDictionary[SourceState, Painted] = WeakKeyDictionary()


def painted(state: SourceState) -> Painted:
    """The colours of a text, found once."""
    if state not in _PAINTED:
        _PAINTED[state] = Painted(state.document.lines, tuple(tokens(state)))
    return _PAINTED[state]


def tokens(state: SourceState) -> Iterator[Token]:
    """Every token and every comment in its colour, line by line, in order."""
    found = state.lexed
    end = braces = 0
    for at, kind in enumerate(found.kinds):
        braces += {"{": 1, "}": -1}.get(kind, 0)
        if found.source[end : found.starts[at]].strip():
            for gap in found.trivia_before(at):
                if gap.text != "\n":
                    yield from _lines(found, gap, "comment")
        colour = "string" if braces and kind == QUOTED else _colour(found, at, kind)
        if colour is not None:
            yield from _lines(found, Comment(found.texts[at], found.starts[at]), colour)
        end = found.end(at)


def _colour(found: Tokens, at: int, kind: str) -> TokenKind | None:
    if at and found.kinds[at - 1] == ".":
        return "property"
    if kind in _WORD_OPERATORS:
        return "operator"
    if kind != NAME:
        return _KINDS.get(kind, None if kind == ERROR or not found.texts[at] else "operator")
    return _name_colour(found.texts[at].upper(), called=found.kinds[at + 1] == "(")


@lru_cache(maxsize=4096)
def _name_colour(name: str, *, called: bool) -> TokenKind:
    if elementary(name) is not None or name in {"STRING", "WSTRING", "VOID"}:
        return "type"
    if called and (name in INSTRUCTIONS or _untyped(name) is not None or system_block(name) is not None):
        return "function"
    return "function" if re.fullmatch(r"\w+_TO_\w+", name) else "variable"


def _lines(found: Tokens, part: Comment, kind: TokenKind) -> Iterator[Token]:
    """A part of the text, cut at line ends."""
    offset = part.start
    for text in part.text.split("\n"):
        if text.strip():
            line, column = found.position(offset)
            yield Token(Span(found.file, line, column, line, column + len(text)), kind)
        offset += len(text) + 1
