"""Faults as people write them: on the command line and in YAML."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import fields
from typing import Any

from plcgen.diagnostics import Diagnostic, DiagnosticError, Report, Span
from plcgen.diagnostics.suggest import did_you_mean
from plcgen.input.keys import Reader, plain_node
from plcgen.input.yaml import resolve_plain
from plcgen.protocols.ppi.sim.faults import Fault, FaultKind

USAGE = "PG901"
_MOST = 1_000_000


def parse_fault(text: str) -> Fault:
    """Read ``KIND[:KEY=VALUE,...]`` as the command line takes it. Raises DiagnosticError.

    ``times`` is ``once``, a number or ``always``.
    """
    option = f"--fault {text}"
    kind, _, rest = (part.strip() for part in text.partition(":"))
    known = [item.value for item in FaultKind]
    if kind not in known:
        hint = did_you_mean(kind, known) or f"faults: {', '.join(known)}"
        raise _usage(option, f'there is no fault "{kind}"', hint)
    entry: dict[str, Any] = {"kind": kind}
    for pair in filter(None, (part.strip() for part in rest.split(","))):
        key, equals, value = (part.strip() for part in pair.partition("="))
        if not equals or not value:
            raise _usage(option, f'"{pair}" has no value', f"for example {kind}:times=2")
        entry[key] = value if key == "data" else _hexadecimal(value) if key == "code" else resolve_plain(value)
    report = Report()
    fault = read_fault(Reader(plain_node(entry, Span(option)), report, "the fault"))
    if report.has_errors:
        raise DiagnosticError([Diagnostic(USAGE, d.message, Span(option), help=d.help) for d in report])
    return fault


def _usage(option: str, message: str, help_: str) -> DiagnosticError:
    return DiagnosticError([Diagnostic(USAGE, message, Span(option), help=help_)])


def _hexadecimal(text: str) -> Any:
    """Codes are hexadecimal, as manuals print them: 05, 8404, 8404h."""
    try:
        return int(text.removesuffix("h").removeprefix("16#"), 16)
    except ValueError:
        return text


def read_fault(reader: Reader, stations: Sequence[int] = ()) -> Fault:
    """Read the keys of one fault; ``stations`` are the addresses it may name, none for any."""
    reader.only(*(item.name for item in fields(Fault)))
    reader.require("kind")
    base = Fault(FaultKind.SILENCE)
    kind = reader.choice("kind", base.kind, {item.value: item for item in FaultKind})
    times = reader.node.get("times")
    word = None if times is None else times.value
    station = reader.optional("station", 0, 126)
    if station is not None and stations and station not in stations:
        node = reader.node.get("station") or reader.node
        known = ", ".join(str(address) for address in stations)
        reader.error("PG107", f"there is no station {station}", node.span, f"stations: {known}")
    return Fault(
        kind,
        times=None if word in {"always", "forever"} else 1 if word == "once" else reader.number("times", 1, 1, _MOST),
        after=reader.number("after", base.after, 0, _MOST),
        at=reader.choice("at", base.at, {"any": "any", "request": "request", "poll": "poll"}),
        station=station,
        value=reader.optional("value", 0, 0xFFFF),
        milliseconds=reader.number("milliseconds", base.milliseconds, 0, _MOST),
        data=_data(reader),
        item=reader.number("item", base.item, 1, 19),
        code=_code(reader, kind),
    )


def _code(reader: Reader, kind: FaultKind) -> int | None:
    """Return code of an item (not FFh, success) or error of a header (not 0)."""
    if reader.node.get("code") is None:
        return None
    return reader.number("code", 1, 1, 0xFE if kind is FaultKind.ITEM else 0xFFFF)


def _data(reader: Reader) -> bytes:
    try:
        return bytes.fromhex(reader.text("data"))
    except ValueError:
        reader.error(
            "PG107", f'"data" of {reader.what} is hexadecimal text', (reader.node.get("data") or reader.node).span
        )
        return b""
