"""SimaticML documents (TIA Portal Openness, V14 to V21) to blocks, tag tables, watch tables, attributes of members."""

from __future__ import annotations

import re
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from plcgen.base.diagnostics import Diagnostic, DiagnosticError, Severity, Span
from plcgen.s7.types.blocks import Block, BlockKind, Section, SectionKind, optimized
from plcgen.s7.types.data_types import ArrayType, Member
from plcgen.s7.xml.reading.interface import InterfaceReader
from plcgen.s7.xml.reading.structured_text import CodeReader
from plcgen.s7.xml.reading.types import parse_datatype
from plcgen.s7.xml.reading.xml import child, children, first_culture, load, local, multilingual, parse_xml, span, text
from plcgen.s7.xml.writing.documents import HEADER, INSTRUCTION, LIBRARY_VERSION

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Mapping
    from pathlib import Path

    from lxml.etree import _Element as Element

_VALUES = {"Tag": "addr", "Constant": "value"}
"""Rows of a table of the editor, and the attribute that says where a tag or what a constant is."""


@dataclass(frozen=True, slots=True)
class Tag:
    """A PLC tag: ``type`` as written (``Word``), ``address`` as written (``%MW2``)."""

    name: str
    type: str
    address: str
    comment: str = ""
    span: Span | None = None


@dataclass(frozen=True, slots=True)
class UserConstant:
    """A user constant of a tag table; ``value`` is the literal as written."""

    name: str
    type: str
    value: str
    span: Span | None = None


@dataclass(frozen=True, slots=True)
class TagTable:
    """A tag table, tags and constants in document order."""

    name: str
    tags: tuple[Tag, ...]
    constants: tuple[UserConstant, ...] = ()


@dataclass(frozen=True, slots=True)
class WatchEntry:
    """A row of a watch table: its ``name`` is symbolic and empty if the row has an absolute ``address`` only."""

    name: str
    address: str | None
    display_format: str
    modify_value: str | None
    span: Span | None = None


@dataclass(frozen=True, slots=True)
class WatchTable:
    """A watch table, rows in document order."""

    name: str
    entries: tuple[WatchEntry, ...]


def tag_table(element: Element, file: str, diagnostics: list[Diagnostic]) -> TagTable | None:
    """One SW.Tags.PlcTagTable; missing attributes are PG812."""
    head = _attributes(element, ("Name",), file, diagnostics)
    if head is None:
        return None
    tags, constants = [], []
    for entry in children(child(element, "ObjectList")):
        place = span(entry, file)
        if local(entry) == "SW.Tags.PlcTag":
            found = _attributes(entry, ("Name", "DataTypeName", "LogicalAddress"), file, diagnostics)
            if found is not None:
                tags.append(
                    Tag(
                        found["Name"],
                        found["DataTypeName"],
                        found["LogicalAddress"],
                        multilingual(entry, "Comment"),
                        place,
                    )
                )
        elif local(entry) == "SW.Tags.PlcUserConstant":
            found = _attributes(entry, ("Name", "DataTypeName", "Value"), file, diagnostics)
            if found is not None:
                constants.append(UserConstant(found["Name"], found["DataTypeName"], found["Value"], place))
    return TagTable(head["Name"], tuple(tags), tuple(constants))


def editor_table(root: Element, file: str, diagnostics: list[Diagnostic]) -> TagTable:
    """A table as the editor of the TIA Portal exports it: a Tag or Constant for each row, whose text is its name."""
    tags, constants = [], []
    for row in children(root):
        place, name, type_ = span(row, file), text(row).strip(), row.get("type", "")
        kind, key = local(row), _VALUES.get(local(row))
        value = row.get(key, "") if key else ""
        if key and not (name and type_ and value):
            diagnostics.append(Diagnostic("PG812", f"{kind} needs a name and the attributes type and {key}", place))
        elif kind == "Tag":
            tags.append(Tag(name, type_, value, row.get("remark", ""), place))
        elif kind == "Constant":
            constants.append(UserConstant(name, type_, value, place))
    return TagTable(root.get("name", ""), tuple(tags), tuple(constants))


