"""Devices and their parameters, by the name a spec gives them.

A device is described by a profile: a YAML file shipped in ``specs/devices``, in a package that offers some under the
entry point group ``plcgen.devices``, or beside the spec (``device: ./acme.yaml``).
"""

from __future__ import annotations

import functools
from collections.abc import Iterable
from dataclasses import dataclass, field, replace
from pathlib import Path
from types import ModuleType
from typing import Any

from plcgen.base.diagnostics import Diagnostic, DiagnosticError, PluginError, Report, Span
from plcgen.base.files.files import below, refusal
from plcgen.base.files.text import read_text
from plcgen.base.plugins import plugins
from plcgen.base.resources import specs_dir
from plcgen.ds47.device import UNKNOWN, Device, Parameter, device_hint, facts, parameter_from

GROUP = "plcgen.devices"
"""Entry points of packages that bring device profiles."""

_SUFFIXES = (".yaml", ".yml")


@dataclass(slots=True)
class Catalogue:
    """The devices that a spec in ``folder`` may name; a profile that is not shipped is read once."""

    folder: Path
    _read: dict[str, Device | None] = field(default_factory=dict)

    def find(self, name: str, place: Span, report: Report) -> Device | None:
        """Return the device of this name, or None after a diagnostic: at ``place``, or at the places of its profile."""
        try:
            if name in _shipped():
                return _shipped_device(name)
            path = _beside(self.folder, name, place) if is_path(name) else _installed(name, place)
            if name not in self._read:
                self._read[name] = None
                self._read[name] = read_profile(path, name)
            return self._read[name]
        except DiagnosticError as problem:
            report.extend(problem.diagnostics)
            return None


def is_path(name: str) -> bool:
    """Whether ``device:`` names a file: names of devices have neither a slash nor an ending."""
    return "/" in name or "\\" in name or name.lower().endswith(_SUFFIXES)


def _installed(name: str, place: Span) -> Path:
    if name in _packaged():
        return _packaged()[name]
    known = device_names()
    help_ = f"{device_hint(name, known)} plcgen devices lists them".strip()
    raise DiagnosticError([Diagnostic("PG201", f'unknown device "{name}"', place, help=help_)])


def _beside(folder: Path, name: str, place: Span) -> Path:
    """Path of a profile beside the spec."""
    path = below(folder, name)
    if path is None:
        message, help_ = (
            f'the device profile "{name}" {refusal(name)}',
            "copy it to the folder of the spec",
        )
    elif not path.is_file():
        message, help_ = (
            f'there is no device profile "{name}"',
            "the path is relative to the spec, with / between folders",
        )
    else:
        return path
    raise DiagnosticError([Diagnostic("PG201", message, place, help=help_)])


def read_profile(path: Path, key: str) -> Device:
    """Read a profile; ``key`` is what a spec calls the device.

    Raises:
        DiagnosticError: with every problem of the file, each at its place.
    """
    return parse_profile(read_text(path, path.as_posix()), path.as_posix(), key)


def parse_profile(text: str, file: str, key: str) -> Device:
    """The device of the text of a profile. Raises DiagnosticError."""
    from plcgen.base.files.validation import load_document
    from plcgen.ds47.profile import LENDERS, PROFILE

    lenders = {name: functools.partial(_shipped_device, name) for name in _shipped() if name != key}
    model = load_document(text, file, PROFILE, {LENDERS: lenders}).model
    device = model.device(key)
    if model.like is None:
        return device
    base = _shipped_device(model.like)
    lent = {pnu: _lent(one, base) for pnu, one in base.parameters.items()}
    own = {pnu: _guarded(one, lent.get(pnu)) for pnu, one in device.parameters.items()}
    lists = tuple(replace(one, grade="inferred", whole=False) for one in base.lists)
    return replace(
        device,
        like=model.like,
        parameters={**lent, **own},
        lists=device.lists or lists,
        messages=device.messages or base.messages,
        main_values=device.main_values or base.main_values,
    )


