"""The JSON schemas of verbs that write one object a line: ``ppi serve`` and ``ppi monitor``; stated by hand."""

from __future__ import annotations

from plcgen.base.display.data import FORMAT
from plcgen.report.shapes import (
    DIAGNOSTIC,
    DIAGNOSTICS,
    FLAG,
    NOTE,
    NUMBER,
    READING,
    TEXT,
    Shape,
    many,
    maybe,
    one_of,
    record,
    said,
)


def _head(kind: str, text: str) -> Shape:
    schema = "https://json-schema.org/draft/2020-12/schema"
    return {"$schema": schema, "$id": f"urn:plcgen:{kind}:{FORMAT}", "title": f"plcgen ppi {kind}", "description": text}


def monitor_schema() -> Shape:
    """JSON schema (draft 2020-12) of a line of ``ppi monitor --json``: one read."""
    row = record(
        {"diagnostics": said("Why the read failed as a whole.", DIAGNOSTICS)},
        time=said("Local time of day.", {"type": "string", "pattern": r"^[0-9]{2}:[0-9]{2}:[0-9]{2}\.[0-9]{3}$"}),
        ok=FLAG,
        values=said("Empty if the read failed as a whole.", many(READING)),
    )
    head = _head("monitor", "A line of ppi monitor --json: one read of all values.")
    return {**head, **row, "$defs": {"note": NOTE, "diagnostic": DIAGNOSTIC}}


def serve_schema() -> Shape:
    """JSON schema (draft 2020-12) of a line of ``ppi serve --json``: one event."""
    station = record(address=NUMBER, cpu=TEXT, mode=one_of("run", "stop"))
    events = {
        "open": record(event=TEXT, line=said("What to open.", TEXT), stations=many(station)),
        "connection": record(event=TEXT, text=TEXT),
        "frame": record(
            event=TEXT,
            time=said("Milliseconds since the start.", NUMBER),
            direction=one_of("request", "answer"),
            bytes=said("Hexadecimal digits.", {"type": "string", "pattern": "^([0-9A-F]{2}( [0-9A-F]{2})*)?$"}),
            text=TEXT,
            fault=said("What was made wrong on purpose.", maybe(TEXT)),
        ),
        "end": record(event=TEXT, requests=NUMBER),
    }
    return {
        **_head("serve", "A line of ppi serve --json: one event."),
        "type": "object",
        "required": ["event"],
        "properties": {"event": {"enum": list(events)}},
        "allOf": [
            {"if": {"properties": {"event": {"const": name}}, "required": ["event"]}, "then": shape}
            for name, shape in events.items()
        ],
    }
