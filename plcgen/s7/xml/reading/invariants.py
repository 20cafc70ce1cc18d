"""What every genuine export keeps to, which no schema covers: the envelope of documents, and offsets of members.

Exports with read-only attributes have ``Offset`` at each member of a block with standard access, an informative
IntegerAttribute in bits (so a public reader of such documents describes it; of members inside a structure it is not
said from where it counts, so that from the block and that from the structure are taken).

Source: genuine TIA Portal exports V14 to V21; every finding is a PG813.
"""

from __future__ import annotations

import codecs
import re
from collections import deque
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import TYPE_CHECKING

from plcgen.base.diagnostics import Diagnostic, DiagnosticError, Note, Severity, Span
from plcgen.s7.layout.layout import layout_block, locate
from plcgen.s7.xml.reading.documents import KINDS
from plcgen.s7.xml.reading.xml import child, children, load, local, namespace, parse_xml, span, text
from plcgen.s7.xml.spelling import BASE, VERSIONS
from plcgen.s7.xml.writing.documents import SECTIONS, section_names

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from lxml.etree import _Element as Element

    from plcgen.s7.types.blocks import Block

MAX_DEPTH = 64
_SHOWN = 5
Stated = tuple[str, str, int, Span]
"""Path of the structure around a member, its own path, bits, place in the document."""


def compare_offsets(
    blocks: Iterable[Block], types: Mapping[str, Block], documents: Mapping[str, Mapping[str, Sequence[Stated]]]
) -> tuple[list[Diagnostic], int]:
    """PG838 for each block whose export states other offsets than the layout has, and how many offsets agree.

    ``documents`` are the stated offsets of blocks by file and name.
    """
    found: list[Diagnostic] = []
    agreed = 0
    for block in blocks:
        stated = documents.get(block.span.file if block.span else "", {}).get(block.name, ())
        if not stated or block.optimized:
            continue
        try:
            layout = layout_block(block, types)
        except DiagnosticError:
            continue
        wrong: list[tuple[str, int, int, Span]] = []
        for above, path, bits, place in stated:
            try:
                own, base = locate(layout, path).offset, locate(layout, above).offset if above else 0
            except KeyError:
                continue
            if bits in {own, own - base}:
                agreed += 1
            else:
                wrong.append((path, bits, own, place))
        if wrong:
            path, bits, own, place = wrong[0]
            message = f"{path} of {block.name} lies at {_place(bits)} in the export, at {_place(own)} here"
            notes = [Note(f"{name}: {_place(there)}, here {_place(here)}", where)
                     for name, there, here, where in wrong[1 : _SHOWN + 1]]  # fmt: skip
            help_ = "the layout of this block is not to be relied on: please report it with the declaration"
            found.append(Diagnostic("PG838", message, place, Severity.WARNING, help=help_, notes=tuple(notes)))
    return found, agreed


def _place(bits: int) -> str:
    return f"{bits // 8}.{bits % 8}"


def document_offsets(file: str, root: Element) -> dict[str, list[Stated]]:
    """Paths, bits and places by the name of the block."""
    if all(attribute.get("Name") != "Offset" for attribute in root.iter("{*}IntegerAttribute")):
        return {}
    return {
        text(child(child(element, "AttributeList"), "Name")).strip(): list(_offsets(element, file))
        for element in children(root)
        if local(element) in KINDS
    }


def _offsets(element: Element, file: str) -> Iterator[Stated]:
    interface = child(child(child(element, "AttributeList"), "Interface"), "Sections")
    pending = deque(("", member, 0) for section in children(interface) for member in children(section, "Member"))
    while pending:
        prefix, member, depth = pending.popleft()
        path = f'{prefix}"{member.get("Name", "")}"'
        for attribute in children(child(member, "AttributeList")):
            value = text(attribute).strip()
            if attribute.get("Name") == "Offset" and value.isdecimal() and len(value) < 10:
                yield prefix.removesuffix("."), path, int(value), span(member, file)
        if depth < MAX_DEPTH and member.get("Datatype") == "Struct":
            pending += [(f"{path}.", inner, depth + 1) for inner in children(member, "Member")]


