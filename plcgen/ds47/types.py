"""A data type as people write it, ``FloatingPoint`` or ``OctetString[4]``: which format, how many octets."""

from __future__ import annotations

from plcgen.base.diagnostics import PlcgenError
from plcgen.base.diagnostics.suggest import did_you_mean
from plcgen.ds47.references import parse_type
from plcgen.ds47.wire import formats
from plcgen.ds47.wire.formats import Format

DEFAULT_STRING = 16
"""Octets of a string type without a length."""

_LONGEST_STRING = 234
_PLC_TYPES = {
    "BOOL": "Boolean", "BYTE": "Unsigned8", "USINT": "Unsigned8", "SINT": "Integer8", "WORD": "Unsigned16",
    "UINT": "Unsigned16", "INT": "Integer16", "DWORD": "Unsigned32", "UDINT": "Unsigned32", "DINT": "Integer32",
    "REAL": "FloatingPoint", "FLOAT": "FloatingPoint", "LREAL": "Float64", "STRING": "VisibleString",
}  # fmt: skip
"""What people write who think of the PLC's types, and what the drive calls it."""


class TypeTextError(PlcgenError, ValueError):
    """A text is not a data type of a parameter; ``help`` says which there are."""

    def __init__(self, message: str, help_: str = "") -> None:
        super().__init__(message)
        self.help = help_


def read_type(text: str) -> tuple[Format, int]:
    """Format of a type and, for strings, the number of octets, else 0. Raises TypeTextError."""
    split = parse_type(text)
    try:
        fmt = formats.by_name(split[0]) if split else None
    except KeyError:
        fmt = None
    own = fmt is not None and split is not None and (not fmt.generic or split[0] == fmt.name)  # WORD is the PLC's
    if fmt is None or split is None or not fmt.writable or not own:
        names = [f.name for f in formats.FORMATS if f.writable]
        word = split[0] if split else text
        plc = _PLC_TYPES.get(word.upper())
        hint = did_you_mean(word, names) if plc is None else f'did you mean "{plc}"?'
        raise TypeTextError(f'"{text}" is not a DS47 data type', f"{hint} DS47 types: {', '.join(names)}".strip())
    if split[1] is not None and (not fmt.is_string or not 1 <= split[1] <= _LONGEST_STRING):
        raise TypeTextError(f"{text}: only strings have a length, 1..{_LONGEST_STRING}")
    return fmt, (split[1] or DEFAULT_STRING) if fmt.is_string else 0