def watch_table(element: Element, file: str, diagnostics: list[Diagnostic]) -> WatchTable | None:
    """One SW.WatchAndForceTables.PlcWatchTable; missing attributes are PG812."""
    head = _attributes(element, ("Name",), file, diagnostics)
    if head is None:
        return None
    entries = []
    for entry in children(child(element, "ObjectList"), "SW.WatchAndForceTables.PlcWatchTableEntry"):
        found = _attributes(entry, (), file, diagnostics) or {}
        if not found.get("Name") and not found.get("Address"):
            message = f"{local(entry)} needs the attribute Name or Address"
            diagnostics.append(Diagnostic("PG812", message, span(entry, file)))
        else:
            entries.append(
                WatchEntry(
                    found.get("Name", ""),
                    found.get("Address") or None,
                    found.get("DisplayFormat", ""),
                    found.get("ModifyValue") or None,
                    span(entry, file),
                )
            )
    return WatchTable(head["Name"], tuple(entries))


def _attributes(
    element: Element, required: tuple[str, ...], file: str, diagnostics: list[Diagnostic]
) -> dict[str, str] | None:
    found = {local(entry): text(entry).strip() for entry in children(child(element, "AttributeList"))}
    missing = [name for name in required if not found.get(name)]
    for name in missing:
        message = f"{local(element)} needs the attribute {name}"
        diagnostics.append(Diagnostic("PG812", message, span(element, file)))
    return None if missing else found


__all__ = [
    "Tag",
    "TagTable",
    "UserConstant",
    "WatchEntry",
    "WatchTable",
    "read_simaticml",
    "read_tag_table",
    "read_watch_table",
]

KINDS = {
    "SW.Types.PlcStruct": BlockKind.UDT,
    "SW.Blocks.GlobalDB": BlockKind.DB,
    "SW.Blocks.InstanceDB": BlockKind.DB,
    "SW.Blocks.ArrayDB": BlockKind.DB,
    "SW.Blocks.FB": BlockKind.FB,
    "SW.Blocks.FC": BlockKind.FC,
    "SW.Blocks.OB": BlockKind.OB,
}
"""Objects with an Interface, by tag."""

_WHOLE = "WithDefaults"
"""Documents that were exported with this setting write used types out with all their members."""

_CODE_BLOCKS = frozenset({BlockKind.FB, BlockKind.FC, BlockKind.OB})
_LANGUAGES = {"FlgNet": "LAD or FBD", "StatementList": "STL", "Graph": "GRAPH"}

_HEADER = {name: key for key, name in HEADER.items()}
_OWN = frozenset(
    {"Interface", "Name", "Number", "MemoryLayout", "InstanceOfName", "InstanceOfType", "AutoNumber", "Namespace"}
    | {"ProgrammingLanguage", "SetENOAutomatically", "OfSystemLibElement", "OfSystemLibVersion"}
    | {"ArrayDataType", "ArrayLimit"}
)
"""Attributes that the block model holds elsewhere, or that a source has no words for."""


def read_simaticml(
    source: Path | str | bytes,
    file: str | None = None,
    *,
    classic: bool | None = False,
    constants: Mapping[str, int | None] | None = None,
    inline: bool = True,
    seen: Callable[[Element], None] | None = None,
) -> tuple[list[Block], list[Diagnostic]]:
    """Blocks and types of one document and everything wrong with it; ``file`` is the name for messages.

    ``constants`` are those of the project by upper-case name, for bounds and lengths. ``inline``: types that the
    document writes out are wanted, too. ``seen`` gets the root of a document that can be read.

    A missing MemoryLayout means optimized access, as on S7-1200/1500; ``classic`` says the document is for
    S7-300/400, where it means standard access, None that nobody knows: then it stays unsaid. Types and instance DBs
    have no layout of their own (None).
    Diagnostics: PG802 too large, PG804 unreadable, PG810 document type, PG811 not well formed, PG812 unknown
    kind, missing attribute or unusable data type.
    """
    root, name, diagnostics = _open(source, file)
    if root is None:
        return [], diagnostics
    if seen is not None:
        seen(root)
    return _blocks(root, name, diagnostics, constants or {}, classic=classic, inline=inline), diagnostics


def _blocks(
    root: Element,
    name: str,
    diagnostics: list[Diagnostic],
    constants: Mapping[str, int | None],
    *,
    classic: bool | None,
    inline: bool,
) -> list[Block]:
    blocks = []
    whole = inline and text(child(child(root, "DocumentInfo"), "ExportSetting")).strip() == _WHOLE
    for element in children(root):
        tag = local(element)
        if tag in KINDS:
            culture = first_culture(element)
            reader = InterfaceReader(name, diagnostics, constants=constants, whole=whole, culture=culture)
            block = _block(element, reader, classic=classic)
            if block is not None:
                blocks.append(block)
        elif tag.startswith(("SW.Blocks.", "SW.Types.")):
            diagnostics.append(Diagnostic("PG812", f"unknown kind of object {tag}", span(element, name)))
    return blocks


