"""A new spec: what its dialog offers, and the text with the names and numbers that were typed there."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import Any, get_args

from plcgen.base.diagnostics import DiagnosticError, Report, Span
from plcgen.ds47.devices import Catalogue, device_names, find_device
from plcgen.ds47.wire.formats import format_names
from plcgen.ppi.wire.address import PpiAddressError, parse_item
from plcgen.project.schema import Toolchain
from plcgen.project.target import combination_problem
from plcgen.s7.types.system import FAMILIES
from plcgen.workbench.serve.room import wrong
from plcgen.workbench.service.specs.shape import spec_shape
from plcgen.workbench.starter import RECIPES, ppi_starter, starter, usable

CLASSIC = ("s7-300", "s7-400")
LANGUAGES = ("en-US", "de-DE", "zh-CN")
Given = Mapping[str, str]
_NAME = re.compile(r"[A-Za-z_][A-Za-z0-9_]{0,23}\Z")
_COMMAND = re.compile(r"(?:; others)?: plcgen [\w -]+$", re.MULTILINE)
_TITLE = re.compile(r"\w[\w .()-]{0,59}\Z")


def _name(given: Given, place: str) -> str:
    key = given.get("key", "").strip()
    if not _NAME.match(key):
        raise wrong(place, f'"{key}" is no name', "up to 24 letters (no umlauts), digits and _, a letter first")
    return key


def _number(given: Given, which: str, default: str, place: str) -> str:
    text = given.get(which, "").strip() or default
    if not text.isdecimal():
        raise wrong(place, f'"{text}" is no number', "a number of the hardware configuration")
    return text


def new_spec(name: str, given: Given, folder: Path) -> str:
    """The text of a starter spec without its hints at commands of a shell: here are buttons for them."""
    lines = _starter_text(name, given, folder).splitlines(keepends=True)
    kept = (line for line in lines if not (line.startswith("#") and re.search(r"plcgen \w", line)))
    return "".join(_COMMAND.sub("", line) for line in kept).lstrip("\n")


def _starter_text(name: str, given: Given, folder: Path) -> str:
    """The text of a starter spec with the names and numbers that were asked for. Raises DiagnosticError."""
    family, tool = given.get("family", "s7-1500"), given.get("toolchain", "tia-v17")
    problem = combination_problem(family, tool) if family in FAMILIES else f"{family} is no family"
    if problem:
        raise wrong(name, problem)
    title = given.get("title", "").strip() or "My station"
    if not _TITLE.match(title):
        raise wrong(name, f'"{title}" is no name of a station', "letters, digits, spaces and - _ . ( )")
    if given.get("device") == "ppi":
        text = ppi_starter(name, family, tool)
        key, address = _name({"key": "s7_200", **given}, name), _number(given, "address", "2", name)
        text = text.replace("s7_200", key).replace("address: 2}", f"address: {address}}}")
        text = re.sub(
            r"\b(port|address): (?:270|256)\b", rf"\g<1>: {_number(given, 'port', '270', name)}", text, count=1
        )
        read = given.get("read", "").strip()
        try:
            parse_item(read or "VW100")
        except PpiAddressError:
            raise wrong(name, f'"{read}" is no address of an S7-200', "such as VW100, VD100, M0.0") from None
        text = text.replace("[VW100, M0.0]", f"[{read}]") if read else text
        return text.replace("My station", title)
    report = Report()
    device = Catalogue(folder).find(given.get("device", ""), Span(name), report)
    if device is None:
        raise DiagnosticError(report)
    jobs = tuple(one for one in given["jobs"].split(",") if one) if "jobs" in given else usable(device)
    if ("jobs" in given and not jobs) or not set(jobs) <= RECIPES.keys():
        raise wrong(name, "a spec begins with one job at least", f"choose of {', '.join(RECIPES)}")
    text = starter(name, device, family, tool, jobs).replace("My station", title)
    text = re.sub(r"\bdrive1\b", _name({"key": "drive1", **given}, name), text)
    for key, keys in (("address", "address|hardware_id"), ("drive_object", "drive_object")):
        if given.get(key, "").strip():
            text = re.sub(rf"(?m)^    ({keys}): \d+", rf"    \g<1>: {_number(given, key, '', name)}", text)
    return text


@cache
def _units() -> tuple[str, ...]:
    """Units of the parameters of shipped devices, those of most parameters first."""
    devices = [find_device(key) for key in device_names()]
    counted = Counter(one.unit for device in devices for one in device.parameters.values() if one.unit)
    return tuple(unit for unit, _ in counted.most_common())


def choices() -> dict[str, Any]:
    """What the forms offer before there is a spec; of a toolchain why it is none for a family ("" if it is one)."""
    shape, tools = spec_shape(), get_args(Toolchain)
    return {
        "devices": [
            {
                "key": key,
                "title": one.title,
                "drive_object": str(one.drive_object),
                "rule": one.drive_object_rule,
                "jobs": list(usable(one)),
            }
            for key in device_names()
            for one in [find_device(key)]
        ],
        "families": [
            {
                "key": one,
                "classic": one in CLASSIC,
                "tools": {tool: combination_problem(one, tool) or "" for tool in tools},
            }
            for one in FAMILIES
        ],
        "types": format_names(),
        "units": list(_units()),
        "cpus": [str(one) for one in shape.words(("ppi", "*", "stations", "*", "cpu"))],
        "languages": list(LANGUAGES),
    }
