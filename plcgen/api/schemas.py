"""JSON schemas of every file that the tool reads and of every result that it writes."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

VERSION = 1
"""Of files without a version of their own."""


def _spec() -> dict[str, Any]:
    from plcgen.project.shape import json_schema
    from plcgen.protocols.registry import protocols

    return json_schema(protocols())


def _shared() -> dict[str, Any]:
    from plcgen.project.shape import json_schema
    from plcgen.protocols.registry import protocols

    return json_schema(protocols(), shared=True)


def _drive() -> dict[str, Any]:
    from plcgen.project.editor import file_schema
    from plcgen.protocols.ds47.sim.load import DriveKeys

    return file_schema("drive", VERSION, "A simulated drive: its objects with their parameters, and faults.", DriveKeys)


def _station() -> dict[str, Any]:
    from plcgen.project.editor import file_schema
    from plcgen.protocols.ppi.sim.load import BusKeys, SingleKeys

    text = "A simulated S7-200, or several under stations, with their values and faults."
    return file_schema("station", VERSION, text, SingleKeys, BusKeys)


def _profile() -> dict[str, Any]:
    from plcgen.project.editor import file_schema
    from plcgen.protocols.ds47.profile import DeviceProfile

    return file_schema(
        "profile", VERSION, "A device profile: what a kind of drive has and how it answers.", DeviceProfile
    )


def _policy() -> dict[str, Any]:
    from plcgen.project.editor import file_schema
    from plcgen.review.compare.policy import KINDS
    from plcgen.review.compare.policyfile import Policy

    found = file_schema("policy", VERSION, "Which class a kind of change has for you.", Policy)
    return {**found, "propertyNames": {"enum": list(KINDS)}}


def _lock() -> dict[str, Any]:
    from plcgen.review.compare.lockread import lock_schema

    return lock_schema()


def _output() -> dict[str, Any]:
    from plcgen.output.shapes import output_schema

    return output_schema()


SCHEMAS: dict[str, Callable[[], dict[str, Any]]] = {
    "spec": _spec,
    "shared": _shared,
    "drive": _drive,
    "station": _station,
    "profile": _profile,
    "policy": _policy,
    "lock": _lock,
    "output": _output,
}
"""By the kind of file; ``output`` are the results of ``--format json``."""


def schema(kind: str = "spec") -> dict[str, Any]:
    """JSON schema (draft 2020-12) of a kind of file, or of the results of ``--format json``; see ``SCHEMAS``.

    Raises:
        ValueError: there is no such kind.
    """
    if kind not in SCHEMAS:
        raise ValueError(f"there is no schema of {kind}; there are {', '.join(SCHEMAS)}")
    return SCHEMAS[kind]()