_BLOCK = ("AutoNumber", "Interface", "MemoryLayout", "Name", "Number", "ProgrammingLanguage")
REQUIRED = MappingProxyType(
    {
        "SW.Types.PlcStruct": ("Interface", "Name"),
        "SW.Blocks.GlobalDB": _BLOCK,
        "SW.Blocks.InstanceDB": (
            *("AutoNumber", "InstanceOfName", "InstanceOfType", "Interface", "Name", "Number"),
            "ProgrammingLanguage",
        ),
        "SW.Blocks.FB": (*_BLOCK, "SetENOAutomatically"),
        "SW.Blocks.FC": (*_BLOCK, "SetENOAutomatically"),
        "SW.Blocks.OB": (*_BLOCK, "SecondaryType", "SetENOAutomatically"),
        "SW.Blocks.CompileUnit": ("NetworkSource", "ProgrammingLanguage"),
        "SW.Tags.PlcTagTable": ("Name",),
        "SW.Tags.PlcTag": ("DataTypeName", "LogicalAddress", "Name"),
        "SW.Tags.PlcUserConstant": ("DataTypeName", "Name", "Value"),
        "SW.WatchAndForceTables.PlcWatchTable": ("Name",),
        "MultilingualTextItem": ("Culture", "Text"),
    }
)
"""Attributes of every kind of object; NOT_CLASSIC of them are absent for S7-300/400."""

NOT_CLASSIC = frozenset({"MemoryLayout", "SetENOAutomatically"})
_ORDER = {"Comment": 0, "CompileUnits": 1, "Title": 2}
_VERSION = re.compile(r"V\d{2}(\.\d)?( SP\d)?")
_DECIMAL = re.compile(r"[0-9]{1,9}")
_HEX = re.compile(r"0|[1-9A-F][0-9A-F]*")


def check_invariants(source: Path | str | bytes, file: str | None = None, *, classic: bool = False) -> list[Diagnostic]:
    """Everything in which a document differs from a genuine export; ``classic`` is an S7-300/400 document.

    Diagnostics: PG813, or PG802, PG804, PG810, PG811 if it cannot be read at all.
    """
    try:
        data, name = load(source, file)
        root = parse_xml(data, name)
    except DiagnosticError as error:
        return list(error.diagnostics)
    check = _Check(name, classic=classic)
    if not data.startswith(codecs.BOM_UTF8):
        check.report("the file has no UTF-8 byte order mark", None)
    if not data.removeprefix(codecs.BOM_UTF8).lower().startswith(b'<?xml version="1.0" encoding="utf-8"?>'):
        check.report('the file does not begin with <?xml version="1.0" encoding="utf-8"?>', None)
    check.document(root)
    return check.diagnostics


