"""What may stand for a value in a document: a literal, or a start value made of literals; nothing else is code."""

from __future__ import annotations

import re
from functools import lru_cache

from plcgen.diagnostics import DiagnosticError
from plcgen.s7.blocks import Block, BlockKind, Section, SectionKind
from plcgen.s7.image import StartValueError, image
from plcgen.s7.literals import LiteralError
from plcgen.s7.types import DataType, Elementary, Member, StringType
from plcgen.s7.values import BIT_STRINGS, RANGES, SIGNED, UNSIGNED
from plcgen.scl.constants import filled, is_bits_of_real
from plcgen.scl.lexer import ADDRESS, EOF, INT, LOCAL, NAME, POINTER, QUOTED, REAL, STRING, TYPED, tokenize
from plcgen.simaticml.datatypes import innermost

SINGLE = re.compile(r"[^\s;,:(){}\[\]'\"/]+").fullmatch
"""Whether a value is one word without brackets, quotes and slashes, as numbers are."""
_PARTS = frozenset(
    {INT, REAL, STRING, TYPED, POINTER, NAME, QUOTED, LOCAL, ADDRESS, EOF, "TRUE", "FALSE", "-", "+", "*", "/"}
    | {"(", ")", "[", "]", ",", ".", ":="}
)


_SMALL = 5
"""Numbers with fewer digits fit whatever has 16 bits."""
_WIDE = frozenset(name for name in SIGNED | UNSIGNED | BIT_STRINGS if RANGES[name][1] >= 10 ** (_SMALL - 1))
_REALS = frozenset({"REAL", "LREAL"})
_REAL = re.compile(r"-?[0-9]{1,9}\.[0-9]{1,9}").fullmatch
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
    if type_.__class__ is Elementary:  # most values are small numbers, and documents have many
        name = type_.name
        if (name in _WIDE and len(text) < _SMALL and text.isdecimal()) or (name in _REALS and _REAL(text)):
            return ""
    return _unfit(text, type_)


@lru_cache(maxsize=4096)
def _unfit(text: str, type_: DataType) -> str:
    if not isinstance(innermost(type_), Elementary | StringType) or not _NAMED.isdisjoint(tokenize(text, "").kinds):
        return ""
    found: list[StartValueError] = []
    member = Member("value", type_, text)
    try:
        image(Block(BlockKind.DB, "value", (Section(SectionKind.STATIC, (member,)),)), {}, found)
    except (DiagnosticError, LiteralError):
        return ""  # of a type that is too large there is more to say elsewhere
    wrong = [e for e in found if filled(e.text, e.type_name) is None and not is_bits_of_real(e.text, e.type_name)]
    return wrong[0].reason if wrong else ""
