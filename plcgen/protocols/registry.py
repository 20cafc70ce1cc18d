"""Which protocols there are: those of this package, and those that other distributions bring by entry point."""

from __future__ import annotations

from functools import cache
from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from plcgen.protocols.base import Protocol

SHIPPED = ("ds47", "ppi")
ENTRY_POINTS = "plcgen.protocols"


@cache
def protocols() -> tuple[Protocol, ...]:
    """Every protocol: the shipped ones first, then others by name.

    An entry point of the group ``plcgen.protocols`` names an object that has the face in ``base``.
    """
    from importlib.metadata import entry_points

    shipped = [import_module(f"plcgen.protocols.{key}").PROTOCOL for key in SHIPPED]
    found = sorted(entry_points(group=ENTRY_POINTS), key=lambda entry: entry.name)
    return (*shipped, *(entry.load() for entry in found))
