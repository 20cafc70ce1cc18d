"""What runs against what: the program from files on disk, the simulated drives behind the addresses of a spec."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

from plcgen.cpu.folder import load_folder
from plcgen.cpu.program import Program
from plcgen.diagnostics import Diagnostic, DiagnosticError, Span
from plcgen.input.options import usage
from plcgen.input.text import read_text
from plcgen.proof.standins import NO_STAND_INS, StandIns
from plcgen.protocols.ds47.plan.nouns import DrivePlan, PlannedDrive
from plcgen.protocols.ds47.sim.bench import build_drive
from plcgen.protocols.ds47.sim.drive import Drive
from plcgen.protocols.ds47.sim.load import load_drive
from plcgen.s7.blocks import BlockKind
from plcgen.scl.dialect import Dialect
from plcgen.trace.settings import FaultPlan

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
    users = Program.load(own, dialect, constants=constants)
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
        [*dict.fromkeys(sources), *own, *missing], dialect, tags=tags, numbers=numbers, constants=constants
    )


def connect(plan: DrivePlan, files: Sequence[str], faults: FaultPlan) -> dict[int, tuple[str, Drive]]:
    """Build the drives by address, each with its key: from drive files where given, else from the device profile.

    A file is ``FILE`` (for every drive) or ``DRIVE=FILE``. Drives at one address are drive objects of one unit.
    """
    chosen = _chosen(plan, files)
    found: dict[int, tuple[str, Drive]] = {}
    for drive in plan.drives:
        path = chosen.get(drive.key) or chosen.get("")
        known = found.get(drive.id_value)
        if known is not None:
            if path is None:
                _merge(known[1], build_drive(plan, drive))
            continue
        unit = build_drive(plan, drive) if path is None else load_drive(read_text(path), str(path))
        unit.faults += faults.of(*_sharing(plan, drive))
        found[drive.id_value] = drive.key, unit
    return found


def _chosen(plan: DrivePlan, files: Sequence[str]) -> Mapping[str, Path]:
    keys = {drive.key for drive in plan.drives}
    chosen: dict[str, Path] = {}
    for text in files:
        key, equals, path = text.partition("=")
        own = bool(equals) and key in keys
        key, path = (key, path) if own else ("", text)
        if key in chosen:
            raise usage(f"--drive {text}", "there is a drive file for this drive already", "write DRIVE=FILE for each")
        chosen[key] = Path(path)
    return chosen


def _merge(unit: Drive, other: Drive) -> None:
    """Add the drive objects of another drive at the same address."""
    for number, item in other.objects.items():
        own = unit.objects.setdefault(number, item)
        if own is not item:
            own.parameters |= {p: value for p, value in item.parameters.items() if p not in own.parameters}


def _sharing(plan: DrivePlan, drive: PlannedDrive) -> tuple[str, ...]:
    """Keys of all drives at the address of a drive."""
    return tuple(other.key for other in plan.drives if other.id_value == drive.id_value)
