"""A new spec: what its dialog offers, and the text with the names and numbers that were typed there."""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any, get_args

from plcgen.base.diagnostics import DiagnosticError, Report, Span
from plcgen.ds47.devices import Catalogue, device_names, find_device
from plcgen.project.schema import Toolchain
from plcgen.project.target import combination_problem
from plcgen.s7.types.families import FAMILIES
from plcgen.workbench.serve.room import wrong
from plcgen.workbench.service.specs.shape import spec_shape
from plcgen.workbench.starter import RECIPES, ppi_starter, starter, usable

CLASSIC = ("s7-300", "s7-400")
LANGUAGES = ("en-US", "de-DE", "zh-CN")
Given = Mapping[str, str]
_NAME = re.compile(r"[A-Za-z_][A-Za-z0-9_]{0,23}\Z")
_TITLE = re.compile(r"\w[\w .()-]{0,59}\Z")


def _name(given: Given, place: str) -> str:
    key = given.get("key", "").strip()
    if not _NAME.match(key):
        raise wrong(place, f'"{key}" is no name', "up to 24 letters, digits and _, a letter first")
    return key


def _number(given: Given, which: str, default: str, place: str) -> str:
    text = given.get(which, "").strip() or default
    if not text.isdecimal():
        raise wrong(place, f'"{text}" is no number', "a number of the hardware configuration")
    return text


def new_spec(name: str, given: Given, folder: Path) -> str:
    """The text of a starter spec without its hints at commands of a shell: here are buttons for them."""
    lines = _starter_text(name, given, folder).splitlines(keepends=True)
    return "".join(line for line in lines if not (line.startswith("#") and re.search(r"plcgen \w", line)))


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
        "cpus": [str(one) for one in shape.words(("ppi", "*", "stations", "*", "cpu"))],
        "languages": list(LANGUAGES),
    }
