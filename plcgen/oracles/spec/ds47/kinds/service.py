"""``service: read``: what the inputs name is read, at first r964[0], the manufacturer; the answer tells its type.

PROFIdrive's parameter 964 is the identification of the device: its first element is the number of the manufacturer.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from typing import Any

from plcgen.oracles.spec.ds47.accesses import JobReader
from plcgen.oracles.spec.ds47.statement import StatedStep
from plcgen.oracles.spec.ds47.types import ANY, ROOM

FIRST = "r964[0]"


def service_steps(job: JobReader) -> Iterator[StatedStep]:
    """One access."""
    access = job.reads(job.fixed(FIRST), output="value", free=True)
    yield StatedStep("reads", (replace(access, type=ANY, size=ROOM, title="", unit="", letter="r"),))


def written_numbers(
    job: Mapping[str, Any], harmless: Iterable[frozenset[int]], safety: frozenset[int]
) -> tuple[frozenset[int], dict[int, str]]:
    """What ``service: {write: true}`` may write, and what of it the spec names, with the reason.

    ``harmless`` are the numbers that are so in each drive of the job. Nothing of Safety is written, nothing that starts
    something in the drive, and no display of PROFIdrive.
    """
    allow = {int(str(text).lstrip("PpRr")): str(reason) for text, reason in (job.get("allow") or {}).items()}
    never = safety | STARTS | DISPLAYS
    named = {number: reason for number, reason in allow.items() if number not in never}
    return (frozenset.intersection(*harmless) | set(named)) - never, named


STARTS = frozenset({15, 970, 971, 972, 973, 974, 976, 977, 3900, 3981})
"""Macro, reset, save, load, end of commissioning, acknowledge (parameters of SINAMICS S120, G120)."""
DISPLAYS = frozenset({944, 945, 947, 948, 949, 964, 965, 975})
"""Counter and buffer of faults, identification of the device, the profile and the drive object (PROFIdrive)."""
STATEMENTS = {"service": service_steps}
