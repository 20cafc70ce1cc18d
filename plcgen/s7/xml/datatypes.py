"""Spelling of data types in the Datatype attribute and in SCL of the TIA Portal."""

from __future__ import annotations

import re
from functools import lru_cache
from types import MappingProxyType

from plcgen.s7.scl import lexer
from plcgen.s7.types.data_types import ArrayType, DataType, Elementary, StringType, StructType
from plcgen.s7.types.names import is_identifier

_SPELLING = {
    name.upper(): name
    for name in """Bool Byte Word DWord LWord SInt USInt Int UInt DInt UDInt LInt ULInt Real LReal Char WChar Time LTime
    S5Time Date Time_Of_Day LTime_Of_Day LDT DTL Date_And_Time Timer Counter Block_DB Block_FB Block_FC Block_SDB
    Any Pointer Variant Void String WString PORT Struct""".split()  # noqa: SIM905 - one word each
}
BREAKS = re.compile(r"[\r\n\x0b\x0c\x1c-\x1e\x85\u2028\u2029]+")
"""Everything that begins a new line somewhere."""
_RESERVED = lexer.KEYWORDS | (_SPELLING.keys() - {"PORT"}) | {"DB", "NULL", "VERSION"}
"""Names that sources of the TIA Portal have in quotes: keywords, types, and what else was seen there."""
DEFAULT_STRING = 254
REMANENCE = MappingProxyType({"RETAIN": "Retain", "DB_SPECIFIC": "SetInIDB"})
"""What stands behind VAR, and the Remanence of members with the same meaning."""


def type_name(name: str) -> str:
    """Spelling of an unquoted type: ``Bool``, ``Time_Of_Day``; what is not in the table stays as it is."""
    return _SPELLING.get(name.upper(), name)


@lru_cache(maxsize=4096)
def declared_name(name: str) -> str:
    """The name of a member in a source: in quotes where the TIA Portal writes them, as around names of types."""
    plain = is_identifier(name) and name.upper() not in _RESERVED
    return name if plain else '"' + BREAKS.sub(" ", name).replace('"', "_") + '"'


@lru_cache(maxsize=4096)
def datatype(type_: DataType) -> str:
    """A type without the members of a structure: ``Array[0..9] of "typeMotor"``, ``String[16]``, ``Struct``."""
    if isinstance(type_, Elementary):
        return type_name(type_.name)
    if isinstance(type_, StringType):
        length = "" if type_.length == DEFAULT_STRING else f"[{type_.length}]"
        return f"{type_name(type_.name)}{length}"
    if isinstance(type_, ArrayType):
        return f"Array[{type_.bounds_text}] of {datatype(type_.element)}"
    if isinstance(type_, StructType):
        return "Struct"
    return f'"{type_.name}"' if type_.quoted else type_name(type_.name)


def default_literal(type_: DataType) -> str:
    """Literal of the value that an element has without a start value."""
    name = type_.name if isinstance(type_, Elementary | StringType) else ""
    if name in {"STRING", "CHAR"}:
        return "''" if name == "STRING" else "' '"
    return {"BOOL": "FALSE", "REAL": "0.0", "LREAL": "0.0", "TIME": "T#0ms", "S5TIME": "S5T#0ms"}.get(name, "0")
