"""Sources to states: declarations, layout, start values and code of every block, in canonical spelling."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace

from plcgen.base.diagnostics import Diagnostic, DiagnosticError, Severity, Span
from plcgen.s7.compare.model import ADDRESS, TAG_TABLE, BlockState, MemberState, Snapshot, path_step
from plcgen.s7.compare.starts import array_start, instance_starts, literal_start, normalized, scalar_start
from plcgen.s7.layout.image import image
from plcgen.s7.layout.layout import layout_block
from plcgen.s7.layout.shapes import Shape
from plcgen.s7.read.blocks import SourceBlock, Sources
from plcgen.s7.types.blocks import Block, BlockKind, SectionKind, is_retentive
from plcgen.s7.types.data_types import Member, NamedType, StructType, innermost
from plcgen.s7.types.literals import LiteralError, type_text

_MEMORY = frozenset({BlockKind.DB, BlockKind.UDT, BlockKind.FB})
_LOCALS = frozenset({SectionKind.TEMP, SectionKind.CONSTANT})
_TEXTS = frozenset(
    {"AUTHOR", "FAMILY", "VERSION", "NAME", "HEADERAUTHOR", "HEADERFAMILY", "HEADERVERSION", "HEADERNAME"}
)
_IGNORED = frozenset({"PROGRAMMINGLANGUAGE", "AUTONUMBER", "NAMESPACE", "INSTANCEOFTYPE", "INSTANCEOFNUMBER"})


def snapshot_of(sources: Sources, label: str) -> Snapshot:
    """States of all blocks of the sources, sorted by kind and name; of several PLCs named ``PLC_1/Motor``."""
    snapshot = Snapshot(label, diagnostics=list(sources.diagnostics))
    for plc, part in (sources.parts or {"": sources}).items():
        for found in part.blocks:
            state = _State(found, part.types, snapshot.diagnostics).block()
            snapshot.blocks.append(replace(state, name=f"{plc}/{state.name}") if plc else state)
        for table in part.tables:
            # A tag table as a block: tags are members with an address, user constants with a value
            members = [
                MemberState(
                    tag.name, path_step(tag.name), tag.type, comment=tag.comment, span=tag.span,
                    attributes=((ADDRESS, tag.address.upper()),),
                )
                for tag in table.tags
            ]  # fmt: skip
            constants = [
                MemberState(one.name, path_step(one.name), one.type, start=one.value, span=one.span)
                for one in table.constants
            ]
            rows = (*members, *constants)
            state = BlockState(TAG_TABLE, table.name, members=rows, span=rows[0].span if rows else None)
            snapshot.blocks.append(replace(state, name=f"{plc}/{state.name}") if plc else state)
    snapshot.blocks.sort(key=lambda block: (block.kind, block.name.upper()))
    return snapshot


class _State:
    """One block with its layout and image, as far as they can be computed."""

    def __init__(self, found: SourceBlock, types: Mapping[str, Block], diagnostics: list[Diagnostic]) -> None:
        self.found = found
        self.source = found.block
        self.owner = types.get((self.source.instance_of or "").upper())
        self.shape: Shape | None = None
        self.size: int | None = None
        self.memory: bytes | None = None
        self.named: list[str] = []
        if self.source.kind not in _MEMORY:
            return
        try:
            layout = layout_block(self.source, types)
            self.shape, self.size = layout.shape, layout.size
        except DiagnosticError as problem:
            if self.owner is None:  # what an instance lacks is said of its function block
                diagnostics.append(_doubt(problem.diagnostics, self.source))
            return
        try:
            self.memory = bytes(image(self.source, types))
        except (LiteralError, DiagnosticError) as error:
            place = getattr(error, "span", None) or self.source.span or Span(found.file)
            message = f'{self.source.kind} "{self.source.name}": {error}'
            diagnostics.append(Diagnostic("PG630", message, place, Severity.WARNING, help=_AS_TEXT))

    def block(self) -> BlockState:
        """The complete state."""
        source = self.source
        texts = {"title": source.title, "comment": source.comment}
        attributes: dict[str, str] = {}
        for name, value in source.attributes.items():
            upper = name.upper()
            if upper in _TEXTS:
                texts[upper.removeprefix("HEADER").lower()] = value
            elif upper not in _IGNORED:
                attributes[name] = value
        declared = self.owner.sections if self.owner is not None and not source.sections else source.sections
        sections = {m.name.upper(): s.kind.value for s in declared for m in s.members}
        foreign = source.instance_of is not None
        members = self.members(sections, foreign=foreign)
        return BlockState(
            kind=source.kind.value,
            name=source.name,
            number=source.number,
            size=self.size,
            optimized=source.optimized,
            instance_of=source.instance_of or "",
            instance_kind="" if self.owner is None else self.owner.kind.value,
            non_retain=source.kind is BlockKind.DB and not is_retentive(source),
            texts=tuple(sorted((key, text) for key, text in texts.items() if text)),
            attributes=tuple(sorted(attributes.items())),
            members=members,
            locals=tuple(
                self.declared(m, s.kind.value, path_step(m.name))
                for s in source.sections
                if s.kind in _LOCALS
                for m in s.members
            ),
            assignments=self.assignments(foreign=foreign),
            code=self.found.code,
            code_hash=self.found.code.digest,
            span=source.span,
        )

    def attributes(self, path: str, member: Member) -> tuple[tuple[str, str], ...]:
        """What stands in braces at a member; a retentive block says it once, not at every member."""
        own = self.found.attributes.get(_plain(path), {})
        if "RETAIN" in own and is_retentive(self.source):
            own = {name: value for name, value in own.items() if name != "RETAIN"}
        spelt = {name.upper(): name for name, _ in member.attributes}
        return tuple((spelt.get(name, name), value) for name, value in sorted(own.items()))

    def assignments(self, *, foreign: bool) -> tuple[tuple[str, str], ...]:
        """BEGIN lines for what is declared elsewhere; those of own members are start values, if there is an image."""
        if foreign:
            return instance_starts(self.source, self.owner)
        pairs = tuple((_path(a.path), normalized(a.literal)) for a in self.source.assignments)
        if self.memory is None:
            return pairs
        inside = tuple(f"{path}." for path in self.named)
        return tuple(pair for pair in pairs if re.sub(r"\[[^\]]*\]", "", pair[0]).startswith(inside))

    def members(self, sections: Mapping[str, str], *, foreign: bool) -> tuple[MemberState, ...]:
        """Members with a place if the layout is known, else as declared."""
        if self.shape is not None:
            return tuple(
                self.laid(f.member, f.shape, f.offset, "", sections, foreign=foreign) for f in self.shape.fields
            )
        found = (
            m
            for s in self.source.sections
            if s.kind not in _LOCALS
            for m in s.members
            if not (isinstance(m.type, NamedType) and m.type.name.upper() == "VOID")
        )
        return tuple(self.declared(m, sections.get(m.name.upper(), ""), path_step(m.name)) for m in found)

    def laid(
        self, member: Member, shape: Shape, offset: int, prefix: str, sections: Mapping[str, str], *, foreign: bool
    ) -> MemberState:
        """One member at its place; the first element of an array stands for all of them."""
        path = f"{prefix}{path_step(member.name)}"
        element, inner_path = shape, path
        while element.element is not None:
            element, inner_path = element.element, f"{inner_path}[]"
        named = isinstance(innermost(member.type), NamedType)
        if named and not foreign:
            self.named.append(_plain(path))
        inner = tuple(
            self.laid(f.member, f.shape, offset + f.offset, f"{inner_path}.", {}, foreign=foreign or named)
            for f in element.fields
        )
        start = ""
        if not foreign and member.at is None:
            start = self.start(member, shape, offset)
        return MemberState(
            member.name, path, _type(member), sections.get(member.name.upper(), ""), offset, shape.bits, start,
            member.comment, self.attributes(path, member), inner, foreign, member.span,
        )  # fmt: skip

    def declared(self, member: Member, section: str, path: str) -> MemberState:
        """One member without a place."""
        type_ = innermost(member.type)
        inner: Iterable[Member] = type_.members if isinstance(type_, StructType) else ()
        children = tuple(self.declared(child, "", f"{path}.{path_step(child.name)}") for child in inner)
        return MemberState(
            member.name, path, _type(member), section, start=literal_start(member), comment=member.comment,
            attributes=self.attributes(path, member), inner=children, span=member.span,
        )  # fmt: skip

    def start(self, member: Member, shape: Shape, offset: int) -> str:
        """Canonical start value: from the image, so that every spelling of a value is the same."""
        if isinstance(innermost(shape.type), NamedType):  # single values are assignments
            return "" if self.memory is None else normalized(member.start or "")
        if isinstance(shape.type, StructType):
            return ""
        if self.memory is None:
            return literal_start(member)
        if shape.bits == 1:
            return "TRUE" if self.memory[offset // 8] >> offset % 8 & 1 else ""
        data = self.memory[offset // 8 : (offset + shape.bits) // 8]
        if shape.element is not None:
            return array_start(data, shape)
        return scalar_start(data, shape.type)


_AS_TEXT = "start values of this block are compared as text"


def _doubt(problems: Sequence[Diagnostic], block: Block) -> Diagnostic:
    """A layout that cannot be computed is no error here: the declarations are still compared."""
    first = problems[0]
    reasons = ", ".join(dict.fromkeys(problem.message for problem in problems[:4]))
    message = f'{block.kind} "{block.name}" is compared without offsets: {reasons}'
    help_ = first.help or "also name the files that declare the type"
    return Diagnostic("PG630", message, first.span, Severity.WARNING, help=help_)


def _type(member: Member) -> str:
    text = type_text(member.type)
    return f"{text} AT {member.at}" if member.at is not None else text


def _plain(path: str) -> str:
    """A path as attributes and start values have it."""
    return path.replace("[]", "").replace('"', "").upper()


def _path(path: str) -> str:
    return "".join(path.split()).replace('"', "").upper()
