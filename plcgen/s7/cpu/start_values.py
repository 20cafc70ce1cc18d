"""Start values that name a constant of the block: ``state : Int := #IDLE``; what a warm restart leaves."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import replace

from plcgen.base.diagnostics import Diagnostic, Span
from plcgen.s7.cpu.linkage import Linkage, ProgramBlock
from plcgen.s7.scl.constants import evaluate, filled, integer, is_bits_of_real, real_of_bits
from plcgen.s7.scl.dialect import Dialect
from plcgen.s7.scl.parser import parse_value
from plcgen.s7.types.blocks import Assignment, Block, Section, SectionKind
from plcgen.s7.types.data_types import Elementary, Member, StringType, StructType
from plcgen.s7.types.literals import LiteralError, parse_literal

_NAMED = re.compile(r"""[#"]?[^\W\d]\w*"?(?!#)(?:\s*[-+*/].*)?|.*[-+*/]\s*[#"]?[^\W\d]\w*"?""")
_APART = re.compile(r"[-+]\s+[0-9][0-9.eE_]*")
"""A number with a blank behind its sign."""
_NAME_IN_LIST = re.compile(r'(?:"[^"]+"|(?<!\w)#\w+)(?!\s*:=)')
"""A constant in ``["A", #B]`` or ``(#A, (), m := "B")``; ``"m" :=`` names a member."""
_WORDS = frozenset({"TRUE", "FALSE", "NULL", "NIL"})


def with_constants(block: Block, project: Mapping[str, str], dialect: Dialect) -> tuple[Block, list[Diagnostic]]:
    """The block with every start value written out; PG827 for a constant whose value stands elsewhere.

    ``project`` has the literals of the constants that are not of the block, by upper-case name.
    """
    if dialect.is_tia:
        block = replace(block, sections=tuple(_signed(section) for section in block.sections))
    texts = {f'"{name}"': literal for name, literal in project.items()}
    numbers = {name: value for name, text in texts.items() if (value := integer(text)) is not None}
    for member in block.section(SectionKind.CONSTANT):
        _add_constant(member, texts, numbers)
    found: list[Diagnostic] = []
    sections = tuple(
        section
        if section.kind is SectionKind.CONSTANT
        else Section(
            section.kind, tuple(_written_out(m, texts, numbers, found) for m in section.members), section.retain
        )
        for section in block.sections
    )
    assigned = (_assigned(assignment, texts, numbers, found) for assignment in block.assignments)
    assignments = tuple(assignment for assignment in assigned if assignment is not None)
    same = sections == block.sections and assignments == block.assignments
    return (block if same else replace(block, sections=sections, assignments=assignments)), found


def _assigned(
    assignment: Assignment, texts: dict[str, str], numbers: dict[str, int], found: list[Diagnostic]
) -> Assignment | None:
    """A line of a DB's BEGIN part with the value of the constants in it; None if nobody here knows it."""
    given = Member("", StringType("STRING", 1), assignment.literal, span=assignment.span)
    literal = _written_out(given, texts, numbers, found).start
    return None if literal is None else replace(assignment, literal=literal)


def _add_constant(member: Member, texts: dict[str, str], numbers: dict[str, int]) -> None:
    """Keep the value of a constant of the block; one without a value has the default of its type, an empty text."""
    name, text = member.name.upper(), (member.start or "").strip()
    value = 0 if not text else _number(text, numbers)
    if value is not None:
        numbers[name] = value
    named = _literal(text, texts) if text else ""
    texts[name] = named if named is not None else (str(value) if value is not None and _is_named(text) else text)


def _is_named(text: str) -> bool:
    """Whether a start value may name a constant, alone or in an expression."""
    return bool(_NAMED.fullmatch(text)) and text.upper() not in _WORDS and "'" not in text


def _number(text: str, numbers: Mapping[str, int]) -> int | None:
    """Value of a whole number or of an expression of constants."""
    node = parse_value(text) if _is_named(text) else None
    return integer(text) if node is None else evaluate(node, numbers)


def unfit_constants(block: Block) -> Iterator[Diagnostic]:
    """PG824 for every constant of an elementary type or text whose literal does not fit; expressions are not judged."""
    for member in block.section(SectionKind.CONSTANT):
        text = (member.start or "").strip()
        if not text or not isinstance(member.type, Elementary | StringType) or _is_named(text):
            continue
        if is_bits_of_real(text, member.type.name):
            continue
        try:
            parse_literal(text, member.type)
        except LiteralError as error:
            yield Diagnostic("PG824", f"{member.name}: {error}", member.span or block.span or Span(""))


def _signed(section: Section) -> Section:
    """The section with numbers for constants that are bits: ``16#8401`` of an Int, ``16#7F7F_FFFF`` of a Real."""
    members = tuple(_with_sign(member) for member in section.members)
    return section if members == section.members else replace(section, members=members)


def _with_sign(member: Member) -> Member:
    if isinstance(member.type, StructType):
        members = tuple(map(_with_sign, member.type.members))
        return member if members == member.type.members else replace(member, type=StructType(members))
    if not isinstance(member.type, Elementary):
        return member
    name, text = member.type.name, member.start or ""
    number = real_of_bits(text, name) if name in {"REAL", "LREAL"} else filled(text, name)
    return member if number is None else replace(member, start=str(number))


def _written_out(member: Member, texts: dict[str, str], numbers: dict[str, int], found: list[Diagnostic]) -> Member:
    if isinstance(member.type, StructType):
        members = tuple(_written_out(inner, texts, numbers, found) for inner in member.type.members)
        member = replace(member, type=StructType(members)) if members != member.type.members else member
    text = (member.start or "").strip()
    if _APART.fullmatch(text):
        return replace(member, start="".join(text.split()))
    if text.startswith(("[", "(")) and "'" not in text:
        text = _NAME_IN_LIST.sub(lambda name: _in_list(name[0], texts), text)
        elsewhere = any(name[0].startswith('"') for name in _NAME_IN_LIST.finditer(text))
        return _elsewhere(member, text, found) if elsewhere else replace(member, start=text)
    if not _is_named(text):
        return member
    literal = _literal(text, texts)
    if literal is not None:
        return replace(member, start=literal or None)
    value = _number(text, numbers)
    if value is not None:
        return replace(member, start=str(value))
    return _elsewhere(member, text, found) if text.startswith('"') else member


def _literal(name: str, texts: Mapping[str, str]) -> str | None:
    """Literal of a constant, ``"N"`` of the project or ``#N`` of the block; empty for the default of its type."""
    found = texts.get(name.upper())
    return texts.get(name.strip('#"').upper()) if found is None else found


def _in_list(name: str, texts: Mapping[str, str]) -> str:
    literal = _literal(name, texts)
    return name if literal is None else literal


def _elsewhere(member: Member, text: str, found: list[Diagnostic]) -> Member:
    message = f"a constant in {text} is defined outside these sources"
    found.append(Diagnostic("PG827", message, member.span or Span("")))
    return replace(member, start=None)


def restart_block(memory: bytearray, image: bytes, entry: ProgramBlock, link: Linkage) -> None:
    """Give what is not retentive its start values: a NON_RETAIN block, or sections of others that are not RETAIN.

    In STEP 7 V5 every value of a data block stays unless the block is NON_RETAIN. Where sections speak of retentivity,
    those of the FB count for its instances.
    """
    declared = link.blocks.get(link.instance_type(entry), entry).block
    said = {section.retain for section in declared.sections}
    if not said & {"RETAIN", "NON_RETAIN"} or entry.shape is None:
        if entry.block.non_retain:
            memory[:] = image
        return
    lost = {
        id(member)
        for section in declared.sections
        if section.retain == "NON_RETAIN"
        or (section.retain != "RETAIN" and ("RETAIN" in said or entry.block.non_retain))
        for member in section.members
    }
    for field in entry.shape.fields:
        if id(field.member) not in lost:
            continue
        first, bit = divmod(field.offset, 8)
        if field.shape.bits < 8:
            mask = 1 << bit
            memory[first] = memory[first] & ~mask & 0xFF | image[first] & mask
        else:
            end = first + -(-field.shape.bits // 8)
            memory[first:end] = image[first:end]
