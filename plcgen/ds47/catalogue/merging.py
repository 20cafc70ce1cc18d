"""A list of a drive laid over the catalogue: what is new, what differs, and the profile that comes of it."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from plcgen.base.files.yaml import Scalar
from plcgen.ds47 import guards
from plcgen.ds47.catalogue.lists import ListedParameter, ParameterList, cell_text
from plcgen.ds47.catalogue.pages import told_value
from plcgen.ds47.device import UNKNOWN, Device, DeviceList, Fact, Grade, Parameter, facts
from plcgen.ds47.lists import ON_WIRE
from plcgen.ds47.types import TypeTextError, read_type
from plcgen.ds47.wire import formats
from plcgen.ds47.wire.formats import Format, FormatKind, FormatValueError

NEW = "new"
_LIST_TYPES = {"floatingpoint32": "FloatingPoint"}
"""How lists call a type that has another name on the wire."""
_NUMERIC = {FormatKind.SIGNED, FormatKind.UNSIGNED, FormatKind.FLOAT}


@dataclass(frozen=True, slots=True)
class ListedChange:
    """One fact that a list changes: what the catalogue says and how it knows, what the list says."""

    parameter: str
    fact: str
    known: str
    grade: str
    listed: str


@dataclass(frozen=True, slots=True)
class Merged:
    """A device with what a list says, and what that changes; ``skipped`` tells what could not be taken over."""

    device: Device
    changes: Sequence[ListedChange]
    skipped: Sequence[str]


def merge_list(device: Device, listed: ParameterList, source: str) -> Merged:
    """Lay a list over the catalogue of a device. Values become observed ones: a list does not say what is default."""
    parameters = dict(device.parameters)
    changes: list[ListedChange] = []
    skipped = [*listed.skipped]
    for one in listed.parameters:
        known = device.find(one.pnu)
        base = known or Parameter(
            one.pnu, _type(one), access="r" if _read_only(one) else "rw", indexes=UNKNOWN, sink=one.letter == "c"
        )
        stated = dict(_stated(base, one, skipped))
        if known is None:
            changes.append(ListedChange(_called(one), NEW, "", "", one.title))
        else:
            changes += _changes(known, stated)
        parameters[one.pnu] = _laid_over(base, one, stated, source)
    return Merged(replace(device, parameters=parameters), changes, skipped)


def _called(one: ListedParameter) -> str:
    return f"{'P' if one.letter == 'p' else one.letter}{one.pnu}"


def _read_only(one: ListedParameter) -> bool:
    return bool(guards.why_read_only(_called(one), one.pnu))


def _type(one: ListedParameter) -> str:
    """The data type, if the list names one that exists."""
    text = _LIST_TYPES.get(one.type.partition("/")[0].strip().lower(), one.type.partition("/")[0].strip())
    try:
        return read_type(text)[0].name if text else ""
    except TypeTextError:
        return ""


def _stated(base: Parameter, one: ListedParameter, skipped: list[str]) -> Iterator[tuple[Fact, Any]]:
    """What a list says about a parameter, as the facts of the catalogue."""
    if one.title:
        yield "title", one.title
    if one.unit:
        yield "unit", one.unit
    if one.indexes is not None and one.indexes > max(base.array or 1, 1):
        yield "array", one.indexes  # the highest index that a list shows is the least that there is
    type_ = _type(one)
    if type_ and one.pnu not in ON_WIRE:
        yield "type", type_
    fmt = read_type(type_ or base.type)[0] if type_ or base.type else None
    low, high = one.minimum, one.maximum
    if low is not None and high is not None and low > high:
        skipped.append(f"line {one.line}: {_called(one)} has a minimum above its maximum")
        return
    limits: tuple[tuple[Fact, float | None], ...] = (("min", low), ("max", high))
    for fact, limit in limits:
        if limit is None:
            continue
        value = _fitting(fmt, limit)
        if value is None:
            skipped.append(f"line {one.line}: {fact} {limit:g} of {_called(one)} is not a value of type {base.type}")
        else:
            yield fact, value


def _fitting(fmt: Format | None, value: float) -> float | None:
    """The number as a value of the type; None if it is none. Lists round, so a REAL becomes the nearest."""
    if fmt is None:
        return value
    if fmt.kind not in _NUMERIC or not math.isfinite(value):
        return None
    number: float = value if fmt.kind is FormatKind.FLOAT else int(value)
    try:
        formats.pack_values(fmt, [number])
    except FormatValueError:
        return None
    return number if number == value else None


def _changes(known: Parameter, stated: Mapping[Fact, Any]) -> Iterator[ListedChange]:
    before = facts(known)
    for fact, value in stated.items():
        had, grade = before.get(fact, ("", ""))
        if had != value or (grade != "read" and fact != "title"):
            yield ListedChange(known.label, fact, told_value(had), grade, told_value(value))


def _laid_over(base: Parameter, one: ListedParameter, stated: Mapping[Fact, Any], source: str) -> Parameter:
    """The catalogue's parameter with what the list says; the facts of the list are read ones."""
    grades: dict[Fact, Grade] = {**base.grades, **dict.fromkeys(stated, "read")}
    if base.type and not base.grades:
        grades |= {"type": "read", "access": "read", "array": grades.get("array", "inferred")}
    type_ = stated.get("type", base.type)
    fmt = read_type(type_)[0] if type_ else None
    observed = base.observed if one.value is None else _fitting(fmt, one.value)
    low, high = stated.get("min", base.minimum), stated.get("max", base.maximum)
    doubted = {fact: value for fact, value in base.doubted.items() if fact not in stated}
    cited = cell_text(source if not base.source or base.source.startswith(source) else f"{source}; {base.source}")
    return replace(
        base,
        type=stated.get("type", base.type),
        title=stated.get("title", base.title),
        unit=stated.get("unit", base.unit),
        array=stated.get("array", base.array),
        indexes="" if "array" in stated else base.indexes,
        minimum=low,
        maximum=high,
        default=_inside(base.default, low, high),
        observed=_inside(observed, low, high),
        changeable=one.changeable or base.changeable,
        access="r" if _read_only(one) else base.access,
        source=cited,
        grades=grades,
        doubted=doubted,
    )


