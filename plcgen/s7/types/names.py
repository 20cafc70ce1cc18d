"""Identifier rules of STEP 7 V5 and TIA Portal, file names, and names made from other names."""

from __future__ import annotations

import re
import unicodedata
import zlib

from plcgen.base.paths import is_device

V5_LIMIT = 24
TIA_LIMIT = 125

RESERVED = frozenset(
    {
        "AND",
        "ANY",
        "ARRAY",
        "AT",
        "BEGIN",
        "BLOCK_DB",
        "BLOCK_FB",
        "BLOCK_FC",
        "BLOCK_SDB",
        "BLOCK_SFB",
        "BLOCK_SFC",
    }
    | {"BOOL", "BY", "BYTE", "CASE", "CHAR", "CONST", "CONSTANT", "CONTINUE", "COUNTER", "DATA_BLOCK", "DATE"}
    | {"DB", "NULL"}  # sources of the TIA Portal have these in quotes
    | {
        "DATE_AND_TIME",
        "DINT",
        "DIV",
        "DO",
        "DT",
        "DTL",
        "DWORD",
        "ELSE",
        "ELSIF",
        "EN",
        "END_CASE",
        "END_CONST",
    }
    | {"END_DATA_BLOCK", "END_FOR", "END_FUNCTION", "END_FUNCTION_BLOCK", "END_IF", "END_LABEL", "END_REGION"}
    | {
        "END_ORGANIZATION_BLOCK",
        "END_REPEAT",
        "END_STRUCT",
        "END_TYPE",
        "END_VAR",
        "END_WHILE",
        "ENO",
        "EXIT",
    }
    | {
        "FALSE",
        "FOR",
        "FUNCTION",
        "FUNCTION_BLOCK",
        "GOTO",
        "IF",
        "INT",
        "LABEL",
        "LDT",
        "LINT",
        "LREAL",
        "LTIME",
    }
    | {"LTIME_OF_DAY", "LTOD", "LWORD", "MOD", "NIL", "NON_RETAIN", "NOT", "NULL", "OF", "OK", "OR"}
    | {
        "ORGANIZATION_BLOCK",
        "POINTER",
        "REAL",
        "REF_TO",
        "REGION",
        "REPEAT",
        "RETAIN",
        "RETURN",
        "S5TIME",
        "SINT",
    }
    | {
        "STRING",
        "STRUCT",
        "THEN",
        "TIME",
        "TIMER",
        "TIME_OF_DAY",
        "TO",
        "TOD",
        "TRUE",
        "TYPE",
        "UDINT",
        "UINT",
    }
    | {
        "ULINT",
        "UNTIL",
        "USINT",
        "VAR",
        "VAR_INPUT",
        "VAR_IN_OUT",
        "VAR_OUTPUT",
        "VAR_TEMP",
        "VARIANT",
        "VERSION",
    }
    | {"VOID", "WCHAR", "WHILE", "WORD", "WSTRING", "XOR"}
)
"""Reserved words of SCL in all dialects, in upper case; letter case does not matter."""

_V5_IDENTIFIER = re.compile(r"[A-Za-z_][A-Za-z0-9_]*")
_V5_ABSOLUTE = re.compile(r"(?:DB|DI|FB|FC|OB|SFB|SFC|SDB|UDT|VAT|[TZC])\d+", re.IGNORECASE)
_PATH = re.compile(r'[\\/:*?"<>|]')

is_identifier = re.compile(r"[^\W\d]\w*").fullmatch
"""Whether a name stands in a source without quotes, as far as its characters say."""

ROLES = frozenset({"symbol", "identifier", "file"})
"""``symbol``: a block, tag or table; ``identifier``: a declared variable; ``file``: a file name."""


def check_name(name: str, toolchain_is_v5: bool, role: str) -> str | None:  # noqa: FBT001 - fixed signature
    """Why a name is not allowed, or None.

    ``role`` is one of ROLES; a symbol also has to serve as a file name, because sources are named after it.
    Raises ValueError for another role.
    """
    if role not in ROLES:
        raise ValueError(f"role {role}: one of {', '.join(sorted(ROLES))}")
    if not name:
        return "a name must not be empty"
    if name != name.strip():
        return "a name must not begin or end with a space"
    for char in name:
        if not char.isprintable():
            return f"the character U+{ord(char):04X} is not allowed"
    if not unicodedata.is_normalized("NFC", name):
        return "a letter and its accent are two characters: they look like one, and another name would look the same"
    if role == "file":
        return check_file_name(name)
    limit = V5_LIMIT if toolchain_is_v5 else TIA_LIMIT
    if len(name) > limit:
        return f"{len(name)} characters, at most {limit} are allowed"
    for char in '".' if role == "symbol" or not toolchain_is_v5 else '"':
        if char in name:
            return f"the character {char} is not allowed"
    if name.upper() in RESERVED:
        return f"{name.upper()} is a reserved word of SCL"
    if role == "symbol":
        return check_file_name(name)
    return _v5_identifier(name) if toolchain_is_v5 else None


def _v5_identifier(name: str) -> str | None:
    if _V5_IDENTIFIER.fullmatch(name) is None:
        return "only the letters A-Z and a-z, digits and _ are allowed, no digit first"
    if "__" in name:
        return "two underscores in a row are not allowed"
    if name.endswith("_"):
        return "a trailing underscore is not allowed"
    if _V5_ABSOLUTE.fullmatch(name):
        return f"{name} is an absolute address"
    return None


def check_file_name(name: str) -> str | None:
    """Why a name cannot be a file name on Windows or would leave its folder, or None."""
    match = _PATH.search(name)
    if match is not None:
        return f"the character {match.group()} is not allowed in a file name"
    if name in (".", ".."):
        return f"{name} is a folder, not a name"
    if name[-1] in ". ":
        return "a file name must not end with a dot or a space"
    if is_device(name):
        return f"{name} is a device name on Windows"
    return None


def shorten(name: str, limit: int) -> str:
    """Cut a name to ``limit`` characters: its beginning, ``_`` and three hex digits of its CRC-32.

    The same name always gives the same result; a short name comes back unchanged. Raises ValueError for a
    limit below 5.
    """
    if limit < 5:
        raise ValueError("at least 5 characters are needed")
    if len(name) <= limit:
        return name
    digest = f"{zlib.crc32(name.encode()) & 0xFFF:03x}"
    return f"{name[: limit - 4].rstrip('_')}_{digest}"


def first_upper(name: str) -> str:
    """A name that begins with a capital letter, otherwise as it is."""
    return name[:1].upper() + name[1:]


def pascal_case(name: str) -> str:
    """``read_speed_limit`` -> ``ReadSpeedLimit``; letters that are upper case already stay so."""
    return "".join(part[0].upper() + part[1:] for part in re.split(r"[_\W]+", name) if part)


def camel_case(name: str) -> str:
    """``read_speed_limit`` -> ``readSpeedLimit``."""
    pascal = pascal_case(name)
    return pascal[:1].lower() + pascal[1:]
