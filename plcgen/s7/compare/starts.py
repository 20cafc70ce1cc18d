"""Canonical start values: the same text for every spelling of a value; those of instances against their blocks.

Of an instance, a text lists behind BEGIN what differs; a document repeats every member, with the value that the
instance has.
"""

from __future__ import annotations

import hashlib
import re
from collections import Counter
from collections.abc import Iterator
from itertools import islice
from typing import TYPE_CHECKING

from plcgen.s7.layout.image import default_bytes
from plcgen.s7.types.blocks import Block, SectionKind
from plcgen.s7.types.data_types import (
    ELEMENTARY,
    ArrayType,
    DataType,
    Elementary,
    Member,
    StringType,
    StructType,
    innermost,
)
from plcgen.s7.types.literals import LiteralError, pack_literal, spell
from plcgen.s7.types.values import unpack_value
from plcgen.s7.xml.writing.starts import single_values

if TYPE_CHECKING:
    from plcgen.s7.layout.shapes import Shape

_BLANK = {"CHAR": b" ", "WCHAR": b"\0 "}
_LONGEST_START = 60
_LONGEST_TEXT = 300
_MOST_VALUES = 10_000


def normalized(text: str) -> str:
    """A literal without blanks and in upper case outside quotes."""
    parts = text.split("'")
    parts[::2] = ["".join(part.split()).upper() for part in parts[::2]]
    return "'".join(parts)


def literal_start(member: Member) -> str:
    """Canonical start value of a member without an image; the text as written if it is a list or does not fit."""
    if member.start is not None and isinstance(member.type, Elementary | StringType):
        try:
            data = pack_literal(member.start, member.type)
        except LiteralError:
            return normalized(member.start)
        if member.type == ELEMENTARY["BOOL"]:
            return "TRUE" if data[0] else ""
        return scalar_start(data, member.type)
    return normalized(member.start or "")


def scalar_start(data: bytes, type_: DataType) -> str:
    """Canonical start value of one value in an image; empty for the default of its type."""
    if isinstance(type_, StringType):
        text = _spelled(data, type_)
        if text in {"''", "WSTRING#''"}:
            return ""
        return text if len(text) <= _LONGEST_TEXT else f"sha256:{hashlib.sha256(data).hexdigest()[:16]}"
    if not isinstance(type_, Elementary) or type_.name in {"ANY", "POINTER"}:
        return "" if not any(data) else data.hex(" ").upper()
    default = _BLANK.get(type_.name)
    if data == default or (default is None and not any(data)):
        return ""
    text = _spelled(data, type_)
    return "" if type_.name == "DATE_AND_TIME" and text.startswith("DT#1990-01-01-00:00:00") else text


def _spelled(data: bytes, type_: Elementary | StringType) -> str:
    try:
        return spell(unpack_value(data, type_), type_, v5=False)
    except ValueError:
        return data.hex(" ").upper()


def array_start(data: bytes, shape: Shape) -> str:
    """Start values of an array whose bytes are ``data``; empty if every element has the default of its type.

    ``[1, 2, 14(0)]``, row by row, if the elements are values; ``[2].speed := 5.0, [3].on := TRUE`` if they are
    structures: what differs from the type, wherever it lies; of an array that declares its structure, what differs from
    most elements, for what all have is as well declared as assigned to each. A digest of that if it is long.
    """
    element = shape.element
    if element is None or not isinstance(shape.type, ArrayType):
        return ""
    blank = _usual(data, shape) if isinstance(element.type, StructType) else default_bytes(element)
    places = list(_differing(data, shape, blank))
    if not places:
        return ""
    if isinstance(element.type, Elementary | StringType):
        text = _listed(data, shape, element, blank)
    else:
        text = ", ".join(_entries(data, element, blank, places))
    if not text:
        return ""
    if len(text) <= (_LONGEST_START if text.startswith("[") and text.endswith("]") else _LONGEST_TEXT):
        return text
    return f"sha256:{hashlib.sha256(text.encode()).hexdigest()[:16]}"


