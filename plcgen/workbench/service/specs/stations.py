"""Stations of a PPI line as a spec describes them: address, CPU, symbols; also while the text is broken."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, NamedTuple

from plcgen.base.diagnostics import DiagnosticError
from plcgen.base.display.page import Page
from plcgen.base.files.files import below
from plcgen.ppi.symbols import load_symbols
from plcgen.ppi.wire.address import address_text
from plcgen.workbench.service.specs.sketch import Path
from plcgen.workbench.service.specs.state import matches

if TYPE_CHECKING:
    from plcgen.workbench.service.specs.state import SpecState

_ITEMS = ("read", "write")
_JOB = ("ppi", "*", "jobs", "*")


class StationSymbol(NamedTuple):
    """A name that a job of a station may read or write, its address and what it is."""

    name: str
    address: str
    comment: str


def names_items(path: Path, *, key: bool) -> bool:
    """Whether addresses and symbols stand at a path: as keys of the mapping there, or as the value."""
    if not matches(path[:4], _JOB) or len(path) < 5 or path[4] not in _ITEMS:
        return False
    rest = path[5:]
    if key:
        return not rest and path[4] == "write"
    return not rest or (isinstance(rest[0], int) and rest[1:] in {(), ("item",)})


def symbols_at(state: SpecState, path: Path) -> Iterator[StationSymbol]:
    """The symbols of the station of a job: those of the spec, or of the table that it names."""
    if not matches(path[:4], _JOB):
        return
    outline = state.sketch
    station: Path = ("ppi", path[1], "stations", outline.value(*path[:4], "station"))
    file = outline.value(*station, "symbols")
    if not file:
        for entry in outline.below((*station, "symbols")):
            yield StationSymbol(str(entry.path[-1]), entry.value, "")
        return
    place = below(state.document.path.parent, file)
    try:
        found = load_symbols(place).symbols if place is not None else ()
    except (DiagnosticError, OSError):
        return  # ``check`` says what is wrong with it
    yield from (StationSymbol(one.name, address_text(one.item), one.comment) for one in found)


def symbol_page(state: SpecState, path: Path, name: str) -> Page | None:
    """What a symbol of a job is."""
    known = next((one for one in symbols_at(state, path) if one.name.casefold() == name.casefold()), None)
    if known is None:
        return None
    return Page(
        known.name,
        f"symbol of {state.sketch.value(*path[:4], 'station')}",
        (("Address", known.address), ("Comment", known.comment)),
    )


def station_page(state: SpecState, place: Path) -> Page | None:
    """A station and the jobs that ask it."""
    address = state.sketch.value(*place, "address")
    if not address:
        return None
    cpu = state.sketch.value(*place, "cpu")
    facts = [f"PPI address: {address}", *([f"CPU: {cpu}"] if cpu else [])]
    jobs = [
        str(one.path[3])
        for one in state.sketch.entries
        if matches(one.path, (*_JOB, "station")) and one.path[1] == place[1] and one.value == place[-1]
    ]
    return Page(str(place[-1]), "station", (("Facts", "\n".join(facts)), ("Jobs", ", ".join(jobs))))
