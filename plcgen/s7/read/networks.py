"""Calls in networks of LAD and FBD, as SimaticML has them: what stands at each parameter, as text."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

from plcgen.s7.xml.reading.documents import KINDS
from plcgen.s7.xml.reading.xml import child, children, local, text

if TYPE_CHECKING:
    from lxml.etree import _Element as Element


@dataclass(frozen=True, slots=True)
class NetworkCall:
    """A call or instruction with its operands by parameter, spelled as in SCL; ``line`` is its line in the file."""

    line: int
    operands: tuple[tuple[str, str], ...]


def document_calls(root: Element) -> dict[str, tuple[NetworkCall, ...]]:
    """Calls of every block of a document by block name, network by network."""
    found: dict[str, tuple[NetworkCall, ...]] = {}
    for block in children(root):
        if local(block) in KINDS:
            name = text(child(child(block, "AttributeList"), "Name")).strip()
            found[name] = tuple(call for network in block.iter("{*}FlgNet") for call in _calls(network))
    return found


def _calls(network: Element) -> Iterator[NetworkCall]:
    """A wire joins an operand (IdentCon) to pins of parts and calls (NameCon)."""
    parts = list(children(child(network, "Parts")))
    operands = {part.get("UId"): operand(part) for part in parts if local(part) == "Access"}
    pins: dict[str | None, list[tuple[str, str]]] = {
        part.get("UId"): [] for part in parts if local(part) in {"Part", "Call"}
    }
    for wire in children(child(network, "Wires")):
        ends = list(children(wire))
        joined = next((operands.get(end.get("UId"), "") for end in ends if local(end) == "IdentCon"), "")
        for end in ends:
            if local(end) == "NameCon" and joined and end.get("UId") in pins:
                pins[end.get("UId")].append((end.get("Name", "").upper(), joined))
    for part in parts:
        if pins.get(part.get("UId")):
            line: object = part.sourceline
            yield NetworkCall(line if isinstance(line, int) else 0, tuple(pins[part.get("UId")]))


def operand(access: Element) -> str:
    """``#a.b``, ``"DB".c``, ``256``, ``P#DB10.DBX0.0 BYTE 33``; empty for an address, whose text nothing here needs."""
    constant = child(access, "Constant")
    if constant is not None:
        return text(child(constant, "ConstantValue")).strip() or f"#{constant.get('Name', '')}"
    steps = [
        f"{part.get('Name', '')}[..]" if len(part) and child(part, "Access") is not None else part.get("Name", "")
        for part in children(child(access, "Symbol"))
        if local(part) == "Component"
    ]
    if not steps:
        return ""
    first = f'"{steps[0]}"' if access.get("Scope", "").startswith("Global") else f"#{steps[0]}"
    return ".".join([first, *steps[1:]])
