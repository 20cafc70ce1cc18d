"""Declarations of the tree to the block model; start values stay the text of the source."""

from __future__ import annotations

import re
from collections import ChainMap
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from difflib import get_close_matches
from textwrap import dedent
from typing import TypeVar

from plcgen.base.diagnostics import Diagnostic, Severity, Span
from plcgen.base.diagnostics.suggest import did_you_mean
from plcgen.s7.layout.shapes import declared_twice
from plcgen.s7.scl import ast
from plcgen.s7.scl.constants import evaluate, project_names, type_of
from plcgen.s7.scl.cursor import MAX_ERRORS
from plcgen.s7.scl.dialect import Dialect
from plcgen.s7.scl.grammar.documents import NUMBER, SAFETY, SCL
from plcgen.s7.scl.instructions import SYSTEM_TYPES
from plcgen.s7.scl.parser import ParseResult
from plcgen.s7.types.blocks import Assignment, Block, BlockKind, Section, SectionKind
from plcgen.s7.types.data_types import (
    ALIASES,
    ELEMENTARY,
    ArrayType,
    DataType,
    Member,
    NamedType,
    StringType,
    StructType,
    elementary,
    inner_members,
    innermost,
    nested,
)


@dataclass(slots=True)
class UnknownNames:
    """What has been reported, whatever it was taken for: a type, a tag, a constant, a block.

    ``warned`` are names of bounds and lengths, and where a warning tells of them: in code the same name is an error.
    """

    reported: set[str] = field(default_factory=set)
    warned: dict[str, Span] = field(default_factory=dict)

    def add(self, *names: str) -> bool:
        """Whether none of the keys of a name has been reported; now they have."""
        keys = {name.upper() for name in names}
        if not self.reported.isdisjoint(keys):
            return False
        self.reported |= keys
        return True

    def warn(self, span: Span, *names: str) -> bool:
        """Whether nothing has been said of any of the keys of a name; now there is a warning."""
        keys = {name.upper() for name in names}
        if not keys.isdisjoint(self.reported | self.warned.keys()):
            return False
        self.warned |= dict.fromkeys(keys, span)
        return True

    def replaced(self) -> set[Span]:
        """Places of the warnings whose name is an error elsewhere."""
        return {span for key, span in self.warned.items() if key in self.reported}


def keys_of(node: ast.Name, block: str) -> tuple[str, ...]:
    """Keys of a name: with ``#`` it is another one in every block, without ``#`` and quotes it may be either."""
    local = f"{block}#{node.name}"
    return (local,) if node.scope == "local" else (node.name, local) if node.scope == "bare" else (node.name,)


Where = TypeVar("Where")

_NUMBERED = re.compile(r"(?i:(UDT|S?FB|S?FC|DB|OB)0*([0-9]{1,5}))")
_KINDS = {
    "TYPE": BlockKind.UDT, "DATA_BLOCK": BlockKind.DB, "FUNCTION_BLOCK": BlockKind.FB,
    "FUNCTION": BlockKind.FC, "ORGANIZATION_BLOCK": BlockKind.OB,
}  # fmt: skip
_SECTIONS = {
    "VAR_INPUT": SectionKind.INPUT, "VAR_OUTPUT": SectionKind.OUTPUT, "VAR_IN_OUT": SectionKind.IN_OUT,
    "VAR": SectionKind.STATIC, "VAR_TEMP": SectionKind.TEMP, "CONST": SectionKind.CONSTANT,
}  # fmt: skip
_IS_NUMBER = re.compile(r"[0-9]{1,5}")
_NO_VALUE = ast.Aggregate(0, 0, "(", ())
_CODE_BLOCKS = frozenset({"FUNCTION_BLOCK", "FUNCTION", "ORGANIZATION_BLOCK"})
_RETAIN = frozenset({"RETAIN", "NON_RETAIN", "DB_SPECIFIC"})
_DEFAULT_STRING = 254
_INDEX = (-32768, 32767)
"""Bounds of an array with standard access (help of the TIA Portal, "ARRAY")."""
_PLAIN = [name for name in (*ELEMENTARY, *ALIASES, "STRING", "WSTRING") if "_" not in name]
_LONGEST = 9
_CONSTANT_HELP = (
    "also name the tag table that has it, or write its value: until then the memory layout of the block is unknown"
)
_BOUND_HELP = "write the number: without it the memory layout of the block is unknown"


