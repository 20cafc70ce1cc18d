"""The Interface part of a SimaticML document: Sections and Members to the block model."""

from __future__ import annotations

import math
import re
from collections import Counter
from dataclasses import dataclass, field, replace
from functools import lru_cache
from itertools import islice
from typing import TYPE_CHECKING, Any, NamedTuple

from plcgen.base.diagnostics import Diagnostic, Note, Severity, Span
from plcgen.s7.types.blocks import Assignment, Block, BlockKind, Section, SectionKind
from plcgen.s7.types.data_types import ArrayType, DataType, Elementary, Member, NamedType, StructType, innermost
from plcgen.s7.types.literals import LiteralError, parse_literal
from plcgen.s7.types.names import is_identifier
from plcgen.s7.xml.reading.types import (
    SINGLE,
    checked_datatype,
    has_constants,
    is_start_value,
    parse_datatype,
    unfit,
    with_values,
)
from plcgen.s7.xml.reading.xml import TAGS, child, children, namespace, parts, span, text
from plcgen.s7.xml.spelling import REMANENCE, datatype, declared_name, default_literal

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence

    from lxml.etree import _Element as Element

NAMESPACE = "http://www.siemens.com/automation/Openness/SW/Interface/v"
VERSIONS = frozenset({"2", "3", "4", "5"})
"""Known versions of the Interface namespace: V14 SP1 to V21."""

MAX_DEPTH = 64
MAX_LISTED = 10_000
MAX_DUPLICATES = 10
"""So many members of one structure with the name of another one are named one by one."""

LOOK_BACK = 1024
"""After so many members reading ends if more than those of them have the same names."""

MAX_PROBLEMS = 1000
"""Problems of one document that are told."""

Bounds = tuple[tuple[int, int], ...]
Steps = tuple[tuple[str, Bounds | None], ...]
"""The way to a member: names, and the bounds of the arrays that each is, None if nobody knows them."""

_INHERITED = frozenset({"Base"})
"""What a GRAPH block takes over from its base type, which has no memory of its own."""

_CONSTANT_HELP = "name the tag table with the constant, or the folder of the PLC"
_SECTIONS = {kind.value: kind for kind in SectionKind} | {"None": SectionKind.STATIC}
_RETAIN = {remanence: word for word, remanence in REMANENCE.items()}
_INDEX = re.compile(r"\s*-?[0-9]{1,10}\s*").fullmatch


class _Single(NamedTuple):
    """Start value of one element: its indices in all arrays around, the value, where it stands."""

    indices: tuple[str, ...]
    literal: str
    element: Element