def read_tag_table(source: Path | str | bytes, file: str | None = None) -> tuple[list[TagTable], list[Diagnostic]]:
    """Tag tables of one document, or the one of an export of the editor; diagnostics as for :func:`read_simaticml`."""
    root, name, diagnostics = _open(source, file, {"Document", "Tagtable"})
    if root is not None and local(root) == "Tagtable":
        return [editor_table(root, name, diagnostics)], diagnostics
    found = (tag_table(table, name, diagnostics) for table in children(root, "SW.Tags.PlcTagTable"))
    return [table for table in found if table is not None], diagnostics


def read_watch_table(source: Path | str | bytes, file: str | None = None) -> tuple[list[WatchTable], list[Diagnostic]]:
    """Watch tables of one document; diagnostics as for :func:`read_simaticml`."""
    root, name, diagnostics = _open(source, file)
    found = (watch_table(table, name, diagnostics) for table in children(root, "SW.WatchAndForceTables.PlcWatchTable"))
    return [table for table in found if table is not None], diagnostics


def _open(
    source: Path | str | bytes, file: str | None, roots: Collection[str] = ("Document",)
) -> tuple[Element | None, str, list[Diagnostic]]:
    try:
        data, name = load(source, file)
        root = parse_xml(data, name)
    except DiagnosticError as error:
        return None, "", list(error.diagnostics)
    if local(root) not in roots:
        wrong = Diagnostic("PG812", f"the root element is {root.tag}, not Document", span(root, name))
        return None, name, [wrong]
    return root, name, []


def _block(element: Element, reader: InterfaceReader, *, classic: bool | None) -> Block | None:
    file, diagnostics = reader.file, reader.diagnostics
    tag, kind = local(element), KINDS[local(element)]
    place = span(element, file)
    found = child(element, "AttributeList")
    attributes = {local(entry): text(entry).strip() for entry in children(found)}
    required = ["Name"] if kind is BlockKind.UDT else ["Name", "Number"]
    if tag == "SW.Blocks.InstanceDB":
        required.append("InstanceOfName")
    missing = [f"{tag} needs the attribute {name}" for name in required if not attributes.get(name)]
    diagnostics.extend(Diagnostic("PG812", message, place) for message in missing)
    if "Name" not in attributes:
        return None
    interface = child(found, "Interface")
    sections = reader.sections(interface) if interface is not None else ()
    if tag == "SW.Blocks.ArrayDB" and (interface is None or "ArrayLimit" in attributes):
        sections = _array(attributes, place, diagnostics)
    elif tag == "SW.Blocks.ArrayDB":
        sections = _one_array(sections, place, diagnostics)
    elif interface is None:
        diagnostics.append(Diagnostic("PG812", f"{tag} needs the attribute Interface", place))
    return Block(
        kind,
        attributes["Name"],
        sections,
        number=_number(attributes.get("Number", ""), place, diagnostics),
        instance_of=_made_from(attributes) or None,
        optimized=_optimized(tag, attributes.get("MemoryLayout"), classic=classic),
        title=multilingual(element, "Title"),
        comment=multilingual(element, "Comment"),
        attributes=_header(attributes),
        assignments=tuple(reader.assignments),
        span=place,
        code=_code(element, file, diagnostics) if kind in _CODE_BLOCKS else None,
        non_retain=kind is BlockKind.DB and not any(s.retain for s in sections),
        inline=tuple(reader.inline.values()),
        safety=attributes.get("ProgrammingLanguage", "").startswith("F_"),
    )


def _made_from(attributes: Mapping[str, str]) -> str:
    """What an instance DB is made from; a software unit puts its namespace before the names of its own blocks."""
    name, own = attributes.get("InstanceOfName", "").strip('"'), f"{attributes.get('Namespace', '')}."
    return name[len(own) :] if name.upper().startswith(own.upper()) else name


def _header(attributes: dict[str, str]) -> dict[str, str]:
    """Attributes as a source has them: AUTHOR, FAMILY, NAME, VERSION, and what an instance DB has of a library.

    The usual event class goes without saying.
    """
    element, version = attributes.get("OfSystemLibElement", ""), attributes.get("OfSystemLibVersion", "")
    kept = {INSTRUCTION: element, LIBRARY_VERSION: version} if version else {}
    kept |= {_HEADER.get(name, name): value for name, value in attributes.items() if name not in _OWN}
    if kept.get("SecondaryType") == "ProgramCycle":
        del kept["SecondaryType"]
    return {name: value for name, value in kept.items() if value}


