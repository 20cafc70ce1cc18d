"""The Datatype attribute: its spelling as a type, constants in its bounds, and what no compiler would take."""

from __future__ import annotations

import re
from collections.abc import Mapping
from functools import lru_cache

from plcgen.s7.types.data_types import ArrayType, DataType, NamedType, StringType, StructType, elementary
from plcgen.s7.types.names import is_identifier

MAX_SPELLING = 1000
"""Characters of a Datatype: names have 128 at most, arrays six dimensions."""

MAX_DIMENSIONS = 6
_LENGTHS = {"STRING": 254, "WSTRING": 16382}
"""Longest text by type, in characters."""

_ARRAY = re.compile(r"Array\s*\[(?P<bounds>[^\]]*)\]\s*of\s+(?P<element>.+)", re.IGNORECASE | re.DOTALL)
_BOUNDS = re.compile(r"\s*(-?\d{1,10})\s*\.\.\s*(-?\d{1,10})\s*", re.ASCII)
_OPEN = re.compile(r"\s*\*(?:\s*,\s*\*)*\s*")
_STRING = re.compile(r"(W?String)(?:\[\s*(\d{1,10})\s*\])?", re.IGNORECASE | re.ASCII)
_QUOTED = re.compile(r'"[^"\r\n]+"')
_BRACKETS = re.compile(r"\[([^\]]*)\]")
_CONSTANT = re.compile(r'"([^"\r\n]+)"|#([^\W\d]\w*)')


@lru_cache(maxsize=4096)
def parse_datatype(spelling: str) -> DataType | None:
    """Type of a Datatype attribute, without the members of a Struct; None if it has no fixed size.

    ``"Udt"`` in quotes is a user type, ``Array[0..9] of Word``, ``String[16]``; a version as in ``dtl:v1.0``
    is dropped. An ``Array[*]`` has no bounds.
    """
    spelling = spelling.strip()
    if len(spelling) > MAX_SPELLING:
        return None
    array = _ARRAY.fullmatch(spelling)
    if array:
        element = parse_datatype(array["element"])
        if _OPEN.fullmatch(array["bounds"]):
            return None if element is None else ArrayType((), element, array["bounds"].count("*"))
        bounds = [_BOUNDS.fullmatch(part) for part in array["bounds"].split(",")]
        if element is None or not all(bounds):
            return None
        return ArrayType(tuple((int(b[1]), int(b[2])) for b in bounds if b), element)
    string = _STRING.fullmatch(spelling)
    if string:
        return StringType(string[1].upper(), int(string[2] or 254))
    name = spelling.partition(":")[0].strip()
    if _QUOTED.fullmatch(name):
        return NamedType(name[1:-1], quoted=True)
    if name.upper() == "STRUCT":
        return StructType(())
    if not is_identifier(name):
        return None
    return elementary(name) or NamedType(name)


def with_values(spelling: str, constants: Mapping[str, int | None]) -> tuple[str, str]:
    """The spelling with numbers for the constants in its brackets, and the first constant that is not known.

    ``constants`` are by upper-case name, those of the block itself with ``#``. One without value leaves an array
    without bounds, or a text of one character.
    """
    unknown: list[str] = []

    def value(found: re.Match[str]) -> str:
        name = found[1] if found[1] is not None else f"#{found[2]}"
        number = constants.get(name.upper())
        if number is None:
            unknown.append(found[0])
        return str(number or 0)

    def bracket(found: re.Match[str]) -> str:
        before = len(unknown)
        text = _CONSTANT.sub(value, found[1])
        if len(unknown) > before:
            return "[*]" if ".." in text else "[1]"
        return f"[{text}]"

    return _BRACKETS.sub(bracket, spelling), unknown[0] if unknown else ""


def has_constants(spelling: str) -> bool:
    """Whether a bound or a length is a name."""
    return "[" in spelling and any(_CONSTANT.search(inside) for inside in _BRACKETS.findall(spelling))


@lru_cache(maxsize=4096)
def checked_datatype(spelling: str) -> tuple[DataType | None, str]:
    """Type of a Datatype attribute, and what is wrong with it; empty if nothing is."""
    type_ = parse_datatype(spelling)
    if type_ is None:
        return None, f"the data type {spelling[:80]} has no fixed size"
    return type_, impossible(type_)


def impossible(type_: DataType) -> str:
    """What no compiler takes of a type; empty if there is nothing."""
    while isinstance(type_, ArrayType):
        if len(type_.bounds) > MAX_DIMENSIONS:
            return f"an array has at most {MAX_DIMENSIONS} dimensions"
        for low, high in type_.bounds:
            if high < low:
                return f"the array ends before it begins ({low}..{high})"
            if not -(2**31) <= low <= high < 2**31:
                return f"the array bounds {low}..{high} are no 32-bit numbers"
        type_ = type_.element
    if isinstance(type_, StringType) and not 0 < type_.length <= _LENGTHS[type_.name]:
        return f"{type_.name} has 1 to {_LENGTHS[type_.name]} characters, not {type_.length}"
    return ""
