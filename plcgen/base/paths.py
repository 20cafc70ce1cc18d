"""Paths that somebody else wrote: in specs, locks, archives, revisions and journals."""

from __future__ import annotations

import re

DEVICES = frozenset(
    {"CON", "PRN", "AUX", "NUL", "CONIN$", "CONOUT$", "CLOCK$"}
    | {f"{device}{number}" for device in ("COM", "LPT") for number in "0123456789\u00b9\u00b2\u00b3"}
)
"""Names that Windows keeps for devices, in every folder and with every ending (Microsoft, "Naming Files, Paths, and
Namespaces"; superscript digits count as digits)."""

_CONTROL = re.compile(r"[\0-\x1f\x7f]")
_ENDS = re.compile(r"[. ]\Z")


def is_device(name: str) -> bool:
    """Whether a name without folders means a device on Windows: ``NUL``, ``aux.yaml``, ``con .txt``."""
    return name.partition(".")[0].rstrip(" ").upper() in DEVICES


def trap_in(path: str, *, up: bool = False) -> str:
    """What in a relative path could lead to another file than it says, on this system or on another; empty if nothing.

    Folders are separated by ``/``. ``up`` allows ``..`` and ``/`` at the beginning, for whoever looks himself where
    the path ends.
    """
    if path.startswith("//"):
        return "it begins with the name of a computer"
    if path.startswith("/") and not up:
        return "it begins at the root"
    if "\\" in path:
        return "it has a backslash, which separates folders on Windows"
    if ":" in path:
        return "it has a colon, which is a drive or a stream of a file on Windows"
    if _CONTROL.search(path):
        return "it has a control character"
    for part in path.split("/"):
        if part == ".." and not up:
            return "it leads upwards"
        if part in {"", ".", ".."}:
            continue
        if is_device(part):
            return f"{part} is a device on Windows"
        if _ENDS.search(part):
            return f'"{part}" ends in a dot or a space, which Windows drops'
    return ""