def _code(element: Element, file: str, diagnostics: list[Diagnostic]) -> str | None:
    """SCL of all networks; None, with a note, if one of them is drawn or a statement list."""
    networks: list[str] = []
    for unit in children(child(element, "ObjectList"), "SW.Blocks.CompileUnit"):
        for network in children(child(child(unit, "AttributeList"), "NetworkSource")):
            if local(network) != "StructuredText":
                name = _LANGUAGES.get(local(network), local(network))
                message = f"a network in {name} is not read: only the interface of this block is used"
                diagnostics.append(Diagnostic("PG814", message, span(network, file), Severity.NOTE))
                return None
            networks.append(CodeReader(file, diagnostics).read(network))
    return "\n".join(networks)


def _array(attributes: dict[str, str], place: Span, diagnostics: list[Diagnostic]) -> tuple[Section, ...]:
    """The one array of an array DB, as a source declares it: ``ARRAY[0..limit] OF type``."""
    limit, spelling = attributes.get("ArrayLimit", ""), attributes.get("ArrayDataType", "")
    element = parse_datatype(spelling)
    if not re.fullmatch(r"[0-9]{1,9}", limit) or element is None:
        message = "an array DB needs the attributes ArrayDataType and ArrayLimit"
        diagnostics.append(Diagnostic("PG812", message, place))
        return ()
    return (Section(SectionKind.STATIC, (Member("THIS", ArrayType(((0, int(limit)),), element)),)),)


def _one_array(sections: tuple[Section, ...], place: Span, diagnostics: list[Diagnostic]) -> tuple[Section, ...]:
    """The one array of an array DB that has it as a member of its Interface."""
    members = [member for section in sections for member in section.members]
    if len(members) != 1 or not isinstance(members[0].type, ArrayType):
        diagnostics.append(Diagnostic("PG812", "an array DB has one member, its array", place))
        return ()
    return (Section(SectionKind.STATIC, (replace(members[0], name="THIS"),)),)


def _number(digits: str, place: Span, diagnostics: list[Diagnostic]) -> int | None:
    if re.fullmatch(r"[0-9]{1,9}", digits):
        return int(digits)
    if digits:
        diagnostics.append(Diagnostic("PG812", f"{digits} is not a block number", place))
    return None


def _optimized(tag: str, memory_layout: str | None, *, classic: bool | None) -> bool | None:
    if memory_layout is not None:
        return memory_layout != "Standard"
    if tag == "SW.Types.PlcStruct" or classic is None:
        return None
    if tag == "SW.Blocks.InstanceDB":
        return False if classic else None  # on S7-1200/1500 as its function block
    return optimized(classic=classic)


MAX_DEPTH = 64


def document_attributes(root: Element) -> dict[str, dict[str, dict[str, str]]]:
    """Block name to member path (upper case) to attribute and value (upper case)."""
    return {
        text(child(child(element, "AttributeList"), "Name")).strip(): _block_attributes(element)
        for element in children(root)
        if local(element) in KINDS
    }


def innermost_name(spelling: str) -> str:
    """Name of a library type, also in an array; empty if the type is one of the user's."""
    name = spelling.rpartition(" of ")[2].strip()
    return "" if '"' in name else name


def _block_attributes(element: Element) -> dict[str, dict[str, str]]:
    found: dict[str, dict[str, str]] = {}
    interface = child(child(child(element, "AttributeList"), "Interface"), "Sections")
    pending = [("", member, 0) for section in children(interface) for member in children(section, "Member")]
    while pending:
        prefix, member, depth = pending.pop()
        path = f"{prefix}{member.get('Name', '')}".upper()
        own: dict[str, str] = {}
        version, type_ = member.get("Version"), innermost_name(member.get("Datatype", ""))
        if version and type_ and type_.upper() != "DTL":
            own |= {"INSTRUCTIONNAME": type_.upper(), "LIBVERSION": version.upper()}
        remanence = member.get("Remanence")
        if remanence:
            own["RETAIN"] = remanence.upper()
        for attribute in children(child(member, "AttributeList")):
            name, value = attribute.get("Name", ""), text(attribute).strip()
            if attribute.get("Informative") == "true":  # exported on request, ignored when read: that of the type
                continue
            if name.startswith(("External", "S7_")) or name == "SetPoint":
                own[name.upper() if name != "SetPoint" else "S7_SETPOINT"] = value.upper()
        if own:
            found[path] = own
        if depth < MAX_DEPTH:
            pending += [(f"{path}.", inner, depth + 1) for inner in children(member, "Member")]
    return found
