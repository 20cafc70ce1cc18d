"""Operands of the engine of which no run can show that they decide, and why; docs/testing.md lists them, too."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from plcgen.cpu.linkage import Probe
from plcgen.protocols.ds47.proof.engine.sources import DriveEngine
from plcgen.scl.logic import DECIDES

ARGUED: dict[tuple[str, str], str] = {
    (DECIDES[True], "tempAsk.want <= 0 OR"): "a number of 0 or less is another one than that of the job, too",
    (DECIDES[False], "statState = STATE_WRITE AND NOT"): "WRREC is called only in this state or while it is active",
    (DECIDES[False], "statState = STATE_READ AND NOT"): "RDREC is called only in this state or while it is active",
    (DECIDES[False], "tempError AND tempCode = 181"): "only an end has a code, and a good one was asked before",
    (DECIDES[False], "tempError AND tempTemporary"): "only a code says that it passes: only an error has one here",
}
"""By the side that no run shows, and how the line goes on from the operand."""


def argued(engine: DriveEngine, probes: Sequence[Probe]) -> Iterator[tuple[Probe, str]]:
    """Those probes that there is a reason for, with it."""
    lines = {file: text.splitlines() for file, text in engine.sources}
    for probe in probes:
        behind = lines[probe.file][probe.line - 1][probe.column - 1 :].replace("#", "")
        for (side, operand), why in ARGUED.items():
            if probe.kind == side and behind.startswith(operand):
                yield probe, why
