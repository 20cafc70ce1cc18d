"""PG845: error OBs that the program of an S7-300/400 does not have although it talks to devices."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator

from plcgen.base.diagnostics import Diagnostic, Severity
from plcgen.s7.cpu.linkage import Linkage, ProgramBlock
from plcgen.s7.types.blocks import BlockKind
from plcgen.s7.types.error_obs import ERROR_OBS

_START_INFORMATION = re.compile(r"OB(\d+)_", re.IGNORECASE)
"""What the temporary variables of an OB begin with where they have their default names."""


def missing_obs(link: Linkage, documented: Iterable[int] = ()) -> Iterator[Diagnostic]:
    """One warning, at the first OB. ``documented`` are numbers of OBs in documents beside the sources.

    Without any OB the sources are no whole program, and an S7-1200/1500 does not stop if a device is lost.
    """
    obs = [entry for entry in link.blocks.values() if entry.block.kind is BlockKind.OB]
    if not link.classic or not obs:
        return
    numbers = {entry.name: _number(link, entry) for entry in obs}
    known = {*numbers.values(), *documented}
    missing = [ob for ob in ERROR_OBS if ob.number not in known]
    first = next((entry.block.span for entry in obs if entry.block.span is not None), None)
    if not missing or first is None:
        return
    unknown = [name for name, number in numbers.items() if not number]
    message = (
        f"the program has no {', '.join(f'OB{ob.number}' for ob in missing)}"
        f"{f', unless {unknown[0]} is one of them' if unknown else ''}: an S7-300/400 that calls it goes to STOP"
    )
    reasons = "; ".join(f"OB{ob.number}: {ob.called}" for ob in missing)
    help_ = f"add what is missing, empty if there is nothing to do in it ({reasons})"
    yield Diagnostic("PG845", message, first, Severity.WARNING, help=help_)


def _number(link: Linkage, entry: ProgramBlock) -> int:
    """Number of an OB, by its name and symbol, by the name that tools give it, or by its start information; else 0."""
    number = link.ob_number(entry)
    named = (ob.number for ob in ERROR_OBS if entry.name.upper() in ob.names)
    found = (_START_INFORMATION.match(member.name) for member in entry.block.members)
    return number or next(named, 0) or next((int(match[1]) for match in found if match), 0)
