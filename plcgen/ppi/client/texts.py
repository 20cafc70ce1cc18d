"""Values of an S7-200 as tables, lines and data."""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from functools import partial
from typing import TYPE_CHECKING, Any

from plcgen.base.diagnostics import Diagnostic, Span
from plcgen.base.display.cells import clean, cut
from plcgen.base.display.data import diagnostic_data, diagnostics_data
from plcgen.base.display.results import Answer
from plcgen.base.display.table import text_table
from plcgen.base.display.view import View
from plcgen.ppi.wire.codes import return_code

if TYPE_CHECKING:
    from plcgen.ppi.client import Reading, Written
    from plcgen.ppi.client.values import Place, Value
    from plcgen.ppi.wire.model import ItemWrite

HEADER = ("name", "address", "type", "value", "bytes")
_SHOWN, _WIDEST = 8, 48


def _bytes(data: bytes) -> str:
    text = data[:_SHOWN].hex(" ").upper()
    return f"{text} ... {len(data)} bytes" if len(data) > _SHOWN else text


def readings_table(readings: Sequence[Reading], before: Sequence[Reading], view: View) -> list[str]:
    """One row a value; values that changed since ``before`` are bold, errors red and say why there is no value."""
    named = any(reading.name.partition(":")[0].upper() != reading.place.address for reading in readings)
    rows = [_row(reading, named=named) for reading in readings]
    header, *lines = text_table(HEADER if named else HEADER[1:], rows)
    old = {id(reading.place): reading for reading in before}
    shown = [view.paint(header, "dim")]
    for reading, line in zip(readings, lines, strict=True):
        known = old.get(id(reading.place))
        changed = known is not None and (known.data, known.code) != (reading.data, reading.code)
        shown.append(view.paint(cut(line, view.width), "error" if not reading.ok else "bold" if changed else ""))
    return shown


def _row(reading: Reading, *, named: bool) -> tuple[str, ...]:
    place = reading.place
    value = cut(clean(reading.text), _WIDEST) if reading.ok else f"error {reading.error}"
    cells = (place.address, place.type_name, value, _bytes(reading.data))
    return (clean(reading.name.rpartition(":")[0] or reading.name), *cells) if named else cells


def reading_line(readings: Sequence[Reading]) -> str:
    """``VB100=34 M0.0=1``: one read in one line."""
    return "  ".join(
        f"{clean(reading.name)}={clean(reading.text) if reading.ok else f'error {reading.code:02X}h'}"
        for reading in readings
    )


def plain(value: Value | None) -> Any:
    """A value as JSON has it: what is no number there becomes a text."""
    if isinstance(value, tuple):
        return [plain(entry) for entry in value]
    return str(value) if isinstance(value, float) and not math.isfinite(value) else value


def reading_data(reading: Reading) -> dict[str, Any]:
    """One reading as plain data."""
    return {
        "name": reading.name,
        "address": reading.place.address,
        "type": reading.place.type_name,
        "ok": reading.ok,
        "value": plain(reading.value),
        "hex": reading.data.hex().upper(),
        "return_code": f"{reading.code:02X}",
        "error": reading.error,
    }


def readings_answer(line: str, readings: Sequence[Reading]) -> Answer:
    """Answer of ``ppi read``, with one diagnostic for each value that could not be read."""
    found = [_refused(line, reading.place, reading.code) for reading in readings if not reading.ok]
    data = {**diagnostics_data("ppi values", found), "values": [reading_data(reading) for reading in readings]}
    return Answer(data, lambda view: "\n".join(readings_table(readings, (), view)) + "\n", found)


def readings_row(time: str, readings: Sequence[Reading], found: Sequence[Diagnostic] = ()) -> str:
    """One line of JSON for one read of ``ppi monitor``; ``found`` says why it failed as a whole."""
    row: dict[str, Any] = {"time": time, "ok": not found and all(r.ok for r in readings)}
    row["values"] = [reading_data(reading) for reading in readings]
    if found:
        row["diagnostics"] = [diagnostic_data(d) for d in found]
    return json.dumps(row, ensure_ascii=False, allow_nan=False) + "\n"


def _refused(line: str, place: Place, code: int) -> Diagnostic:
    meaning = return_code(code)
    return Diagnostic("PG719", f"{place.name}: {code:02X}h, {meaning.text}", Span(line), help=meaning.help)


def entries_text(entries: Sequence[tuple[Place, ItemWrite]]) -> str:
    """Return what would be written."""
    rows = [(*_planned(place, entry), _bytes(entry.data)) for place, entry in entries]
    return "\n".join(text_table(("address", "type", "value", "bytes"), rows))


def _planned(place: Place, entry: ItemWrite) -> tuple[str, str, str]:
    from plcgen.ppi.client.values import text_of

    value = text_of(place.value(entry.data), place.type)
    return place.address, place.type_name, cut(clean(value), _WIDEST)


def written_answer(line: str, entries: Sequence[tuple[Place, ItemWrite]], written: Sequence[Written]) -> Answer:
    """Answer of ``ppi write``, with one diagnostic for each value that could not be written."""
    found = [_refused(line, entry.place, entry.code) for entry in written if not entry.ok]
    rows = [
        {
            "name": place.name,
            "address": place.address,
            "type": place.type_name,
            "value": plain(place.value(entry.data)),
            "hex": entry.data.hex().upper(),
            "ok": result.ok,
            "return_code": f"{result.code:02X}",
            "error": result.error,
        }
        for (place, entry), result in zip(entries, written, strict=True)
    ]
    return Answer({**diagnostics_data("ppi write", found), "values": rows}, partial(_written, entries, written), found)


def _written(entries: Sequence[tuple[Place, ItemWrite]], written: Sequence[Written], view: View) -> str:
    rows = [
        (*_planned(place, entry), "written" if result.ok else f"error {result.error}")
        for (place, entry), result in zip(entries, written, strict=True)
    ]
    header, *lines = text_table(("address", "type", "value", "result"), rows, limit=view.width)
    shown = [view.paint(line, "" if result.ok else "error") for line, result in zip(lines, written, strict=True)]
    return "\n".join([view.paint(header, "dim"), *shown]) + "\n"
