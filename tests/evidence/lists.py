"""What lists print of a parameter, as the package keeps it; and its table of messages, from the help as text.

``python -m tests.evidence HELP --part lists --save`` makes the table of the files ``SINAMICS Alarms *.md`` of a public
copy of the TIA Portal information system.
"""

from __future__ import annotations

import html
import re
import struct
from collections.abc import Iterator, Mapping
from pathlib import Path

from plcgen.ds47 import lists, messages
from plcgen.ds47.types import read_type
from plcgen.ds47.wire import formats
from plcgen.ds47.wire.formats import FormatValueError

OBJECTS = re.compile(r"VECTOR(_G)?|SERVO|DC_CTRL|[ASB]_INF|CU_(S120|S150|G130|G150)|CU_DC|TM[0-9]+(DI_DO)?|TB30")
"""Drive objects that a profile has, without the fieldbus of a control unit and without function modules."""
_NUMBER = re.compile(r"-?[0-9]+(\.[0-9]+)?(E[+-]?[0-9]+)?\Z")
_HEX = re.compile(r"([0-9A-F ]+) hex\Z")
_BIN = re.compile(r"([01 ]+) bin\Z")
_LAST = re.compile(r"(?:0\.\.)?([0-9]+)\Z")


def number(text: str, fmt: str) -> str:
    """A limit or factory setting as a decimal number; empty if it is none, or none of the type."""
    for pattern, base in ((_HEX, 16), (_BIN, 2)):
        match = pattern.match(text)
        if match:
            text = str(int(match[1].replace(" ", ""), base))
    if not _NUMBER.match(text):
        return ""
    value: float = float(text)
    if fmt != "FloatingPoint":
        if not value.is_integer():
            return ""
        value = int(value)
    try:
        formats.pack_values(read_type(fmt)[0], [value])
    except (FormatValueError, OverflowError, struct.error):
        return ""
    return repr(value)


def _objects(text: str) -> str:
    found = {"ALL"} if "All objects" in text else set()
    for one in text.split(", "):
        match = OBJECTS.match(one)
        rest = one[match.end() :] if match else "?"
        if match and (rest.startswith((" (", "_PN", "_DP")) or not rest):
            found.add(match[0])
    return " ".join(sorted(found))


def _array(row: Mapping[str, str]) -> str:
    match = _LAST.match(row["index"])
    if match:
        return str(int(match[1]) + 1)
    return (
        (row["dynamic_index"] if row["dynamic_index"] in {"CDS", "DDS", "EDS", "MDS"} else "n") if row["index"] else ""
    )


def kept(row: Mapping[str, str]) -> list[str]:
    """One parameter of a list as the package has it, in the order of ``lists.COLUMNS``."""
    listed, _, signal = row["type"].partition(" / ")
    said = "FloatingPoint" if listed == "FloatingPoint32" else listed
    fmt = lists.ON_WIRE.get(int(row["number"]), said)
    strange = fmt.startswith("OctetString")
    low, high, default = ("" if strange else number(row[key], fmt) for key in ("min", "max", "default"))
    if signal and default != "0":
        default = ""  # a source, which is not coded as it is printed
    bounds = [float(one) for one in (low, high) if one]
    if default and len(bounds) == 2 and not bounds[0] <= float(default) <= bounds[1]:
        default = ""
    return [
        row["number"], row["letter"], _objects(row["objects"]), row["title"], fmt, "bico" if signal else "",
        "" if strange else _array(row), row["unit"], low, high, default, row["scaling"], row["changeable"],
        row["values"], row["bit_names"], row["index_names"],
    ]  # fmt: skip


PACKAGES = {"sdral010": "a_inf", "sdral011": "servo", "sdral012": "vector", "sdral400": "s210_fw5",
            "sdral401": "s210_fw6", "sdral423": "s200_basic_pn", "sdral425": "s200_pn", "sdral451": "g220",
            "sdral453": "g220_clean_power", "StdrAlG120": "g120"}  # fmt: skip
