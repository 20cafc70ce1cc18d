"""What the proof of the drive engine says about a damaged block of it: the first piece that fails ends it."""

from __future__ import annotations

from pathlib import Path

from plcgen.proof.scenario import Failure
from plcgen.protocols.ds47.proof.engine.checks import EngineWork, run_faults
from plcgen.protocols.ds47.proof.engine.sources import DriveEngine
from plcgen.scl.dialect import Dialect
from plcgen.sources.generated import generated_sources

FILES = ("DriveChannel", "DriveTicket", "DriveGate")
"""The blocks that all projects of a target share."""
ENGINE = "engine"
"""Key of a case that damages one of them."""
_ORDER = {"faults": 0, "units": 1, "formats": 2, "places": 3, "interrupts": 4, "restarts": 5}


def first_failure(folder: Path, dialect: Dialect) -> Failure | None:
    """The first thing that goes wrong; None if nothing does. Raises DiagnosticError if the engine does not compile."""
    engine = DriveEngine.of(generated_sources(folder), dialect)
    _ = engine.program
    work = EngineWork(engine)
    for index in sorted(range(len(work.pieces)), key=lambda number: _ORDER.get(work.pieces[number].group, 0)):
        piece = work.pieces[index]
        result = run_faults(engine, piece.errand, most=1) if piece.errand is not None else work(index)
        if result.failures:
            return result.failures[0]
    return None
