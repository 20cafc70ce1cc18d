"""Which drives a place of a spec is about, and which parameters they have; also while the text is broken."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from plcgen.base.diagnostics import Report
from plcgen.ds47.device import Device, Parameter, facts, limit_text, parameter_from
from plcgen.ds47.devices import Catalogue
from plcgen.ds47.plan.redefinition import merged
from plcgen.ds47.references import parse_reference, split_bit
from plcgen.ds47.registry import kinds
from plcgen.workbench.service.specs.sketch import Path
from plcgen.workbench.service.specs.state import at_start

if TYPE_CHECKING:
    from plcgen.workbench.service.specs.state import SpecState

MOST = 200
"""Parameters that are offered at once."""


@dataclass(frozen=True, slots=True)
class KnownDrive:
    """A drive of a spec: its device, the type of its drive object, and the parameters that the spec defines itself."""

    key: str
    device: Device
    object_type: str
    own: dict[int, Parameter] = field(default_factory=dict)

    def find(self, text: str) -> Parameter | None:
        """The parameter that a reference means, an index and a bit left aside."""
        bit = split_bit(text)
        reference = parse_reference(bit[0] if bit else text)
        if reference is None:
            return None
        if reference.pnu is not None:
            return self.own.get(reference.pnu) or self.device.find(reference.pnu, self.object_type)
        return next(
            (one for one in self.own.values() if one.name == reference.name), self.device.by_name(reference.name)
        )

    def matching(self, typed: str) -> Iterator[Parameter]:
        """Parameters that begin as what was typed: a number, a name, or words of the title; the usual ones first."""
        digits = typed.lstrip("PpRr").lstrip("0") if typed[1:].isdigit() or typed.isdigit() else ""
        seen: set[int] = set()
        usual = (*self.own.values(), *self.device.parameters.values())
        for one in (*usual, *self._more(typed, digits)):
            if one.pnu not in seen and _fits(one, typed, digits):
                seen.add(one.pnu)
                yield one

    def _more(self, typed: str, digits: str) -> Iterator[Parameter]:
        if digits:
            numbers = (number for number in self.device.listed(self.object_type) if str(number).startswith(digits))
            yield from (one for number in numbers if (one := self.find(f"P{number}")) is not None)
        elif len(typed) > 2:
            yield from self.device.search(typed.replace("_", " "))


def _fits(one: Parameter, typed: str, digits: str) -> bool:
    if digits:
        return str(one.pnu).startswith(digits)
    words = typed.lower().replace("_", " ").split()
    text = f"{one.name.replace('_', ' ')} {one.title}".lower()
    return len(typed) < 2 or all(word in text for word in words)


def drives_at(state: SpecState, path: Path) -> list[KnownDrive]:
    """The drives that a place is about: those of its job, of the jobs with its recipe, or the one in which it is."""
    return [found for key in dict.fromkeys(_keys_at(state, path)) if (found := known_drive(state, key)) is not None]


def _keys_at(state: SpecState, path: Path) -> Iterator[str]:
    if len(path) > 1 and path[0] == "jobs":
        yield from job_drives(state, str(path[1]))
    elif len(path) > 1 and path[0] == "recipes":
        recorded = [kind.key for kind in kinds() if kind.recorded]
        for entry in state.sketch.entries:
            if (
                len(entry.path) == 3
                and entry.path[0] == "jobs"
                and entry.path[2] in recorded
                and entry.value == path[1]
            ):
                yield from job_drives(state, str(entry.path[1]))
    elif len(path) > 1 and path[0] == "drives":
        yield str(path[1])
    elif len(path) > 3 and path[0] == "units" and path[2] == "drives":
        yield str(path[3])


def job_drives(state: SpecState, job: str) -> Iterable[str]:
    """Keys of the drives of a job: as the text has them, else as the plan knows them."""
    place: Path = ("jobs", job, "drive")
    said = [one.value for one in state.sketch.entries if one.path[:3] == place and one.value]
    if said and not any(one[:1] == "*" or "$(" in one for one in said):
        return said
    plan = state.drive_plan
    return () if plan is None else [one.drive.key for one in plan.jobs if one.path == ("jobs", job)]


def known_drive(state: SpecState, key: str) -> KnownDrive | None:
    """A drive by its key: as the text describes it, else as the plan knows it."""
    planned, outline = state.drive(key), state.sketch
    place: Path = ("drives", key)
    name = outline.value(*place, "device")
    if not name:
        unit = next(
            (one.path for one in outline.entries if one.path[0] == "units" and one.path[2:] == ("drives", key)), ()
        )
        name = outline.value("units", unit[1], "device") if unit else ""
        place = unit or place
    device = None
    if name and "$(" not in name:
        device = Catalogue(state.document.path.parent).find(name, at_start(state.document.file), Report())
    if device is None:
        device = planned.device if planned is not None else None
    if device is None:
        return None
    if planned is not None and planned.device.key == device.key:
        return KnownDrive(key, device, planned.object_type, _own(state, key, device, planned.object_type))
    number = outline.value(*place, "drive_object")
    object_type = device.object_type(int(number) if number.isdecimal() else device.drive_object)
    return KnownDrive(key, device, outline.value(*place, "object_type") or object_type)


def _own(state: SpecState, key: str, device: Device, object_type: str) -> dict[int, Parameter]:
    """The parameters that the spec defines for a drive, over those of the device."""
    plan, planned = state.drive_plan, state.drive(key)
    found: dict[int, Parameter] = {}
    if plan is None or planned is None:
        return found
    for text, definition in plan.settings(planned).parameters.items():
        reference = parse_reference(text)
        if reference is None or reference.pnu is None:
            continue
        own = parameter_from(reference.pnu, definition.model_dump(), text[:1])
        known = device.find(reference.pnu, object_type)
        found[reference.pnu] = own if known is None else merged(known, own)
    return found


def spelled(one: Parameter) -> str:
    """A parameter as a spec writes it."""
    return one.label


def in_short(one: Parameter) -> str:
    """Title, unit and limits."""
    low, high = limit_text(one.minimum), limit_text(one.maximum)
    limits = f"{low} to {high}" if low and high else f"from {low}" if low else f"up to {high}" if high else ""
    return " · ".join(filter(None, (one.title, one.unit, limits)))


def in_full(one: Parameter) -> list[tuple[str, str]]:
    """Every fact that is stated, with its grade where it was not read in the source, and the source."""
    words = {"min": "least value", "max": "greatest value", "default": "factory setting", "array": "indexes"}
    rows = [
        f"{words.get(fact, fact)}: {_shown(fact, value)}{'' if grade == 'read' else f' ({grade})'}"
        for fact, (value, grade) in facts(one).items()
        if fact != "title"
    ]
    more = [("Writing it", one.dangerous)] if one.dangerous else []
    more += [("Can be changed", one.changeable)] if one.changeable else []
    more += [("Note", one.note)] if one.note else []
    return [("Facts", "\n".join(rows)), *more, ("Source", one.source)]


def _shown(fact: str, value: object) -> str:
    if fact == "access":
        return {"r": "read only", "w": "write only"}.get(str(value), "read and write")
    if isinstance(value, dict):
        return ", ".join(f"{name} = {number}" for name, number in value.items())
    if isinstance(value, list | tuple):
        return ", ".join(map(str, value))
    return f"{value:g}" if isinstance(value, float) else "yes" if value is True else str(value)
