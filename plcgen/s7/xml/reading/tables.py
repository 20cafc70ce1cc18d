"""Tag tables and watch tables as frozen values: of SimaticML documents, and tag tables of the TIA Portal's editor."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from plcgen.base.diagnostics import Diagnostic, Span
from plcgen.s7.xml.reading.xml import child, children, local, multilingual, span, text

if TYPE_CHECKING:
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
