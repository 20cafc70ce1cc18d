"""``plcgen ppi read``: values of an S7-200."""

from __future__ import annotations

from typing import Any

import click

from plcgen.cli.options import CONTEXT, Verb, common_options, console, json_option
from plcgen.cli.output import OK, PROBLEMS
from plcgen.cli.ppi.connection import failed, line_options, open_client
from plcgen.cli.ppi.places import cpu_option, symbols_option
from plcgen.diagnostics import DiagnosticError


@click.command(
    "read",
    cls=Verb,
    context_settings=CONTEXT,
    examples=(
        "plcgen ppi read VB100 M0.0 T32 --port /dev/ttyUSB0",
        "plcgen ppi read VD200:REAL VB0[21]:STRING --port socket://192.168.1.50:4000",
        "plcgen ppi read pump_speed level:REAL --symbols press.csv --port COM3",
        "plcgen ppi read VB0[1000] --port /dev/ttyUSB0 --json",
    ),
)
@click.argument("words", nargs=-1, required=True, metavar="ADDRESS...")
@line_options
@cpu_option
@symbols_option
@json_option
@common_options
@click.pass_context
def command(
    ctx: click.Context, /, words: tuple[str, ...], cpu: str | None, symbols: str | None, *, as_json: bool, **given: Any
) -> int:
    """Read values by address or symbol, in as few telegrams as possible.

    A type behind a colon says how to read the bytes: BYTE, WORD, INT, DWORD, DINT, REAL, CHAR, STRING. Without one
    bytes, words and double words are unsigned numbers. Exit code 1 if the station refuses an item.
    """
    from plcgen.cli.ppi.places import find_profile, find_symbols, places
    from plcgen.protocols.ppi.client.texts import reading_problems, readings_json, readings_text

    out = console(ctx)
    try:
        table = find_symbols(symbols)
        asked = places(words, table, find_profile(cpu))
        with open_client(ctx, given, table) as client:
            readings = client.read(*asked)
    except DiagnosticError as problem:
        return failed(out, "ppi values", problem.diagnostics, words, as_json=as_json)
    found = reading_problems(given["port"], readings)
    if as_json:
        out.result(readings_json(readings, found))
    else:
        out.result(readings_text(readings, color=out.out_color, width=out.out_width))
        out.complain(found)
    return PROBLEMS if found else OK
