"""Which elements of a SimaticML document stand where, as often as they may, with which attributes.

From the interface schemas of Openness (SW.InterfaceSections, SW.Common) and, for what has none, genuine exports. A
reader of blocks passes over what it does not know; the TIA Portal refuses the document, or does something else.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING

from plcgen.base.diagnostics import Diagnostic
from plcgen.s7.xml.reading.xml import local, span

if TYPE_CHECKING:
    from lxml.etree import _Element as Element

CONTENTS: Mapping[str, str] = MappingProxyType(
    {
        "Document": r"Engineering SW\.\S+ ",
        "Engineering": "",
        "SW.WatchAndForceTables.PlcWatchTableEntry": "AttributeList ",
        "ObjectList": r"((MultilingualText ){0,2}(SW\.Blocks\.CompileUnit )?(MultilingualText )?"
        r"|(MultilingualTextItem )+|(SW\.Tags\.PlcTag )*|(SW\.WatchAndForceTables\.PlcWatchTableEntry )*)",
        "MultilingualText": "ObjectList ",
        "MultilingualTextItem": "AttributeList ",
        "Interface": "Sections ",
        "Sections": "(Section )+",
        "Section": "(Member )*",
        "Member": "(AttributeList )?(Comment )?(StartValue )?(Sections )?((Member )*|(Subelement )*)",
        "Subelement": "StartValue ",
        "Comment": "(MultiLanguageText )+",
        "NetworkSource": "(StructuredText )?",
    }
)
"""The children of an element as a pattern over their names; whatever is not here has none."""
OBJECT = "AttributeList ObjectList "
"""Those of blocks, types, tables, tags and networks."""
ID = "[0-9A-F]+"
ATTRIBUTES: Mapping[str, Mapping[str, str]] = MappingProxyType(
    {
        "Engineering": {"version": r"V\d+(\.\d)?( SP\d)?"},
        "MultilingualText": {"ID": ID, "CompositionName": "Comment|Title"},
        "MultilingualTextItem": {"ID": ID, "CompositionName": "Items"},
        "SW.Blocks.CompileUnit": {"ID": ID, "CompositionName": "CompileUnits"},
        "SW.Tags.PlcTag": {"ID": ID, "CompositionName": "Tags"},
        "SW.WatchAndForceTables.PlcWatchTableEntry": {"ID": ID, "CompositionName": "Entries"},
        "Section": {"Name": "Input|Output|InOut|Static|Temp|Constant|Return|None"},
        "MultiLanguageText": {"Lang": "[A-Za-z-]+"},
        "Subelement": {"Path": "[0-9,]+"},
        "BooleanAttribute": {"Name": r"\w+", "SystemDefined": "true"},
        "StringAttribute": {"Name": r"\w+", "SystemDefined": "true"},
    }
)
"""The attributes of an element, all of them, as patterns of their values; whatever is not here has none."""
IN_CODE = frozenset({"UId", "Text", "Num", "Scope", "Name", "BlockType"})
"""Attributes of elements of code; each has a number, but for the text of a comment."""
ELEMENTS = frozenset(
    {
        "Token", "Blank", "Access", "Symbol", "Component", "Constant", "ConstantValue", "NewLine", "Instruction",
        "Parameter", "NamelessParameter", "CallInfo", "Instance", "BooleanAttribute", "LineComment",
    }
)  # fmt: skip
"""Elements of code that are generated (SW.PlcBlocks.Access, SW.PlcBlocks.SCL)."""
MEMBER = frozenset({"Name", "Datatype"}), frozenset({"Version", "Remanence"})
"""What a member must have, and may have."""


def misshapen(path: Path, root: Element) -> Iterator[Diagnostic]:
    """Elements that are not where they may be; the code of a block is compared token by token."""
    pending = [root]
    while pending:
        element = pending.pop()
        for what in _wrong(element):
            yield Diagnostic("PG614", what, span(element, str(path)))
        pending += element if local(element) != "StructuredText" else ()


def _wrong(element: Element) -> Iterator[str]:
    name, inner = local(element), [local(one) for one in element]
    if name == "StructuredText":
        known = ({local(one), *map(str, one.attrib)} for one in element.iterdescendants())
        odd = next((one for one in known if not one & {"UId", "Text"} or not one - IN_CODE <= ELEMENTS), None)
        if odd is not None:
            yield f"{name} has an element with {', '.join(sorted(odd))}"
        return
    stray = "".join([element.text or "", *(one.tail or "" for one in element)]).strip() if inner else ""
    if name == "AttributeList":
        good = len(inner) == len(set(inner)) or set(inner) <= {"BooleanAttribute", "StringAttribute"}
    else:
        pattern = CONTENTS.get(name, OBJECT if name.startswith("SW.") else "")
        good = re.fullmatch(pattern, "".join(f"{one} " for one in inner)) is not None
    if not good or stray:
        yield f"{name} has {stray or ', '.join(inner) or 'nothing'} in it"
    found = {str(key): str(value) for key, value in element.attrib.items()}
    wanted = ATTRIBUTES.get(name, {"ID": ID} if name.startswith("SW.") else {})
    if name == "Member":
        if not MEMBER[0] <= set(found) <= MEMBER[0] | MEMBER[1]:
            yield f"{name} has the attributes {', '.join(found)}"
        return
    for key in sorted({*found, *wanted}):
        if key not in wanted or re.fullmatch(wanted[key], found.get(key, "")) is None:
            yield f"{name} has {key} = {found.get(key, 'nothing')}"
