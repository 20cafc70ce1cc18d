"""Which protocols there are: those of this package, and those that other distributions bring by entry point."""

from __future__ import annotations

from functools import cache
from importlib import import_module

from plcgen.plugins import plugins
from plcgen.protocols.base import Protocol

SHIPPED = ("ds47", "ppi")
GROUP = "plcgen.protocols"


@cache
def protocols() -> tuple[Protocol, ...]:
    """Every protocol: the shipped ones first, then others by name.

    An entry point of the group ``plcgen.protocols`` names an object that has the face in ``base``.
    """
    shipped = [import_module(f"plcgen.protocols.{key}").PROTOCOL for key in SHIPPED]
    return (*shipped, *plugins(GROUP, Protocol).values())  # type: ignore[type-abstract]


def protocol(key: str) -> Protocol:
    """The protocol of this name. Raises KeyError."""
    return {known.key: known for known in protocols()}[key]
