"""Operands of the engine of which no run can show that they decide, and why; README.md lists them, too."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from plcgen.s7.cpu.linkage import Probe
from plcgen.s7.scl import ast
from plcgen.s7.scl.logic import DECIDES, decisions, operands_of
from plcgen.s7.scl.parser import parse_value
from tests.engine.sources import DriveEngine


@dataclass(frozen=True, slots=True)
class ArguedOperand:
    """The first operand of one whole condition of the channel: the kind of probe that no run can show."""

    condition: str
    kind: str
    why: str

    @property
    def shape(self) -> list[tuple[type, str]]:
        """The condition without its spelling. Raises ValueError if it is none."""
        node = parse_value(self.condition)
        if node is None:
            raise ValueError(self.condition)
        return _shape(node)


ARGUED = (
    ArguedOperand("tempAsk.want <= 0 OR tempAsk.want <> statTicket OR statStill >= LEASE OR tempGrant = 0",
             DECIDES[True], "a number of 0 or less also differs from the ticket of the job"),
)  # fmt: skip


def argued(engine: DriveEngine, probes: Sequence[Probe]) -> Iterator[tuple[Probe, str]]:
    """Those probes that there is a reason for, with it: by the place of the operand in the parsed condition."""
    entry = engine.program.link.find(engine.names["channel"])
    if entry is None:
        return
    position = entry.result.tokens.position
    reasons: dict[tuple[int, int, str], str] = {}
    for node in decisions(entry.tree):
        shape = _shape(node)
        for one in ARGUED:
            if one.shape == shape:
                reasons[*position(operands_of(node)[0].start), one.kind] = one.why
    for probe in probes:
        why = reasons.get((probe.line, probe.column, probe.kind))
        if why is not None and probe.file == entry.result.tokens.file:
            yield probe, why


def _shape(node: ast.Node) -> list[tuple[type, str]]:
    """Nodes from left to right with what is written in them: the same in every dialect."""
    written = (
        getattr(each, "operator", "") or getattr(each, "name", "") or getattr(each, "text", "")
        for each in ast.walk(node)
    )
    return [(type(each), "/" if text == "DIV" else text) for each, text in zip(ast.walk(node), written, strict=True)]
