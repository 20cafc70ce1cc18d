"""Which block calls which job: a caller that would be too large for a CPU is followed by another one.

A code block of an S7-300/400 and a DB with standard access of any CPU have 64 KB at most (specs/cpus/s7.yaml, block_kb
and db_kb). What stands here are upper bounds, known before anything is written; tests hold the blocks against them.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from plcgen.ds47.kind import Poll
from plcgen.ds47.plan.access import Use
from plcgen.ds47.plan.nouns import DeviationList, DriveCaller, DriveTelegram, MessageList, PlannedUnit
from plcgen.project.numbering import Numbering


class Footprint(NamedTuple):
    """Bytes that something takes in the instance DB of its caller, and in the code of the caller."""

    data: int
    code: int


ROOM = Footprint(60 * 1024, 60 * 1024)
"""What is filled of 64 KB, whatever the CPU: naming another one moves no job."""
GATE = Footprint(1100, 200)
CHANNEL = Footprint(720, 160)
"""Both in the largest size of the engine, so that no job moves because another one needs a larger size."""

_JOB = Footprint(94, 110)
_RECIPE = Footprint(32, 60)
"""What a job with a recipe has besides: its number, the address of the records, what is outside."""
_POLLING = 64
_DEVIATION = 24
"""Of an entry, which a job of several telegrams has twice; what is wanted is as large as the answers."""
_SINGLE, _SEVERAL = 16, 100
"""Bytes of code for a value of a job that is one operand, and for one that is an array or a string."""


def footprint(
    uses: Sequence[Use], telegrams: Sequence[DriveTelegram], listed: MessageList | DeviationList | None
) -> Footprint:
    """At most so many bytes are an instance of a job and its call."""
    values = [use.count * (use.format.size + use.format.size % 2) + 2 for use in uses]
    buffers = [len(telegram.request.data) + telegram.response.size + 4 for telegram in telegrams]
    steps = any(telegram.step for telegram in telegrams)
    clock = _POLLING if steps or any(use.as_(Poll) for use in uses) else 0
    data = _JOB.data + clock + sum(values) + (8 if steps else 4) * len(uses) + sum(buffers)
    if isinstance(listed, DeviationList):
        data += 2 * listed.places * _DEVIATION + sum(buffers)
    pins = [_SINGLE if use.count == 1 and not use.format.is_string else _SEVERAL for use in uses]
    code = _JOB.code + sum(pins) + (0 if listed is None else _SINGLE + _SEVERAL)
    recorded = any(use.recorded for use in uses)
    return Footprint(data + recorded * _RECIPE.data, code + recorded * _RECIPE.code)


class Callers:
    """Hands out the callers in the order of the jobs, the channel of a unit with the unit's first job.

    So a job that is added behind the others moves none of them.
    """

    def __init__(self, numbering: Numbering) -> None:
        self._numbering = numbering
        self._units: set[str] = set()
        self._data, self._code = GATE
        self.found: list[DriveCaller] = []
        self._open()

    def caller(self, unit: PlannedUnit, job: Footprint) -> DriveCaller:
        """The caller of the next job."""
        parts = [job] if unit.key in self._units else [CHANNEL, job]
        data, code = (sum(sizes) for sizes in zip(*parts, strict=True))
        if self._units and (self._data + data > ROOM.data or self._code + code > ROOM.code):
            self._data = self._code = 0
            self._open()
        self._units.add(unit.key)
        self._data += data
        self._code += code
        return self.found[-1]

    def _open(self) -> None:
        number = len(self.found) + 1
        suffix = "" if number == 1 else str(number)
        block, instance, control = (
            self._numbering.fixed(kind, name)
            for kind, name in (
                ("FB", f"DriveCalls{suffix}"),
                ("DB", f"DriveCalls{suffix}_DB"),
                ("DB", f"DriveJobs{suffix}"),
            )
        )
        self.found.append(DriveCaller(number, block, instance, control))
