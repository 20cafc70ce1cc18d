"""Modules under the names that they had in version 0.1, for one release: importing one works, with a warning.

``plcgen.cpu.testing`` is on pages and in tests of users; the other names cost nothing beside it.
"""

from __future__ import annotations

import sys
import warnings
from importlib import import_module
from importlib.machinery import ModuleSpec
from types import ModuleType

MOVED = {
    "plcgen.cpu": "plcgen.s7.cpu",
    "plcgen.diagnostics": "plcgen.base.diagnostics",
    "plcgen.ds47.kinds.kind": "plcgen.ds47.kind",
    "plcgen.protocols.base": "plcgen.protocol.base",
    "plcgen.protocols.ds47": "plcgen.ds47",
    "plcgen.protocols.ppi": "plcgen.ppi",
    "plcgen.scl": "plcgen.s7.scl",
    "plcgen.signoff": "plcgen.report.review",
    "plcgen.simaticml": "plcgen.s7.xml",
    "plcgen.sources": "plcgen.s7.read",
}


class OldNames:
    """Finds a module under its old name: it is the one of the new name, not a second one."""

    def __init__(self) -> None:
        self._specs: dict[str, ModuleSpec | None] = {}

    def find_spec(self, name: str, _path: object = None, _target: object = None) -> ModuleSpec | None:
        """The module behind an old name; None for all other names."""
        if name == "plcgen.protocols":
            return ModuleSpec(name, self, is_package=True)  # type: ignore[arg-type]
        for old, new in MOVED.items():
            if name == old or name.startswith(f"{old}."):
                return ModuleSpec(name, self, origin=new + name.removeprefix(old))  # type: ignore[arg-type]
        return None

    def create_module(self, spec: ModuleSpec) -> ModuleType | None:
        """The module of the new name."""
        if spec.origin is None:
            return None
        message = f"{spec.name} is called {spec.origin} now"
        warnings.warn(message, DeprecationWarning, stacklevel=6)
        module = import_module(spec.origin)
        self._specs[spec.name] = module.__spec__
        return module

    def exec_module(self, module: ModuleType) -> None:
        """It has been executed under its new name, which stays the one it is known by."""
        for name, spec in list(self._specs.items()):
            if spec is not None and spec.name == module.__name__:
                module.__spec__ = self._specs.pop(name)


def install() -> None:
    """Let old names be found: in front, because Python would find what lies below one a second time."""
    sys.meta_path.insert(0, OldNames())
