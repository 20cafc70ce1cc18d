"""``sequence``: steps that read, write, or wait until all of their conditions are true in one answer."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Any

from plcgen.oracles.spec.ds47.accesses import JobReader, SpecItem
from plcgen.oracles.spec.ds47.kinds.write import TRIGGERS, accesses
from plcgen.oracles.spec.ds47.statement import FromInput, StatedAccess, StatedCondition, StatedStep
from plcgen.oracles.spec.ds47.values import number_meant
from plcgen.oracles.spec.place import Keys, milliseconds

TIMEOUT_MS, INTERVAL_MS = 10_000, 500
NOT_REACHED = 0x8510
TIMES = frozenset({"timeout", "interval"})
"""Keys in ``until`` that are no conditions."""
_COMPARISON = re.compile(r"(<>|<=|>=|=|<|>)\s*(.+)")
_LINE = re.compile(r"([^<>=]+?)\s*(<>|<=|>=|=|<|>)\s*(.+)")


def sequence_steps(job: JobReader) -> Iterator[StatedStep]:
    """One step for each of the spec."""
    taken: set[str] = set()
    for number, step in enumerate(job.job["sequence"], 1):
        below = ("sequence", number - 1)
        if "until" in step:
            items = job.items(*below, "read") if "read" in step else []
            step_ = _waiting(job, step["until"], number)
            read = tuple(_named(job.reads(item, free=True), number, taken) for item in items)
            yield replace(step_, accesses=(*step_.accesses, *read))
        elif "read" in step:
            items = job.items(*below, "read")
            read = tuple(_named(job.reads(item, free=True), number, taken) for item in items)
            yield StatedStep("reads", read, number=number)
        else:
            found = accesses(job, job.items(*below, "write"))
            written = tuple(_supplied(access, name, number, taken) for access, name in found)
            once = any(access.number in TRIGGERS for access in written)
            yield StatedStep("writes", written, once=once, number=number)


def _named(access: StatedAccess, number: int, taken: set[str]) -> StatedAccess:
    name = access.output if access.output not in taken else f"{access.output}Step{number}"
    taken.add(name)
    return replace(access, output=name)


def _supplied(access: StatedAccess, name: str, number: int, taken: set[str]) -> StatedAccess:
    """A parameter takes its name with or without an input."""
    if name not in taken:
        taken.add(name)
        return access
    named = (replace(v, name=f"{v.name}Step{number}") if isinstance(v, FromInput) else v for v in access.values)
    return replace(access, values=tuple(named))


def _waiting(job: JobReader, until: Any, number: int) -> StatedStep:
    """A step that waits."""
    conditions: list[StatedCondition] = []
    asked: list[StatedAccess] = []
    own = until if isinstance(until, Mapping) else {}
    for text, given, way in _wanted(until, (*job.way, "sequence", number - 1, "until")):
        item = SpecItem(text, {}, None, job.source.place(way))
        parameter = job.parameter(item)
        relation, value = _relation(given)
        bit = "" if parameter.bit is None else f"Bit{parameter.bit}"
        access = job.access(item, parameter, write=False, output=f"{job.name(item, parameter)}{bit}Step{number}")
        wanted = number_meant(value, parameter, job.drive.profile)
        conditions.append(
            StatedCondition(len(asked), relation, float(wanted) if isinstance(wanted, str) else wanted, parameter.bit)
        )
        asked.append(access)
    return StatedStep(
        "asks",
        tuple(asked),
        until=tuple(conditions),
        limit_ms=milliseconds(own.get("timeout"), TIMEOUT_MS),
        interval_ms=milliseconds(own.get("interval"), INTERVAL_MS),
        late=NOT_REACHED,
        ordered=False,
        number=number,
    )


def _wanted(until: Any, way: Keys) -> Iterator[tuple[str, Any, Keys]]:
    if isinstance(until, Mapping):
        yield from ((str(text), given, (*way, text)) for text, given in until.items() if text not in TIMES)
        return
    match = _LINE.fullmatch(str(until).strip())
    if match is not None:
        yield match[1], f"{match[2]} {match[3]}", way


def _relation(given: Any) -> tuple[str, Any]:
    """A comparison in quotes, or a value that must be reached."""
    match = _COMPARISON.fullmatch(given.strip()) if isinstance(given, str) else None
    if match is None:
        return "=", given
    text = match[2].strip()
    try:
        return match[1], int(text, 10)
    except ValueError:
        pass
    try:
        return match[1], float(text)
    except ValueError:
        return match[1], text


STATEMENTS = {"sequence": sequence_steps}
