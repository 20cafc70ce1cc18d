"""What a job and its channel must leave alone: data blocks, flags and periphery that are not theirs, other slots."""

from __future__ import annotations

from plcgen.ds47.proof.rig import JobRig
from plcgen.ds47.proof.stimulus import GATE_DB, SLOTS
from plcgen.proof.rig import Members
from plcgen.proof.scenario import ScenarioError
from plcgen.s7.cpu.memory import Memory

Piece = tuple[str, Memory, int, int | None]
"""Name, memory, first byte, end."""


class Untouched:
    """Bytes around a job.

    Nobody ever writes to ``still``, which was ``untouched``; the requests of other slots are as ``begin`` found them.
    """

    def __init__(self, rig: JobRig) -> None:
        self.rig, cpu = rig, rig.cpu
        gate = Members(cpu, rig.program, GATE_DB, ["gate.channels[2].ask"])
        own = {id(memory) for memory in (rig.db.memory, rig.unit.memory, gate.memory)}
        for buffer in (rig.job.telegrams[0].request, rig.job.telegrams[0].response) if rig.job.pinned else ():
            own.add(id(cpu.db(buffer.home.name)))
        images = rig.program.images
        still = {index: memory for index, memory in cpu.blocks.items() if id(memory) not in own}
        self.still = [*still.values(), *cpu.areas.values()]
        self.untouched = [bytearray(images[index]) for index in still]
        self.untouched += [bytearray(len(memory)) for memory in cpu.areas.values()]
        self.others: list[Piece] = [
            ("the place of another channel", gate.memory, gate.spots["gate.channels[2].ask"].byte, None)
        ]
        self.before: list[bytes] = []

    def begin(self, *, alone: bool) -> None:
        """A run begins; ``alone`` says that no other slot asks and the CPU does not start again."""
        unit, own = self.rig.unit, self.rig.db.get("slot")
        starts = [unit.spots[f"asks[{slot}].telegram"].byte for slot in range(1, SLOTS + 1)]
        size = starts[1] - starts[0]
        self.others = self.others[:1]
        if alone:
            self.others += [
                (f"slot {slot} of the unit", unit.memory, start, start + size)
                for slot, start in enumerate(starts, 1)
                if slot != own
            ]
        self.before = [bytes(memory[first:end]) for _, memory, first, end in self.others]

    def check(self) -> None:
        """Raises ScenarioError if a byte outside changed."""
        for memory, content in () if self.still == self.untouched else zip(self.still, self.untouched, strict=True):
            if memory != content:
                at = next(n for n, byte in enumerate(content) if memory[n] != byte)
                raise ScenarioError(f"byte {at} of {memory.name or memory.area} changed, which is not the job's")
        for (name, memory, first, end), was in zip(self.others, self.before, strict=True):
            if memory[first:end] != was:
                raise ScenarioError(f"{name} changed, which is not the job's")
