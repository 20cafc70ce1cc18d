"""How documents spell text, operands and data types; which version of the TIA Portal writes which namespaces.

Source: SimaticML documents of TIA Portal V14 SP1 to V21 and the schemas under ``PublicAPI/Vxx/Schemas``.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from functools import lru_cache
from types import MappingProxyType

from plcgen.s7.scl import lexer
from plcgen.s7.types.data_types import ArrayType, DataType, Elementary, StringType, StructType
from plcgen.s7.types.names import is_identifier

BASE = "http://www.siemens.com/automation/Openness/SW/"
INTERFACE = f"{BASE}Interface/"
STRUCTURED_TEXT = f"{BASE}NetworkSource/StructuredText/"


@dataclass(frozen=True, slots=True)
class Version:
    """The islands of one TIA Portal version by namespace version; ``flg_net`` lists every one it writes.

    ``inferred`` says that no document with the StructuredText namespace of this version was at hand.
    """

    name: str
    interface: str
    structured_text: str
    flg_net: tuple[str, ...]
    inferred: bool = False

    @property
    def interface_namespace(self) -> str:
        """Namespace of ``Sections``."""
        return INTERFACE + self.interface

    @property
    def text_namespace(self) -> str:
        """Namespace of ``StructuredText``."""
        return STRUCTURED_TEXT + self.structured_text

    @property
    def early(self) -> bool:
        """Whether the version is older than V16, the first whose attribute lists are known."""
        return int(self.name[1:3]) < 16

    @property
    def marks_quotes(self) -> bool:
        """Whether names of global variables say that they stand in quotes: from V18 on."""
        return int(self.name[1:3]) >= 18

    @property
    def has_type_namespace(self) -> bool:
        """Whether types carry the attribute Namespace: from V19 on."""
        return int(self.name[1:3]) >= 19


VERSIONS = MappingProxyType(
    {
        version.name: version
        for version in (
            Version("V14 SP1", "v2", "v1", ("v1",), inferred=True),
            Version("V15", "v3", "v2", ("v2", "v3")),
            Version("V15.1", "v3", "v2", ("v2", "v3")),
            Version("V16", "v4", "v3", ("v4",)),
            Version("V17", "v5", "v3", ("v4",)),
            Version("V18", "v5", "v3", ("v4",)),
            Version("V19", "v5", "v4", ("v5",)),
            Version("V20", "v5", "v4", ("v5",), inferred=True),
            Version("V21", "v5", "v4", ("v5",)),
        )
    }
)
"""By the text of ``Engineering@version``. V13 and V14 know no StructuredText: text sources only."""


_ILLEGAL = re.compile("[\x00-\x08\x0b\x0c\x0e-\x1f\ud800-\udfff\ufffe\uffff]")


def content(text: str) -> str:
    """Text of an element; a character that XML cannot hold becomes ``?``."""
    if _ILLEGAL.search(text):
        text = _ILLEGAL.sub("?", text)
    return text.replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;").replace("\r", "&#13;")


def attribute(text: str) -> str:
    """Value of an attribute in double quotes."""
    return content(text).replace('"', "&quot;").replace("\n", "&#10;").replace("\t", "&#9;")


_DATA = re.compile(r"%?DB(\d{1,5})\.DB([XBWDL])(\d{1,5})(?:\.([0-7]))?", re.IGNORECASE | re.ASCII)
_MEMORY = re.compile(r"%?(P?)([IQMEA])([XBWDL]?)(\d{1,5})(?:\.([0-7]))?(:P)?", re.IGNORECASE | re.ASCII)
_NUMBERED = re.compile(r"%(DB|T|C)(\d{1,5})", re.IGNORECASE | re.ASCII)
_TYPES = {"": "Bool", "X": "Bool", "B": "Byte", "W": "Word", "D": "DWord", "L": "LWord"}
_WIDTHS = {"Bool": "X", "Byte": "B", "Word": "W", "DWord": "D", "LWord": "L"}
_AREAS = {"I": "Input", "E": "Input", "Q": "Output", "A": "Output", "M": "Memory"}
_LETTERS = {"Input": "I", "Output": "Q", "Memory": "M", "PeripheryInput": "I", "PeripheryOutput": "Q"}
_WHOLE = {"DB": ("DB", "Block_DB"), "T": ("Timer", "Timer"), "C": ("Counter", "Counter")}


@dataclass(frozen=True, slots=True)
class Operand:
    """An absolute operand; ``bits`` is byte * 8 + bit, or the number of a DB, timer or counter as a whole."""

    area: str
    type: str
    bits: int
    block: int | None = None

    @property
    def text(self) -> str:
        """How SCL writes it, with the mnemonics I, Q, M."""
        if self.type in {"Block_DB", "Timer", "Counter"}:
            return f"%{'DB' if self.area == 'DB' else self.type[0]}{self.bits}"
        width = _WIDTHS.get(self.type, "")
        byte, bit = divmod(self.bits, 8)
        place = f"{byte}.{bit}" if width == "X" else str(byte)
        if self.block is not None:
            return f"%DB{self.block}.DB{width}{place}"
        peripheral = ":P" if self.area.startswith("Periphery") else ""
        return f"%{_LETTERS.get(self.area, 'M')}{'' if width == 'X' else width}{place}{peripheral}"


def address(text: str) -> Operand | None:
    """Read an operand of a source; None if it is no plain one, such as an indexed one."""
    if data := _DATA.fullmatch(text):
        block, letter, byte, bit = data.groups()
        if (letter.upper() == "X") != (bit is not None):
            return None
        return Operand("DB", _TYPES[letter.upper()], int(byte) * 8 + int(bit or 0), int(block))
    if memory := _MEMORY.fullmatch(text):
        early, area, letter, byte, bit, late = memory.groups()
        if (letter.upper() in {"", "X"}) != (bit is not None):
            return None
        name = _AREAS[area.upper()]
        if early or late:
            if name == "Memory":
                return None
            name = f"Periphery{name}"
        return Operand(name, _TYPES[letter.upper()], int(byte) * 8 + int(bit or 0))
    if whole := _NUMBERED.fullmatch(text):
        area, kind = _WHOLE[whole[1].upper()]
        return Operand(area, kind, int(whole[2]))
    return None


_SPELLING = {
    name.upper(): name
    for name in """Bool Byte Word DWord LWord SInt USInt Int UInt DInt UDInt LInt ULInt Real LReal Char WChar Time LTime
    S5Time Date Time_Of_Day LTime_Of_Day LDT DTL Date_And_Time Timer Counter Block_DB Block_FB Block_FC Block_SDB
    Any Pointer Variant Void String WString PORT Struct""".split()  # one word each
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
