"""Which protocols there are: those of this package, and those that other distributions bring by entry point."""

from __future__ import annotations

from functools import cache
from importlib import import_module

from plcgen.plugins import expect_free, plugins
from plcgen.protocols.base import Protocol

SHIPPED = ("ds47", "ppi")
GROUP = "plcgen.protocols"


@cache
def protocols() -> tuple[Protocol, ...]:
    """Every protocol: the shipped ones first, then others by name.

    An entry point of the group ``plcgen.protocols`` names an object that has the face in ``base``. Raises PluginError.
    """
    shipped = [import_module(f"plcgen.protocols.{key}").PROTOCOL for key in SHIPPED]
    brought = plugins(GROUP, Protocol).values()  # type: ignore[type-abstract]
    expect_free(GROUP, (one.key for one in brought), SHIPPED)
    sections = [section for one in shipped for section in one.sections]
    expect_free(GROUP, (section for one in brought for section in one.sections), sections)
    return (*shipped, *brought)


def protocol(key: str) -> Protocol:
    """The protocol of this name. Raises KeyError."""
    return {known.key: known for known in protocols()}[key]
