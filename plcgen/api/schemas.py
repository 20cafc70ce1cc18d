"""JSON schemas of every file that the tool reads and of every result that it writes."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from plcgen.base.diagnostics import ArgumentError


def _spec(profiles: Sequence[str] = (), *, shared: bool = False) -> dict[str, Any]:
    from plcgen.project.registry import protocols
    from plcgen.project.shape import json_schema

    return json_schema(protocols(), profiles, shared=shared)


def _shared(profiles: Sequence[str] = ()) -> dict[str, Any]:
    return _spec(profiles, shared=True)


def _drive() -> dict[str, Any]:
    from plcgen.ds47.sim.load import DriveKeys
    from plcgen.project.editor import file_schema

    return file_schema("drive", "A simulated drive: its objects with their parameters, and faults.", DriveKeys)


def _station() -> dict[str, Any]:
    from plcgen.ppi.sim.load import BusKeys, SingleKeys
    from plcgen.project.editor import file_schema

    text = "A simulated S7-200, or several under stations, with their values and faults."
    return file_schema("station", text, SingleKeys, BusKeys)


def _profile() -> dict[str, Any]:
    from plcgen.ds47.profile import DeviceProfile
    from plcgen.project.editor import file_schema

    return file_schema("profile", "A device profile: what a kind of drive has and how it answers.", DeviceProfile)


def _policy() -> dict[str, Any]:
    from plcgen.project.editor import file_schema
    from plcgen.s7.compare.policy import KINDS, Policy

    found = file_schema("policy", "Which class a kind of change has for you.", Policy)
    return {**found, "propertyNames": {"enum": list(KINDS)}}


def _lock() -> dict[str, Any]:
    from plcgen.report.diff.lockfile import lock_schema

    return lock_schema()


def _faults() -> dict[str, Any]:
    from plcgen.ds47.recording.faults import DriveFaults
    from plcgen.ppi.recording import LineFaults
    from plcgen.project.editor import file_schema

    text = "Faults of drives or of a PPI line for simulate: a list, or the key faults of a mapping."
    drive, line = file_schema("faults", text, DriveFaults), file_schema("faults", text, LineFaults)
    line = json.loads(json.dumps(line).replace("#/$defs/", "#/$defs/Line"))
    line["$defs"] = {f"Line{name}": each for name, each in line["$defs"].items()}
    items = [each.pop("properties")["faults"]["items"] for each in (drive, line)]
    faults = {"type": "array", "items": {"anyOf": items}, "description": "the faults, each of its kind"}
    mapping = {
        "type": "object", "properties": {"faults": faults}, "required": ["faults"], "additionalProperties": False
    }  # fmt: skip
    head = {key: drive[key] for key in ("$schema", "$id", "title", "description")}
    return {**head, "anyOf": [faults, mapping], "$defs": {**drive["$defs"], **line["$defs"]}}


def _serve() -> dict[str, Any]:
    from plcgen.report.lines import serve_schema

    return serve_schema()


def _monitor() -> dict[str, Any]:
    from plcgen.report.lines import monitor_schema

    return monitor_schema()


def _output() -> dict[str, Any]:
    from plcgen.report.shapes import output_schema

    return output_schema()


SCHEMAS: dict[str, Callable[[], dict[str, Any]]] = {
    "spec": _spec,
    "shared": _shared,
    "drive": _drive,
    "station": _station,
    "profile": _profile,
    "policy": _policy,
    "lock": _lock,
    "faults": _faults,
    "output": _output,
    "serve": _serve,
    "monitor": _monitor,
}
"""By the kind of file; ``output`` are results of ``--format json``, ``serve`` and ``monitor`` a line of these verbs."""
WITH_PROFILES = {"spec": _spec, "shared": _shared}
"""Those that offer names of device profiles."""


def schema(kind: str = "spec", *, profiles: Sequence[str | Path] = ()) -> dict[str, Any]:
    """JSON schema (draft 2020-12) of a kind of file, or of the results of ``--format json``; see ``SCHEMAS``.

    ``profiles`` are device profiles of your own: the schemas of a spec and of what it includes offer their names, too.

    Raises:
        ArgumentError: there is no such kind, or it has no profiles.
        DiagnosticError: a file is no profile.
    """
    if kind not in SCHEMAS:
        raise ArgumentError(f"there is no schema of {kind}; available: {', '.join(SCHEMAS)}")
    if not profiles:
        return SCHEMAS[kind]()
    if kind not in WITH_PROFILES:
        raise ArgumentError(f"the schema of {kind} offers nothing of device profiles; {' and '.join(WITH_PROFILES)} do")
    return WITH_PROFILES[kind]([str(Path(path).absolute()) for path in profiles])
