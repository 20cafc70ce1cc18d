"""The state of a CPU as a whole, taken and put back: one run after the other from the same point."""

from __future__ import annotations

from collections.abc import Mapping
from copy import deepcopy
from dataclasses import dataclass, replace

from plcgen.s7.cpu.cpu import Cpu
from plcgen.s7.cpu.system.record import Key, RecordJob
from plcgen.s7.cpu.system.timers import Cell


@dataclass(frozen=True, slots=True)
class CpuState:
    """Memory, clock, S5 timers and counters, and record jobs of a CPU; drives and serial ports are not in it."""

    blocks: Mapping[int, bytes]
    areas: Mapping[str, bytes]
    clock: tuple[int, int]
    scans: int
    jobs: Mapping[Key, RecordJob]
    orphans: tuple[RecordJob, ...]
    misuses: int
    cells: tuple[dict[int, Cell], dict[int, Cell]]


def freeze(cpu: Cpu) -> CpuState:
    """Take the state of a CPU, between two scans."""
    records = cpu.records
    return CpuState(
        {index: bytes(memory) for index, memory in cpu.blocks.items()},
        {name: bytes(memory) for name, memory in cpu.areas.items()},
        (cpu.time.cell[0], cpu.time.cell[1]),
        cpu.scans,
        {key: replace(job) for key, job in records.jobs.items()},
        tuple(replace(job) for job in records.orphans),
        len(cpu.misuses),
        deepcopy((cpu.cells.timers, cpu.cells.counters)),
    )


def thaw(cpu: Cpu, state: CpuState) -> None:
    """Put a state back into the CPU it was taken from; misuses that came later are forgotten."""
    for index, content in state.blocks.items():
        cpu.blocks[index][:] = content
    for name, content in state.areas.items():
        cpu.areas[name][:] = content
    cpu.time.cell[:] = state.clock
    cpu.scans = state.scans
    cpu.records.jobs.clear()
    cpu.records.jobs.update({key: replace(job) for key, job in state.jobs.items()})
    cpu.records.orphans = [replace(job) for job in state.orphans]
    cpu.cells.timers, cpu.cells.counters = deepcopy(state.cells)
    del cpu.misuses[state.misuses :]