"""Packages of the information system with messages; 400 begins with firmware 5.1, 401 with 6.1."""
GROUPS = {"cu230p": "CU230P", "cu240": "CU240", "cu250s": "CU250S", "g110m": "CU_G110M", "g115d": "G115D",
          "g120c": "G120C", "g120x": "G120X", "vector": r"VECTOR(_G)?\Z", "servo": r"SERVO\Z", "a_inf": r"[ASB]_INF\Z",
          "dc_ctrl": r"DC_CTRL\Z"}  # fmt: skip
"""How the lists of messages print the drive objects of a family, or how these names begin."""
OF_LIST = {"vector": {"vector", "dc_ctrl"}, "servo": {"servo"}, "a_inf": {"a_inf"},
           "g120": {"cu230p", "cu240", "cu250s", "g110m", "g115d", "g120c", "g120x"}}  # fmt: skip
"""Families for which a list speaks: what it says of the objects of other lists stands there. DC_CTRL has none."""


_MESSAGE = re.compile(r"(?m)^###+ ([FACN])([0-9]+) *(?:\(([^)]*)\))? *(.*)$")


def families(name: str, objects: str) -> set[str]:
    """Families of a message: by the list, or by its drive objects where one list has several families."""
    if name not in OF_LIST:
        return {name}
    named = {family for family in OF_LIST[name] if any(re.match(GROUPS[family], one) for one in objects.split(", "))}
    everywhere = objects == "All objects" or (not objects and OF_LIST[name])
    return OF_LIST[name] if everywhere else named


def read_messages(text: str) -> Iterator[tuple[str, tuple[str, ...]]]:
    """Drive objects of every message, and what the table keeps of it: number, kind, .., acknowledgement."""
    found = list(_MESSAGE.finditer(text))
    for one, following in zip(found, [*found[1:], None], strict=True):
        part = text[one.end() : following.start() if following else len(text)]
        if "**Message" not in part:  # the heading over several meanings
            continue
        kind, number, also, title = one.groups("")
        said = [_said(part, name) for name in ("Message class", "Reaction|Response", "Acknowledge|Acknowledgment")]
        yield _said(part, "Drive object"), (str(int(number)), kind, also.replace(",", ""), _plain(title), *said)


def _said(part: str, name: str) -> str:
    match = re.search(rf"\*\*(?:{name}):\*\*(.*?)(?=\n\*\*|\n#|\n\||\Z)", part, re.DOTALL)
    return _plain(match[1]).removesuffix("-").strip() if match else ""


def _plain(text: str) -> str:
    return " ".join(html.unescape(text.replace("\\", "")).split())


def messages_text(folder: Path) -> str:
    """The table of messages: a line for each meaning that a number has, with the families that give it this one."""
    found: dict[tuple[str, ...], set[str]] = {}
    sources = {}
    for path in sorted(folder.rglob("SINAMICS Alarms *.md")):
        text = path.read_text("utf-8")
        package = re.search(r"\b(sdral[0-9]+|StdrAlG120)[a-zA-Z]*", text[:400])
        if package is None or package[1] not in PACKAGES:
            continue
        for objects, key in read_messages(text):
            where = families(PACKAGES[package[1]], objects)
            sources |= dict.fromkeys(where, package[0])
            found.setdefault(key, set()).update(where)
    head = ", ".join(f"{family}={sources[family]}" for family in sorted(sources))
    rows = sorted((int(key[0]), key[1:], " ".join(sorted(where))) for key, where in found.items() if where)
    lines = ["\t".join((str(number), *rest, where)) for number, rest, where in rows]
    return "\n".join([f"# {head}", "\t".join(messages.COLUMNS), *lines, ""])


def report(folder: Path, *, save: bool) -> Iterator[str]:
    """How many meanings the lists of messages have; ``save`` writes the table."""
    made = messages_text(folder)
    if save:
        messages.TABLE.write_text(made, "utf-8", newline="\n")
    yield f"lists: {'messages':18} {made.count(chr(10)) - 2:5} meanings"