@dataclass(slots=True)
class InterfaceReader:
    """Reads the sections of one block; start values inside arrays and other types become assignments.

    ``constants`` are the known ones by upper-case name, for bounds and lengths. ``whole`` says that the document writes
    used types out with all their members: then ``inline`` has them.
    """

    file: str
    diagnostics: list[Diagnostic]
    assignments: list[Assignment] = field(default_factory=list)
    constants: Mapping[str, int | None] = field(default_factory=dict)
    whole: bool = False
    inline: dict[str, Block] = field(default_factory=dict)
    culture: str = ""
    """The language in which comments are wanted."""
    types: dict[str, DataType] = field(default_factory=dict)
    """Types by their spelling in this block."""

    def sections(self, interface: Element) -> tuple[Section, ...]:
        """All sections below an Interface element, in document order."""
        root = child(interface, "Sections")
        if root is None:
            self.report("the Interface has no Sections", interface)
            return ()
        uri = namespace(root)
        if not uri.startswith(NAMESPACE) or uri.removeprefix(NAMESPACE) not in VERSIONS:
            self.report(f"unknown Interface namespace {uri or '(none)'}", root)
        self.constants = {**self.constants, **_own_constants(root)}
        found = []
        for section in children(root, "Section"):
            name = section.get("Name", "")
            if name in _INHERITED:
                continue
            kind = _SECTIONS.get(name)
            if kind is None:
                self.report(f"unknown section {name or '(no Name)'}", section)
                continue
            found += self.groups(section, kind)
        self.duplicates([m for section in found for m in section.members])
        return tuple(found)

    def duplicates(self, members: Sequence[Member]) -> None:
        """PG805: names are unique within a block and within a structure, whatever their case."""
        if len({m.name.upper() for m in members}) == len(members):
            return
        first: dict[str, Member] = {}
        again = [m for m in members if first.setdefault(m.name.upper(), m) is not m]
        more = f", as are {len(again) - 1} more members" if len(again) > MAX_DUPLICATES else ""
        for member in again[:1] if more else again:
            known = first[member.name.upper()]
            notes = (Note("first declared here", known.span),) if known.span else ()
            message, place = f'"{member.name}" is declared twice{more}', member.span or Span(self.file)
            self.diagnostics.append(Diagnostic("PG805", message, place, notes=notes))

    def groups(self, section: Element, kind: SectionKind, depth: int = 0) -> list[Section]:
        """Members of one section; a source declares retentive ones in a section of their own, with their views."""
        groups: list[tuple[str, list[Member]]] = []
        above = (("", ()),) * depth
        for element in section.iterchildren("{*}Member"):
            member = self.member(element, above)
            if member is None:
                continue
            retain = _RETAIN.get(element.get("Remanence", ""), "")
            if not groups or (groups[-1][0] != retain and member.at is None):
                groups.append((retain, []))
            last = groups[-1][1]
            last.append(member)
            if not len(last) % LOOK_BACK:
                names = {m.name.upper() for m in last[-LOOK_BACK:]}
                if len(names) < LOOK_BACK - MAX_DUPLICATES:
                    break
        return [Section(kind, tuple(members), retain) for retain, members in groups or [("", [])]]

    def member(self, element: Element, parents: Steps) -> Member | None:
        """One Member; ``parents`` are the members above it."""
        name, spelling = element.get("Name"), element.get("Datatype")
        if not name or not spelling:
            self.report(f"a Member needs the attribute {'Datatype' if name else 'Name'}", element)
            return None
        if len(parents) >= MAX_DEPTH:
            self.report(f"{name}: nested more than {MAX_DEPTH} levels deep", element)
            return None
        type_ = self.types.get(spelling) or self.data_type(name, spelling, element)
        if type_ is None:
            return None
        line: Any = element.sourceline
        place = Span(self.file, line or 1, 1)
        version = element.get("Version")
        if not version and not len(element):
            return Member(name, type_, None, "", None, place)
        comment = ""
        literal: str | None = None
        listed: Element | None = None
        rest: dict[str, list[Element]] = {}
        tags = TAGS
        for sub in element:
            tag = tags[sub.tag]
            if tag == "Comment":
                comment = comment or _one_text(sub, self.culture)
            elif tag == "StartValue":
                plain = sub.text  # nearly every value is one word; a look at it is cheaper than a call
                literal = literal or (plain if plain and SINGLE(plain) else self.value(sub))
            elif tag == "AttributeList":
                listed = sub
            else:
                rest.setdefault(tag, []).append(sub)
        if literal and unfit(literal, type_):
            self.misfit(literal, type_, element)
            literal = None
        if rest or not isinstance(type_, Elementary):
            type_, literal = self.inside(type_, literal, rest, (*parents, (name, _bounds(type_))))
        at, attributes = _attributes(version, listed, type_) if version or listed is not None else (None, ())
        return Member(name, type_, literal, comment, at, place, attributes)

    def data_type(self, name: str, spelling: str, element: Element) -> DataType | None:
        """Type of a member, with the values of constants; one that is not known is a warning, as in texts."""
        spelled, unknown = with_values(spelling, self.constants) if has_constants(spelling) else (spelling, "")
        type_, wrong = checked_datatype(spelled)
        if wrong:
            self.report(f"{name}: {wrong}", element)
            return None
        if unknown:
            message = f"the constant {unknown} is defined outside this document"
            place = span(element, self.file)
            self.diagnostics.append(Diagnostic("PG806", message, place, Severity.WARNING, help=_CONSTANT_HELP))
        elif type_ is not None:
            self.types[spelling] = type_
        return type_

    def inside(
        self,
        type_: DataType,
        literal: str | None,
        rest: dict[str, list[Element]],
        path: Steps,
    ) -> tuple[DataType, str | None]:
        """Type with its members, and start value with those of single elements."""
        found = [self.member(m, path) for m in rest.get("Member", ())]
        members = [m for m in found if m is not None]
        type_ = _with_members(type_, tuple(members))
        self.duplicates(members)
        if "Sections" in rest:
            if self.whole:
                self._written_out(innermost(type_), rest["Sections"], len(path))
            self._expanded(rest["Sections"], path)
        if "Subelement" in rest:
            single = list(self._singles(rest["Subelement"], type_, path))
            own = _bounds(type_)
            if own and isinstance(type_, ArrayType) and not isinstance(type_.element, ArrayType) and literal is None:
                literal = self._listed(single, type_, path)
            else:
                self._assigned(single, path)
        return type_, literal

    def _written_out(self, type_: DataType, groups: Sequence[Element], depth: int) -> None:
        """Keep the type that a document writes out at a member, and those inside; start values are the member's."""
        if not isinstance(type_, NamedType) or type_.name.upper() in self.inline or depth >= MAX_DEPTH:
            return
        sections = [part for group in groups for part in children(group, "Section")]
        if not any(len(part) for part in sections):
            return
        self.inline[type_.name.upper()] = Block(BlockKind.UDT, type_.name, ())  # it may be inside itself
        problems: list[Diagnostic] = []
        reader = InterfaceReader(
            self.file, problems, constants=self.constants, whole=True, inline=self.inline, culture=self.culture
        )
        named = [(part.get("Name", ""), part) for part in sections if part.get("Name") not in _INHERITED]
        found = [s for name, part in named if name in _SECTIONS for s in reader.groups(part, _SECTIONS[name], depth)]
        self.diagnostics += [p for p in problems if p.code == "PG806"]  # the rest is said at the type's own document
        kind = BlockKind.UDT if all(name == "None" for name, _ in named) else BlockKind.FB
        place = span(groups[0], self.file)
        self.inline[type_.name.upper()] = Block(kind, type_.name, tuple(found), span=place)

    def value(self, element: Element) -> str | None:
        """Text of a StartValue; None if it is empty, or no value at all."""
        found = (element.text or "").strip()
        if found and not (SINGLE(found) or is_start_value(found)):
            self.report(f"{found[:40]} is not a start value", element)
            return None
        return found or None

    def misfit(self, literal: str, type_: DataType, element: Element) -> None:
        """Report a start value that does not fit the type."""
        reason = unfit(literal, type_)
        self.report(f"{literal[:40]} is no start value of {datatype(type_)}: {reason}", element)

    def _expanded(self, groups: Sequence[Element], path: Steps) -> None:
        """Start values of the members of a type, the user's or the system's, written out below Sections."""
        if len(path) >= MAX_DEPTH:
            self.report("nested too deeply", groups[0])
            return
        for sections in groups:
            for section in sections.iterchildren("{*}Section"):
                for inner in section.iterchildren("{*}Member"):
                    self._expanded_member(inner, path)

    def _expanded_member(self, element: Element, parents: Steps) -> None:
        if not len(element):
            return
        name, type_ = element.get("Name"), parse_datatype(element.get("Datatype", ""))
        if not name or type_ is None or len(parents) >= MAX_DEPTH:
            return
        path = (*parents, (name, _bounds(type_)))
        inside = parts(element)
        start = inside.get("StartValue")
        literal = self.value(start[0]) if start else None
        if literal and unfit(literal, type_):
            self.misfit(literal, type_, element)
            literal = None
        if literal and not any(bounds != () for _, bounds in path):
            self._assign(path, (), literal, element)
        self._assigned(self._singles(inside.get("Subelement", ()), type_, path), path)
        for inner in inside.get("Member", ()):
            self._expanded_member(inner, path)
        if "Sections" in inside:
            self._expanded(inside["Sections"], path)

    def _singles(self, found: Sequence[Element], type_: DataType, path: Steps) -> Iterator[_Single]:
        """Start values of single elements: a Path has the indices of all arrays from the outermost in."""
        around = [bounds for _, bounds in path if bounds is not None]
        expected, element = sum(map(len, around)), innermost(type_)
        for sub in found:
            start = sub[0] if len(sub) == 1 and TAGS[sub[0].tag] == "StartValue" else child(sub, "StartValue")
            plain = None if start is None else start.text
            literal = plain if plain and SINGLE(plain) else None if start is None else self.value(start)
            if not literal or len(around) < len(path):
                continue
            indices = tuple(sub.get("Path", "").replace(";", ",").split(","))
            if unfit(literal, element):
                self.misfit(literal, element, sub)
                continue
            if len(indices) != expected:
                self.report(f"Subelement Path {sub.get('Path')} does not fit the arrays of {path[-1][0]}", sub)
                continue
            yield _Single(indices, literal, sub)

    def _assigned(self, found: Iterable[_Single], path: Steps) -> None:
        for single in found:
            self._assign(path, single.indices, single.literal, single.element)

    def _assign(self, path: Steps, indices: Sequence[str], literal: str, at: Element) -> None:
        left = iter(indices)
        places = (f"[{','.join(islice(left, len(bounds)))}]" if bounds else "" for _, bounds in path)
        steps = (declared_name(name) + place for (name, _), place in zip(path, places, strict=True))
        self.assignments.append(Assignment(".".join(steps), literal, span(at, self.file)))

    def _listed(self, found: Sequence[_Single], type_: ArrayType, path: Steps) -> str | None:
        """Start values of single elements as one list ``[1, 0, 3]``; what is no list becomes assignments.

        An array inside of arrays has a list if each of its elements there has values; of different ones the most
        frequent counts, and what the others have instead is assigned. Too many gaps are no list.
        """
        around = tuple(pair for _, bounds in path[:-1] for pair in bounds or ())
        size = math.prod(high - low + 1 for low, high in type_.bounds)
        lists: dict[int, dict[int, _Single]] = {}
        for single in found:
            position = _position(single.indices, (*around, *type_.bounds))
            if position is None:
                indices = ",".join(single.indices)
                self.report(f"Subelement Path {indices} is outside the array {path[-1][0]}", single.element)
                continue
            lists.setdefault(position // size, {})[position % size] = single
        if not lists:
            return None
        length, elements = max(map(max, lists.values())) + 1, math.prod(high - low + 1 for low, high in around)
        gaps = length * elements - len(found)
        if length > MAX_LISTED or len(lists) < elements or gaps > MAX_LISTED:
            self._assigned(found, path)
            return None
        default = default_literal(type_.element)
        written = [[v[n].literal if n in v else default for n in range(length)] for v in lists.values()]
        usual = Counter(map(tuple, written)).most_common(1)[0][0]
        others = [v for v, values in zip(lists.values(), written, strict=True) if tuple(values) != usual]
        if any(n not in values and literal != default for values in others for n, literal in enumerate(usual)):
            self._assigned(found, path)
            return None
        self._assigned((s for v in others for n, s in sorted(v.items()) if s.literal != usual[n]), path)
        if length > 1 and len(set(usual)) == 1:
            return f"[{length}({usual[0]})]"
        return f"[{', '.join(usual)}]"

    def report(self, message: str, element: Element) -> None:
        """Add one PG812, up to a bound."""
        if len(self.diagnostics) >= MAX_PROBLEMS:
            return
        self.diagnostics.append(Diagnostic("PG812", message, span(element, self.file)))


def _one_text(comment: Element, culture: str) -> str:
    """The text of a comment in a language, otherwise the first; most have one, and a look is cheaper than a loop."""
    if len(comment) < 2:
        return (comment[0].text or "").strip() if len(comment) else ""
    found = [(item.get("Lang"), text) for item in comment if (text := (item.text or "").strip())]
    return next((text for language, text in found if language == culture), found[0][1] if found else "")


def _own_constants(root: Element) -> dict[str, int]:
    """Whole numbers among the constants that a block declares itself, by upper-case name with #."""
    found = {}
    for section in children(root, "Section"):
        if section.get("Name") == SectionKind.CONSTANT.value:
            for member in children(section, "Member"):
                number = whole_number(text(child(member, "StartValue")))
                if number is not None:
                    found[f"#{member.get('Name', '').upper()}"] = number
    return found


def whole_number(literal: str) -> int | None:
    """Value of a whole number as constants have it: ``10``, ``16#A``, ``INT#10``; None if it is no such number."""
    try:
        value = parse_literal(literal.strip(), "DINT")
    except LiteralError:
        return None
    return value if isinstance(value, int) and not isinstance(value, bool) else None


def _bounds(type_: DataType) -> Bounds | None:
    """Bounds of an array and of the arrays in it; empty if the type is none, None if nobody knows them."""
    found: Bounds = ()
    while isinstance(type_, ArrayType):
        if not type_.bounds:
            return None
        found, type_ = (*found, *type_.bounds), type_.element
    return found


def _position(indices: Sequence[str], bounds: Bounds) -> int | None:
    """Place of an element counted through its arrays, the last index fastest; None if it is outside."""
    if not all(map(_INDEX, indices)):
        return None
    position = 0
    for part, (low, high) in zip(indices, bounds, strict=True):
        if not low <= int(part) <= high:
            return None
        position = position * (high - low + 1) + int(part) - low
    return position


def _with_members(type_: DataType, members: tuple[Member, ...]) -> DataType:
    """Put the members into a Struct or an array of Struct."""
    if isinstance(type_, StructType):
        return StructType(members)
    if isinstance(type_, ArrayType):
        return replace(type_, element=_with_members(type_.element, members))
    return type_


def _attributes(
    version: str | None, listed: Element | None, type_: DataType
) -> tuple[str | None, tuple[tuple[str, str], ...]]:
    """What a view lies over, and attributes as a source has them in braces: the version of a library type first."""
    found: list[tuple[str, str]] = []
    at: str | None = None
    inner = innermost(type_)
    if version and isinstance(inner, NamedType) and not inner.quoted:
        found += [("InstructionName", inner.name), ("LibVersion", version)]
    for entry in () if listed is None else listed:
        name = entry.get("Name", "")
        if name == "At":
            at = text(entry).strip().strip('"') or None
        elif entry.get("Informative") != "true" and (pair := _attribute(TAGS[entry.tag], name, entry.text or "")):
            found.append(pair)
    return at, tuple(found)


@lru_cache(maxsize=4096)
def _attribute(kind: str, name: str, value: str) -> tuple[str, str] | None:
    """An attribute as sources have it, the same pair for every member that has it; None if its name is none there."""
    if not is_identifier(name):
        return None
    value = value.strip()
    return "S7_SetPoint" if name == "SetPoint" else name, value.capitalize() if kind == "BooleanAttribute" else value
