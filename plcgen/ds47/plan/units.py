"""The units of a spec with their drives, and the blocks that every project of a target has."""

from __future__ import annotations

from pathlib import Path

from plcgen.base.diagnostics import Diagnostic, Note, Report
from plcgen.ds47.device import Device
from plcgen.ds47.devices import Catalogue
from plcgen.ds47.plan.nouns import Engine, PlannedDrive, PlannedUnit
from plcgen.ds47.schema import DriveSections, PlacedDrive, UnitSettings
from plcgen.project.numbering import Numbering
from plcgen.project.spec import LoadedSpec
from plcgen.s7.types.names import TIA_LIMIT, V5_LIMIT, pascal_case, shorten

OUTPUT_BIT = 0x8000
FIRST_NAMED = 60_000
"""Numbers that stand for hardware identifiers of which only the name is known."""


def plan_engine(numbering: Numbering) -> Engine:
    """The types and blocks of the engine, in the order in which a compiler wants them."""
    names = {
        "order": ("UDT", "typeDriveOrder"),
        "turn": ("UDT", "typeDriveTurn"),
        "ask": ("UDT", "typeDriveAsk"),
        "unit": ("UDT", "typeDriveUnit"),
        "place": ("UDT", "typeDrivePlace"),
        "gate_type": ("UDT", "typeDriveGate"),
        "channel": ("FB", "DriveChannel"),
        "ticket": ("FB", "DriveTicket"),
        "gate": ("FB", "DriveGate"),
        "gate_db": ("DB", "DriveGateData"),
    }
    made = {key: numbering.fixed(kind, name) for key, (kind, name) in names.items()}
    return Engine(**made)


def plan_units(
    loaded: LoadedSpec, numbering: Numbering, report: Report
) -> tuple[tuple[PlannedUnit, ...], tuple[PlannedDrive, ...]]:
    """Every unit and every drive; drives at one address share a unit even if the spec does not say so."""
    planner = _Planner(loaded, numbering, report)
    for placed in loaded.sections(DriveSections).placed():
        planner.add(placed)
    return tuple(planner.units), tuple(planner.drives)


class _Planner:
    """Plans drive after drive."""

    def __init__(self, loaded: LoadedSpec, numbering: Numbering, report: Report) -> None:
        self.loaded, self.numbering, self.report = loaded, numbering, report
        self.catalogue = Catalogue(Path(loaded.file).parent)
        self.units: list[PlannedUnit] = []
        self.drives: list[PlannedDrive] = []
        self._by_key: dict[str, PlannedUnit | None] = {}
        self._by_id: dict[int, PlannedUnit] = {}
        self._named: dict[str, int] = {}
        self._seen: dict[str, PlacedDrive] = {}

    def add(self, placed: PlacedDrive) -> None:
        """Plan one drive, and its unit if it is the first of it."""
        earlier = self._seen.setdefault(placed.key, placed)
        if earlier is not placed:
            message = f'two drives are called "{placed.key}"'
            first = Note("first use", self.loaded.key_span(earlier.path))
            place = self.loaded.key_span(placed.path)
            self.report.add(Diagnostic("PG103", message, place, help="rename one of them", notes=(first,)))
            return
        id_value, id_name = self._identifier(placed)
        unit = self._unit(placed, id_value)
        if unit is None:
            return
        number = unit.device.drive_object if placed.drive.drive_object is None else placed.drive.drive_object
        self.drives.append(
            PlannedDrive(
                key=placed.key,
                unit=unit,
                id_value=id_value,
                id_name=id_name,
                drive_object=number,
                object_type=placed.drive.object_type or unit.device.object_type(number),
                comment=placed.drive.comment or {},
                path=placed.path,
            )
        )

    def _unit(self, placed: PlacedDrive, id_value: int) -> PlannedUnit | None:
        if placed.unit in self._by_key:
            return self._by_key[placed.unit]
        path = placed.settings_path
        device = self.catalogue.find(placed.settings.device, self.loaded.span((*path, "device")), self.report)
        unit = None
        if device is not None:
            index = _record_index(placed, device, self.loaded, self.report)
            alone = path == placed.path
            unit = self._by_id.get(id_value) if alone and id_value else None
            if unit is None or unit.device is not device or unit.record_index != index:
                unit = self._new(placed.unit, device, index, placed.settings, path)
                self._by_id.setdefault(id_value, unit)
        self._by_key[placed.unit] = unit
        return unit

    def _new(self, key: str, device: Device, index: int, settings: UnitSettings, path: tuple[str, ...]) -> PlannedUnit:
        limit = V5_LIMIT if self.numbering.where.v5 else TIA_LIMIT
        name = pascal_case(key)
        unit = PlannedUnit(
            key=key,
            member=shorten(f"channel{name}", limit),
            db=self.numbering.block("DB", f"{name}Unit", path),
            device=device,
            record_index=index,
            wait=settings.wait,
            path=path,
        )
        self.units.append(unit)
        return unit

    def _identifier(self, placed: PlacedDrive) -> tuple[int, str]:
        """ID of WRREC and RDREC, and the name of its system constant; 0 after a diagnostic."""
        drive = placed.drive
        if not self.numbering.where.classic:
            given = drive.hardware_id
            if isinstance(given, str):
                return self._named.setdefault(given, FIRST_NAMED + len(self._named)), given
            return self._needed(given, placed, "hardware_id", "hardware identifier"), ""
        value = self._needed(drive.address, placed, "address", "logical address")
        return (value | OUTPUT_BIT if drive.output_address else value), ""

    def _needed(self, value: int | None, placed: PlacedDrive, key: str, what: str) -> int:
        if value is None:
            family = self.loaded.spec.plc.family.upper()
            message = f"an {family} needs the drive's {what}"
            place = self.loaded.key_span(placed.path)
            self.report.add(Diagnostic("PG215", message, place, help=f"add {key}: to this drive"))
        return value or 0


def _record_index(placed: PlacedDrive, device: Device, loaded: LoadedSpec, report: Report) -> int:
    default = device.record_index[device.default_index]
    value = placed.settings.record_index
    if value is None:
        return default
    index = device.record_index.get(value) if isinstance(value, str) else value
    if index is None or index not in device.record_index.values():
        known = ", ".join(f"{name} = {number:04X}h" for name, number in device.record_index.items())
        shown = value if isinstance(value, str) else f"{value:04X}h"
        message = f"{device.title} has no parameter channel at record index {shown}"
        place = loaded.span((*placed.settings_path, "record_index"))
        report.add(Diagnostic("PG216", message, place, help=f"its indexes: {known}"))
        return default
    return index
