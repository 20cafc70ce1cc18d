"""Types and values in documents: the Datatype attribute, constants in its bounds, start values; never code."""

from __future__ import annotations

import re
from collections.abc import Mapping
from functools import lru_cache

from plcgen.base.diagnostics import DiagnosticError
from plcgen.s7.layout.image import StartValueError, image
from plcgen.s7.scl.constants import filled, is_bits_of_real
from plcgen.s7.scl.lexer import ADDRESS, EOF, INT, LOCAL, NAME, POINTER, QUOTED, REAL, STRING, TYPED, tokenize
from plcgen.s7.types.blocks import Block, BlockKind, Section, SectionKind
from plcgen.s7.types.data_types import (
    ELEMENTARY,
    ArrayType,
    DataType,
    Elementary,
    Member,
    NamedType,
    StringType,
    StructType,
    elementary,
    innermost,
)
from plcgen.s7.types.literals import LiteralError, parse_literal
from plcgen.s7.types.names import is_identifier
from plcgen.s7.types.values import BIT_STRINGS, RANGES, SIGNED, UNSIGNED

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


_PLAIN_TEXT = r"'[ !\"#%&(-~]*'"
"""Pattern of a text of ASCII without anything that needs ``$``."""
SINGLE = re.compile(rf"[^\s;,:(){{}}\[\]'\"/]+|{_PLAIN_TEXT}").fullmatch
"""Whether a value is one word without brackets, quotes and slashes, as numbers are, or a plain text."""
_PARTS = frozenset(
    {INT, REAL, STRING, TYPED, POINTER, NAME, QUOTED, LOCAL, ADDRESS, EOF, "TRUE", "FALSE", "-", "+", "*", "/"}
    | {"(", ")", "[", "]", ",", ".", ":="}
)


def _surely_fitting(name: str) -> str:
    """Pattern of literals that fit a type whatever their digits."""
    if name == "BOOL":
        return "TRUE|FALSE|true|false"
    if name in {"REAL", "LREAL"}:
        return r"-?[0-9]{1,9}\.[0-9]{1,9}"
    if name == "STRING":
        return _PLAIN_TEXT
    if name == "TIME":
        return r"(?:T|TIME)#(?:[0-9]{1,9}(?:ms|MS)|[0-9]{1,6}[sS])"
    digits = len(str(RANGES[name][1])) - 1
    based = f"|16#[0-9A-Fa-f]{{1,{ELEMENTARY[name].bits // 4}}}" if name in BIT_STRINGS else ""
    return f"[0-9]{{1,{digits}}}{based}"


_SURE = {
    name: re.compile(_surely_fitting(name)).fullmatch
    for name in SIGNED | UNSIGNED | BIT_STRINGS | {"BOOL", "REAL", "LREAL", "STRING", "TIME"}
}
"""Most values are plain numbers, and documents have many: of these nothing else is asked."""
_NAMED = frozenset({NAME, QUOTED, LOCAL, ADDRESS, "+", "*", "/"})
"""Constants with values from elsewhere, and expressions of them."""


@lru_cache(maxsize=4096)
def is_literal(text: str) -> bool:
    """Whether a constant is one literal and nothing more: a number, a text, a pointer."""
    if SINGLE(text):
        return True
    kinds = tokenize(text, "").kinds
    return len(kinds) == 2 and kinds[0] in {STRING, TYPED, POINTER} and text == text.strip()


@lru_cache(maxsize=4096)
def is_start_value(text: str) -> bool:
    """Whether a start value is made of literals, names, brackets and commas only, without comments."""
    if is_literal(text):
        return True
    tokens = tokenize(text, "")
    if not _PARTS.issuperset(tokens.kinds):
        return False
    return all(comment.text == "\n" for n in range(len(tokens.kinds)) for comment in tokens.trivia_before(n))


def unfit(text: str, type_: DataType) -> str:
    """Why a start value does not fit its type; empty if it does, or if nobody here can say.

    That is so of constants, and of types that are declared elsewhere.
    """
    if isinstance(type_, (Elementary, StringType)):
        sure = _SURE.get(type_.name)
        if sure is not None and sure(text) and (isinstance(type_, Elementary) or len(text) - 2 <= type_.length):
            return ""
    return _unfit(text, type_)


@lru_cache(maxsize=4096)
def _unfit(text: str, type_: DataType) -> str:
    if not isinstance(innermost(type_), Elementary | StringType) or not _NAMED.isdisjoint(tokenize(text, "").kinds):
        return ""
    found: list[LiteralError] = []
    try:
        if isinstance(type_, Elementary | StringType) and not text.endswith(")"):
            parse_literal(text, type_)
        else:
            found += _unfit_in_image(Member("value", type_, text))
    except LiteralError as error:
        found.append(error)
    except DiagnosticError:
        return ""  # of a type that is too large there is more to say elsewhere
    wrong = [e for e in found if filled(e.text, e.type_name) is None and not is_bits_of_real(e.text, e.type_name)]
    return wrong[0].reason if wrong else ""


def _unfit_in_image(member: Member) -> list[StartValueError]:
    found: list[StartValueError] = []
    image(Block(BlockKind.DB, member.name, (Section(SectionKind.STATIC, (member,)),)), {}, found)
    return found