def _guarded(one: Parameter, lent: Parameter | None) -> Parameter:
    """A parameter of a profile: what can do harm, or can only be read, in the device that it is like stays so."""
    if lent is None:
        return one
    return replace(one, dangerous=one.dangerous or lent.dangerous, access="r" if lent.access == "r" else one.access)


def _lent(one: Parameter, base: Device) -> Parameter:
    """A parameter of another device: whatever was read there is a conclusion here, so it decides no limits."""
    known = facts(one)
    entry: dict[str, Any] = {fact: value for fact, (value, _) in known.items()}
    entry |= {key: getattr(one, key) for key in ("name", "dangerous", "harmless", "note", "bico")}
    entry |= {"type": one.type or UNKNOWN, "source": f"as of the same number in {base.key}: {one.source}"}
    grades = {fact: "inferred" if grade == "read" else grade for fact, grade in one.grades.items()}
    lent = parameter_from(one.pnu, {**entry, "grade": "inferred", "facts": grades}, one.letter)
    return replace(lent, scale=one.scale)  # all of it is in counts already


@functools.cache
def _shipped() -> dict[str, Path]:
    return _profiles(specs_dir() / "devices")


@functools.cache
def _shipped_device(key: str) -> Device:
    return read_profile(_shipped()[key], key)


@functools.cache
def _packaged() -> dict[str, Path]:
    """Profiles that other distributions bring: asked for only if a device is none of the shipped ones.

    An entry point is a package, which stands for its folder, or a path to a folder or file.
    """
    found: dict[str, Path] = {}
    for name, target in plugins(GROUP, object).items():
        place = getattr(target, "__file__", None) if isinstance(target, ModuleType) else target
        if not isinstance(place, str | Path):
            raise PluginError(f"the entry point {name} in {GROUP} is neither a package nor a path")
        found = _profiles(Path(place).parent if isinstance(target, ModuleType) else Path(place)) | found
    return found


def _profiles(path: Path) -> dict[str, Path]:
    """Profiles of a folder, or the one file, by device."""
    files = path.iterdir() if path.is_dir() else [path]
    return {file.stem: file for file in sorted(files) if file.suffix.lower() in _SUFFIXES}


def device_names() -> tuple[str, ...]:
    """Names of all devices that are shipped or come from installed packages, sorted."""
    return tuple(sorted({*_shipped(), *_packaged()}))


def find_device(name: str) -> Device:
    """Return the device of a command line: a name, or the path of any profile.

    Raises:
        DiagnosticError: PG201 if there is none of that name, else the problems of its profile.
    """
    if is_path(name):
        return read_profile(Path(name), name)
    report = Report()
    found = Catalogue(Path()).find(name, Span("--device"), report)
    if found is None:
        raise DiagnosticError(report)
    return found


_APART = frozenset({"sinamics-dcm", "sinamics-dcp"})
"""Converters for direct current: a number that they lack may mean something else in drives of three-phase motors."""


def sibling_devices(device: Device) -> list[Device]:
    """The other shipped devices of the manufacturer's family that a device belongs to, or that it is like."""
    own = device.like or device.key
    family = f"{own.partition('-')[0]}-"
    names = [name for name in _shipped() if name.startswith(family) and name != device.key and name not in _APART]
    return [] if own in _APART or device.key in _APART else [_shipped_device(name) for name in names]


def named_parameters(profiles: Iterable[str] = ()) -> dict[str, list[Parameter]]:
    """Parameters of all devices, and of some ``profiles`` besides, by their names, for completion."""
    found: dict[str, list[Parameter]] = {}
    for device in map(find_device, (*device_names(), *profiles)):
        for parameter in device.parameters.values():
            found.setdefault(parameter.name, []).append(parameter)
    return {name: found[name] for name in sorted(found) if name}


def offer_names(schema: dict[str, Any]) -> None:
    """Let an editor complete the names of devices in the JSON schema of a spec."""
    schema.pop("type", None)
    schema["anyOf"] = [
        {"enum": list(device_names())},
        {"type": "string", "pattern": r"[/\\]|\.[Yy][Aa]?[Mm][Ll]$", "description": "a profile beside the spec"},
    ]
