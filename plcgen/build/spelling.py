"""How types, literals and comments are written for a target."""

from __future__ import annotations

from functools import lru_cache

from plcgen.project.target import Target
from plcgen.s7.scl.classic import Spelling
from plcgen.s7.types.data_types import ArrayType, DataType, Elementary
from plcgen.s7.types.literals import format_literal
from plcgen.s7.types.values import unpack_value

_TIA = {
    "BOOL": "Bool", "BYTE": "Byte", "WORD": "Word", "DWORD": "DWord", "LWORD": "LWord", "CHAR": "Char", "INT": "Int",
    "DINT": "DInt", "LINT": "LInt", "SINT": "SInt", "USINT": "USInt", "UINT": "UInt", "UDINT": "UDInt",
    "ULINT": "ULInt", "REAL": "Real", "LREAL": "LReal", "ARRAY": "Array", "OF": "of", "TIME": "Time",
    "DTL": "DTL", "DATE_AND_TIME": "Date_And_Time",
}  # fmt: skip


def spelling_of(where: Target) -> Spelling:
    """How sources are spelled for a target."""
    if where.v5:
        return Spelling.STEP7_V5
    return Spelling.TIA if where.t15 and not where.toolchain.startswith("tia-v13") else Spelling.NO_REGIONS


@lru_cache(maxsize=4)
def type_words(*, tia: bool) -> dict[str, str]:
    """Spelling of each type keyword: ``Bool`` in TIA Portal, ``BOOL`` in STEP 7 V5."""
    return _TIA if tia else {name: name for name in _TIA}


@lru_cache(maxsize=4096)
def declared_type(type_: DataType, *, tia: bool) -> str:
    """Declaration text of a buffer member's type."""
    words = type_words(tia=tia)
    if isinstance(type_, Elementary):
        return words[type_.name]
    if isinstance(type_, ArrayType):
        bounds = ", ".join(f"{low}..{high}" for low, high in type_.bounds)
        return f"{words['ARRAY']}[{bounds}] {words['OF']} {declared_type(type_.element, tia=tia)}"
    raise TypeError(f"buffers hold no {type_!r}")


@lru_cache(maxsize=4096)
def literal(type_: Elementary, data: bytes, *, v5: bool) -> str:
    """Literal of one value given as wire bytes."""
    return format_literal(unpack_value(data, type_), type_.name, v5)


def array_elements(type_: ArrayType, data: bytes, *, v5: bool) -> list[tuple[int, str]]:
    """Index and literal of every array element that differs from its type's default: a blank for CHAR, else zero."""
    element = type_.element
    if not isinstance(element, Elementary):
        raise TypeError(f"buffers hold no array of {element!r}")
    step = element.bits // 8
    low, high = type_.bounds[0]
    pieces = [(index, data[(index - low) * step : (index - low + 1) * step]) for index in range(low, high + 1)]
    default = b" " if element.name == "CHAR" else bytes(step)
    return [(index, literal(element, piece, v5=v5)) for index, piece in pieces if piece != default]


def encodable(text: str, where: Target) -> bool:
    """Whether the target's source encoding has every character of a text."""
    if text.isascii() or not where.v5:
        return True
    try:
        text.encode(where.encoding)
    except UnicodeEncodeError:
        return False
    return True


def comment_text(texts: dict[str, str], languages: tuple[str, ...], where: Target, fallback: str = "") -> str:
    """Comment for a source text: the first of the project's languages that the encoding can hold, one line."""
    for language in (*languages, *texts):
        text = texts.get(language)
        if text and encodable(text, where):
            return one_line(text)
    return fallback


_MARKS = ("(*", "*)", "//", "/*", "*/", "'", "{", "}", ";", '"')
"""What would begin or end something else in a TITLE line; a quote would end that of STEP 7 V5."""


def clean_title(text: str) -> str:
    """A text without what would begin or end something else in a TITLE line."""
    for mark in _MARKS:
        text = text.replace(mark, " ".join(mark) if len(mark) > 1 else " ")
    return " ".join(text.split())


@lru_cache(maxsize=65536)
def one_line(text: str) -> str:
    """A text that is safe inside a line comment: no line breaks or control characters."""
    return " ".join("".join(c if c.isprintable() else " " for c in text).split())


@lru_cache(maxsize=64)
def culture(language: str) -> str:
    """Language tag as TIA Portal writes it: ``en`` -> ``en-US``."""
    return {"en": "en-US", "de": "de-DE", "zh": "zh-CN", "fr": "fr-FR", "it": "it-IT", "es": "es-ES"}.get(
        language, language
    )