def blocks(
    result: ParseResult,
    dialect: Dialect | None = None,
    constants: Mapping[str, int] | None = None,
    unknown: UnknownNames | None = None,
) -> tuple[list[Block], list[Diagnostic]]:
    """Every unit as a block, and PG805..PG807 about them; syntax errors are in ``result`` already.

    ``constants`` are the whole numbers among those of the project, for bounds and lengths. Of ``unknown``
    names of a program, none is reported again; without it each is, where it stands.
    """
    declared = {unit.name.upper() for unit in result.units}
    builder = _Builder(result, declared, dialect, project_names(constants or {}), unknown)
    found = [builder.block(unit) for unit in result.units]
    return found, builder.diagnostics + list(recursive_types(found))


class _Builder:
    """One file: its text, its own types, and the diagnostics about its declarations."""

    def __init__(
        self,
        result: ParseResult,
        declared: set[str],
        dialect: Dialect | None,
        project: dict[str, int],
        unknown: UnknownNames | None,
    ) -> None:
        self.result = result
        self.source = result.tokens.source
        self.declared = declared
        self.strict = dialect is not None and dialect.is_tia
        self.classic = dialect in {Dialect.STEP7_V5, Dialect.TIA_300_400}
        self.diagnostics: list[Diagnostic] = []
        self.project = project
        self.constants: Mapping[str, int] = {}
        self.unresolved: set[str] = set()
        self.unknown = unknown
        self.name = ""
        self.compared = 0
        self.instruction = False
        self.standard = False

    def error(self, code: str, message: str, node: ast.Node, text: str = "") -> None:
        """Keep a diagnostic at a node."""
        self.diagnostics.append(Diagnostic(code, message, self.result.span(node), help=text))

    def text(self, node: ast.Node) -> str:
        """Source text of a node."""
        return self.source[node.start : node.end]

    # --- blocks ---------------------------------------------------------------------------------------

    def block(self, unit: ast.Unit) -> Block:
        """One unit."""
        kind = _KINDS[unit.keyword]
        attributes = {a.name: a.value for a in unit.attributes}
        optimized = attributes.pop("S7_Optimized_Access", None)
        number = attributes.pop(NUMBER, "")
        safety = attributes.pop(SAFETY, "").upper() == "TRUE"
        self.standard = optimized is not None and optimized.upper() == "FALSE"
        self.name = unit.name
        self.constants = self.block_constants(unit)
        sections = self.sections(unit)
        instance_of = None
        body = unit.body_type
        if isinstance(body, ast.TypeName) and kind is BlockKind.DB:
            instance_of = body.name
        elif body is not None:
            sections.append(Section(SectionKind.STATIC, self.body_members(body)))
        if unit.return_type is not None and not _is_void(unit.return_type):
            result = Member("Ret_Val", self.data_type(unit.return_type), span=self.result.span(unit.return_type))
            sections.append(Section(SectionKind.RETURN, (result,)))
        if kind in {BlockKind.DB, BlockKind.UDT}:
            sections = _merged(sections)
        # PG805: names are unique within a block and within a structure, whatever their case
        pending: list[tuple[Member, ...]] = [tuple(m for s in sections for m in s.members)]
        while pending:
            members = pending.pop()
            first: dict[str, Member] = {}
            for member in members:
                known = first.setdefault(member.name.upper(), member)
                if known is not member:
                    self.duplicate(member, known)
                if inside := inner_members(member.type):
                    pending.append(inside)
        properties = dict(unit.properties)
        title = properties.pop("TITLE", "")
        return Block(
            kind,
            unit.name,
            tuple(sections),
            number=int(number) if _IS_NUMBER.fullmatch(number) else _number(unit, kind),
            instance_of=instance_of,
            optimized=None if optimized is None else optimized.upper() == "TRUE",
            non_retain="NON_RETAIN" in unit.flags,
            title=title,
            comment=unit.comment,
            attributes={**attributes, **properties},
            assignments=self.assignments(unit) if kind is BlockKind.DB else (),
            span=self.result.tokens.span(unit.start, unit.start + len(unit.keyword)),
            code=self.code(unit) if unit.keyword in _CODE_BLOCKS and unit.code[0] >= 0 else None,
            safety=safety,
        )

    def code(self, unit: ast.Unit) -> str:
        """Text of the statements: the rest of the line of BEGIN and the line of the END do not belong to it."""
        if unit.networks:
            scl = [network.inside for network in unit.networks if network.language.upper() == SCL]
            return "\n".join(dedent(trim_code(self.source[begin:stop])) for begin, stop in scl)
        begin, stop = unit.code
        return trim_code(self.source[begin:stop])

    def sections(self, unit: ast.Unit) -> list[Section]:
        """Return the declaration sections in source order; labels are no members."""
        found: list[Section] = []
        for section in unit.sections:
            kind = _SECTIONS.get(section.keyword)
            if kind is None:
                continue
            if "CONSTANT" in section.modifiers:
                kind = SectionKind.CONSTANT
            elif kind is SectionKind.STATIC and unit.keyword in {"FUNCTION", "ORGANIZATION_BLOCK"}:
                kind = SectionKind.TEMP
            retain = next((m for m in section.modifiers if m in _RETAIN), "")
            found.append(Section(kind, self.members(section.declarations), retain))
        return found

    def body_members(self, body: ast.TypeSpec) -> tuple[Member, ...]:
        """Members of a DB's or UDT's structure; another type is one member called THIS."""
        if isinstance(body, ast.StructSpec):
            return self.members(body.members)
        return (Member("THIS", self.data_type(body), span=self.result.span(body)),)

    def assignments(self, unit: ast.Unit) -> tuple[Assignment, ...]:
        """Return the lines behind BEGIN of a DB."""
        found: list[Assignment] = []
        for statement in unit.statements:
            if isinstance(statement, ast.Assign) and statement.operator == ":=" and not statement.also:
                if statement.value == _NO_VALUE:
                    continue  # a comment of one element in a SIMATIC SD document
                path, literal = self.text(statement.target), self.text(statement.value)
                found.append(Assignment(path, literal, self.result.span(statement)))
            elif not isinstance(statement, ast.Label):
                self.error("PG801", "only assignments are allowed after BEGIN of a data block", statement)
        return tuple(found)

    def block_constants(self, unit: ast.Unit) -> Mapping[str, int]:
        """Integer constants of CONST and VAR CONSTANT, by upper-case name, and those of the project."""
        known = ChainMap[str, int]({}, self.project)
        self.unresolved = set()
        for section in unit.sections:
            if section.keyword == "CONST" or "CONSTANT" in section.modifiers:
                for declaration in section.declarations:
                    value = evaluate(declaration.initial, known) if declaration.initial else None
                    names = [name.name.upper() for name in declaration.names]
                    if value is not None:
                        known.update((name, value) for name in names)
                    else:
                        self.unresolved.update(names)
        return known

    # --- members --------------------------------------------------------------------------------------

    def members(self, declarations: Iterable[ast.Declaration]) -> tuple[Member, ...]:
        """One member per name."""
        found: list[Member] = []
        for declaration in declarations:
            found += self.declared_members(declaration)
        return tuple(found)

    def declared_members(self, declaration: ast.Declaration) -> list[Member]:
        """Expand one declaration: its names share type and start value."""
        spec, initial = declaration.type, declaration.initial
        if spec is not None:
            self.instruction = any(name.attributes and _is_instruction(name.attributes) for name in declaration.names)
            data_type = self.data_type(spec)
        elif initial is not None:
            data_type = type_of(initial, evaluate(initial, self.constants))
        else:
            return []
        start = None if initial is None else self.source[initial.start : initial.end]
        of_type = spec.attributes if isinstance(spec, ast.TypeName) else ()
        found = []
        for name in declaration.names:
            own = (*name.attributes, *of_type)
            pairs = tuple((a.name, a.value) for a in own) if own else ()
            span = self.result.tokens.span(name.start, name.end)
            found.append(Member(name.name, data_type, start, declaration.comment, declaration.at, span, pairs))
        return found

    def duplicate(self, member: Member, known: Member) -> None:
        """Two members with one name, with both places; so many that nobody reads them are left out."""
        if len(self.diagnostics) < MAX_ERRORS:
            self.diagnostics.append(declared_twice(member, known, Span(self.result.tokens.file)))

    # --- types ----------------------------------------------------------------------------------------

    def data_type(self, spec: ast.TypeSpec) -> DataType:
        """Convert a type to the block model; PG806 for a name nobody knows."""
        if isinstance(spec, ast.TypeName):
            return self.named(spec)
        if isinstance(spec, ast.ArraySpec):
            bounds = tuple(self.bound(spec, low, high) for low, high in spec.bounds)
            return ArrayType(bounds, self.data_type(spec.element), spec.open_dimensions)
        if isinstance(spec, ast.StructSpec):
            return StructType(self.members(spec.members))
        if isinstance(spec, ast.StringSpec):
            return StringType(spec.name.upper(), self.length(spec))
        return NamedType("REF_TO " + self.text(spec.target))

    def named(self, spec: ast.TypeName) -> DataType:
        """Return an elementary type, or a name that stays a name."""
        if spec.quoted:
            return NamedType(spec.name, quoted=True)
        if found := elementary(spec.name):
            return found
        upper = spec.name.upper()
        known = (
            upper in SYSTEM_TYPES
            or upper in self.declared
            or self.instruction
            or _is_instruction(spec.attributes)
            or "." in spec.name
            or _NUMBERED.fullmatch(upper)
        )
        if not known:
            self.report_unknown(spec)
        return NamedType(spec.name)

    def report_unknown(self, spec: ast.TypeName) -> None:
        """STEP 7 V5 allows symbols without quotes: there only what looks like a typing error is one."""
        if len(self.diagnostics) >= MAX_ERRORS or not (self.strict or self.is_misspelt(spec.name)):
            return
        candidates = [*ELEMENTARY, *ALIASES, "STRING", "WSTRING", *SYSTEM_TYPES, *self.declared]
        text = did_you_mean(spec.name, candidates) or "put the name of a user type in quotes"
        if self.unknown is None or self.unknown.add(spec.name):
            self.error("PG806", f"unknown type {spec.name}", spec, text)

    def is_misspelt(self, name: str) -> bool:
        """Whether the name of a type is about one letter away from an elementary one; a few names per file."""
        if not name.isalpha() or len(name) > _LONGEST or self.compared >= MAX_ERRORS:
            return False
        self.compared += 1
        return bool(get_close_matches(name.upper(), _PLAIN, n=1, cutoff=0.85))

    def bound(self, spec: ast.ArraySpec, low: ast.Expression, high: ast.Expression) -> tuple[int, int]:
        """One dimension; a bound that is not a constant of this block counts as its neighbour."""
        values = [evaluate(low, self.constants), evaluate(high, self.constants)]
        for node, value in zip((low, high), values, strict=True):
            if value is None and not self.is_elsewhere(node) and self.is_news(node):
                self.error(
                    "PG801", f"the array bound {self.text(node)} is not a constant of this block", node, _BOUND_HELP
                )
        first = values[0] if values[0] is not None else values[1] or 0
        last = values[1] if values[1] is not None else first
        if last < first:
            self.error("PG801", f"the array ends before it begins ({first}..{last})", spec)
            last = first
        if (self.classic or self.standard) and not (_INDEX[0] <= first and last <= _INDEX[1]):
            where = "on S7-300/400" if self.classic else "with standard access"
            message = f"array bounds lie within {_INDEX[0]}..{_INDEX[1]} {where}, not {first}..{last}"
            self.error("PG801", message, spec)
        return first, last

    def is_elsewhere(self, node: ast.Expression) -> bool:
        """Whether the value depends on a constant of the project; if so, warn with PG806."""
        for inner in ast.walk(node):
            if isinstance(inner, ast.Name) and (inner.scope == "quoted" or inner.name.upper() in self.unresolved):
                message = f"the constant {self.text(inner)} is defined outside this source"
                span = self.result.span(inner)
                news = self.unknown is None or self.unknown.warn(span, *keys_of(inner, self.name))
                if news and len(self.diagnostics) < MAX_ERRORS:
                    self.diagnostics.append(Diagnostic("PG806", message, span, Severity.WARNING, help=_CONSTANT_HELP))
                return True
        return False

    def is_news(self, node: ast.Expression) -> bool:
        """Whether none of the names without a value has been reported; now they have."""
        if self.unknown is None:
            return True
        names = (name for name in ast.walk(node) if isinstance(name, ast.Name))
        unknown = [name for name in names if evaluate(name, self.constants) is None]
        news = [self.unknown.add(*keys_of(name, self.name)) for name in unknown]
        return all(news)

    def length(self, spec: ast.StringSpec) -> int:
        """Return the declared length of a string, 254 without one."""
        if spec.length is None:
            return _DEFAULT_STRING
        value = evaluate(spec.length, self.constants)
        if value is None and self.is_elsewhere(spec.length):
            return _DEFAULT_STRING
        limit = _DEFAULT_STRING if spec.name.upper() == "STRING" else 16382
        if value is None and not self.is_news(spec.length):
            return _DEFAULT_STRING
        if value is None or not 0 < value <= limit:
            self.error("PG801", f"{spec.name.upper()} needs a constant length from 1 to {limit}", spec.length)
            return _DEFAULT_STRING
        return value


