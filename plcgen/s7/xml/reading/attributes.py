"""Attributes of members in SimaticML that the block model does not hold: retentivity and access from outside."""

from __future__ import annotations

from typing import TYPE_CHECKING

from plcgen.s7.xml.reading.documents import KINDS
from plcgen.s7.xml.reading.xml import child, children, local, text

if TYPE_CHECKING:
    from lxml.etree import _Element as Element

MAX_DEPTH = 64


def document_attributes(root: Element) -> dict[str, dict[str, dict[str, str]]]:
    """Block name to member path (upper case) to attribute and value (upper case)."""
    return {
        text(child(child(element, "AttributeList"), "Name")).strip(): _block(element)
        for element in children(root)
        if local(element) in KINDS
    }


def innermost_name(spelling: str) -> str:
    """Name of a library type, also in an array; empty if the type is one of the user's."""
    name = spelling.rpartition(" of ")[2].strip()
    return "" if '"' in name else name


def _block(element: Element) -> dict[str, dict[str, str]]:
    found: dict[str, dict[str, str]] = {}
    interface = child(child(child(element, "AttributeList"), "Interface"), "Sections")
    pending = [("", member, 0) for section in children(interface) for member in children(section, "Member")]
    while pending:
        prefix, member, depth = pending.pop()
        path = f"{prefix}{member.get('Name', '')}".upper()
        own = _own(member)
        if own:
            found[path] = own
        if depth < MAX_DEPTH:
            pending += [(f"{path}.", inner, depth + 1) for inner in children(member, "Member")]
    return found


def _own(member: Element) -> dict[str, str]:
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
    return own
