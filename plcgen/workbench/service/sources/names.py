"""What a name in a source is: the block, or the member of which block, and where both are declared."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from plcgen.base.diagnostics import DiagnosticError, Span
from plcgen.s7.layout.layout import Entry, Layout, layout_block, locate
from plcgen.s7.scl import ast
from plcgen.s7.scl.lexer import LOCAL, QUOTED, Tokens
from plcgen.s7.types.blocks import Block, BlockKind, SectionKind
from plcgen.s7.types.data_types import ArrayType, DataType, Member, NamedType, StructType, UnknownPathError
from plcgen.workbench.service.sources.version import NAMES, SourceState

DEEPEST = 64
"""Steps of a name; types contain each other seven levels deep at most on any CPU."""


@dataclass(frozen=True, slots=True)
class Step:
    """A step of a name as written: ``a`` or ``a[1]``; ``index`` is the text in the brackets."""

    name: str
    index: str = ""


@dataclass(frozen=True, slots=True)
class Meant:
    """What a name means.

    ``root`` is the block in whose memory it lies and ``path`` the way there with indexes that are numbers; ``owner``
    says in which type ``member`` is declared, to tell it from others of the same name. Without a member it is ``root``.
    """

    root: Block
    member: Member | None
    path: str
    owner: tuple[str, ...]
    section: SectionKind | None = None

    @property
    def key(self) -> tuple[str, ...]:
        """The same for every use of the same thing."""
        if self.member is None:
            return (self.root.name.upper(),)
        return (*self.owner, self.member.name.upper())


def meant_at(state: SourceState, offset: int) -> tuple[Meant, Span] | None:
    """What the name at an offset means, and where that name stands."""
    at = state.token_at(offset)
    if at is None or state.tokens.kinds[at] not in NAMES:
        return None
    found = meaning(state, at)
    if found is None:
        return None
    return found, state.tokens.span(state.tokens.starts[at], state.tokens.end(at))


def meaning(state: SourceState, at: int) -> Meant | None:
    """What the name at a token means: in a declaration, in code, as the type of something."""
    tokens = state.tokens
    unit = state.unit_at(tokens.starts[at])
    own = None if unit is None else state.block_of(unit)
    declared = None if unit is None else _declaration_at(unit, tokens.starts[at])
    if declared is not None and own is not None:
        return walk_to(own, [Step(name) for name in declared], state.types)
    callee = _callee(tokens, at)
    if callee is not None:
        return _argument(state, at, callee)
    steps = written(state, at)
    if not steps:
        return None
    head = steps[0].name
    local = tokens.kinds[at] == LOCAL or _head_kind(state, at) == LOCAL
    if own is not None and (local or _head_kind(state, at) != QUOTED):
        found = walk_to(own, steps, state.types)
        if found is not None or local:
            return found
    block = state.types.get(head.upper())
    if block is None:
        return None
    return Meant(block, None, "", ()) if len(steps) == 1 else walk_to(block, steps[1:], state.types)


_FARTHEST = 4_000
"""Tokens in front of an argument among which its call begins."""


def _callee(tokens: Tokens, at: int) -> int | None:
    """The name of what is called, if a token names an argument of a call."""
    kinds = tokens.kinds
    if not 1 < at < len(kinds) - 1 or kinds[at + 1] not in {":=", "=>"} or kinds[at - 1] not in {"(", ","}:
        return None
    depth = 0
    for back in range(at - 1, max(at - _FARTHEST, 0), -1):
        kind = kinds[back]
        if kind in {")", "]"}:
            depth += 1
        elif kind in {"(", "["} and depth:
            depth -= 1
        elif kind == "(":
            return back - 1 if kinds[back - 1] in NAMES else None
        elif kind in {";", "["}:
            return None
    return None


def _argument(state: SourceState, at: int, callee: int) -> Meant | None:
    """The parameter that an argument is for: of a block, or of the block of an instance."""
    tokens = state.tokens
    called = meaning(state, callee)
    if called is None:  # V5 calls FB10.DB20
        block = state.types.get(_bare(tokens.texts[callee]).upper())
        called = None if block is None else Meant(block, None, "", ())
    if called is None:
        return None
    name = Step(_bare(tokens.texts[at]))
    if called.member is None:
        return walk_to(called.root, [name], state.types)
    owner, members = members_of(called.member, called.owner, state.types)
    member = next((one for one in members if one.name.upper() == name.name.upper()), None)
    if member is None:
        return None
    quoted = f'"{member.name}"' if not member.name.isidentifier() else member.name
    return Meant(called.root, member, f"{called.path}.{quoted}", owner, called.section)


def _declaration_at(unit: ast.Unit, offset: int) -> list[str] | None:
    """The names down to the declaration at an offset; None if there is none."""
    lists = [section.declarations for section in unit.sections]
    if isinstance(unit.body_type, ast.StructSpec):
        lists.append(unit.body_type.members)
    names: list[str] = []
    for _ in range(DEEPEST):
        declaration = next((one for each in lists for one in each if one.start <= offset <= one.end), None)
        if declaration is None:
            return None
        name = next((one for one in declaration.names if one.start <= offset < one.end), None)
        if name is not None:
            return [*names, name.name]
        spec = declaration.type
        while isinstance(spec, ast.ArraySpec):
            spec = spec.element
        if not isinstance(spec, ast.StructSpec):
            return None
        names.append(declaration.names[0].name)
        lists = [spec.members]
    return None


def written(state: SourceState, at: int) -> list[Step]:
    """The name of several steps that ends with a token."""
    tokens = state.tokens
    steps: list[Step] = []
    index = ""
    while at >= 0 and len(steps) < DEEPEST:
        if tokens.kinds[at] not in NAMES:
            return []
        steps.append(Step(_bare(tokens.texts[at]), index))
        if at < 2 or tokens.kinds[at - 1] != ".":
            break
        at, index = at - 2, ""
        if tokens.kinds[at] == "]":
            end = tokens.starts[at]
            depth = 1
            while at > 0 and depth:
                at -= 1
                depth += {"]": 1, "[": -1}.get(tokens.kinds[at], 0)
            index = tokens.source[tokens.end(at) : end]
            at -= 1
    return steps[::-1]


def _head_kind(state: SourceState, at: int) -> str:
    """Kind of the token with which the name begins that ends with a token."""
    kinds = state.tokens.kinds
    while at > 1 and kinds[at - 1] == ".":
        at -= 2
        depth = 0
        while at > 0 and (kinds[at] == "]" or depth):
            depth += {"]": 1, "[": -1}.get(kinds[at], 0)
            at -= 1
    return kinds[at]


def _bare(text: str) -> str:
    return text.removeprefix("#").strip('"')


def walk_to(block: Block, steps: Sequence[Step], types: Mapping[str, Block]) -> Meant | None:
    """Follow steps from a block to a member."""
    root, path = block, ""
    owner: tuple[str, ...] = (block.name.upper(),)
    base = types.get((block.instance_of or "").upper()) if block.instance_of else None
    if base is not None:
        block, owner = base, (base.name.upper(),)
    members: Sequence[Member] = block.members
    sections = {id(member): section.kind for section in block.sections for member in section.members}
    member: Member | None = None
    section: SectionKind | None = None
    for step in steps:
        if member is not None:
            owner, members = members_of(member, owner, types)
        member = next((one for one in members if one.name.upper() == step.name.upper()), None)
        if member is None:
            return None
        section = section or sections.get(id(member))
        quoted = f'"{member.name}"' if not member.name.isidentifier() else member.name
        path += f"{'.' if path else ''}{quoted}{_index(member.type, step.index)}"
    return None if member is None else Meant(root, member, path.removesuffix(_last_index(member, path)), owner, section)


def _index(type_: DataType, text: str) -> str:
    """An index that says where: as written if it is made of numbers, else the first element."""
    if not isinstance(type_, ArrayType):
        return ""
    parts = [part.strip() for part in text.split(",")]
    if text and all(part.lstrip("-").isdecimal() for part in parts):
        return f"[{','.join(parts)}]"
    return f"[{','.join(str(low) for low, _ in type_.bounds)}]" if type_.bounds else ""


def _last_index(member: Member, path: str) -> str:
    """The index behind the last step, which means the array as a whole."""
    return path[path.rindex("[") :] if isinstance(member.type, ArrayType) and path.endswith("]") else ""


def members_of(
    member: Member, owner: tuple[str, ...], types: Mapping[str, Block]
) -> tuple[tuple[str, ...], Sequence[Member]]:
    """The members of a member, and in which type they are declared."""
    type_ = member.type
    while isinstance(type_, ArrayType):
        type_ = type_.element
    if isinstance(type_, StructType):
        return (*owner, member.name.upper()), type_.members
    if isinstance(type_, NamedType):
        block = types.get(type_.name.upper()) or system_block(type_.name)
        if block is not None:
            return (block.name.upper(),), block.members
    return owner, ()


def system_block(name: str) -> Block | None:
    """A system function block or type by name; that of S7-1200/1500 where both have one."""
    from plcgen.s7.cpu.system.interfaces import system_fbs

    found = next(
        (fbs[name.upper()] for classic in (False, True) if name.upper() in (fbs := system_fbs(classic=classic))), None
    )
    return None if found is None else found.block


def layout_of(block: Block, types: Mapping[str, Block]) -> Layout | None:
    """Where the members of a block lie with standard access; None if something in it is not known."""
    if block.kind not in {BlockKind.DB, BlockKind.UDT, BlockKind.FB}:
        return None
    try:
        return layout_block(block, types)
    except DiagnosticError:
        return None


def entry_of(meant: Meant, types: Mapping[str, Block]) -> Entry | None:
    """Where a member lies in its block; None if it has no place there, or that is not known."""
    layout = layout_of(meant.root, types) if meant.path else None
    if layout is None:
        return None
    try:
        return locate(layout, meant.path)
    except UnknownPathError:
        return None


def definition(state: SourceState, line: int, column: int) -> Span | None:
    """Where what stands at a place is declared."""
    found = meant_at(state, state.offset(line, column))
    if found is None:
        return None
    meant, _ = found
    return meant.member.span if meant.member is not None else _block_place(state, meant.root)


def _block_place(state: SourceState, block: Block) -> Span | None:
    unit = next((one for one in state.result.units if one.name == block.name and state.block_of(one) is block), None)
    return state.name_place(unit) if unit is not None else block.span


def uses(state: SourceState, key: tuple[str, ...]) -> Iterator[Span]:
    """Every place of a source at which something is named."""
    tokens, name = state.tokens, key[-1]
    for at, kind in enumerate(tokens.kinds):
        if kind in NAMES and _bare(tokens.texts[at]).upper() == name:
            meant = meaning(state, at)
            if meant is not None and meant.key == key:
                yield tokens.span(tokens.starts[at], tokens.end(at))