@dataclass(slots=True)
class _Check:
    file: str
    classic: bool = field(kw_only=True)
    version: str = ""
    diagnostics: list[Diagnostic] = field(default_factory=list)

    def report(self, message: str, element: Element | None) -> None:
        place = Span(self.file, 1, 1) if element is None else span(element, self.file)
        self.diagnostics.append(Diagnostic("PG813", message, place))

    def document(self, root: Element) -> None:
        if root.tag != "Document":
            self.report(f"the root element is {root.tag}, not Document", root)
            return
        engineering = child(root, "Engineering")
        self.version = "" if engineering is None else engineering.get("version", "")
        if engineering is None or not _VERSION.fullmatch(self.version):
            self.report('Document begins with <Engineering version="V18"/>', root)
        elif root[0] is not engineering:
            self.report("Engineering comes first in Document", engineering)
        self.ids(root)
        for element in root.iter():
            if element.get("ID") is not None and not namespace(element):
                self.object(element)

    def ids(self, root: Element) -> None:
        """IDs count up in hexadecimal in document order from 0; objects and only objects have one."""
        expected = 0
        for element in root.iter():
            tag = local(element)
            found = element.get("ID")
            if found is None:
                if tag in REQUIRED or tag == "MultilingualText":
                    self.report(f"{tag} has no ID", element)
                continue
            if not _HEX.fullmatch(found):
                self.report(f"ID {found} is not an upper-case hexadecimal number", element)
            elif int(found, 16) != expected:
                self.report(f"ID {found}: {expected:X} is next in document order", element)
                expected = int(found, 16)
            expected += 1

    def object(self, element: Element) -> None:
        tag = local(element)
        found = child(element, "AttributeList")
        names = [local(entry) for entry in children(found)]
        if names != sorted(names):
            self.report(f"{tag}: attributes are not in alphabetical order: {', '.join(names)}", found)
        required = [n for n in REQUIRED.get(tag, ()) if not (self.classic and n in NOT_CLASSIC)]
        for name in required:
            if name not in names:
                self.report(f"{tag} has no {name}", element)
        if self.classic:
            for name in names:
                if name in NOT_CLASSIC:
                    self.report(f"{tag}: S7-300/400 documents have no {name}", found)
        self.compositions(element, tag)
        if tag in SECTIONS:
            self.interface(child(found, "Interface"), tag)
        if tag == "SW.WatchAndForceTables.PlcWatchTableEntry":
            self.row(found, names)
        if tag == "SW.Blocks.CompileUnit":
            self.network(child(found, "NetworkSource"))

    def row(self, found: Element | None, names: list[str]) -> None:
        """A row of a watch table by name: the TIA Portal refuses to set anything else of it."""
        if not {"Name", "Address"} & set(names):
            self.report("a row of a watch table has a Name or an Address", found)
        elif "Address" not in names and names != ["Name"]:
            self.report(f"a row of a watch table by name has a Name only, not {', '.join(names)}", found)

    def compositions(self, element: Element, tag: str) -> None:
        """Comment, CompileUnits, Title in this order; texts have a composition name."""
        names = [entry.get("CompositionName", "") for entry in children(child(element, "ObjectList"))]
        for entry in children(child(element, "ObjectList")):
            if local(entry) == "MultilingualText" and entry.get("CompositionName") not in (
                "Comment",
                "Title",
            ):
                self.report("a MultilingualText is the Comment or the Title", entry)
        places = [_ORDER[name] for name in names if name in _ORDER]
        if places != sorted(places):
            self.report(f"{tag}: the order is Comment, CompileUnits, Title", child(element, "ObjectList"))

    def interface(self, interface: Element | None, tag: str) -> None:
        sections = child(interface, "Sections")
        if sections is None:
            return
        self.namespace_of(sections, "Interface/", 0)
        names = tuple(entry.get("Name", "") for entry in children(sections, "Section"))
        found = section_names(tag, classic=self.classic)
        expected = tuple("None" if tag == "SW.Types.PlcStruct" else kind.value for kind in found)
        if names != expected:
            self.report(f"{tag}: the sections are {', '.join(expected)}", sections)
        for member in sections.iter("{*}Member"):
            kind = member.get("Datatype", "")
            if re.search(r"(^|\bof\s+)struct$", kind, re.IGNORECASE) and child(member, "Member") is None:
                self.report(f"{member.get('Name')}: an empty Struct makes the block inconsistent", member)
            if tag == "SW.Blocks.InstanceDB" and member.get("Remanence") is not None:
                self.report(f"{member.get('Name')}: Remanence is rejected in an instance DB", member)

    def network(self, source: Element | None) -> None:
        """Namespaces of the code and its UIds: each once within a network."""
        for code in children(source):
            if local(code) == "StructuredText":
                self.namespace_of(code, "NetworkSource/StructuredText/", 1)
            elif local(code) == "FlgNet":
                self.namespace_of(code, "NetworkSource/FlgNet/", 2)
            self.uids(code, ascending=local(code) == "StructuredText")

    def uids(self, code: Element, *, ascending: bool) -> None:
        """UIds are numbers, each once within a network; in StructuredText they ascend in document order."""
        seen: set[str] = set()
        last = 0
        for uid, element in _uids(code):
            if not _DECIMAL.fullmatch(uid):
                self.report(f"UId {uid[:20]} is not a number", element)
                continue
            if uid in seen:
                self.report(f"UId {uid} is used twice in one network", element)
            elif ascending and int(uid) <= last:
                self.report(f"UId {uid} comes after {last}: they ascend in document order", element)
            seen.add(uid)
            last = max(last, int(uid))

    def namespace_of(self, element: Element, part: str, index: int) -> None:
        """Compare the namespace with the one of the Engineering version."""
        known = VERSIONS.get(self.version)
        if known is None:
            return
        versions = ((known.interface,), (known.structured_text,), known.flg_net)[index]
        allowed = [f"{BASE}{part}{version}" for version in versions]
        if namespace(element) not in allowed:
            message = f"{local(element)}: {self.version} has the namespace {' or '.join(allowed)}"
            self.report(message, element)


def _uids(code: Element) -> Iterator[tuple[str, Element]]:
    for element in code.iter():
        uid = element.get("UId")
        if uid is not None:
            yield uid, element
