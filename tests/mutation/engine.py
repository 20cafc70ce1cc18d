"""What the proof of the drive engine says about a damaged block of it: the first piece that fails ends it."""

from __future__ import annotations

from pathlib import Path

from plcgen.proof.scenario import Failure
from plcgen.s7.read.generated import generated_sources
from plcgen.s7.scl.dialect import Dialect
from tests.engine.checks import EngineWork, Piece, run_faults
from tests.engine.errands import READ_ONE, TRIGGER, WRITE_ONE
from tests.engine.sources import DriveEngine

FILES = ("DriveChannel", "DriveTicket", "DriveGate")
"""The blocks that all projects of a target share."""
ENGINE = "engine"
"""Key of a case that damages one of them."""
_QUICK = (READ_ONE, TRIGGER, WRITE_ONE)
_ORDER = ("units", "formats", "places", "faults", "restarts", "interrupts", "copies", "edges")


def rank(piece: Piece) -> int:
    """What notices most in the least time comes first."""
    quick = piece.errand in _QUICK and piece.group == "faults"
    return _QUICK.index(piece.errand) if quick else len(_QUICK) + _ORDER.index(piece.group)


def first_failure(folder: Path, dialect: Dialect) -> Failure | None:
    """The first thing that goes wrong; None if nothing does. Raises DiagnosticError if the engine does not compile."""
    engine = DriveEngine.of(generated_sources(folder), dialect)
    _ = engine.program
    work = EngineWork(engine)
    for index in sorted(range(len(work.pieces)), key=lambda number: rank(work.pieces[number])):
        piece = work.pieces[index]
        on_edge = piece.group == "edges"
        result = run_faults(engine, piece.errand, 1, on_edge=on_edge) if piece.errand is not None else work(index)
        if result.failures:
            return result.failures[0]
    return None
