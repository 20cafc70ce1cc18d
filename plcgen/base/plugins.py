"""What other distributions bring: objects behind the entry points of a group."""

from __future__ import annotations

import sys
from collections.abc import Iterable
from functools import lru_cache
from typing import Any, TypeVar

from plcgen.base.diagnostics import PluginError

Plugin = TypeVar("Plugin")


def plugins(group: str, shape: type[Plugin]) -> dict[str, Plugin]:
    """The objects of a group by the name of their entry point, sorted by name.

    Raises:
        PluginError: if one of them cannot be loaded or has not the shape.
    """
    found: dict[str, Plugin] = {}
    for point in sorted(offered(tuple(sys.path)).select(group=group), key=lambda point: (point.name, point.value)):
        try:
            loaded = point.load()
        except (Exception, SystemExit) as problem:  # code of others: whatever it raises is told
            raise PluginError(f"the plug-in {point.name} ({point.value}) cannot be loaded: {problem}") from problem
        if not isinstance(loaded, shape):
            raise PluginError(f"{point.value} in {group} is not of type {shape.__name__}")
        found[point.name] = loaded
    return found


def expect_free(group: str, names: Iterable[str], taken: Iterable[str]) -> None:
    """Raise PluginError if a plug-in brings a name that something else has already."""
    known = set(taken)
    for name in names:
        if name in known:
            raise PluginError(f'a plug-in in {group} brings "{name}", which is taken')
        known.add(name)


@lru_cache(maxsize=1)
def offered(_path: tuple[str, ...]) -> Any:
    """Every entry point on ``sys.path``: to find them takes a look into each distribution, so it is done once."""
    from importlib.metadata import entry_points

    return entry_points()
