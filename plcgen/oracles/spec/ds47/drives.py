"""Which drive: identifier, drive object, data record, unit (docs/spec.md "Drives", "Units"; docs/hardware-id.md)."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from plcgen.oracles.profidrive import LONGEST, MOST_ELEMENTS, MOST_PARAMETERS
from plcgen.oracles.spec.ds47.parameters import StatedCatalogue
from plcgen.oracles.spec.ds47.statement import StatedDrive
from plcgen.oracles.spec.place import Keys, NotStatedError, SpecSource, milliseconds, texts

RECORDS = {"profibus": 47, "profinet-local": 0xB02E, "profinet-global": 0xB02F}
"""S120 Function Manual Communication 12/2018, section 3.4."""
LOCAL = 0xB02E
CLASSIC = frozenset({"s7-300", "s7-400"})
WAIT_MS = 60_000


@dataclass(frozen=True, slots=True)
class KnownDrive:
    """A drive with what is known of its device."""

    stated: StatedDrive
    catalogue: StatedCatalogue
    profile: Mapping[str, Any]
    object_type: str = ""
    """Type of its drive object, empty if its device has one type only."""

    def elements(self, *, write: bool) -> int:
        """Number of elements in a request for a parameter without an index."""
        found: int = (self.profile.get("scalar_elements") or {}).get("write" if write else "read", 1)
        return found


def known_drives(source: SpecSource) -> dict[str, KnownDrive]:
    """All drives of a spec by their keys."""
    found: dict[str, KnownDrive] = {}
    alone: dict[int | str, str] = {}  # drives of their own with one identifier are one unit, named after the first one
    for key, entry, settings, unit, way in _entries(source.data):
        name = str(settings.get("device"))
        if name not in source.profiles:
            raise NotStatedError(f"there is no profile {name}")
        profile = source.profiles[name]
        identifier, output = _identifier(source.data["plc"], entry)
        record = _record(settings.get("record_index"), profile)
        asked = entry.get("drive_object")
        stated = StatedDrive(
            key=key,
            place=source.place(way),
            identifier=identifier,
            output=output,
            drive_object=int(profile["drive_object"]["default"] if asked is None else asked),
            record=record,
            unit=unit or alone.setdefault(identifier, key),
            wait_ms=milliseconds(settings.get("wait"), WAIT_MS),
            by_size=(profile.get("answers") or {}).get("format") == "size",
            local=record == LOCAL,
            comments=texts(entry.get("comment")),
            **_room(profile.get("limits") or {}),
        )
        type_ = _object_type(entry, profile, stated.drive_object)
        catalogue = StatedCatalogue(name, source, entry.get("parameters") or {}, type_)
        found[key] = KnownDrive(stated, catalogue, profile, type_)
    return found


def _object_type(entry: Mapping[str, Any], profile: Mapping[str, Any], number: int) -> str:
    """What the spec says, else by the number."""
    types = profile.get("object_types")
    known = "" if not types else "control_unit" if number == types["control_unit"] else types["others"]
    return str(entry.get("object_type") or known)


def _room(limits: Mapping[str, Any]) -> dict[str, int]:
    """What one telegram holds."""
    names = {"longest": ("record", LONGEST), "most_parameters": ("parameters", MOST_PARAMETERS)}
    names["most_elements"] = ("elements", MOST_ELEMENTS)
    return {name: int(limits.get(key, usual)) for name, (key, usual) in names.items()}


def _entries(spec: Mapping[str, Any]) -> Iterator[tuple[str, Mapping[str, Any], Mapping[str, Any], str, Keys]]:
    """Key, own settings, settings of its device, unit (empty: told by the identifier), way."""
    for key, entry in (spec.get("drives") or {}).items():
        yield str(key), entry, entry, "", ("drives", key)
    for unit, of_unit in (spec.get("units") or {}).items():
        for key, entry in of_unit["drives"].items():
            yield str(key), entry or {}, of_unit, str(unit), ("units", unit, "drives", key)


def _identifier(plc: Mapping[str, Any], entry: Mapping[str, Any]) -> tuple[int | str, bool]:
    """What addresses the drive; on S7-300/400 bit 15 is set for a module with outputs only."""
    if plc["family"] in CLASSIC:
        return int(entry["address"]), bool(entry.get("output_address"))
    given = entry["hardware_id"]
    return (given if isinstance(given, str) else int(given)), False


def _record(asked: Any, profile: Mapping[str, Any]) -> int:
    numbers = {name: number for name, number in profile["record_index"].items() if name != "default"}
    if asked is None:
        return int(numbers[profile["record_index"]["default"]])
    if isinstance(asked, str):
        return int(numbers.get(asked, RECORDS[asked]))
    return int(asked)
