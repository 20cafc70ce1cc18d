"""Rules about block numbers."""

from __future__ import annotations

from typing import TYPE_CHECKING

from plcgen.base.diagnostics import Diagnostic, Note, Severity
from plcgen.project.rules.places import key_or_value, number_span

if TYPE_CHECKING:
    from collections.abc import Iterator

    from plcgen.project.nouns import BlockRef, Project


def used_twice(project: Project) -> Iterator[Diagnostic]:
    """PG401: two blocks of one kind have the same number."""
    first: dict[tuple[str, int], BlockRef] = {}
    for block in numbered(project):
        earlier = first.setdefault((block.kind, block.number), block)
        if earlier is block:
            continue
        if not block.pinned:
            earlier, block = block, earlier  # noqa: PLW2901 - the pinned one is the one a person can change
        yield Diagnostic(
            "PG401",
            f'{block.kind}{block.number} is the number of two blocks: "{earlier.name}" and "{block.name}"',
            number_span(project, block),
            help="give one of them another number, or leave the number out",
            notes=(Note(f'first use: "{earlier.name}"', number_span(project, earlier)),),
        )


def numbers_out_of_range(project: Project) -> Iterator[Diagnostic]:
    """PG402: a block number the CPU does not have."""
    reported: set[str] = set()
    for block in numbered(project):
        highest = project.target.max_numbers[block.kind]
        if block.number <= highest:
            continue
        family = project.target.family.upper()
        if block.pinned:
            yield Diagnostic(
                "PG402",
                f"{block.kind}{block.number} does not exist: an {family} has {block.kind}1 to {block.kind}{highest}",
                number_span(project, block),
                help="write a smaller number, or leave it out",
            )
        elif block.kind not in reported:
            reported.add(block.kind)
            key = block.kind.lower()
            yield Diagnostic(
                "PG402",
                f'automatic {block.kind} numbers reach {block.number} ("{block.name}"): '
                f"an {family} has {block.kind}1 to {block.kind}{highest}",
                key_or_value(project, ("plc", "numbers", key)),
                help=f"let plc.numbers.{key} start lower, or split the spec",
            )


def too_many(project: Project) -> Iterator[Diagnostic]:
    """PG411, a warning: more blocks than the CPU holds that the spec names."""
    cpu = project.target.cpu
    if cpu is None:
        return
    held = [block for block in project.blocks if block.kind != "UDT"]
    counts = {kind: sum(block.kind == kind for block in held) for kind in cpu.counts}
    rows = [(f"{kind}s", counts[kind], fact) for kind, fact in cpu.counts.items()]
    rows += [("blocks", len(held), cpu.blocks)] if cpu.blocks is not None else []
    for what, count, most in rows:
        if count > most.value:
            yield Diagnostic(
                "PG411",
                f"{count} {what}: a CPU {cpu.name} holds {most.value}{most.remark}",
                key_or_value(project, ("plc", "cpu")),
                Severity.WARNING,
                help="split the spec between CPUs, or use another CPU; the rest of the program has blocks, too",
            )
            return


def numbered(project: Project) -> Iterator[BlockRef]:
    """Blocks whose number matters: types have one in STEP 7 V5 only."""
    return (block for block in project.blocks if block.kind != "UDT" or project.target.v5)
