"""Whole documents of types and blocks: the envelope around Interface and code, as genuine exports have it.

IDs count up in hexadecimal in document order; the attributes of an object are in alphabetical order.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

from plcgen.s7.types.blocks import Block, BlockKind, is_optimized
from plcgen.s7.types.system import system_block
from plcgen.s7.xml.spelling import content
from plcgen.s7.xml.writing.elements import is_system
from plcgen.s7.xml.writing.interface import TextsOf, interface_element, section_names
from plcgen.s7.xml.writing.starts import Starts

if TYPE_CHECKING:
    from plcgen.s7.xml.versions import Version

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
