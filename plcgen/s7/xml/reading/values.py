"""What may stand for a value in a document: a literal, or a start value made of literals; nothing else is code."""

from __future__ import annotations

import re
from functools import lru_cache

from plcgen.base.diagnostics import DiagnosticError
from plcgen.s7.layout.image import StartValueError, image
from plcgen.s7.scl.constants import filled, is_bits_of_real
from plcgen.s7.scl.lexer import ADDRESS, EOF, INT, LOCAL, NAME, POINTER, QUOTED, REAL, STRING, TYPED, tokenize
from plcgen.s7.types.blocks import Block, BlockKind, Section, SectionKind
from plcgen.s7.types.data_types import ELEMENTARY, DataType, Elementary, Member, StringType, innermost
from plcgen.s7.types.literals import LiteralError, parse_literal
from plcgen.s7.types.values import BIT_STRINGS, RANGES, SIGNED, UNSIGNED

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
