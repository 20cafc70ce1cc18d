"""The engine of a folder with the program around it that calls it under every fault."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from itertools import chain
from typing import Any

from plcgen.base.diagnostics import DiagnosticError
from plcgen.ds47.proof import engine
from plcgen.proof.rig import layout_of
from plcgen.s7.cpu.program import Program
from plcgen.s7.layout.layout import locate
from plcgen.s7.types.data_types import ArrayType
from tests.engine.stimulus import Sizes, engine_stimulus

BLOCKS = ("channel", "ticket", "gate")
_CALLERS = re.compile(
    r"""("(?:Unit[1-3]|GateData|ProofCalls|OB[0-9]+)"(?: : Void)?\s*\{ S7_Optimized_Access := )'FALSE'"""
)
"""Access of the data that others share, and of those who call with it."""


@dataclass(frozen=True)
class DriveEngine(engine.DriveEngine):
    """The engine of one target that can be run. ``mixed``: units and their callers have optimised access."""

    mixed: bool = False

    @cached_property
    def program(self) -> Program:
        """The engine with the stimulus around it, compiled. Raises DiagnosticError."""
        text = engine_stimulus(self.dialect, self.names, self.sizes)
        if self.mixed:
            text = _CALLERS.sub(r"\1'TRUE'", text)
        sources = [*self.sources, ("stimulus.scl", text)]
        program = Program.load(sources, self.dialect, coverage=True, litter=True)
        if not program.ok:
            raise DiagnosticError([d for d in program.diagnostics if d.severity.label == "error"])
        return program

    @cached_property
    def sizes(self) -> Sizes:
        """Sizes of the unit's arrays. Raises DiagnosticError."""
        members = f' unit : "{self.names["unit"]}";\n gate : "{self.names["gate_data"]}";\n'
        text = f'DATA_BLOCK "Sizes"\nSTRUCT\n{members}END_STRUCT;\nBEGIN\nEND_DATA_BLOCK\n'
        program = Program.load([*self.sources, ("sizes.db", text)], self.dialect)
        if not program.ok:
            raise DiagnosticError([d for d in program.diagnostics if d.severity.label == "error"])
        layout = layout_of(program, "Sizes")

        def last(member: str) -> int:
            type_ = locate(layout, f"unit.{member}").type
            return type_.bounds[0][1] if isinstance(type_, ArrayType) else 0

        gate = locate(layout, "gate.channels").type
        return Sizes(
            last("telegram"), last("errors"), last("asks"), gate.bounds[0][1] if isinstance(gate, ArrayType) else 0
        )

    def differs_in_sizes_only(self, other: DriveEngine) -> bool:
        """Whether another engine of the target has the same text but for the numbers that are its sizes."""
        if self.dialect is not other.dialect or [len(u) for u in self.units] != [len(u) for u in other.units]:
            return False
        pairs = zip(chain(*self.units), chain(*other.units), strict=True)
        known = {
            (a, b) for one, two in zip(self.sizes.numbers, other.sizes.numbers, strict=True) for a, b in ((one, two),)
        }
        return all(one == two or (one, two) in known for one, two in pairs)

    def __reduce__(self) -> tuple[Any, ...]:
        """A program cannot be pickled: a worker compiles it again."""
        return DriveEngine, (self.dialect, self.sources, self.names, self.mixed)


def write_proven(found: Mapping[str, engine.Proven]) -> None:
    """Write the file anew."""
    engine.FILE.write_text(json.dumps(dict(sorted(found.items())), indent=1) + "\n", encoding="ascii")
