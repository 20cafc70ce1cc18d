"""Functions that move bytes: BLKMOV, FILL, MOVE_BLK, PEEK, POKE, READ_BIG; and pointers to memory and back."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from plcgen.base.diagnostics import PlcgenError
from plcgen.s7.cpu.kinds import Typed, typed
from plcgen.s7.cpu.memory import AREA_L, CODECS, Memory, Reference, codec_functions

_CODES = {0x80: "P", 0x81: "I", 0x82: "Q", 0x83: "M", 0x84: "DB", 0x85: "DB", 0x86: "L"}
_AREA_CODES = {"P": 0x80, "I": 0x81, "Q": 0x82, "M": 0x83, "DB": 0x84, "L": 0x86}
_PEEKED = {0x81: False, 0x82: False, 0x83: False, 0x84: True}
"""Areas of PEEK and POKE, I, Q, M and DB, and whether DBNUMBER may be other than 0 (help of the TIA Portal)."""
_BAD_POSITION = 0x80B4 - 0x10000
_SIZES = {1: 1, 2: 1, 3: 1, 4: 2, 5: 2, 6: 4, 7: 4, 8: 4, 9: 2, 10: 4, 11: 4, 12: 2, 14: 8, 0x13: 1}
_BOOL = 1
_S7 = 0x10
"""Syntax ID of an ANY for S7 (System and Standard Functions, "Format of the Parameter Type ANY")."""
_NO_ANY: Reference = None, 0, -1
_UNALIGNED: Reference = None, 0, -2

_HANDLES = 4000
"""Pointers to local data that are known at once."""
MOVE_LIMIT = 1 << 28
"""Bytes that blocks and structures may move in one scan."""

Report = Callable[[str, str], None]
Between = Callable[[], object]


def _nothing() -> None:
    """Nobody interrupts a copy."""


class AccessFaultError(PlcgenError):
    """An access that stops the block, as in a CPU without an error OB."""

    def __init__(self, code: str, message: str) -> None:
        self.code = code
        super().__init__(message)


class MemoryMoves:
    """The functions of one CPU; ``locate`` finds an area by its name and DB number."""

    def __init__(self, locate: Callable[[str, int], Memory | None], report: Report) -> None:
        self.locate = locate
        self.report = report
        self.handles: dict[int, Memory] = {}
        self.known: dict[bytes, tuple[Memory, int]] = {}  # POINTERs to what stays where it is
        self.kinds: dict[bytes, Typed] = {}  # references behind POINTERs that know their type
        self.variants: dict[tuple[int, int, str], Reference] = {}
        self.lent = 0
        self.moved = 0

    def functions(self) -> dict[str, Callable[..., Any]]:
        """Return what generated code calls."""
        names = "pt local deref any_of any10 ptr6 blkmov fill move_elements fill_elements peek peek_bit poke poke_bit"
        names += " keep kept pointed blkmov_text chars poke_block opened lend give_back take put copy there"
        return {name: getattr(self, name) for name in names.split()}

    # --- references -----------------------------------------------------------------------------------

    def pt(self, area: str, db: int, byte: int, size: int) -> Reference:
        """Memory behind a ``P#`` constant."""
        return self.locate(area, db), byte, size

    @staticmethod
    def local(size: int, optimized: bool = False) -> Memory:  # noqa: FBT001, FBT002 - called from generated code
        """New local data."""
        return Memory(size, AREA_L, optimized=optimized)

    def lend(self, reference: Reference, optimized: bool) -> Reference:  # noqa: FBT001 - called from generated code
        """Reference to a structured IN_OUT: a copy in local data if the called block has another access setting.

        Source: help of the TIA Portal, "Parameter transfer with S7-1200/1500"; FAQ 109478253.
        """
        memory, offset, size = reference
        if memory is None or memory.optimized == optimized:
            return reference
        self.count(2 * size)  # there and back
        copied = Memory(memory[offset : offset + size], AREA_L, optimized=optimized)
        return typed(copied, 0, size, reference.kind) if isinstance(reference, Typed) else (copied, 0, size)

    def give_back(self, reference: Reference, lent: Reference, between: Between = _nothing) -> None:
        """Copy a lent copy back behind the call, over whatever was written there meanwhile."""
        if lent is not reference and reference[0] is not None and lent[0] is not None:
            self.cp(reference[0], reference[1], lent[0], 0, reference[2], between)

    def ptr6(self, reference: Reference) -> bytes:
        """POINTER to a reference."""
        memory, offset, _ = reference
        if memory is None:
            return bytes(6)
        number = memory.number
        if memory.area == AREA_L:
            # the oldest goes: those of the calls that run are the newest
            number = self.lent = self.lent % 0xFFFF + 1
            self.handles[number] = memory
            if len(self.handles) > _HANDLES:
                del self.handles[next(iter(self.handles))]
        pointer = number.to_bytes(2) + bytes((_AREA_CODES[memory.area],)) + (offset * 8).to_bytes(3)
        if isinstance(reference, Typed):
            self.kinds[pointer] = reference
            if len(self.kinds) > _HANDLES:
                del self.kinds[next(iter(self.kinds))]
        return pointer

    def pointed(self, pointer: bytes) -> Reference:
        """Reference behind the POINTER of an ``ARRAY[*]``."""
        return self.kinds.get(pointer, _NO_ANY)

    def keep(self, memory: Memory, offset: int, name: str, reference: Reference) -> None:
        """A VARIANT of an instance."""
        self.variants[id(memory), offset, name] = reference

    def kept(self, memory: Memory, offset: int, name: str) -> Reference:
        """What a VARIANT of an instance points to; nothing before the first call."""
        return self.variants.get((id(memory), offset, name), (None, 0, 0))

    def any10(self, reference: Reference) -> bytes:
        """ANY to a reference, counted in bytes."""
        return b"\x10\x02" + min(reference[2], 0xFFFF).to_bytes(2) + self.ptr6(reference)

    def deref(self, data: bytes) -> tuple[Memory, int]:
        """Memory and byte offset behind a POINTER; AccessFaultError if there is none."""
        known = self.known.get(data)
        if known is not None:
            return known
        memory = self.area(data[2], int.from_bytes(data[:2]))
        if memory is None:
            raise AccessFaultError("PG834", "a parameter passed by reference points nowhere")
        found = memory, (int.from_bytes(data[3:6]) & 0x7FFFF) >> 3
        if memory.area != AREA_L and len(self.known) < _HANDLES:
            self.known[data] = found
        return found

    @staticmethod
    def there(reference: Reference) -> tuple[Memory, int]:
        """Memory and byte offset of a parameter passed by reference; AccessFaultError if there is none."""
        if reference[0] is None:
            raise AccessFaultError("PG834", "a parameter passed by reference points nowhere")
        return reference[0], reference[1]

    def area(self, code: int, number: int) -> Memory | None:
        """Memory of an area code."""
        if code == _AREA_CODES[AREA_L]:
            return self.handles.get(number)
        area = _CODES.get(code)
        return None if area is None else self.locate(area, number)

    def any_of(self, memory: bytearray, offset: int) -> Reference:
        """Reference behind an ANY that lies in memory; to nothing if it has another syntax ID or no type of data.

        A bit address of anything but bits leads to nothing either: an alignment error, RET_VAL 8x28h and 8x29h of the
        manual System and Standard Functions.
        """
        data = bytes(memory[offset : offset + 10])
        if data[0] != _S7 or data[1] not in _SIZES:
            return _NO_ANY
        if data[1] != _BOOL and data[9] & 7:
            return _UNALIGNED
        size = _SIZES[data[1]] * int.from_bytes(data[2:4])
        return self.area(data[6], int.from_bytes(data[4:6])), (int.from_bytes(data[7:10]) & 0x7FFFF) >> 3, size

    def opened(self, number: int) -> Memory:
        """Data block behind a number; AccessFaultError if there is none."""
        found = self.locate("DB", number)
        if found is None:
            raise AccessFaultError("PG834", f"there is no DB{number}")
        return found

    # --- blocks ---------------------------------------------------------------------------------------

    def blkmov(self, source: Reference, target: Reference, between: Between = _nothing) -> int:
        """SFC20: as many bytes as both sides have; RET_VAL names the parameter that is wrong.

        ``between`` is called in the middle: SFC20 can be interrupted (System and Standard Functions, SFC20), SFC81 not.
        """
        problem = self.problem(source, 1, 0x22) or self.problem(target, 3, 0x23)
        if problem or source[0] is None or target[0] is None:
            return problem
        size = min(source[2], target[2])
        self.count(size)
        self.cp(target[0], target[1], source[0], source[1], size, between)
        return 0

    @staticmethod
    def chars(text: Reference) -> Reference:
        """The characters that a STRING holds: BLKMOV moves these (help, "Rules for moving character strings")."""
        memory, offset, size = text
        return text if memory is None else (memory, offset + 2, min(memory[offset + 1], size - 2))

    def blkmov_text(self, source: Reference, target: Reference, between: Between = _nothing) -> int:
        """SFC20 from a STRING to a STRING: the characters, and how many these are."""
        memory, offset, size = target
        characters = self.chars(source)
        problem = self.blkmov(characters, (memory, offset + 2, size - 2), between)
        if not problem and memory is not None:
            memory[offset + 1] = min(characters[2], size - 2)
        return problem

    def fill(self, pattern: Reference, target: Reference) -> int:
        """SFC21: repeat a pattern over a range."""
        problem = self.problem(pattern, 1, 0x22) or self.problem(target, 3, 0x23)
        if problem or pattern[0] is None or target[0] is None:
            return problem
        data = bytes(pattern[0][pattern[1] : pattern[1] + pattern[2]]) or b"\0"
        size = target[2]
        self.count(size)
        target[0][target[1] : target[1] + size] = (data * (size // len(data) + 1))[:size]
        return 0

    def problem(self, reference: Reference, parameter: int, code: int) -> int:
        """RET_VAL of a reference that cannot be used, 0 if it can; beyond the end is a misuse too."""
        memory, offset, size = reference
        if reference is _NO_ANY:
            return (0x8001 | parameter << 8) - 0x10000
        if reference is _UNALIGNED:
            return (0x8000 | parameter << 8 | code + 6) - 0x10000
        if memory is None:
            return (0x803A | parameter << 8) - 0x10000
        if offset < 0 or offset + size > len(memory):
            self.report("PG834", f"bytes {offset} to {offset + size - 1} are not in {describe(memory)}")
            return (0x8000 | parameter << 8 | code) - 0x10000
        return 0

    def move_elements(self, source: Reference, target: Reference, count: int, size: int) -> None:
        """MOVE_BLK: COUNT elements, not beyond either array."""
        total = count * size
        if total > source[2] or total > target[2] or count < 0:
            self.report("PG834", f"{count} elements reach beyond the array")
            return
        self.count(total)
        if source[0] is not None and target[0] is not None:
            target[0][target[1] : target[1] + total] = source[0][source[1] : source[1] + total]

    def fill_elements(self, target: Reference, count: int, type_: str, value: Any) -> None:
        """FILL_BLK: COUNT elements with one value."""
        scratch = Memory(CODECS[type_].size, AREA_L)
        exec(CODECS[type_].write.format(m="m", o=0, v="v"), dict(codec_functions()), {"m": scratch, "v": value})  # noqa: S102
        total = count * len(scratch)
        if total > target[2] or count < 0:
            self.report("PG834", f"{count} elements reach beyond the array")
        elif target[0] is not None:
            self.count(total)
            target[0][target[1] : target[1] + total] = bytes(scratch) * count

    def count(self, size: int) -> None:
        """Add to the bytes moved in this scan; AccessFaultError if they are too many."""
        self.moved += size
        if self.moved > MOVE_LIMIT:
            raise AccessFaultError("PG835", f"one scan moved more than {MOVE_LIMIT} bytes")

    def copy(
        self, target: bytearray, at: int, source: bytearray, start: int, size: int, between: Between = _nothing
    ) -> None:
        """Copy a structure, as an assignment does."""
        self.moved += size
        inside = 0 <= at <= len(target) - size and 0 <= start <= len(source) - size
        if inside and between is _nothing and self.moved <= MOVE_LIMIT:
            target[at : at + size] = source[start : start + size]
        else:
            self.count(0)
            self.cp(target, at, source, start, size, between)

    @staticmethod
    def cp(target: bytearray, at: int, source: bytearray, start: int, size: int, between: Between = _nothing) -> None:
        """Copy a structure; IndexError beyond the end. ``between`` is called behind the first half."""
        if at < 0 or start < 0 or at + size > len(target) or start + size > len(source):
            raise IndexError(at)
        if between is not _nothing:
            half = size // 4 * 2
            target[at : at + half] = source[start : start + half]
            between()
            at, start, size = at + half, start + half, size - half
        target[at : at + size] = source[start : start + size]

    # --- PEEK and POKE --------------------------------------------------------------------------------

    def memory(self, code: int, number: int, offset: int, size: int) -> Memory:
        """Memory that has the bytes; AccessFaultError if not."""
        named = code in _PEEKED and (not number or _PEEKED[code])
        found = self.area(code, number) if named else None
        if found is None or offset < 0 or offset + size > len(found):
            where = f"area 16#{code:02X}, DB{number}" if found is None else describe(found)
            raise AccessFaultError("PG834", f"byte {offset} is not in {where}")
        return found

    def peek(self, code: int, number: int, offset: int, size: int) -> int:
        """PEEK."""
        return int.from_bytes(self.memory(code, number, offset, size)[offset : offset + size])

    def peek_bit(self, code: int, number: int, offset: int, bit: int) -> bool:
        """PEEK_BOOL."""
        return bool(self.memory(code, number, offset, 1)[offset] >> (bit & 7) & 1)

    def poke(self, code: int, number: int, offset: int, size: int, value: int) -> None:
        """POKE."""
        target = self.memory(code, number, offset, size)
        target[offset : offset + size] = (value & (1 << 8 * size) - 1).to_bytes(size)

    def poke_bit(self, code: int, number: int, offset: int, bit: int, value: object) -> None:
        """POKE_BOOL."""
        target = self.memory(code, number, offset, 1)
        mask = 1 << (bit & 7)
        target[offset] = target[offset] | mask if value else target[offset] & 255 - mask

    def poke_block(self, *numbers: int) -> None:
        """POKE_BLK: area, DB and offset of source and target, number of bytes."""
        code, number, offset, to_code, to_number, to_offset, count = numbers
        source = self.memory(code, number, offset, count)
        target = self.memory(to_code, to_number, to_offset, count)
        self.count(count)
        target[to_offset : to_offset + count] = source[offset : offset + count]

    # --- READ_BIG -------------------------------------------------------------------------------------

    @staticmethod
    def take(array: Reference, position: int, size: int, order: str) -> tuple[int, bytes]:
        """READ_BIG: error number and bytes."""
        memory, first, room = array
        if memory is None or position < 0 or position + size > room:
            return _BAD_POSITION, bytes(size)
        data = bytes(memory[first + position : first + position + size])
        return 0, data if order == "big" else data[::-1]

    @staticmethod
    def put(array: Reference, position: int, data: bytes, order: str) -> int:
        """WRITE_BIG: error number."""
        memory, first, room = array
        if memory is None or position < 0 or position + len(data) > room:
            return _BAD_POSITION
        memory[first + position : first + position + len(data)] = data if order == "big" else data[::-1]
        return 0


def describe(memory: Memory) -> str:
    """How messages name a memory."""
    name = f'"{memory.name}" ' if memory.name else ""
    number = str(memory.number) if memory.area == "DB" and memory.number else ""
    return f"{memory.area}{number} {name}of {len(memory)} bytes"
