"""The Interface of a block: Sections and Members, with start values, comments, versions and views (AT)."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import lru_cache
from types import MappingProxyType

from plcgen.s7.types.blocks import Block, BlockKind, SectionKind, is_retentive
from plcgen.s7.types.data_types import (
    ArrayType,
    DataType,
    Elementary,
    Member,
    NamedType,
    StringType,
    StructType,
    innermost,
)
from plcgen.s7.xml.spelling import REMANENCE, attribute, content, datatype
from plcgen.s7.xml.writing.starts import Path, Starts, arrays

_INPUT, _OUTPUT, _IN_OUT = SectionKind.INPUT, SectionKind.OUTPUT, SectionKind.IN_OUT
_STATIC, _TEMP, _CONSTANT, _RETURN = SectionKind.STATIC, SectionKind.TEMP, SectionKind.CONSTANT, SectionKind.RETURN
SECTIONS = MappingProxyType(
    {
        "SW.Types.PlcStruct": (_STATIC,),
        "SW.Blocks.GlobalDB": (_STATIC,),
        "SW.Blocks.InstanceDB": (_INPUT, _OUTPUT, _IN_OUT, _STATIC),
        "SW.Blocks.FB": (_INPUT, _OUTPUT, _IN_OUT, _STATIC, _TEMP, _CONSTANT),
        "SW.Blocks.FC": (_INPUT, _OUTPUT, _IN_OUT, _TEMP, _CONSTANT, _RETURN),
        "SW.Blocks.OB": (_INPUT, _TEMP, _CONSTANT),
    }
)
"""Sections of every kind of object, in order; that of a type is called None."""

_BOOLEAN = frozenset({"ExternalAccessible", "ExternalVisible", "ExternalWritable", "SetPoint", "UserVisible"})
_RENAMED = {"S7_SetPoint": "SetPoint"}
_VERSIONED = {"DTL": "1.0"}
"""Types that always carry a version."""

_LEAVES = (Elementary, StringType)

PAD = "          "
"""Indentation of a Member."""

TextsOf = Callable[[str], tuple[tuple[str, str], ...]]
"""A text of a block by culture, in the order of the project's languages."""
"""Language of a comment; empty if there is no place for it."""


def section_names(kind: str, *, classic: bool) -> tuple[SectionKind, ...]:
    """Sections of an object; the OBs of S7-300/400 have no inputs."""
    found = SECTIONS[kind]
    return found[1:] if classic and kind == "SW.Blocks.OB" else found


def interface_element(
    block: Block, kind: str, namespace: str, texts: TextsOf, starts: Starts, names: Sequence[SectionKind]
) -> str:
    """The Interface attribute of an object with these sections, without the indentation of its first line."""
    lines = [f'<Interface><Sections xmlns="{namespace}">']
    for section in names:
        name = "None" if kind == "SW.Types.PlcStruct" else section.value
        body = "".join(_section(block, section, kind, texts, starts))
        if section is _RETURN and not body:
            body = f'{PAD}<Member Name="Ret_Val" Datatype="Void" />\n'
        lines.append(
            f'        <Section Name="{name}">\n{body}        </Section>'
            if body
            else f'        <Section Name="{name}" />'
        )
    lines.append("      </Sections></Interface>")
    return "\n".join(lines)


def _section(block: Block, section: SectionKind, kind: str, texts: TextsOf, starts: Starts) -> list[str]:
    values = kind != "SW.Types.PlcStruct" or block.kind is BlockKind.UDT
    whole = kind == "SW.Blocks.GlobalDB" and is_retentive(block)
    found = []
    for group in block.sections:
        if group.kind is section:
            said = "RETAIN" if whole else group.retain
            retain = "" if kind == "SW.Blocks.InstanceDB" else REMANENCE.get(said, "")
            found += [written_member(m, texts, starts if values else None, retain=retain) for m in group.members]
    return found


def written_member(
    declared: Member,
    texts: TextsOf,
    starts: Starts | None,
    path: Path = (),
    pad: str = PAD,
    *,
    around: Sequence[ArrayType] = (),
    retain: str = "",
) -> str:
    """One Member with everything inside, a line each; ``around`` are the arrays that it lies in."""
    simple = declared.start is None or declared.start[0] not in "[("
    if simple and not path and isinstance(declared.type, _LEAVES) and (starts is None or not starts.assigned):
        start = declared.start if starts is not None else None
        return _leaf(
            declared.name,
            declared.type,
            start,
            declared.comment,
            declared.at,
            declared.attributes,
            texts(declared.comment),
            retain=retain,
        )
    return _member(declared, texts, starts, path, pad, around, retain=retain)


@lru_cache(maxsize=16384)
def _leaf(
    name: str,
    type_: DataType,
    start: str | None,
    comment: str,
    at: str | None,
    attributes: tuple[tuple[str, str], ...],
    texts: tuple[tuple[str, str], ...],
    *,
    retain: str,
) -> str:
    """A member without members: the same ones occur in block after block."""
    declared = Member(name, type_, start, comment, at, None, attributes)
    return _member(declared, lambda _: texts, Starts(), (), PAD, (), retain=retain)


