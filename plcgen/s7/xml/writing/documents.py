"""Whole documents of types and blocks, as genuine exports have them: the envelope, the Interface, the code.

IDs count up in hexadecimal in document order; the attributes of an object are in alphabetical order.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from types import MappingProxyType
from typing import TYPE_CHECKING

from plcgen.s7.types.blocks import Block, BlockKind, SectionKind, is_optimized, is_retentive
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
from plcgen.s7.types.system import system_block
from plcgen.s7.xml.spelling import REMANENCE, attribute, content, datatype
from plcgen.s7.xml.writing.elements import is_system
from plcgen.s7.xml.writing.starts import Path, Starts, arrays

if TYPE_CHECKING:
    from plcgen.s7.xml.spelling import Version

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
    version, pairs = _member_attributes(declared)
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


def _member_attributes(declared: Member) -> tuple[str, list[tuple[str, str]]]:
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


HEADER = {"AUTHOR": "HeaderAuthor", "FAMILY": "HeaderFamily", "NAME": "HeaderName", "VERSION": "HeaderVersion"}
"""Header lines of a source and the attributes of the same meaning."""

_STRUCTURES = "IEC_"
"""Names of timers and counters that are types: their data blocks have static members only."""

SEEN_BY_OPC_UA = "DBAccessibleFromOPCUA"
"""An attribute of data blocks whose default is true; sources of the TIA Portal call it DB_Accessible_From_OPC_UA."""

INSTRUCTION, LIBRARY_VERSION = "InstructionName", "LibVersion"
"""What stands in braces at an instance of a library block."""

_EVENTS = (
    (range(1, 2), "ProgramCycle"), (range(10, 18), "TimeOfDay"), (range(20, 24), "TimeDelayInterrupt"),
    (range(30, 39), "CyclicInterrupt"), (range(40, 48), "HardwareInterrupt"), (range(80, 81), "TimeErrorInterrupt"),
    (range(82, 83), "DiagnosticErrorInterrupt"), (range(83, 84), "PullOrPlugOfModules"),
    (range(86, 87), "RackOrStationFailure"), (range(100, 103), "Startup"), (range(121, 122), "ProgrammingError"),
    (range(122, 123), "IOAccessError"),
)  # fmt: skip
"""Event class by OB number (STEP 7 manual, organization blocks)."""


@dataclass(frozen=True, slots=True)
class Setting:
    """What a document depends on besides its block: version, CPU family, languages.

    ``cultures`` are those of the project; ``texts`` gives a text of a block in those that have it; a text that none has
    is left out (None: all texts are in the first culture).
    """

    version: Version
    classic: bool
    cultures: tuple[str, ...] = ("en-US",)
    texts: TextsOf | None = None

    def texts_of(self, text: str) -> tuple[tuple[str, str], ...]:
        """A text of a block by culture; empty if the project has no place for it."""
        return ((self.cultures[0], text),) if self.texts is None else self.texts(text)


class _Ids:
    def __init__(self) -> None:
        self.next = 0

    def __call__(self) -> str:
        self.next += 1
        return f"{self.next - 1:X}"


def _kind_of(block: Block) -> str:
    """Tag of the object that a block becomes."""
    if block.kind is BlockKind.UDT:
        return "SW.Types.PlcStruct"
    if block.kind is BlockKind.DB:
        return "SW.Blocks.InstanceDB" if block.instance_of else "SW.Blocks.GlobalDB"
    return f"SW.Blocks.{block.kind.value}"


def document(
    block: Block, setting: Setting, code: str = "", types: Mapping[str, Block] | None = None
) -> tuple[str, list[str]]:
    """Text of the document and what of the block it cannot hold.

    ``code`` are the numbered elements of StructuredText; ``types`` are the known types and FBs by upper-case
    name, for start values inside user types.
    """
    kind = _kind_of(block)
    starts = Starts(types)
    for assignment in block.assignments:
        starts.assign(assignment.path, assignment.literal, block.members)
    of = _made_from(block, types or {})
    names = section_names(kind, classic=setting.classic)
    if (of is not None and of.kind is BlockKind.UDT) or library_element(block).upper().startswith(_STRUCTURES):
        names = section_names("SW.Blocks.GlobalDB", classic=setting.classic)
    interface = interface_element(block, kind, setting.version.interface_namespace, setting.texts_of, starts, names)
    attributes = _attributes(block, kind, setting, interface, of)
    ids = _Ids()
    head = ids()
    body = _texts(block, kind, setting, code, ids)
    lines = [f"      {line}\n" for line in attributes]
    return (
        '<?xml version="1.0" encoding="utf-8"?>\n<Document>\n'
        f'  <Engineering version="{setting.version.name}" />\n'
        f'  <{kind} ID="{head}">\n    <AttributeList>\n{"".join(lines)}    </AttributeList>\n'
        f"{body}  </{kind}>\n</Document>\n"
    ), starts.lost


def library_element(block: Block) -> str:
    """What an instance DB of a block of the CPU or of a library is made from; empty for one of the user's."""
    of = block.instance_of or ""
    return block.attributes.get(INSTRUCTION) or (of if is_system(of) else "")


