"""``write``, with ``verify``, ``on_error`` and ``save`` beside it.

Words of which bits are written are read first. ``verify: readback`` reads what was written again; ``on_error:
restore`` reads the old values before it writes, and r0899 with both unless the drive may run. A save comes last.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

from plcgen.oracles.spec.ds47.accesses import JobReader, SpecItem
from plcgen.oracles.spec.ds47.kinds import save
from plcgen.oracles.spec.ds47.settings import restores
from plcgen.oracles.spec.ds47.statement import Source, StatedAccess, StatedStep

STATE = "r899"
"""Status word: bit 2 operation enabled, bit 11 pulses enabled (SINAMICS DCP operating instructions p. 192)."""
TRIGGERS = frozenset({15, *range(970, 975), 976, 977, 3900, 3981})
"""A write of these starts something: it is never sent twice (docs/generated-code.md, "Triggers")."""


def write_steps(job: JobReader) -> Iterator[StatedStep]:
    """The steps of a job that writes values of the spec."""
    yield from writing(job, accesses(job, job.items("write")))


def accesses(job: JobReader, items: Sequence[SpecItem]) -> list[tuple[StatedAccess, str]]:
    """What is written, in the order of the spec, bits of one word at the first of them; each with its name."""
    found: list[tuple[StatedAccess, str]] = []
    words: dict[tuple[int, int], int] = {}
    for item in items:
        parameter = job.parameter(item)
        if parameter.bit is None:
            found.append((job.writes(item), job.name(item, parameter)))
            continue
        bit = item.settings.get("as") or f"{job.name(item, parameter)}Bit{parameter.bit}"
        start = item.settings.get("start", 0 if item.value is None else None)
        given = job.wanted(replace(item, settings={**item.settings, "start": start}), parameter, bit)
        at = words.setdefault((parameter.number, parameter.first), len(found))
        if at == len(found):
            word = job.access(item, parameter, write=True, output="")
            found.append(
                (replace(word, written=item.text.rpartition(".")[0]), job.name(replace(item, settings={}), parameter))
            )
        word, kept = found[at]
        found[at] = replace(word, bits=(*word.bits, (parameter.bit, given[0]))), kept
    return found


def writing(job: JobReader, found: Sequence[tuple[StatedAccess, str]]) -> Iterator[StatedStep]:
    """All steps around a write."""
    restore = restores(job.job)
    state = (job.reads(job.fixed(STATE), output=""),) if restore == "stopped" else ()
    before = [asked(job, access, f"{name}Before") for access, name in found if access.bits or restore]
    if before:
        yield StatedStep("remembers" if restore else "reads the words", (*before, *_named(state, "stateBefore")))
    written = tuple(access for access, _ in found)
    yield StatedStep("writes", written, once=any(access.number in TRIGGERS for access in written))
    if job.job.get("verify") == "readback":
        back = [wanted_back(job, access, f"{name}Back") for access, name in found]
        yield StatedStep("reads back", (*back, *_named(state, "stateBack")))
    if job.job.get("save") is not None:
        yield from save.save_steps_of(job, job.job["save"])


def asked(job: JobReader, access: StatedAccess, output: str) -> StatedAccess:
    """The same parameter is read."""
    scalar = not access.indexed and not access.string
    elements = job.drive.elements(write=False) if scalar else access.elements
    return replace(access, write=False, values=(), bits=(), elements=elements, output=output)


def wanted_back(job: JobReader, access: StatedAccess, output: str) -> StatedAccess:
    """The same parameter is read, and must have the values that were written."""
    values: tuple[Source, ...] = access.values
    return replace(asked(job, access, output), values=values, bits=access.bits)


def _named(state: tuple[StatedAccess, ...], output: str) -> tuple[StatedAccess, ...]:
    return tuple(replace(access, output=output) for access in state)


STATEMENTS = {"write": write_steps}
