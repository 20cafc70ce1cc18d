"""The simulated drives behind the addresses of a spec."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

from plcgen.base.files.options import usage
from plcgen.base.files.text import read_text
from plcgen.ds47.plan.nouns import DrivePlan, PlannedDrive
from plcgen.ds47.recording.faults import FaultPlan
from plcgen.ds47.sim.bench import build_drive
from plcgen.ds47.sim.drive import Drive
from plcgen.ds47.sim.load import load_drive


class Partner(NamedTuple):
    """The drive at an address: its key, and whether it is that of a drive file."""

    key: str
    drive: Drive
    own: bool


def connect(plan: DrivePlan, files: Sequence[str], faults: FaultPlan) -> dict[int, Partner]:
    """Build the drives by address: from drive files where given, else from the device profile.

    A file is ``FILE`` (for every drive) or ``DRIVE=FILE``. Drives at one address are drive objects of one unit.
    """
    chosen = _chosen(plan, files)
    found: dict[int, Partner] = {}
    for drive in plan.drives:
        path = chosen.get(drive.key) or chosen.get("")
        known = found.get(drive.id_value)
        if known is not None:
            if path is None:
                _merge(known.drive, build_drive(plan, drive))
            continue
        unit = build_drive(plan, drive) if path is None else load_drive(read_text(path), str(path))
        unit.faults += faults.of(*_sharing(plan, drive))
        found[drive.id_value] = Partner(drive.key, unit, path is not None)
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