def _made_from(block: Block, types: Mapping[str, Block]) -> Block | None:
    """The type or function block of an instance DB, if it is known."""
    of = block.instance_of or ""
    return types.get(of.upper()) or system_block(library_element(block) or of)


def _attributes(block: Block, kind: str, setting: Setting, interface: str, of: Block | None) -> list[str]:
    """Attributes in alphabetical order."""
    code = kind in {"SW.Blocks.FB", "SW.Blocks.FC", "SW.Blocks.OB"}
    texts = {"Name": block.name}
    if kind == "SW.Types.PlcStruct":
        if setting.version.has_type_namespace:
            texts["Namespace"] = ""
    else:
        texts["AutoNumber"] = "false" if block.number is not None else "true"
        texts["Number"] = str(1 if block.number is None else block.number)
        texts["ProgrammingLanguage"] = "SCL" if code else "DB"
        for key, name in HEADER.items():
            if block.attributes.get(key):
                texts[name] = block.attributes[key]
    spelt = {name.replace("_", "").upper(): value for name, value in block.attributes.items()}
    if block.kind is BlockKind.DB and spelt.get(SEEN_BY_OPC_UA.upper(), "").lower() == "false":
        texts[SEEN_BY_OPC_UA] = "false"
    if not setting.classic and kind not in {"SW.Types.PlcStruct", "SW.Blocks.InstanceDB"}:
        texts["MemoryLayout"] = "Optimized" if is_optimized(block, {}, classic=False) else "Standard"
    if code and not setting.classic:
        texts["SetENOAutomatically"] = "false"
    if kind == "SW.Blocks.OB":
        texts["SecondaryType"] = block.attributes.get("SecondaryType") or next(
            (name for numbers, name in _EVENTS if block.number in numbers), "ProgramCycle"
        )
    if block.instance_of is not None:
        texts |= _instance(block, of)
        own_access = "InstanceOfType" not in texts or texts["InstanceOfType"] == "UDT"
        if own_access and block.optimized is not None and not setting.classic:
            texts["MemoryLayout"] = "Optimized" if block.optimized else "Standard"
    found = {name: f"<{name}>{content(text)}</{name}>" if text else f"<{name} />" for name, text in texts.items()}
    found["Interface"] = interface
    return [found[name] for name in sorted(found)]


def _instance(block: Block, of: Block | None) -> dict[str, str]:
    """What an instance DB is made from: a block of the user's with its kind, one of a library with its version."""
    texts, element = {"InstanceOfName": block.instance_of or ""}, library_element(block)
    if not element:
        return texts | {"InstanceOfType": "UDT" if of is not None and of.kind is BlockKind.UDT else "FB"}
    texts["OfSystemLibElement"] = element
    if block.attributes.get(LIBRARY_VERSION):
        texts["OfSystemLibVersion"] = block.attributes[LIBRARY_VERSION]
    return texts


def _texts(block: Block, kind: str, setting: Setting, code: str, ids: _Ids) -> str:
    """ObjectList: Comment, the network, Title."""
    title = block.title
    parts = [_text("Comment", block.comment, setting, ids, "      ")]
    if kind in {"SW.Blocks.FB", "SW.Blocks.FC", "SW.Blocks.OB"}:
        unit = ids()
        network = f'<StructuredText xmlns="{setting.version.text_namespace}">\n{code}</StructuredText>' if code else ""
        source = f"<NetworkSource>{network}</NetworkSource>" if network else "<NetworkSource />"
        inner = _text("Comment", "", setting, ids, " " * 10) + _text("Title", "", setting, ids, " " * 10)
        parts.append(
            f'      <SW.Blocks.CompileUnit ID="{unit}" CompositionName="CompileUnits">\n        <AttributeList>\n'
            f"          {source}\n          <ProgrammingLanguage>SCL</ProgrammingLanguage>\n        </AttributeList>\n"
            f"        <ObjectList>\n{inner}        </ObjectList>\n      </SW.Blocks.CompileUnit>\n"
        )
    parts.append(_text("Title", title, setting, ids, "      "))
    return f"    <ObjectList>\n{''.join(parts)}    </ObjectList>\n"


def _text(name: str, text: str, setting: Setting, ids: _Ids, pad: str) -> str:
    """A MultilingualText: ``text`` in the languages that have it, the others empty."""
    head = f'{pad}<MultilingualText ID="{ids()}" CompositionName="{name}">\n{pad}  <ObjectList>\n'
    items = []
    texts = dict(setting.texts_of(text)) if text else {}
    for culture in setting.cultures:
        shown = f"<Text>{content(texts[culture])}</Text>" if culture in texts else "<Text />"
        items.append(
            f'{pad}    <MultilingualTextItem ID="{ids()}" CompositionName="Items">\n{pad}      <AttributeList>\n'
            f"{pad}        <Culture>{culture}</Culture>\n{pad}        {shown}\n"
            f"{pad}      </AttributeList>\n{pad}    </MultilingualTextItem>\n"
        )
    return f"{head}{''.join(items)}{pad}  </ObjectList>\n{pad}</MultilingualText>\n"
