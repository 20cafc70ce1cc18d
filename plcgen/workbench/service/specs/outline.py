"""What a spec defines, as a tree: drives, jobs, recipes, stations."""

from __future__ import annotations

from plcgen.base.diagnostics import Span
from plcgen.workbench.service.results import Symbol, SymbolKind
from plcgen.workbench.service.specs.names import named
from plcgen.workbench.service.specs.sketch import Entry, Path
from plcgen.workbench.service.specs.state import SpecState, matches

_SYMBOLS: dict[str, SymbolKind] = {
    "drive": "drive", "job": "job", "unit": "unit", "recipe": "recipe", "station": "station", "master": "unit",
    "variable": "variable",
}  # fmt: skip


def outline(state: SpecState) -> tuple[Symbol, ...]:
    """The sections of a spec with what has a name in them."""
    entries = state.sketch.entries if state.is_spec else []
    ends: dict[Path, Span] = {}
    below: dict[Path, list[Entry]] = {}
    for entry in entries:
        for depth in range(len(entry.path) + 1):
            ends[entry.path[:depth]] = entry.place
        below.setdefault(entry.path[:-1], []).append(entry)

    def symbol(entry: Entry) -> Symbol | None:
        kind = next((one.word for one in named() if any(matches(entry.path[:-1], home) for home in one.homes)), "")
        inside = tuple(found for one in below.get(entry.path, ()) if (found := symbol(one)) is not None)
        if not kind and not inside and len(entry.path) > 1:
            return None
        end = ends[entry.path]
        whole = Span(entry.key.file, entry.key.line, entry.key.column, end.end_line, end.end_column)
        detail = state.sketch.value(*entry.path, "device") if kind in {"drive", "unit"} else _does(below, entry)
        return Symbol(str(entry.path[-1]), _SYMBOLS.get(kind, "section"), detail, whole, entry.key, inside)

    return tuple(found for one in below.get((), ()) if (found := symbol(one)) is not None)


def _does(below: dict[Path, list[Entry]], entry: Entry) -> str:
    """What a job does: the keys that say more than its drive."""
    if len(entry.path) < 2 or entry.path[-2] != "jobs":
        return entry.value
    keys = [str(one.path[-1]) for one in below.get(entry.path, ())]
    return ", ".join(key for key in keys if key not in {"drive", "station", "comment", "trigger"})
