"""What runs: the program from files on disk, with the user's own sources."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

from plcgen.base.diagnostics import Diagnostic, DiagnosticError, Span
from plcgen.proof.standins import NO_STAND_INS, StandIns
from plcgen.s7.cpu.program import Program
from plcgen.s7.cpu.sources import load_folder
from plcgen.s7.scl.dialect import Dialect
from plcgen.s7.types.blocks import BlockKind

_START_UP = frozenset({"OB100", "STARTUP"})


def load_program(
    folder: Path,
    dialect: Dialect,
    own: Sequence[Path] = (),
    constants: Mapping[str, int] | None = None,
    foreign: StandIns = NO_STAND_INS,
) -> Program:
    """Load a generated folder and the user's own sources; ``constants`` are system constants by name.

    ``foreign`` stands for what of the user's program is named and not among his sources.

    A block of the user's replaces the generated one of the same name, his cyclic OB the generated example.
    Raises DiagnosticError if anything does not compile or no cyclic OB is left.
    """
    more = foreign.sources.values()
    program = load_folder(folder, dialect, constants=constants, symbols=foreign.tags, more=more)
    if own:
        program = _joined(program, dialect, own, constants, foreign)
    if not program.ok:
        raise DiagnosticError(program.diagnostics)
    if program.main() is None:
        text = "generate the folder again, or name a file with an OB1 or Main: --with FILE.scl"
        raise DiagnosticError([Diagnostic("PG608", "there is no cyclic OB to run", Span(str(folder)), help=text)])
    return program


def _joined(
    base: Program, dialect: Dialect, own: Sequence[Path], constants: Mapping[str, int] | None, foreign: StandIns
) -> Program:
    """Load the sources of a folder once more, together with others."""
    users = Program.load(own, dialect, constants=constants, foreign=own)
    taken = {name for name, entry in users.link.blocks.items() if entry.block.span is not None}
    cyclic = any(e.block.kind is BlockKind.OB and n not in _START_UP for n, e in users.link.blocks.items())
    stand_ins = {name.upper(): source for name, source in foreign.sources.items()}
    sources: list[Path] = []
    for name, entry in base.link.blocks.items():
        example = cyclic and entry.block.kind is BlockKind.OB and name not in _START_UP
        if name not in taken and name not in stand_ins and not example and entry.block.span is not None:
            sources.append(Path(entry.block.span.file))
    numbers: dict[str, int] = {}
    tags: dict[str, str | tuple[str, str]] = {
        name: (str(address), type_) for name, (address, type_) in base.link.tags.items()
    }
    for number, name in base.link.aliases.items():
        if number.startswith("DB"):
            numbers[name] = int(number[2:])
        else:
            tags.setdefault(name, number)
    missing = [source for name, source in stand_ins.items() if name not in taken]
    return Program.load(
        [*dict.fromkeys(sources), *own, *missing],
        dialect,
        tags=tags,
        numbers=numbers,
        constants=constants,
        foreign=own,
    )