def _usual(data: bytes, shape: Shape) -> bytes:
    """The most frequent contents of an element, of equally frequent ones the first."""
    size = 0 if shape.element is None else shape.element.bits // 8
    return Counter(data[at // 8 : at // 8 + size] for _, at in shape.places()).most_common(1)[0][0]


def _differing(data: bytes, shape: Shape, blank: bytes) -> Iterator[tuple[str, int]]:
    """Elements that do not have the default of their type."""
    if shape.element is not None and shape.element.bits == 1:
        if any(data):
            yield from ((index, at) for index, at in shape.places() if data[at // 8] >> at % 8 & 1)
        return
    for index, at in shape.places():
        if not data.startswith(blank, at // 8):
            yield index, at


def _listed(data: bytes, shape: Shape, element: Shape, blank: bytes) -> str:
    """All values, runs of one value as ``14(0)``; empty if all are defaults."""
    default = "FALSE" if element.bits == 1 else _spelled(blank, element.type)  # type: ignore[arg-type]
    values = [_value(data, element, at) for _, at in shape.places()]
    return f"[{', '.join(_runs([value or default for value in values]))}]" if any(values) else ""


def _value(data: bytes, shape: Shape, at: int) -> str:
    if shape.bits == 1:
        return "TRUE" if data[at // 8] >> at % 8 & 1 else ""
    part = data[at // 8 : (at + shape.bits) // 8]
    return array_start(part, shape) if shape.element is not None else scalar_start(part, shape.type)


def _entries(data: bytes, element: Shape, blank: bytes, places: list[tuple[str, int]]) -> Iterator[str]:
    """Members of structured elements whose value is not that of the type."""
    left = _MOST_VALUES
    leaves = list(islice(_leaves(element, 0, ""), _MOST_VALUES + 1))
    if len(leaves) > _MOST_VALUES:
        yield hashlib.sha256(data).hexdigest()
        return
    for index, start in places:
        for path, leaf, at in leaves:
            value, usual = _value(data, leaf, start + at), _value(blank, leaf, at)
            if value == usual:
                continue
            left -= 1
            if left < 0:
                yield hashlib.sha256(data).hexdigest()
                return
            yield f"[{index}].{path} := {value or 'default'}"


def _leaves(shape: Shape, at: int, prefix: str) -> Iterator[tuple[str, Shape, int]]:
    """Values and arrays below a structure; views hold none of their own."""
    for field in shape.fields:
        if field.member.at is not None:
            continue
        path = f"{prefix}{field.member.name}"
        inner = field.shape.element
        if field.shape.fields:
            yield from _leaves(field.shape, at + field.offset, f"{path}.")
        elif inner is not None and isinstance(inner.type, StructType):
            for index, offset in field.shape.places():
                yield from _leaves(inner, at + field.offset + offset, f"{path}[{index}].")
        else:
            yield path, field.shape, at + field.offset


def _runs(values: list[str]) -> list[str]:
    found: list[tuple[str, int]] = []
    for value in values:
        if found and found[-1][0] == value:
            found[-1] = (value, found[-1][1] + 1)
        else:
            found.append((value, 1))
    return [value if count == 1 else f"{count}({value})" for value, count in found]


_LOCALS = frozenset({SectionKind.TEMP, SectionKind.CONSTANT})


def instance_starts(block: Block, owner: Block | None) -> tuple[tuple[str, str], ...]:
    """Path and canonical literal of every start value that ``owner`` has otherwise; all if it is unknown (None).

    Paths are in upper case and without quotes or blanks; a value that is the default of its type is written out.
    """
    declared = {} if owner is None else _values(owner)
    found = _values(block)
    types = {path: member.type for b in (owner, block) if b is not None for path, member in _instance_leaves(b)}
    changed = {}
    for path, literal in found.items():
        type_ = types.get(re.sub(r"\[[^\]]*\]", "", path))
        usual = declared.get(path)
        own = _canonical(literal, type_)
        before = "" if usual is None else _canonical(usual, type_)
        if owner is None or own != before:
            changed[path] = own or normalized(literal)
    return tuple(changed.items())


def _values(block: Block) -> dict[str, str]:
    """Literals by path: of declarations, single values of arrays by their index; lines behind BEGIN replace them."""
    members = (m for s in block.sections if s.kind not in _LOCALS for m in s.members)
    found = {".".join(name.upper() + index for name, index in way): literal for way, literal in single_values(members)}
    for assignment in block.assignments:
        found["".join(assignment.path.split()).replace('"', "").upper()] = assignment.literal
    return found


def _instance_leaves(block: Block) -> Iterator[tuple[str, Member]]:
    """Members with upper-case paths, those of structures too, and of arrays of them."""
    pending = [("", m) for s in block.sections if s.kind not in _LOCALS for m in s.members]
    while pending:
        prefix, member = pending.pop()
        path = f"{prefix}{member.name.upper()}"
        yield path, member
        inside = innermost(member.type)
        if isinstance(inside, StructType):
            pending += [(f"{path}.", inner) for inner in inside.members]


def _canonical(literal: str, type_: DataType | None) -> str:
    """The same text for every spelling of a value; empty for the default of its type."""
    return normalized(literal) if type_ is None else literal_start(Member("", innermost(type_), literal))
