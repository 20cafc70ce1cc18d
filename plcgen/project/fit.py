"""The size of a program beside what its CPU holds: figures for people and programs, and what does not fit."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from plcgen.base.diagnostics import Diagnostic, Severity, Span
from plcgen.base.diagnostics.counting import quantity
from plcgen.project.cpus import CpuFact, CpuType
from plcgen.s7.memory.estimate import Estimate

KILO = 1024


@dataclass(frozen=True, slots=True)
class ProgramSize:
    """What a program takes: the estimate, and the CPU type if one is named.

    ``idle_statements`` is for the statements that one scan without a running job executes; None: not measured.
    """

    estimate: Estimate
    cpu: CpuType | None = None
    idle_statements: int | None = None

    @property
    def share(self) -> int | None:
        """Percent of the CPU's work memory, of the fuller one if code and data have one each; None if not known."""
        shares = [100 * used // fact.value for _, used, fact in self._memories()]
        return max(shares, default=None) if self.estimate.classic else None

    def _memories(self) -> Iterator[tuple[str, int, CpuFact]]:
        cpu, size = self.cpu, self.estimate
        if cpu is None:
            return
        memories = (
            ("", size.total, cpu.work),
            (" of code", size.code, cpu.work_code),
            (" of data", size.data, cpu.work_data if size.classic else cpu.work_data or cpu.work),
        )
        for what, used, fact in memories:
            if fact is not None and used is not None:
                yield what, used, fact

    def text(self) -> str:
        """One line: blocks, their lines, bytes, share of the CPU."""
        size = self.estimate
        blocks = ", ".join(quantity(size.count(kind), kind) for kind in ("FB", "FC", "DB") if size.count(kind))
        share = "" if self.cpu is None or self.share is None else f", {self.share} % of a CPU {self.cpu.name}"
        idle = "" if self.idle_statements is None else f"; an idle scan runs {self.idle_statements:,} statements"
        memory = f"{kilobytes(size.data)} in data blocks"
        if size.total is not None:
            memory = f"about {kilobytes(size.total)} of work memory"
        return f"{blocks} of {size.lines:,} lines, {memory}{share}{idle}"

    def data(self) -> dict[str, Any]:
        """The same for programs."""
        cpu = None if self.cpu is None else {"name": self.cpu.name, "percent": self.share}
        return {**self.estimate.summary(), "cpu": cpu, "idle_statements": self.idle_statements}

    def misfits(self, place: Span) -> Iterator[Diagnostic]:
        """PG412 and PG413, warnings at ``place``: blocks that are too large for the CPU, too little work memory."""
        cpu = self.cpu
        if cpu is None:
            return
        about = "about " if self.estimate.classic else ""  # the bytes of data blocks alone are no estimate
        for what, limit, sizes in (
            ("code of", cpu.block_size, [(block.code, block) for block in self.estimate.blocks]),
            ("data of", cpu.db_size, [(block.data, block) for block in self.estimate.blocks]),
        ):
            over = [(size, block) for size, block in sizes if limit is not None and size > limit.value]
            if limit is not None and over:
                size, block = max(over, key=lambda found: found[0])
                others = f", and {len(over) - 1} more" if len(over) > 1 else ""
                message = f'{about}{kilobytes(size)} {what} {block.kind} "{block.name}"{others}: '
                message += f"a CPU {cpu.name} takes {kilobytes(limit.value)} in a block{limit.remark}"
                help_ = "split the job or the array, or use another CPU"
                yield Diagnostic("PG412", message, place, Severity.WARNING, help=help_)
        for what, used, fact in self._memories():
            if used > fact.value:
                message = f"{about}{kilobytes(used)}{what}: a CPU {cpu.name} has {kilobytes(fact.value)} of work memory"
                message += what.replace(" of", " for") + fact.remark
                help_ = "split the spec between CPUs, or use another CPU; the rest of the program needs memory, too"
                yield Diagnostic("PG413", message, place, Severity.WARNING, help=help_)


def kilobytes(size: int) -> str:
    """Bytes as KB of 1024, below 10 KB with one digit."""
    return f"{size / KILO:.1f} KB" if size < 10 * KILO else f"{round(size / KILO):,} KB"
