"""CPUs by name: how much of each memory area they have. The table is ``profiles.toml`` beside this module."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache

from plcgen.ppi.wire.areas import Area

TYPE_LENGTH = 20
"""SYS begins with the CPU type in so many ASCII characters."""
SYS_LENGTH = 196
"""Bytes of SYS at least, as seen on a CPU. What stands after the type is not known."""


@dataclass(frozen=True, slots=True)
class CpuProfile:
    """One CPU. ``sizes`` counts bytes, or elements for T, C and HC; ``type`` is the text of SYS.

    ``unchecked`` names the entries that were not compared with the manual.
    """

    key: str
    title: str
    type: str
    sizes: Mapping[Area, int]
    unchecked: tuple[str, ...] = ()


@cache
def profiles() -> Mapping[str, CpuProfile]:
    """Every CPU of the table by its key: 221, 222, 224R1, 224, 224XP, 226, ST20, ST40."""
    import tomllib
    from importlib.resources import files

    table = tomllib.loads(files("plcgen.ppi.wire").joinpath("profiles.toml").read_text("utf-8"))
    return {
        key: CpuProfile(
            key,
            entry["title"],
            entry["type"],
            {Area[name]: size for name, size in entry["memory"].items()} | {Area.SYS: SYS_LENGTH},
            tuple(entry["unchecked"]),
        )
        for key, entry in table.items()
    }


def profile(key: str) -> CpuProfile:
    """Return the CPU of this name, in any letter case. Raises KeyError."""
    return profiles()[key.upper().removeprefix("CPU").strip()]
