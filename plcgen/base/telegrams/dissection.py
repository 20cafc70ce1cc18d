"""Bytes field by field, for people: what the dissectors of all protocols have in common."""

from __future__ import annotations

from dataclasses import dataclass, field


@dataclass(frozen=True, slots=True)
class ByteField:
    """One field: where, its name, the value as text, what it means; ``problem`` marks a wrong one."""

    offset: int
    length: int
    name: str
    value: str
    note: str = ""
    problem: bool = False


@dataclass(slots=True)
class Walker:
    """Goes through bytes from the first to the last and collects fields; every byte belongs to exactly one."""

    data: bytes
    fields: list[ByteField] = field(default_factory=list)
    offset: int = 0

    @property
    def left(self) -> int:
        """Bytes that belong to no field yet."""
        return len(self.data) - self.offset

    def peek(self, size: int) -> int:
        """The number in the next ``size`` bytes, big-endian."""
        return int.from_bytes(self.data[self.offset : self.offset + size], "big")

    def add(self, size: int, name: str, text: str = "", note: str = "", *, problem: bool = False) -> int:
        """Append a field of up to ``size`` bytes (a short one is marked) and return its number."""
        chunk = self.data[self.offset : self.offset + size]
        if not chunk:
            return 0
        if len(chunk) < size:
            note, text, problem = f"cut short: {len(chunk)} of {size} bytes", "", True
        self.fields.append(ByteField(self.offset, len(chunk), name, text or chunk.hex(" ").upper(), note, problem))
        self.offset += len(chunk)
        return int.from_bytes(chunk, "big")

    def hexadecimal(self, size: int, name: str, note: str = "") -> int:
        """Append a number shown as ``0Ah``."""
        return self.add(size, name, f"{self.peek(size):0{2 * size}X}h", note)

    def decimal(self, size: int, name: str, note: str = "", *, problem: bool = False) -> int:
        """Append a number shown as ``10``."""
        return self.add(size, name, str(self.peek(size)), note, problem=problem)
