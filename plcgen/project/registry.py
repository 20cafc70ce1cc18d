"""Which protocols there are: those of this package, and those that other distributions bring by entry point."""

from __future__ import annotations

from functools import cache
from importlib import import_module

from plcgen.base.plugins import expect_free, plugins
from plcgen.project.part import SpecPart

SHIPPED = ("ds47", "ppi")
GROUP = "plcgen.protocols"


@cache
def protocols() -> tuple[SpecPart, ...]:
    """Every protocol: the shipped ones first, then others by name.

    An entry point of the group ``plcgen.protocols`` names an object that has the face in ``protocol.base``.
    Raises PluginError.
    """
    shipped = [import_module(f"plcgen.{key}").PROTOCOL for key in SHIPPED]
    face: type[SpecPart] = import_module("plcgen.protocol.base").Protocol  # these stand above
    brought = plugins(GROUP, face).values()
    expect_free(GROUP, (one.key for one in brought), SHIPPED)
    sections = [section for one in shipped for section in one.sections]
    expect_free(GROUP, (section for one in brought for section in one.sections), sections)
    return (*shipped, *brought)


def protocol(key: str) -> SpecPart:
    """The protocol of this name. Raises KeyError."""
    return {known.key: known for known in protocols()}[key]
