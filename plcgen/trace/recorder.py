"""Watching a CPU: members whose bytes changed, and every call of WRREC and RDREC with what the drive saw of it."""

from __future__ import annotations

import datetime as dt
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import Any

from plcgen.cpu.cpu import Cpu, Family
from plcgen.cpu.memory import Memory, Reference
from plcgen.cpu.program import Program
from plcgen.cpu.system.bus import Periphery
from plcgen.cpu.system.interfaces import SystemFb
from plcgen.cpu.system.record import RecordBlock, RecordJob
from plcgen.protocols.ds47.sim.drive import Drive
from plcgen.s7.errors import UnfitValueError
from plcgen.s7.layout import layout_block, locate
from plcgen.s7.types import ArrayType, DataType, Elementary
from plcgen.s7.values import SIGNED, UNSIGNED
from plcgen.trace.model import Contact, Kind, RecordCall, Signal, Value


class RecordingCpu(Cpu):
    """A CPU that keeps every call of WRREC and RDREC; ``groups`` says which job an instance data block belongs to."""

    def __init__(self, program: Program, bus: Periphery, family: Family, groups: Mapping[str, str]) -> None:
        self.calls: list[RecordCall] = []
        self.contacts: list[Contact] = []
        self._groups = groups
        self._seen: dict[int, int] = {}
        self._requests: dict[int, bytes] = {}
        self._instances: dict[tuple[str, int], str] = {}
        self.drive_keys: dict[int, str] = {}
        super().__init__(program, bus, family=family)
        self.records.ended = self._note_contacts

    def _runner(self, system: SystemFb) -> Callable[..., None]:
        inner = super()._runner(system)
        if not isinstance(inner, RecordBlock):
            return inner

        def call(memory: Memory, offset: int, record: Reference) -> None:
            inner(memory, offset, record)
            self._note(inner, memory, offset)

        return call

    def take(self) -> tuple[tuple[RecordCall, ...], tuple[Contact, ...]]:
        """Hand out what happened since the last call."""
        found = tuple(self.calls), tuple(self.contacts)
        self.calls.clear()
        self.contacts.clear()
        return found

    def _note(self, block: RecordBlock, memory: Memory, offset: int) -> None:
        def bit(place: tuple[int, int]) -> bool:
            return bool(memory[offset + place[0]] & place[1])

        instance = self._instance(memory, offset)
        group = self._groups.get(memory.name.upper(), instance)
        status = int.from_bytes(memory[offset + block.status : offset + block.status + 4])
        finished, busy, error = (bit(flag) for flag in block.flags)
        length = int.from_bytes(memory[offset + block.answer : offset + block.answer + 2])
        self.calls.append(
            RecordCall(group, block.kind, instance, bit(block.req), busy, finished, error, status, length)
        )

    def _note_contacts(self, job: RecordJob) -> None:
        """Keep what a drive wrote into its journal when this job ended."""
        group = self._groups.get(job.memory.name.upper(), self._instance(job.memory, job.offset))
        for drive in (unit for unit in self.bus.drives.values() if isinstance(unit, Drive)):
            seen = self._seen.get(id(drive), 0)
            for found in drive.journal[seen:]:
                if found.direction == "write" and not found.status:
                    self._requests[id(drive)] = found.data
                asked = self._requests.get(id(drive), b"") if found.direction == "read" else b""
                key = self.drive_keys.get(id(drive), "")
                self.contacts.append(Contact(group, key, found.direction, found.index, found.status, found.data, asked))
            self._seen[id(drive)] = len(drive.journal)

    def _instance(self, memory: Memory, offset: int) -> str:
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


def name_drives(cpu: RecordingCpu, drives: Iterable[tuple[str, Drive]]) -> None:
    """Tell the CPU the keys of its drives."""
    cpu.drive_keys |= {id(drive): key for key, drive in drives}


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
            return plain(self.read())
        except ValueError:
            return bytes(self.memory[self.start : self.end]).hex(" ").upper()


def watch(cpu: Cpu, path: str) -> tuple[Watched, DataType]:
    """Find a member, tag or address. Raises KeyError if there is none, ValueError if it is a whole data block."""
    memory, layout, rest, offset, type_ = cpu.symbols.find(path)
    if layout is None and type_ is None:
        raise UnfitValueError(f"{path} is a whole data block: name a member")
    declared: DataType
    if layout is not None:
        entry = locate(layout, rest)
        offset, bits, declared = entry.offset, entry.size, entry.type
    else:
        assert type_ is not None  # noqa: S101 - one of the two is there
        bits, declared = type_.bits, type_
    mask = 1 << offset % 8 if bits == 1 else 0
    return Watched(memory, offset // 8, -(-(offset + bits) // 8), mask, lambda: cpu[path]), declared


def plain(tree: Any) -> Value:
    """Make a value of the CPU one that every format can write; characters of an array become one text."""
    if isinstance(tree, list):
        items = [plain(item) for item in tree]
        if items and all(isinstance(item, str) and len(item) == 1 for item in items):
            return "".join(str(item) for item in items)
        return items
    if isinstance(tree, dict):
        return {name: plain(item) for name, item in tree.items()}
    if isinstance(tree, dt.datetime | dt.date):
        return tree.isoformat()
    return tree if isinstance(tree, bool | int | float | str) else str(tree)


def kind_of(type_: DataType) -> tuple[Kind, int]:
    """Kind and width in bits of a type; of its elements for an array."""
    while isinstance(type_, ArrayType):
        type_ = type_.element
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
    kind, bits = kind_of(type_)
    return Signal(group, name, kind, bits, path=path, **more), watched
