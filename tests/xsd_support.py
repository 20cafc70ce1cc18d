"""Validates the islands of SimaticML documents against Siemens' schemas, where they are at hand.

The schemas have no target namespace: each is wrapped in a schema that declares the namespace of the island
and includes the file. They come from ``PLCGEN_SIMATICML_XSD`` (``PublicAPI/Vxx/Schemas`` of an installed TIA
Portal) or from ``../shared/xsd`` next to the project; without them the check is skipped, never passed.
"""

from __future__ import annotations

import os
from functools import cache
from pathlib import Path
from xml.sax.saxutils import quoteattr

import pytest
from lxml import etree

BASE = "http://www.siemens.com/automation/Openness/SW/"
PROJECT = Path(__file__).parents[1]

# Versions of Interface, StructuredText and FlgNet by TIA Portal version.
VERSIONS = {
    "V14 SP1": (2, 1, 1),
    "V15": (3, 2, 3),
    "V15.1": (3, 2, 3),
    "V16": (4, 3, 4),
    "V17": (5, 3, 4),
    "V18": (5, 3, 4),
    "V19": (5, 4, 5),
    "V20": (5, 4, 5),
    "V21": (5, 4, 5),
}


def schema_folder() -> Path:
    """Find the folder with the schemas, or skip the test with the reason."""
    given = os.environ.get("PLCGEN_SIMATICML_XSD")
    folder = Path(given) if given else PROJECT.parent / "shared" / "xsd"
    if not folder.is_dir():
        pytest.skip(f"no SimaticML schemas in {folder}: set PLCGEN_SIMATICML_XSD")
    return folder


def validate_islands(path: Path | str, tia_version: str) -> list[str]:
    """Messages ``line: text`` for every Interface and code island of a document; empty if all are valid.

    An island in the namespace of another TIA version is a message too. Skips the test without schemas.
    """
    folder = schema_folder()
    interface, structured_text, flg_net = VERSIONS[tia_version]
    islands = {
        "Sections": (f"{BASE}Interface/v{interface}", f"SW.InterfaceSections_v{interface}.xsd"),
        "StructuredText": (
            f"{BASE}NetworkSource/StructuredText/v{structured_text}",
            f"SW.PlcBlocks.SCL_v{structured_text}.xsd",
        ),
        "FlgNet": (f"{BASE}NetworkSource/FlgNet/v{flg_net}", f"SW.PlcBlocks.LADFBD_v{flg_net}.xsd"),
    }
    root = etree.parse(str(path), etree.XMLParser(resolve_entities=False, no_network=True)).getroot()
    messages = []
    for element in root.iter("{*}Sections", "{*}StructuredText", "{*}FlgNet"):
        name = etree.QName(element)
        parent = element.getparent()
        if name.localname == "Sections" and etree.QName(parent).localname != "Interface":
            continue
        uri, file = islands[name.localname]
        if name.namespace != uri:
            messages.append(f"{element.sourceline}: {name.localname} is in {name.namespace}, not in {uri}")
        else:
            messages += _validate(element, folder / file, uri)
    return messages


def _validate(element, file: Path, uri: str) -> list[str]:
    if not file.is_file():
        pytest.skip(f"no schema {file}")
    schema = _schema(file, uri)
    offset = element.sourceline - 1
    copy = etree.fromstring(etree.tostring(element, with_tail=False))
    if schema.validate(copy):
        return []
    return [f"{entry.line + offset}: {entry.message}" for entry in schema.error_log]


@cache
def _schema(file: Path, uri: str) -> etree.XMLSchema:
    wrapper = (
        f"<xs:schema xmlns:xs='http://www.w3.org/2001/XMLSchema' targetNamespace={quoteattr(uri)} "
        f"xmlns={quoteattr(uri)} elementFormDefault='qualified'>"
        f"<xs:include schemaLocation={quoteattr(file.resolve().as_uri())}/></xs:schema>"
    )
    return etree.XMLSchema(etree.fromstring(wrapper.encode()))
