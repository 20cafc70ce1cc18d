"""Values of an S7-200 as tables, lines and data."""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from plcgen.diagnostics import Diagnostic, Span
from plcgen.output.cells import clean, cut
from plcgen.output.json import diagnostic_data, diagnostics_data, dump
from plcgen.output.paint import paint
from plcgen.output.table import text_table
from plcgen.protocols.ppi.wire.codes import return_code

if TYPE_CHECKING:
    from plcgen.protocols.ppi.client import Reading, Written
    from plcgen.protocols.ppi.client.places import Place
    from plcgen.protocols.ppi.client.values import Value
    from plcgen.protocols.ppi.wire.model import WriteItem

HEADER = ("name", "address", "type", "value", "bytes")
_SHOWN, _WIDEST = 8, 48


def _bytes(data: bytes) -> str:
    text = data[:_SHOWN].hex(" ").upper()
    return f"{text} ... {len(data)} bytes" if len(data) > _SHOWN else text


def readings_text(readings: Sequence[Reading], *, color: bool = False, width: int = 0) -> str:
    """One row a value; the value column says why where there is none."""
    return "\n".join(readings_table(readings, (), color=color, width=width)) + "\n"


def readings_table(
    readings: Sequence[Reading], before: Sequence[Reading], *, color: bool = False, width: int = 0
) -> list[str]:
    """Return the lines of the table; values that changed since ``before`` are bold, errors red."""
    named = any(reading.name.partition(":")[0].upper() != reading.place.address for reading in readings)
    rows = [_row(reading, named=named) for reading in readings]
    header, *lines = text_table(HEADER if named else HEADER[1:], rows)
    old = {id(reading.place): reading for reading in before}
    shown = [paint(header, "dim", color=color)]
    for reading, line in zip(readings, lines, strict=True):
        known = old.get(id(reading.place))
        changed = known is not None and (known.data, known.code) != (reading.data, reading.code)
        text = cut(line, width) if width else line
        shown.append(
            paint(text, "error" if not reading.ok else "bold", color=color) if changed or not reading.ok else text
        )
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


def _plain(value: Value | None) -> Any:
    """A value as JSON has it: what is no number there becomes a text."""
    if isinstance(value, tuple):
        return [_plain(entry) for entry in value]
    return str(value) if isinstance(value, float) and not math.isfinite(value) else value


def reading_data(reading: Reading) -> dict[str, Any]:
    """One reading as plain data."""
    return {
        "name": reading.name,
        "address": reading.place.address,
        "type": reading.place.type_name,
        "ok": reading.ok,
        "value": _plain(reading.value),
        "hex": reading.data.hex().upper(),
        "return_code": f"{reading.code:02X}",
        "error": reading.error,
    }


def readings_json(readings: Sequence[Reading], found: Sequence[Diagnostic]) -> str:
    """JSON of ``ppi read``."""
    return dump({**diagnostics_data("ppi values", found), "values": [reading_data(reading) for reading in readings]})


def readings_row(time: str, readings: Sequence[Reading]) -> str:
    """One line of JSON for one read of ``ppi monitor``."""
    row = {"time": time, "ok": all(r.ok for r in readings), "values": [reading_data(r) for r in readings]}
    return json.dumps(row, ensure_ascii=False, allow_nan=False) + "\n"


def missed_row(time: str, found: Sequence[Diagnostic]) -> str:
    """One line of JSON for a read that failed as a whole."""
    row = {"time": time, "ok": False, "values": [], "diagnostics": [diagnostic_data(d) for d in found]}
    return json.dumps(row, ensure_ascii=False, allow_nan=False) + "\n"


def reading_problems(line: str, readings: Sequence[Reading]) -> list[Diagnostic]:
    """Return one diagnostic for each value that could not be read."""
    return [_refused(line, reading.place, reading.code) for reading in readings if not reading.ok]


def written_problems(line: str, written: Sequence[Written]) -> list[Diagnostic]:
    """Return one diagnostic for each value that could not be written."""
    return [_refused(line, entry.place, entry.code) for entry in written if not entry.ok]


def _refused(line: str, place: Place, code: int) -> Diagnostic:
    meaning = return_code(code)
    return Diagnostic("PG719", f"{place.name}: {code:02X}h, {meaning.text}", Span(line), help=meaning.help)


def entries_text(entries: Sequence[tuple[Place, WriteItem]]) -> str:
    """Return what would be written."""
    rows = [(p.address, p.type_name, cut(clean(_value(p, e)), _WIDEST), _bytes(e.data)) for p, e in entries]
    return "\n".join(text_table(("address", "type", "value", "bytes"), rows))


def _value(place: Place, entry: WriteItem) -> str:
    from plcgen.protocols.ppi.client.values import text_of

    return text_of(place.value(entry.data), place.type)


def written_text(
    entries: Sequence[tuple[Place, WriteItem]], written: Sequence[Written], *, color: bool = False, width: int = 0
) -> str:
    """One row a value with its result."""
    rows = [
        (
            place.address,
            place.type_name,
            cut(clean(_value(place, entry)), _WIDEST),
            "written" if result.ok else f"error {result.error}",
        )
        for (place, entry), result in zip(entries, written, strict=True)
    ]
    header, *lines = text_table(("address", "type", "value", "result"), rows, limit=width)
    shown = [
        line if result.ok else paint(line, "error", color=color) for line, result in zip(lines, written, strict=True)
    ]
    return "\n".join([paint(header, "dim", color=color), *shown]) + "\n"


def written_json(
    entries: Sequence[tuple[Place, WriteItem]], written: Sequence[Written], found: Sequence[Diagnostic]
) -> str:
    """JSON of ``ppi write``."""
    rows = [
        {
            "name": place.name,
            "address": place.address,
            "type": place.type_name,
            "value": _plain(place.value(entry.data)),
            "hex": entry.data.hex().upper(),
            "ok": result.ok,
            "return_code": f"{result.code:02X}",
            "error": result.error,
        }
        for (place, entry), result in zip(entries, written, strict=True)
    ]
    return dump({**diagnostics_data("ppi write", found), "values": rows})
