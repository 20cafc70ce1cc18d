"""Device profiles and parameter catalogues: data in ``specs/devices``, one file a device."""

from __future__ import annotations

import functools
from dataclasses import dataclass
from typing import Any

from plcgen.input.text import read_text
from plcgen.input.yaml import load_yaml
from plcgen.resources import specs_dir


@dataclass(frozen=True, slots=True)
class Parameter:
    """A drive parameter as the catalogue or the spec defines it.

    ``type`` is the DS47 data type on the wire; ``array`` the number of indexes (None: not indexed);
    ``access`` is r, w or rw; ``minimum``/``maximum`` in the parameter's unit; ``dangerous`` says why a write
    needs a sign-off.
    """

    pnu: int
    type: str
    name: str = ""
    title: str = ""
    unit: str = ""
    access: str = "rw"
    array: int | None = None
    minimum: float | None = None
    maximum: float | None = None
    default: bool | float | str | None = None
    bico: bool = False
    dangerous: str = ""
    source: str = ""


@dataclass(frozen=True, slots=True)
class Device:
    """A device profile: limits and habits of one drive family (source: its manuals, named in ``source``).

    ``record_index`` maps access points to data record indexes; ``default_index`` names the default one.
    ``drive_objects`` is None when every number is possible. ``answer_format`` is ``exact`` (the parameter's
    type) or ``size`` (41h/42h/43h). ``scalar_elements`` is the number of elements this device wants in a
    request without an index: (read, write).
    """

    key: str
    title: str
    source: str
    record_index: dict[str, int]
    default_index: str
    drive_object: int
    drive_objects: tuple[int, ...] | None
    drive_object_rule: str
    record_limit: int
    max_parameters: int
    answer_format: str
    error_words: int
    scalar_elements: tuple[int, int]
    strict_length: bool
    error_table: str
    parameters: dict[int, Parameter]

    def by_name(self, name: str) -> Parameter | None:
        """Catalogue parameter by symbolic name."""
        return next((p for p in self.parameters.values() if p.name == name), None)


@functools.cache
def device_names() -> tuple[str, ...]:
    """Keys of all shipped device profiles, sorted."""
    return tuple(sorted(path.stem for path in (specs_dir() / "devices").glob("*.yaml")))


@functools.cache
def device(key: str) -> Device | None:
    """Profile of a device, or None if there is none of that name."""
    if key not in device_names():
        return None
    path = specs_dir() / "devices" / f"{key}.yaml"
    return _device(key, load_yaml(read_text(path), path.name).data())


def _device(key: str, data: dict[str, Any]) -> Device:
    index = dict(data["record_index"])
    objects = data["drive_object"]
    allowed = objects["allowed"]
    return Device(
        key=key,
        title=data["title"],
        source=data["source"],
        default_index=index.pop("default"),
        record_index=index,
        drive_object=objects["default"],
        drive_objects=None if allowed == "any" else tuple(allowed),
        drive_object_rule=objects["rule"],
        record_limit=data["limits"]["record"],
        max_parameters=data["limits"]["parameters"],
        answer_format=data["answers"]["format"],
        error_words=data["answers"]["error_words"],
        scalar_elements=(data["scalar_elements"]["read"], data["scalar_elements"]["write"]),
        strict_length=data["strict_length"],
        error_table=data["error_table"],
        parameters={
            parameter.pnu: parameter
            for parameter in (parameter_from(int(ref[1:]), entry) for ref, entry in data["parameters"].items())
        },
    )


def parameter_from(pnu: int, entry: dict[str, Any]) -> Parameter:
    """Build a parameter from its catalogue or spec entry (already validated)."""
    return Parameter(
        pnu=pnu,
        type=entry["type"],
        name=entry.get("name") or "",
        title=entry.get("title") or "",
        unit=entry.get("unit") or "",
        access=entry.get("access", "rw"),
        array=entry.get("array"),
        minimum=entry.get("min"),
        maximum=entry.get("max"),
        default=entry.get("default"),
        bico=entry.get("bico", False),
        dangerous=entry.get("dangerous", ""),
        source=entry.get("source", ""),
    )
