"""Values as a spec writes them: numbers, names of values, sources, texts (docs/spec.md "Parameters")."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from decimal import Decimal
from typing import Any

from plcgen.oracles.spec.ds47.parameters import WrittenParameter
from plcgen.oracles.spec.ds47.statement import FromInput, Number, Source
from plcgen.oracles.spec.ds47.types import base, is_float, string_octets
from plcgen.oracles.spec.place import NotStatedError

_SOURCE = re.compile(r"[PpRr]0*(\d+)(?:\.(\d+)|\[(\d+)\])?(?:@(self|\d+))?")
_S7 = re.compile(r"(?:(?:B|W|DW|L|BYTE|WORD|DWORD)#)?(16|8|2)#([0-9A-Fa-f_]+)")
OWN_OBJECT = 0x3F
"""The drive object that is addressed (G110M operating instructions p. 198)."""
SELF = "self"


def number_meant(value: Any, parameter: WrittenParameter, profile: Mapping[str, Any]) -> Number | str:
    """One value: a number, a name of the parameter's values, a source, S7 notation, text, or octets."""
    if isinstance(value, bool):
        return int(value)
    if isinstance(value, int | float):
        return float(value) if is_float(parameter.type) else counts(value, parameter.facts)
    text = str(value)
    if string_octets(parameter.type):
        return text
    names = parameter.facts.get("values") or {}
    if text in names:
        return int(names[text])
    match = _S7.fullmatch(text)
    if match:
        return int(match[2].replace("_", ""), int(match[1]))
    if parameter.bico or _SOURCE.fullmatch(text):
        return source_value(text, profile)
    raise NotStatedError(f"nobody says which number {text!r} of {parameter.text} is")


def counts(value: Number, facts: Mapping[str, Any]) -> Number:
    """A fixed point value as the drive counts it: 3.5 s of 0.01 s each are 350 (docs/spec.md, "Drives")."""
    scale = facts.get("scale")
    return int(Decimal(str(value)) / Decimal(str(scale))) if scale else value


def source_value(text: str, profile: Mapping[str, Any]) -> int:
    """A source as a double word: number in bits 31..16, drive object in 15..10, bit or index in 9..0."""
    match = _SOURCE.fullmatch(text)
    if match is None:
        raise NotStatedError(f"{text!r} is no source")
    number, index, owner = int(match[1]), int(match[2] or match[3] or 0), match[4]
    if profile.get("bico") == "plain":
        return number << 16 | index
    if number == 0 and index == 0 and owner is None:
        return 0
    return number << 16 | (OWN_OBJECT if owner in {None, SELF} else int(owner)) << 10 | index


def octets(type_: str, value: str) -> tuple[int, ...]:
    """Octets of a text or of hexadecimal digits; what a shorter one is filled up with nobody says."""
    data = bytes.fromhex(value) if base(type_) == "OctetString" else value.encode("latin-1", "replace")
    return tuple(data)


def sources_of(
    parameter: WrittenParameter, given: Any, profile: Mapping[str, Any], name: str, start: Any
) -> tuple[Source, ...]:
    """What is written to each index: constants, or an input named ``name`` with ``start`` values."""
    length = string_octets(parameter.type)
    count = parameter.count
    if given is not None:
        return tuple(number_meant(one, parameter, profile) for one in _spread(given, count))
    begin = start_of(parameter, start, profile)
    if length:
        return tuple(FromInput(name, index, begin[0]) for index in range(length))
    if count == 1:
        return (FromInput(name, None, begin[0]),)
    return tuple(FromInput(name, parameter.first + at, begin[at]) for at in range(count))


def start_of(parameter: WrittenParameter, start: Any, profile: Mapping[str, Any]) -> list[Number | str]:
    """Start values of an input: those of the spec, else the factory setting, else zero or the limit nearest to it."""
    given = parameter.facts.get("default") if start is None else start
    if given is None:
        given = "" if string_octets(parameter.type) else nearest_to_zero(parameter.facts)
    return [number_meant(one, parameter, profile) for one in _spread(given, parameter.count)]


def nearest_to_zero(facts: Mapping[str, Any]) -> Number:
    """Zero, if the limits allow it."""
    low, high = facts.get("min"), facts.get("max")
    found: Number = 0
    if low is not None and low > 0:
        found = low
    if high is not None and high < 0:
        found = high
    return found


def _spread(given: Any, count: int) -> list[Any]:
    if isinstance(given, Sequence) and not isinstance(given, str):
        return list(given)
    return [given] * count
