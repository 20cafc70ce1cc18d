"""Watching a CPU: members whose bytes changed, and every call of the blocks that talk to partners."""

from __future__ import annotations

import datetime as dt
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any

from plcgen.report.trace.model import BlockCall, CallShape, Kind, Signal, Value
from plcgen.s7.cpu.cpu import Cpu
from plcgen.s7.cpu.memory import Memory, Reference
from plcgen.s7.cpu.program import Program
from plcgen.s7.cpu.system.interfaces import SystemFb
from plcgen.s7.cpu.system.point_to_point import PortBlock, Receiver
from plcgen.s7.cpu.system.port import Periphery
from plcgen.s7.cpu.system.record import RecordBlock
from plcgen.s7.layout.layout import layout_block
from plcgen.s7.types.data_types import DataType, Elementary, UnfitValueError, innermost
from plcgen.s7.types.system import Family
from plcgen.s7.types.values import SIGNED, UNSIGNED

SHAPES = {
    "WRREC": CallShape("WRREC", "DONE", 32),
    "RDREC": CallShape("RDREC", "VALID", 32, answers=True),
}


class RecordingCpu(Cpu):
    """A CPU that keeps every call of the system's blocks for records and ports; ``group`` says for which job an
    instance of them works now.
    """

    def __init__(self, program: Program, bus: Periphery, family: Family) -> None:
        self.calls: list[BlockCall] = []
        self.group: Callable[[str], str] = str
        self._instances: dict[tuple[str, int], str] = {}
        super().__init__(program, bus, family=family)

    def _runner(self, system: SystemFb) -> Callable[..., None]:
        inner = super()._runner(system)
        if isinstance(inner, RecordBlock):
            note: Callable[[Memory, int], None] = partial(self._note_record, inner)
        elif isinstance(inner, PortBlock):
            shape = CallShape(inner.kind, inner.ready, 16, answers=isinstance(inner, Receiver))
            note = partial(self._note_port, inner, shape)
        else:
            return inner

        def call(memory: Memory, offset: int, buffer: Reference = (None, 0, 0)) -> None:
            inner(memory, offset, buffer)
            note(memory, offset)

        return call

    def take(self) -> tuple[BlockCall, ...]:
        """Hand out the calls since the last time."""
        found = tuple(self.calls)
        self.calls.clear()
        return found

    def _note_record(self, block: RecordBlock, memory: Memory, offset: int) -> None:
        def bit(place: tuple[int, int]) -> bool:
            return bool(memory[offset + place[0]] & place[1])

        instance = self.instance(memory, offset)
        status = int.from_bytes(memory[offset + block.status : offset + block.status + 4])
        finished, busy, error = (bit(flag) for flag in block.flags)
        length = int.from_bytes(memory[offset + block.answer : offset + block.answer + 2])
        shape, request = SHAPES[block.kind], bit(block.req)
        self.calls.append(
            BlockCall(self.group(instance), shape, instance, request, busy, finished, error, status, length)
        )

    def _note_port(self, block: PortBlock, shape: CallShape, memory: Memory, offset: int) -> None:
        instance = self.instance(memory, offset)
        request, finished, error = (block.bit(memory, offset, name) for name in ("REQ", block.ready, "ERROR"))
        busy = (id(memory), offset) in block.jobs
        status = block.number(memory, offset, "STATUS")
        length = block.number(memory, offset, block.length) if isinstance(block, Receiver) else 0
        self.calls.append(
            BlockCall(self.group(instance), shape, instance, request, busy, finished, error, status, length)
        )

    def instance(self, memory: Memory, offset: int) -> str:
        """Name of an instance: its data block, with the member that lies at the offset."""
        key = (memory.name, offset)
        if key not in self._instances:
            self._instances[key] = memory.name + self._member(memory, offset)
        return self._instances[key]

    def _member(self, memory: Memory, offset: int) -> str:
        entry = self.program.link.find(memory.name)
        if entry is None:
            return ""
        layout = layout_block(entry.block, self.program.link.types)
        here = [e for e in layout.entries if e.byte == offset and e.shape.fields]
        return f".{here[-1].path}" if here else ""


@dataclass(slots=True)
class Watched:
    """A member in memory and its bytes when it was last read."""

    memory: Memory
    start: int
    end: int
    mask: int
    read: Callable[[], Any]
    raw: bytes | int = -1

    def changed(self) -> bool:
        """Whether the bytes differ from those of the last call."""
        raw: bytes | int = bytes(self.memory[self.start : self.end])
        if self.mask:
            raw = self.memory[self.start] & self.mask
        if raw == self.raw:
            return False
        self.raw = raw
        return True

    def value(self) -> Value:
        """Decode the bytes as they are now."""
        try:
            return recorded_value(self.read())
        except ValueError:
            return bytes(self.memory[self.start : self.end]).hex(" ").upper()


class Derived:
    """A value that is worked out from members; it is watched like one."""

    def __init__(self, value: Callable[[], Value]) -> None:
        self.value = value
        self._last: Value | None = None

    def changed(self) -> bool:
        """Whether the value differs from that of the last call."""
        now = self.value()
        if now == self._last:
            return False
        self._last = now
        return True


def watch(cpu: Cpu, path: str) -> tuple[Watched, DataType]:
    """Find a member, tag or address. Raises KeyError if there is none, ValueError if it is a whole data block."""
    memory, member, offset, type_ = cpu.symbols.find(path)
    if member is None and type_ is None:
        raise UnfitValueError(f"{path} is a whole data block: name a member")
    declared: DataType
    if member is not None:
        entry = member[2]
        offset, bits, declared = entry.offset, entry.size, entry.type
    else:
        assert type_ is not None  # one of the two is there
        bits, declared = type_.bits, type_
    mask = 1 << offset % 8 if bits == 1 else 0
    return Watched(memory, offset // 8, -(-(offset + bits) // 8), mask, lambda: cpu[path]), declared


def recorded_value(tree: Any) -> Value:
    """Make a value of the CPU one that every format can write; characters of an array become one text."""
    if isinstance(tree, list):
        items = [recorded_value(item) for item in tree]
        if items and all(isinstance(item, str) and len(item) == 1 for item in items):
            return "".join(str(item) for item in items)
        return items
    if isinstance(tree, dict):
        return {name: recorded_value(item) for name, item in tree.items()}
    if isinstance(tree, dt.datetime | dt.date):
        return tree.isoformat()
    return tree if isinstance(tree, bool | int | float | str) else str(tree)


def recorded_kind(type_: DataType) -> tuple[Kind, int]:
    """Kind and width in bits of a type; of its elements for an array."""
    type_ = innermost(type_)
    if not isinstance(type_, Elementary):
        return "text", 0
    if type_.name == "BOOL":
        return "bool", 1
    if type_.name in {"REAL", "LREAL"}:
        return "real", 64
    if type_.name in SIGNED | UNSIGNED or type_.name in {"TIME", "S5TIME", "LTIME"}:
        return "integer", type_.bits
    return ("word", type_.bits) if type_.name in {"BYTE", "WORD", "DWORD", "LWORD"} else ("text", 0)


def signal(cpu: Cpu, group: str, name: str, path: str, **more: Any) -> tuple[Signal, Watched]:
    """Build the signal of a member. Raises KeyError and ValueError like ``watch``."""
    watched, type_ = watch(cpu, path)
    kind, bits = recorded_kind(type_)
    return Signal(group, name, kind, bits, path=path, **more), watched
