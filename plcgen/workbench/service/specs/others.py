"""YAML files of plcgen that are no specs: device profiles, simulated drives and stations."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING

from plcgen.base.diagnostics import Diagnostic, DiagnosticError
from plcgen.workbench.service.specs.shape import Shape

if TYPE_CHECKING:
    from plcgen.workbench.service.specs.state import SpecState


@dataclass(frozen=True, slots=True)
class FileKind:
    """A kind of file: the name of its schema, sets of keys of which a file of it has one, and what reads its text."""

    schema: str
    keys: tuple[frozenset[str], ...]
    read: Callable[[str, str], object]

    @property
    def shape(self) -> Shape:
        """What its schema says."""
        return _shape(self.schema)


def _profile(text: str, file: str) -> object:
    from plcgen.ds47.devices import parse_profile

    return parse_profile(text, file, file)


def _drive(text: str, file: str) -> object:
    from plcgen.ds47.sim.load import load_drive

    return load_drive(text, file)


def _bus(text: str, file: str) -> object:
    from plcgen.ppi.sim.load import load_bus

    return load_bus(text, file)


_KINDS = (
    FileKind("profile", (frozenset({"record_index"}), frozenset({"title", "source"}), frozenset({"like"})), _profile),
    FileKind("drive", (frozenset({"objects"}),), _drive),
    FileKind("station", (frozenset({"stations"}), frozenset({"cpu", "address"}), frozenset({"cpu", "values"})), _bus),
)


@cache
def _shape(schema: str) -> Shape:
    from plcgen import api

    return Shape(api.schema(schema))


def kind_of(state: SpecState) -> FileKind | None:
    """The kind of a file that is no spec, if most of its keys are those of a kind."""
    keys = {str(one.path[0]) for one in state.sketch.entries if len(one.path) == 1}
    for kind in _KINDS:
        known = kind.shape.keys(()).keys()
        if any(some <= keys for some in kind.keys) and 2 * len(keys & known) >= len(keys):
            return kind
    return None


def problems(state: SpecState) -> tuple[Diagnostic, ...]:
    """What is wrong with a file of such a kind; nothing for files of others."""
    kind = kind_of(state)
    if kind is None:
        return ()
    try:
        kind.read(state.document.text, state.document.file)
    except DiagnosticError as found:
        return tuple(found.diagnostics)
    return ()