def _member(
    declared: Member,
    texts: TextsOf,
    starts: Starts | None,
    path: Path,
    pad: str,
    around: Sequence[ArrayType],
    *,
    retain: str,
) -> str:
    name = declared.name
    here = (*path, name.upper())
    if starts is not None:
        starts.declare(declared, here, around)
    version, pairs = _attributes(declared)
    head = f'{pad}<Member Name="{attribute(name)}" Datatype="{attribute(datatype(declared.type))}"'
    head += f' Version="{attribute(version)}"' if version else ""
    head += f' Remanence="{retain}"' if retain else ""
    inner = pad + "  "
    parts = _attribute_list(declared, pairs, inner)
    found = texts(declared.comment) if declared.comment else ()
    if found:
        items = (f'<MultiLanguageText Lang="{name}">{content(text)}</MultiLanguageText>' for name, text in found)
        lines = "".join(f"{inner}  {item}\n" for item in items)
        parts.append(f"{inner}<Comment>\n{lines}{inner}</Comment>\n")
    element = innermost(declared.type)
    if isinstance(element, StructType):
        around = (*around, *arrays(declared.type))
        parts += [written_member(m, texts, starts, here, inner, around=around) for m in element.members]
    elif isinstance(element, NamedType) and starts is not None and starts.below(here):
        parts.append(_expanded(element, starts, here, inner))
    if starts is not None:
        parts += _values(starts.of(here), inner)
    if not parts:
        return head + " />\n"
    return f"{head}>\n{''.join(parts)}{pad}</Member>\n"


def _attributes(declared: Member) -> tuple[str, list[tuple[str, str]]]:
    """Version of the type, and the other attributes of a declaration."""
    pairs = dict(declared.attributes)
    element = innermost(declared.type)
    name = datatype(element)
    version = pairs.pop("LibVersion", "") or _VERSIONED.get(name, "")
    pairs.pop("InstructionName", None)
    return version, list(pairs.items())


def _attribute_list(declared: Member, pairs: Sequence[tuple[str, str]], pad: str) -> list[str]:
    lines = []
    for spelling, value in pairs:
        name = _RENAMED.get(spelling, spelling)
        if name in _BOOLEAN:
            text = f'<BooleanAttribute Name="{name}" SystemDefined="true">{value.lower()}</BooleanAttribute>'
        else:
            text = f'<StringAttribute Name="{attribute(name)}">{content(value)}</StringAttribute>'
        lines.append(f"{pad}  {text}\n")
    if declared.at is not None:
        lines.append(
            f'{pad}  <StringAttribute Name="At" SystemDefined="true">{content(declared.at)}</StringAttribute>\n'
        )
    return [f"{pad}<AttributeList>\n{''.join(lines)}{pad}</AttributeList>\n"] if lines else []


def _values(entries: dict[str, str], pad: str) -> list[str]:
    """Start value, or one Subelement per array element: the indices of all arrays around it, joined by commas."""
    lines = []
    for index, literal in entries.items():
        value = f"<StartValue>{content(literal)}</StartValue>\n"
        if index:
            path = attribute(index.replace(";", ","))
            lines.append(f'{pad}<Subelement Path="{path}">\n{pad}  {value}{pad}</Subelement>\n')
        else:
            lines.append(f"{pad}{value}")
    return lines


def _expanded(type_: DataType, starts: Starts, path: Path, pad: str) -> str:
    """Members of a user type or of a function block that have a start value of their own here."""
    parts = []
    for name, members in starts.sections(type_):
        lines = "".join(_with_starts(members, starts, path, pad + "    "))
        head = f'{pad}  <Section Name="{name}"'
        parts.append(f"{head}>\n{lines}{pad}  </Section>\n" if lines else f"{head} />\n")
    return f"{pad}<Sections>\n{''.join(parts)}{pad}</Sections>\n"


def _with_starts(members: Sequence[Member], starts: Starts, path: Path, pad: str) -> list[str]:
    """Those members; a STRUCT has its members in itself, only a user type has Sections."""
    lines = []
    for inner in members:
        here = (*path, inner.name.upper())
        below = starts.below(here)
        values = _values(starts.of(here), pad + "  ")
        if not values and not below:
            continue
        head = f'{pad}<Member Name="{attribute(inner.name)}" Datatype="{attribute(datatype(inner.type))}">\n'
        deeper = ""
        if below:
            element = innermost(inner.type)
            if isinstance(element, StructType):
                deeper = "".join(_with_starts(element.members, starts, here, pad + "  "))
            else:
                deeper = _expanded(element, starts, here, pad + "  ")
        lines.append(f"{head}{deeper}{''.join(values)}{pad}</Member>\n")
    return lines