def _inside(value: Scalar, low: float | None, high: float | None) -> Scalar:
    """A value, unless it is a number beyond the limits."""
    if not isinstance(value, int | float):
        return value
    return value if (low is None or value >= low) and (high is None or value <= high) else None


def profile_text(device: Device) -> str:
    """A device as the text of a profile that reads back as the same device."""
    indexes = {**device.record_index, "default": device.default_index}
    objects: dict[str, Any] = {
        "default": device.drive_object,
        "allowed": "any" if device.drive_objects is None else list(device.drive_objects),
        "rule": device.drive_object_rule,
    }
    limits = {"record": device.record_limit, "parameters": device.max_parameters, "elements": device.max_elements}
    head: dict[str, Any] = {
        "title": device.title,
        "source": device.source,
        "record_index": indexes,
        "drive_object": objects,
        "limits": limits,
        "answers": {"format": device.answer_format, "error_words": device.error_words},
        "takes": {"formats": device.takes},
        "scalar_elements": dict(zip(("read", "write"), device.scalar_elements, strict=True)),
        "strict_length": device.strict_length,
        "bases": list(device.bases),
        "bico": device.bico,
        "error_table": device.error_table,
        "main_values": dict(device.main_values),
    }
    types = device.object_types
    if types is not None:
        head["object_types"] = {
            "control_unit": types.control_unit,
            "others": types.others,
            "whole": sorted(types.whole),
        }
    if device.lists:
        head["lists"] = [_of_list(one) for one in device.lists]
    if device.messages:
        head["messages"] = list(device.messages)
    if device.absences:
        head["absent"] = {
            f"P{pnu}": {"source": one.source, "grade": one.grade} for pnu, one in sorted(device.absences.items())
        }
    lines = [f"{key}: {_flow(value)}" for key, value in head.items()]
    rows = [f"  {one.label.capitalize()}: {_flow(_row(one))}" for _, one in sorted(device.parameters.items())]
    return "\n".join([*lines, "parameters:" if rows else "parameters: {}", *rows]) + "\n"


def _of_list(one: DeviceList) -> dict[str, Any]:
    """A list that the device has, as a profile names it."""
    said = {"list": one.name, "objects": sorted(one.objects), "type": one.type, "grade": one.grade, "whole": one.whole}
    return {key: value for key, value in said.items() if value not in ("", [])}


def _row(one: Parameter) -> dict[str, Any]:
    """One parameter as a row of a profile."""
    stated: dict[str, Any] = {key: value for key, (value, _) in facts(one).items() if key != "access" or value == "w"}
    every = {fact: grade for fact, grade in one.grades.items() if grade != "read"}
    shown: dict[str, Any] = {"name": one.name, "title": one.title, "type": one.type or UNKNOWN}
    shown |= {**stated, "observed": one.observed}
    shown |= {"changeable": one.changeable, "dangerous": one.dangerous, "harmless": one.harmless}
    shown |= {"facts": every}
    shown |= {"note": one.note, "source": one.source}
    return {key: value for key, value in shown.items() if value not in (None, "", {})}


def _flow(value: Any) -> str:
    """A value in the flow style of YAML; texts in double quotes, which YAML and JSON write alike."""
    if isinstance(value, Mapping):
        return "{" + ", ".join(f"{key}: {_flow(one)}" for key, one in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(map(_flow, value)) + "]"
    if isinstance(value, float):
        return repr(value) if "e" not in repr(value) or "." in repr(value) else repr(value).replace("e", ".0e")
    return json.dumps(value, ensure_ascii=False)
