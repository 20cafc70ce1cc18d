"""Mixed access: units of optimised access under blocks of standard access, which therefore work on copies of them.

What one organization block calls must work all the same. What interrupts it loses what it wrote, because the copy goes
back over it (Siemens FAQ 109478253): that is why ``verify`` refuses such a project.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial

from tests.engine.errands import MATRIX
from tests.engine.field import JobField
from tests.engine.mailboxes import mailboxes
from tests.engine.places import places

Run = Callable[[JobField], None]


def copies() -> Iterator[tuple[str, Run]]:
    """Names and procedures: every second one of jobs on a unit and of channels at the gate."""
    for name, run in (*mailboxes(), *places())[::2]:
        yield f"through copies: {name}", partial(through_copies, run)


def through_copies(run: Run, field: JobField) -> None:
    """A procedure with units, gate and callers of optimised access."""
    other = JobField(replace(field.rig.engine, mixed=True), MATRIX)
    try:
        run(other)
    finally:
        field.rig.scans += other.scans