def trim_code(text: str) -> str:
    """Code without the end of the line before it and without the line break and indentation behind it."""
    first, newline, rest = text.partition("\n")
    if newline and not first.strip(" \t"):
        text = rest
    head, newline, last = text.rpartition("\n")
    return head if newline and not last.strip(" \t") else text


def _is_instruction(attributes: Iterable[ast.Attribute]) -> bool:
    """Whether the attributes name a library instruction: then its type needs no declaration."""
    return any(a.name in {"InstructionName", "OriginalPartName"} for a in attributes)


def _is_void(spec: ast.TypeSpec) -> bool:
    return isinstance(spec, ast.TypeName) and not spec.quoted and spec.name.upper() == "VOID"


def _number(unit: ast.Unit, kind: BlockKind) -> int | None:
    match = None if unit.quoted else _NUMBERED.fullmatch(unit.name)
    return int(match[2]) if match and match[1].upper() == kind.value else None


def _merged(sections: list[Section]) -> list[Section]:
    """Merge STATIC sections of one retentivity: a UDT has one, an instance DB without a body none."""
    others = [s for s in sections if s.kind is not SectionKind.STATIC]
    static: list[Section] = []
    for section in sections:
        if section.kind is not SectionKind.STATIC or (static and not section.members):
            continue
        if static and section.retain == static[-1].retain:
            static[-1] = Section(SectionKind.STATIC, static[-1].members + section.members, section.retain)
        else:
            static.append(section)
    return [*others, *(static or [Section(SectionKind.STATIC, ())])] if sections else others


