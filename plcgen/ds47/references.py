"""How a parameter is written in a spec: ``P50303``, ``p2155[1..2]``, ``r0945[0]`` or a catalogue name."""

from __future__ import annotations

import re
from dataclasses import dataclass

_NUMBER = re.compile(r"[PpRrCc]?0*([0-9]{1,9})\Z")
_REFERENCE = re.compile(
    r"\s*([A-Za-z_][A-Za-z0-9_]*|[0-9]+)\s*(?:\[\s*([0-9]{1,6})\s*(?:\.\.\s*([0-9]{1,6})\s*)?\])?\s*\Z"
)
_TYPE = re.compile(r"\s*([A-Za-z][A-Za-z0-9]*)\s*(?:\[\s*([0-9]{1,4})\s*\])?\s*\Z")


@dataclass(frozen=True, slots=True)
class Reference:
    """A parameter as written: number or name, the first and last index if there is one, whether with an r."""

    pnu: int | None
    name: str
    first: int | None
    last: int | None
    read_only: bool = False


def parse_reference(text: str) -> Reference | None:
    """Read a parameter reference; None if the text is none."""
    match = _REFERENCE.match(text)
    if not match:
        return None
    number = _NUMBER.match(match[1])
    first = int(match[2]) if match[2] else None
    last = int(match[3]) if match[3] else first
    read_only = match[1][0] in "rR"
    return Reference(int(number[1]) if number else None, "" if number else match[1], first, last, read_only)


_BIT = re.compile(r"(.*\S)\s*\.\s*([0-9]{1,2})\s*\Z")


def split_bit(text: str) -> tuple[str, int] | None:
    """Split ``P1200.3`` into the parameter as written and the bit; None if the text is no bit of a parameter."""
    match = _BIT.match(text)
    return (match[1], int(match[2])) if match and parse_reference(match[1]) is not None else None


_NEARLY = re.compile(
    r"\s*([A-Za-z_]\w*|[0-9]+)\s*[\[({]\s*([0-9]{1,6})\s*(\.{1,4}|…|–|-|:|,|;|\s+to\s+)\s*([0-9]{1,6})\s*[\])}]?\s*\Z"
)
_ONE = re.compile(r"\s*([PpRrCc][0-9]{1,5})\s*(?:[({]\s*([0-9]{1,6})\s*[)}]?|\[\s*([0-9]{1,6})|(\.)([0-9]{1,6}))\s*\Z")
_LIST = re.compile(r"[\s\w\[\].]*,[\s\w\[\].,]*\Z")


def spelling_hint(text: str) -> str:
    """How to write what is no reference, as far as it can be told what is meant."""
    array, one = _NEARLY.match(text), _ONE.match(text)
    if array:
        name, first, between, last = array.groups()
        each = f", or {name}[{first}], {name}[{last}] for these two" if between in ",;" else ""
        return f"write {name}[{first}..{last}]{each}"
    if one:
        bit = f" for an index; a bit is read with its word: {one[1]}" if one[4] else ""
        return f"write {one[1]}[{one[2] or one[3] or one[5]}]{bit}"
    if _LIST.match(text):
        return f"write [{text}]"
    return "write a number, such as P1120 or P2155[1..2], or a name"


def number_of(text: str) -> int | None:
    """Number of a parameter as written; None for a name or what is no reference."""
    reference = parse_reference(text)
    return reference.pnu if reference is not None else None


def parse_type(text: str) -> tuple[str, int | None] | None:
    """Split ``OctetString[4]`` into name and length; None if the text has another shape."""
    match = _TYPE.match(text)
    return (match[1], int(match[2]) if match[2] else None) if match else None
