"""What a VARIANT and an ``ARRAY[*]`` know at run time of what they point to, and functions that ask for it."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, replace

from plcgen.s7.cpu.memory import Memory, Reference
from plcgen.s7.cpu.type_rules import WIDTHS
from plcgen.s7.layout.shapes import Shape
from plcgen.s7.types.data_types import ArrayType, Elementary, NamedType, StringType


@dataclass(frozen=True, slots=True)
class Kind:
    """Type of a variable: ``name`` in upper case, of an array ``ARRAY`` with bounds, strides in bits and elements."""

    name: str
    bits: int
    bounds: tuple[tuple[int, int], ...] = ()
    strides: tuple[int, ...] = ()
    element: Kind | None = None
    room: int = 0
    """Characters of a text."""
    bools: int = 0
    """BOOL in it."""

    @property
    def count(self) -> int:
        """Elements of an array; of BOOL with those that fill up the last byte (help of CountOfElements)."""
        if self.element is None:
            return 0
        number = math.prod(high - low + 1 for low, high in self.bounds)
        return -(-number // 8) * 8 if self.element.name == "BOOL" else number


def kind_of(shape: Shape) -> Kind:
    """Kind of a declared variable."""
    type_ = shape.type
    if isinstance(type_, ArrayType) and shape.element is not None:
        element = kind_of(shape.element)
        number = math.prod(high - low + 1 for low, high in type_.bounds) * element.bools
        return Kind("ARRAY", shape.bits, type_.bounds, shape.strides, element, bools=number)
    bools = sum(kind_of(part.shape).bools for part in shape.fields)
    if isinstance(type_, NamedType | Elementary):
        return Kind(type_.name.upper(), shape.bits, bools=int(type_.name == "BOOL") + bools)
    if isinstance(type_, StringType):
        return Kind(type_.name, shape.bits, room=type_.length)
    members = ";".join(f"{part.member.name} {kind_of(part.shape)}" for part in shape.fields)
    return Kind(f"STRUCT {members}".upper(), shape.bits, bools=bools)


class Typed(tuple[Memory | None, int, int]):  # noqa: SLOT001 - a tuple has no room for slots
    """A reference that knows the kind of what it points to."""

    kind: Kind


def typed(memory: Memory, offset: int, size: int, kind: Kind) -> Typed:
    """Make a reference to a variable."""
    reference = Typed((memory, offset, size))
    reference.kind = kind
    return reference


_NOTHING = Kind("", 0)


def kind_at(reference: Reference) -> Kind:
    """Kind behind a reference; without a name if it points to nothing or came without one."""
    return reference.kind if isinstance(reference, Typed) else _NOTHING


def element_at(reference: Reference, *indices: int) -> int:
    """Offset in bits of an element of an ``ARRAY[*]``; IndexError outside."""
    kind, offset = kind_at(reference), 0
    for index, (low, high), stride in zip(indices, kind.bounds, kind.strides, strict=True):
        if not low <= index <= high:
            raise IndexError(index)
        offset += (index - low) * stride
    return offset


def bound(end: int, reference: Reference, dimension: int) -> tuple[bool, int]:
    """LOWER_BOUND (``end`` 0) and UPPER_BOUND (1)."""
    bounds = kind_at(reference).bounds
    return (True, bounds[dimension - 1][end]) if 1 <= dimension <= len(bounds) else (False, 0)


def get_value(source: Reference, target: Reference) -> tuple[bool, None]:
    """VariantGet and VariantPut: copy a value of one type; nothing is copied between two types."""
    if (
        source[0] is None
        or target[0] is None
        or replace(kind_at(source), room=0, bits=0) != replace(kind_at(target), room=0, bits=0)
    ):
        return False, None
    if kind_at(source).room:
        size = min(source[2], target[2])
        head = 4 if kind_at(source).name == "WSTRING" else 2
        unit = head // 2
        length = min(int.from_bytes(source[0][source[1] + unit : source[1] + head]), kind_at(target).room)
        target[0][target[1] + unit : target[1] + head] = length.to_bytes(unit)
        target[0][target[1] + head : target[1] + size] = source[0][source[1] + head : source[1] + size]
        return True, None
    if kind_at(source).name == "BOOL":
        target[0][target[1]] = source[0][source[1]] & 1
    else:
        target[0][target[1] : target[1] + target[2]] = source[0][source[1] : source[1] + source[2]]
    return True, None


def move_elements(source: Reference, count: int, first: int, at: int, target: Reference) -> int:
    """MOVE_BLK_VARIANT: RET_VAL; a variable that is no array counts as one element."""
    if source[0] is None or target[0] is None:
        return 0x8151 if source[0] is None else 0x8551
    kinds = kind_at(source), kind_at(target)
    elements = [kind.element or kind for kind in kinds]
    counts = [kind.count if kind.element is not None else 1 for kind in kinds]
    if "BOOL" in {element.name for element in elements}:
        return 0x8154 if elements[0].name == "BOOL" else 0x8554
    if elements[0] != elements[1]:
        return 0x80B4
    if count < 1:
        return 0x8281
    for number, index, total in ((0x8382, first, counts[0]), (0x8482, at, counts[1])):
        if not 0 <= index < total:
            return number
        if index + count > total:
            return number + 1
    size = (kinds[0].strides[-1] if kinds[0].strides else kinds[0].bits) // 8
    data = source[0][source[1] + first * size : source[1] + (first + count) * size]
    target[0][target[1] + at * size : target[1] + at * size + len(data)] = data
    return 0


def serialize(source: Reference, target: Reference, position: int) -> tuple[int, int]:
    """Serialize: RET_VAL and the position behind the bytes."""
    return _transfer(source, target, position, 0x8150, 0x8250, 0x8253, forth=True)


def deserialize(source: Reference, target: Reference, position: int) -> tuple[int, int]:
    """Deserialize."""
    return _transfer(target, source, position, 0x8250, 0x8150, 0x8153, forth=False)


def _transfer(
    variable: Reference, array: Reference, position: int, nowhere: int, no_array: int, full: int, *, forth: bool
) -> tuple[int, int]:
    if variable[0] is None or array[0] is None:
        return nowhere if variable[0] is None else no_array, position
    if not 0 <= position < array[2]:
        return 0x8382, position
    size = variable[2]
    if position + size > array[2]:
        return full, position
    start = array[1] + position
    if variable[0] is array[0] and variable[1] < array[1] + array[2] and array[1] < variable[1] + size:
        return 0x80B0, position
    if forth:
        array[0][start : start + size] = variable[0][variable[1] : variable[1] + size]
    else:
        variable[0][variable[1] : variable[1] + size] = array[0][start : start + size]
    return 0, position + size


def scatter(types: tuple[str, ...], value: int, target: Reference) -> tuple[bool, None]:
    """SCATTER: the lowest bit is the first element."""
    width = WIDTHS[types[0]]
    if target[0] is None or kind_at(target).bools < width:
        return False, None
    target[0][target[1] : target[1] + width // 8] = value.to_bytes(width // 8, "little")
    return True, None


def gather(types: tuple[str, ...], source: Reference) -> tuple[bool, None, int]:
    """GATHER: as many bits as the result has; with others nothing is transferred."""
    width = WIDTHS[types[-1]]
    if source[0] is None or kind_at(source).bools != width:
        return False, None, 0
    return True, None, int.from_bytes(source[0][source[1] : source[1] + width // 8], "little")


def to_characters(text: str, first: int, target: Reference) -> tuple[bool, None, int]:
    """Strg_TO_Chars: how many characters found room."""
    size = _character_size(target)
    if target[0] is None or not 0 <= first * size < target[2]:
        return False, None, 0
    count = min(len(text), target[2] // size - first)
    data = text[:count].encode("latin-1" if size == 1 else "utf-16-be", "replace")
    target[0][target[1] + first * size : target[1] + first * size + len(data)] = data
    return count == len(text), None, count


def from_characters(source: Reference, first: int, count: int) -> tuple[bool, None, str]:
    """Chars_TO_Strg: up to a character of code 0; 0 are all."""
    size = _character_size(source)
    if source[0] is None or not 0 <= first * size < source[2]:
        return False, None, ""
    last = source[2] // size if not count else min(first + count, source[2] // size)
    data = bytes(source[0][source[1] + first * size : source[1] + last * size])
    text = data.decode("latin-1" if size == 1 else "utf-16-be", "replace")
    return True, None, text.partition("\0")[0]


def _character_size(reference: Reference) -> int:
    element = kind_at(reference).element
    return 2 if element is not None and element.bits == 16 else 1


def type_of_elements(reference: Reference) -> str:
    """TypeOfElements: of a variable that is no array its own type."""
    kind = kind_at(reference)
    return (kind.element or kind).name


def _characters(reference: Reference) -> tuple[Memory, int, int] | None:
    """Where the characters of a text or of an array are, and how many there are or fit."""
    memory, offset, size = reference
    if memory is None:
        return None
    if kind_at(reference).name == "STRING":
        return memory, offset + 2, min(memory[offset + 1], size - 2)
    return memory, offset, size


def from_hexadecimal(source: Reference, count: int, target: Reference) -> int:
    """ATH: RET_VAL; other characters count as 0, and an odd last digit is the upper one of its byte."""
    digits = _characters(source)
    if digits is None or target[0] is None or not 0 <= count <= digits[2]:
        return 0x8182
    if (count + 1) // 2 > target[2]:
        return 0x8482
    memory, start, _ = digits
    text = memory[start : start + count].decode("latin-1")
    clean = re.sub("[^0-9A-Fa-f]", "0", text)
    data = bytes.fromhex(clean + "0" * (count % 2))
    target[0][target[1] : target[1] + len(data)] = data
    return 0 if clean == text else 7


def to_hexadecimal(source: Reference, count: int, target: Reference) -> int:
    """HTA: two digits in upper case of each byte."""
    data = _characters(source)
    if data is None or target[0] is None or not 0 <= count <= data[2]:
        return 0x8182
    memory, offset, size = target
    text = memory is not None and kind_at(target).name == "STRING"
    room = size - 2 if text else size
    if 2 * count > room or memory is None:
        return 0x8482
    digits = data[0][data[1] : data[1] + count].hex().upper().encode("ascii")
    if text:
        memory[offset : offset + 2] = bytes((room, len(digits)))
        offset += 2
    memory[offset : offset + len(digits)] = digits
    return 0


def clear(reference: Reference) -> None:
    """RESET_TIMER: all bytes 0."""
    memory, offset, size = reference
    if memory is not None:
        memory[offset : offset + size] = bytes(size)
