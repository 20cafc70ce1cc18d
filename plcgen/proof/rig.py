"""What a generated block runs on: the files on disk in a soft CPU, and the places of its members."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from plcgen.base.diagnostics import DiagnosticError
from plcgen.project.nouns import BlockRef, Project
from plcgen.proof.scenario import ScenarioError
from plcgen.proof.standins import stand_ins
from plcgen.s7.cpu.cpu import Cpu
from plcgen.s7.cpu.program import Program
from plcgen.s7.cpu.sources import FolderParts, read_parts
from plcgen.s7.layout.image import Tree
from plcgen.s7.layout.layout import Layout, locate
from plcgen.s7.types.data_types import Elementary


def read_program(project: Project, folder: Path) -> FolderParts:
    """The folder's sources, with those of the proofs and stand-ins for what is the user's own."""
    proofs = [plan.protocol.proof(plan) for plan in project.plans]
    foreign = stand_ins(project)
    return read_parts(
        folder,
        project.target.dialect,
        constants={name: number for proof in proofs for name, number in proof.constants().items()},
        symbols=foreign.tags,
        more=[*(source for proof in proofs for source in proof.stimulus()), *foreign.sources.values()],
    )


class ProgramBench:
    """A project and the program in its folder, which is read once: a worker compiles what its parent has read."""

    def __init__(self, project: Project, folder: Path, parts: FolderParts | None = None) -> None:
        self.project, self.folder = project, folder
        if parts is not None:
            self.parts = parts

    @cached_property
    def parts(self) -> FolderParts:
        """What is compiled."""
        return read_program(self.project, self.folder)

    @cached_property
    def program(self) -> Program:
        """The compiled sources, with coverage; local data holds garbage, as in a CPU. Raises DiagnosticError."""
        dialect, lean = self.project.target.dialect, self.parts.large
        program = self.parts.load(dialect, coverage=True, litter=True, lean=lean)
        if not program.ok:
            raise DiagnosticError([d for d in program.diagnostics if d.severity.label == "error"])
        return program

    def __reduce__(self) -> tuple[type[ProgramBench], tuple[Project, Path, FolderParts]]:
        """A program cannot be pickled."""
        return ProgramBench, (self.project, self.folder, self.parts)


@dataclass(frozen=True, slots=True)
class Spot:
    """Where a member lies: byte, bytes, and the bit of a BOOL (``flag``)."""

    byte: int
    size: int
    bit: int
    flag: bool = False

    @classmethod
    def of(cls, layout: Layout, path: str) -> Spot:
        """Place of a member. Raises KeyError."""
        entry = locate(layout, path)
        flag = isinstance(entry.type, Elementary) and entry.type.name == "BOOL"
        return cls(entry.byte, (entry.size + 7) // 8, entry.bit, flag)

    def put(self, memory: bytearray, data: bytes) -> None:
        """Store wire bytes."""
        if self.flag:
            memory[self.byte] = memory[self.byte] & 255 - (1 << self.bit) | (data[0] & 1) << self.bit
        else:
            memory[self.byte : self.byte + len(data)] = data

    def bytes(self, memory: bytearray, size: int | None = None) -> bytes:
        """Wire bytes of the member, or the first ``size`` of them."""
        if self.flag:
            return bytes((memory[self.byte] >> self.bit & 1,))
        return bytes(memory[self.byte : self.byte + (self.size if size is None else size)])


class Members:
    """Members of one data block of a CPU, by their paths; ``names`` gives them shorter names."""

    def __init__(self, cpu: Cpu, program: Program, block: str, paths: Iterable[str], prefix: str = "") -> None:
        self.block, self.memory = block, cpu.db(block)
        self.layout = layout_of(program, block)
        self.spots = {path.removeprefix(prefix): Spot.of(self.layout, path) for path in paths}

    def get(self, name: str, *, signed: bool = False) -> int:
        """Value of a member that is a number."""
        spot = self.spots[name]
        return int.from_bytes(self.memory[spot.byte : spot.byte + spot.size], signed=signed)

    def flag(self, name: str) -> bool:
        """Value of a BOOL."""
        spot = self.spots[name]
        return bool(self.memory[spot.byte] >> spot.bit & 1)

    def set(self, name: str, value: int) -> None:
        """Store a number or a BOOL."""
        spot = self.spots[name]
        spot.put(self.memory, bytes((value,)) if spot.flag else value.to_bytes(spot.size, signed=value < 0))

    def put(self, name: str, data: bytes) -> None:
        """Store wire bytes."""
        self.spots[name].put(self.memory, data)

    def bytes(self, name: str, size: int | None = None) -> bytes:
        """Wire bytes of a member."""
        return self.spots[name].bytes(self.memory, size)

    def words(self, name: str, count: int) -> list[int]:
        """The first words of an array."""
        at = self.spots[name].byte
        return [int.from_bytes(self.memory[at + 2 * i : at + 2 * i + 2]) for i in range(count)]


def layout_of(program: Program, name: str) -> Layout:
    """Layout of a block as the soft CPU has it. Raises ScenarioError."""
    entry = program.link.find(name)
    if entry is None or entry.shape is None:
        raise ScenarioError(f'"{name}" is missing')
    return Layout(entry.shape.bits // 8, entry.shape)


def file_of(program: Program, block: str) -> str:
    """File in which a block is declared; empty if there is no such block."""
    entry = program.link.find(block)
    return entry.result.tokens.file if entry is not None else ""


class Source:
    """The source of a block: its file, and which probes of coverage are its own, with a few others between them."""

    def __init__(self, program: Program, block: BlockRef | str) -> None:
        entry = program.link.find(block if isinstance(block, str) else block.name)
        self.file = entry.result.tokens.file if entry is not None else ""
        self.block = entry.name if entry is not None else ""
        self.line = entry.result.tokens.position(entry.unit.start)[0] if entry is not None else 1
        own = [i for i, probe in enumerate(program.probes) if probe.block == self.block]
        self.probes = slice(own[0], own[-1] + 1) if own else slice(0, 0)


def shown_value(value: Tree) -> str:
    """A value as a line of the report shows it: four elements of an array."""
    if isinstance(value, list | tuple):
        return f"[{', '.join(shown_value(item) for item in value[:4])}{', ..' if len(value) > 4 else ''}]"
    if isinstance(value, float):
        return f"{value:.7g}.0" if value.is_integer() and abs(value) < 1e7 else f"{value:.7g}"
    return str(value)
