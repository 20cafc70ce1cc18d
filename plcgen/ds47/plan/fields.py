"""Every byte of a telegram gets a member: the buffer DBs' layout, derived from DS47 alone.

Array members have an even number of bytes and start at even offsets, so that no offset rests on how a compiler
pads arrays. Source of the FAQ names: Siemens FAQ 109750712, figures 4-5, 4-6, 4-9 and 4-10.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from plcgen.ds47.plan.access import Part
from plcgen.ds47.plan.nouns import DriveField
from plcgen.ds47.plan.types import element_type
from plcgen.ds47.wire.formats import Format, padded
from plcgen.ds47.wire.model import Attribute
from plcgen.project.target import Target
from plcgen.s7.types.data_types import ELEMENTARY, ArrayType, DataType

_FAQ_REQUEST = {
    "reference": "Request_Ref", "request_id": "Request_ID", "drive_object": "Axis", "count": "Num_of_Para",
    "attribute": "Para_Attribute", "elements": "Num_of_Element", "pnu": "Para_No", "subindex": "Subindex",
    "format": "Value_Format", "value_count": "No_of_Element", "value": "Value", "pad": "Padding",
}  # fmt: skip
_FAQ_RESPONSE = {
    "reference": "Request_Ref_Mirror", "request_id": "Request_ID", "drive_object": "Axis_Mirror",
    "format": "Para_Format", "value_count": "Num_of_Element", "value": "ParameterValue", "pad": "Padding",
    "error_format": "Error_Format", "error_count": "Num_of_Error_Word", "error_number": "Error_Number",
    "error_info": "Error_Info", "reserve": "Reserve",
}  # fmt: skip
_STYLE_REQUEST = {
    "reference": "requestReference", "request_id": "requestId", "drive_object": "driveObject",
    "count": "parameterCount", "attribute": "attribute", "elements": "elementCount", "pnu": "parameterNumber",
    "subindex": "subindex", "format": "valueFormat", "value_count": "valueCount", "pad": "padding",
}  # fmt: skip
_STYLE_RESPONSE = {
    "reference": "referenceMirror", "request_id": "responseId", "drive_object": "driveObjectMirror",
    "count": "parameterCount", "format": "valueFormat", "value_count": "valueCount", "pad": "padding",
    "error_format": "errorFormat", "error_count": "errorWordCount", "error_number": "errorNumber",
    "error_info": "errorInfo", "reserve": "reserve",
}  # fmt: skip

BYTE, WORD = ELEMENTARY["BYTE"], ELEMENTARY["WORD"]


def value_member(fmt: Format, count: int, first: int, where: Target) -> tuple[DataType, int]:
    """Type of a value member and the number of bytes it covers, pad included where it is part of an array.

    ``first`` is the subindex of the first value: arrays are numbered as the drive numbers them.
    """
    size = count * fmt.size
    element = element_type(fmt, where)
    if element is None:
        return ArrayType(((0, padded(size) - 1),), BYTE), padded(size)
    if fmt.is_string:
        return ArrayType(((1, padded(count)),), element), padded(size)
    if count == 1:
        return element, size
    extra = size % 2
    return ArrayType(((first, first + count - 1 + extra),), element), size + extra


def interface_type(fmt: Format, count: int, first: int, where: Target) -> DataType:
    """Type of a value at the block's interface: as the buffer member, without a pad element."""
    if fmt.name == "Boolean" and count == 1:
        return ELEMENTARY["BOOL"]
    element = element_type(fmt, where)
    if element is None:
        return ArrayType(((0, count * fmt.size - 1),), BYTE)
    if fmt.is_string:
        return ArrayType(((1, count),), element)
    return element if count == 1 else ArrayType(((first, first + count - 1),), element)


@dataclass(slots=True)
class _Layout:
    """Collects fields front to back."""

    names: dict[str, str]
    own: dict[str, str]
    single: bool
    style: bool
    fields: list[DriveField]
    offset: int = 0

    def add(
        self, role: str, type_: DataType, size: int, data: bytes, part: Part | None = None, position: int = 0
    ) -> None:
        name = self.names.get(role, "")
        if role == "value" and self.style and part is not None:
            name = part.use.member
        elif position and not self.single:
            name = f"{name}_{position}" if not self.style else f"{name}{position}"
        name = self.own.get(name, name)
        self.fields.append(DriveField(name, role, type_, self.offset, size, data.ljust(size, b"\0"), part))
        self.offset += size

    def byte(self, role: str, value: int = 0, part: Part | None = None, position: int = 0) -> None:
        self.add(role, BYTE, 1, bytes([value]), part, position)

    def word(self, role: str, value: int = 0, part: Part | None = None, position: int = 0) -> None:
        self.add(role, WORD, 2, value.to_bytes(2, "big"), part, position)

    def block(self, part: Part, position: int, where: Target, data: bytes, *, header: bool) -> None:
        self.byte("format", part.use.format.code if header else 0, part, position)
        self.byte("value_count", part.count if header else 0, part, position)
        type_, size = value_member(part.use.format, part.count, part.subindex, where)
        self.add("value", type_, size, data, part, position)
        if self.offset % 2:
            self.byte("pad", 0, part, position)


def request_fields(
    parts: Sequence[Part],
    header: tuple[int, int, int],
    where: Target,
    own: dict[str, str],
    *,
    write: bool,
    faq: bool,
) -> tuple[DriveField, ...]:
    """Members of the request DB; ``header`` is (reference, request id, drive object)."""
    layout = _Layout(_FAQ_REQUEST if faq else _STYLE_REQUEST, own, len(parts) == 1, not faq, [])
    for role, value in zip(("reference", "request_id", "drive_object"), header, strict=True):
        layout.byte(role, value)
    layout.byte("count", len(parts))
    for position, part in enumerate(parts, 1):
        layout.byte("attribute", Attribute.VALUE, part, position)
        layout.byte("elements", part.elements, part, position)
        layout.word("pnu", part.use.parameter.pnu, part, position)
        layout.word("subindex", part.subindex, part, position)
    if write:
        for position, part in enumerate(parts, 1):
            layout.block(part, position, where, part.data, header=True)
    return tuple(layout.fields)


def response_fields(
    parts: Sequence[Part], size: int, where: Target, own: dict[str, str], *, write: bool, faq: bool
) -> tuple[DriveField, ...]:
    """Members of the response DB, ``size`` bytes long; what the positive answer leaves free is a reserve."""
    names = dict(_FAQ_RESPONSE if faq else _STYLE_RESPONSE)
    if faq:
        names["count"] = "Num_of_Para" if write else "Num_of_para"  # figures 4-10 and 4-6 differ in this letter
    layout = _Layout(names, own, len(parts) == 1, not faq, [])
    for role in ("reference", "request_id", "drive_object", "count"):
        layout.byte(role)
    if not write:
        for position, part in enumerate(parts, 1):
            layout.block(part, position, where, b"", header=False)
    elif len(parts) == 1 and size - layout.offset >= 6:
        layout.byte("error_format")
        layout.byte("error_count")
        layout.word("error_number")
        layout.word("error_info")
    rest = size - layout.offset
    if rest > 1:
        even = rest - rest % 2
        layout.add("reserve", ArrayType(((0, even - 1),), BYTE), even, b"")
    if rest > 0 and rest % 2:
        layout.byte("reserve" if rest == 1 else "pad")
    return tuple(layout.fields)
