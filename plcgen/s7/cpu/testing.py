"""The soft CPU for tests of your own blocks: load SCL, set inputs, run scans, read outputs.

With pytest, ``load_scl`` is all that is needed; wrap it in a fixture of your own if several tests share a program.
See ``docs/soft-cpu.md``.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import Any

from plcgen.base.diagnostics import DiagnosticError, PlcgenError
from plcgen.s7.cpu.cpu import Cpu
from plcgen.s7.cpu.outside import Stub, read_stubs
from plcgen.s7.cpu.program import Program, Source
from plcgen.s7.cpu.sources import load_folder
from plcgen.s7.cpu.system.port import Periphery, RecordServer
from plcgen.s7.cpu.type_rules import IecCheck
from plcgen.s7.scl.dialect import BY_NAME, Dialect
from plcgen.s7.types.system import Family


class ConditionError(PlcgenError, AssertionError):
    """What a test waited for did not come."""


class Bench:
    """A CPU with its program and its bus, and the few verbs a test needs."""

    def __init__(
        self, program: Program, drives: Mapping[int, RecordServer] | None = None, family: Family | None = None
    ) -> None:
        self.bus = Periphery()
        for address, drive in (drives or {}).items():
            self.bus.attach(address, drive)
        self.cpu = Cpu(program, self.bus, family=family)

    def set(self, **values: object) -> None:
        """Set tags, for example ``start=True``; members of data blocks go through ``bench.cpu["DB.member"]``."""
        for name, value in values.items():
            self.cpu[name] = value

    def call(self, name: str, /, milliseconds: int = 10, **inputs: object) -> dict[str, Any]:
        """One scan in which only this instance or FC is called, with inputs set before: outputs of an FC by name."""
        return self.cpu.call(name, milliseconds, **inputs)

    def scan(self, count: int = 1, milliseconds: int = 10) -> None:
        """Run scans of the cyclic OB."""
        self.cpu.scan(milliseconds, count)

    def until(self, condition: Callable[[Cpu], object], *, scans: int = 1000, milliseconds: int = 10) -> int:
        """Run scans until a condition holds and return how many. Raises ConditionError if it never does."""
        for number in range(1, scans + 1):
            self.cpu.scan(milliseconds)
            if condition(self.cpu):
                return number
        raise ConditionError(f"the condition did not hold within {scans} scans")

    def attach(self, address: int, drive: RecordServer) -> None:
        """Put a simulated drive at a logical address or hardware identifier."""
        self.bus.attach(address, drive)


def load_scl(
    *sources: Source,
    dialect: str | Dialect = "tia-1500",
    tags: Mapping[str, str | tuple[str, str]] | None = None,
    numbers: Mapping[str, int] | None = None,
    drives: Mapping[int, RecordServer] | None = None,
    family: Family | None = None,
    coverage: bool = False,
    iec_check: str = "as-stated",
    stubs: Iterable[Stub] | Path = (),
) -> Bench:
    """Load files or texts and switch the CPU on.

    A single folder is loaded as ``plcgen generate`` writes it. ``iec_check`` is on, off or as-stated: on in such a
    folder, for S7-1200/1500, and off in other sources. ``stubs`` are blocks without code that Python stands in for, or
    a YAML file with the outputs of each. Raises DiagnosticError if the sources are wrong.
    """
    target = BY_NAME.get(dialect) or Dialect(dialect)
    check = IecCheck(iec_check)
    only = sources[0] if len(sources) == 1 else None
    if isinstance(only, Path) and only.is_dir():
        program = load_folder(only, target, coverage=coverage, iec_check=check)
    else:
        program = Program.load(
            sources, target, tags=tags, numbers=numbers, coverage=coverage, iec_check=check, foreign=sources,
            stubs=read_stubs(stubs) if isinstance(stubs, Path) else stubs,
        )  # fmt: skip
    if not program.ok:
        raise DiagnosticError(program.diagnostics)
    return Bench(program, drives, family)
