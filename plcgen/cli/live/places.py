"""Addresses on the command line, the limit of time, and the answer of the verbs that compare."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any, TypeVar

import click

if TYPE_CHECKING:
    from plcgen.base.diagnostics import Diagnostic
    from plcgen.base.display.results import Answer
    from plcgen.ds47.live.comparison import LiveRow
    from plcgen.ds47.live.connection import S7Partner

Callback = TypeVar("Callback", bound=Callable[..., Any])


def timeout_option(verb: Callback) -> Callback:
    """Add ``--timeout``."""
    return click.option(
        "--timeout",
        type=click.FloatRange(0.1, 60),
        default=5.0,
        show_default=True,
        metavar="SECONDS",
        help="Longest wait for one answer; connecting takes 5 s at most.",
    )(verb)


def read_partner(text: str, option: str, rack: int = 0, slot: int = 0) -> S7Partner:
    """``HOST`` or ``HOST:PORT``."""
    from plcgen.ds47.live.connection import PORT, S7Partner

    host, colon, port = text.strip().rpartition(":")
    if not colon:
        host, port = port, str(PORT)
    if not host or not host.isascii() or not host.isprintable() or " " in host or not _is_port(port):
        raise click.BadParameter(f'"{text}": write an IPv4 address, 192.168.0.5 or 192.168.0.5:102', param_hint=option)
    return S7Partner(host, int(port), rack, slot)


def _is_port(text: str) -> bool:
    return text.isascii() and text.isdigit() and len(text) <= 5 and 1 <= int(text) <= 0xFFFF


def comparison(kind: str, rows: Sequence[LiveRow], place_title: str, skipped: Sequence[str]) -> Answer:
    """Rows as a table and as data; what deviates or was not read is a diagnostic."""
    from plcgen.base.diagnostics import Diagnostic, Span
    from plcgen.base.display.data import diagnostics_data
    from plcgen.base.display.results import Answer
    from plcgen.base.display.table import text_table
    from plcgen.ds47.live.comparison import DEVIATES, UNREAD

    problems: list[Diagnostic] = []
    for row in rows:
        if row.verdict == DEVIATES:
            found = row.found or row.why
            problems.append(Diagnostic("PG707", f"{row.place}: {found}, not {row.wanted}", Span(row.subject)))
        elif row.verdict == UNREAD:
            problems.append(Diagnostic("PG706", row.why, Span(row.subject)))
    header = ("subject", place_title, "wanted", "found", "verdict")
    cells = [(row.subject, row.place, row.wanted, row.found, row.verdict) for row in rows]
    text = "\n".join(text_table(header, cells, indent=0)) + "\n" if cells else ""
    text += "".join(f"not asked: {one}\n" for one in skipped)
    keys = ("subject", "place", "wanted", "found", "verdict", "why")
    data = [{key: getattr(row, key) for key in keys} for row in rows]
    shown = {**diagnostics_data(kind, problems), "rows": data, "skipped": list(skipped)}
    return Answer(shown, lambda _view: text, problems)