def recursive_types(found: Iterable[Block]) -> Iterator[Diagnostic]:
    """PG807 for every type that contains itself by value, at the member that closes the circle."""
    by_name = {block.name.upper(): block for block in found if block.kind in {BlockKind.UDT, BlockKind.FB}}
    for circle, member in circles({name: _uses(block) for name, block in by_name.items()}):
        message = "a type must not contain itself: " + " -> ".join(by_name[name].name for name in circle)
        yield Diagnostic("PG807", message, member.span or Span(""), help="use a second type or an index")


def circles(uses: Mapping[str, Iterable[tuple[str, Where]]]) -> Iterator[tuple[list[str], Where]]:
    """Each circle of names that use each other, the first one again at its end, and where the use that closes it is.

    ``uses`` says which others a name uses, and where; a name that it does not have uses none.
    """
    state: dict[str, int] = {}
    for root, own in uses.items():
        stack = [(root, iter(own))] if root not in state else []
        state.setdefault(root, 1)
        while stack:
            name, rest = stack[-1]
            following = next(rest, None)
            if following is None:
                state[name] = 2
                stack.pop()
                continue
            used, place = following
            if state.get(used) == 1:
                names = [name for name, _ in stack]
                yield [*names[names.index(used) :], used], place
            elif used in uses and used not in state:
                state[used] = 1
                stack.append((used, iter(uses[used])))


def _uses(block: Block) -> Iterator[tuple[str, Member]]:
    """Members of named types that lie inside the memory of a block, behind the upper-case type name."""
    inside = {SectionKind.INPUT, SectionKind.OUTPUT, SectionKind.STATIC}
    for member in nested(m for s in block.sections if s.kind in inside for m in s.members):
        inner = innermost(member.type)
        if isinstance(inner, NamedType):
            yield inner.name.upper(), member
