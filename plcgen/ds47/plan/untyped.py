"""Reads whose type comes from the answer: what of the value is an output of its own, and what else a job may say."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from plcgen.ds47.device import Device, Parameter
from plcgen.ds47.devices import sibling_devices
from plcgen.ds47.kind import ReadItem, WriteItem
from plcgen.ds47.plan.access import Form, Read, Use
from plcgen.ds47.references import parse_reference
from plcgen.ds47.wire import formats
from plcgen.project.spec import SpecPath
from plcgen.s7.types.names import first_upper, shorten

ANY = formats.FROM_ANSWER.name
"""Type of a parameter of which only the answer tells one."""
_FORMS: Mapping[str, tuple[str, str]] = {
    "format": ("Byte", "format of the answer"),
    "dint": ("Integer32", "as DINT"),
    "real": ("FloatingPoint", "as REAL"),
}


def with_forms(use: Use, longest: int) -> Use:
    """A read without a type with the outputs that say what has come."""
    if not use.untyped:
        return use
    shown = tuple(
        replace(
            use, format=formats.by_name(type_), data=bytes(formats.by_name(type_).size), role=Form(name), comment={},
            member=shorten(f"{use.member}{first_upper(name)}", longest),
            parameter=replace(use.parameter, title=title, unit=""), position=-8 * use.position - place,
        )
        for place, (name, (type_, title)) in enumerate(_FORMS.items(), 1)
    )  # fmt: skip
    return replace(use, role=Read(shown=shown))


def named_later(item: ReadItem | WriteItem, path: SpecPath) -> Use:
    """A single value of a job whose parameter is named at run time, whatever the catalogue knows of the first."""
    reference = parse_reference(item.parameter)
    if reference is None or reference.pnu is None:
        raise ValueError(f"{item.parameter} has no number")
    parameter = Parameter(reference.pnu, ANY, access="r")
    return Use(
        position=1, parameter=parameter, format=formats.FROM_ANSWER, first=reference.first, elements=1, count=1,
        data=bytes(formats.FROM_ANSWER.size), sources=False, member=item.as_ or "value", comment={}, path=path,
        item=item, served=True,
    )  # fmt: skip


def of_siblings(device: Device, pnu: int) -> dict[str, list[Parameter]]:
    """What devices of the same family say of a number that this one's catalogue lacks: by type, a row per device."""
    found: dict[str, list[Parameter]] = {}
    for other in sibling_devices(device):
        known = other.find(pnu)
        if known is not None and known.type and known.grades.get("type") != "recalled":
            found.setdefault(known.type, []).append(replace(known, source=other.key))
    return found
