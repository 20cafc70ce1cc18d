"""``plcgen ppi info``: which CPU answers."""

from __future__ import annotations

from typing import Any

import click

from plcgen.cli.options import CONTEXT, Verb, common_options, console, json_option
from plcgen.cli.output import OK
from plcgen.cli.ppi.connection import failed, line_options, open_client
from plcgen.diagnostics import DiagnosticError


@click.command(
    "info",
    cls=Verb,
    context_settings=CONTEXT,
    examples=(
        "plcgen ppi info --port /dev/ttyUSB0",
        "plcgen ppi info --port socket://10.0.0.5:4000 --station 3 --json",
    ),
)
@line_options
@json_option
@common_options
@click.pass_context
def command(ctx: click.Context, /, *, as_json: bool, **given: Any) -> int:
    """Show the CPU type and firmware that the station reports in its system area."""
    out = console(ctx)
    try:
        with open_client(ctx, given) as client:
            info = client.info()
    except DiagnosticError as problem:
        return failed(out, "ppi info", problem.diagnostics, as_json=as_json)
    if as_json:
        from plcgen.output.json import diagnostics_data, dump

        data = {"station": given["station"], "type": info.type, "firmware": info.firmware, "text": info.text}
        out.result(dump({**diagnostics_data("ppi info", ()), **data}))
    else:
        firmware = f", firmware {info.firmware}" if info.firmware else ""
        out.result(f"station {given['station']}: {info.type}{firmware}\n")
    return OK
