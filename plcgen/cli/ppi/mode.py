"""What RUN and STOP share on the command line."""

from __future__ import annotations

from typing import Any

import click

from plcgen.cli.options import console
from plcgen.cli.output import OK
from plcgen.cli.ppi.connection import failed, open_client
from plcgen.diagnostics import DiagnosticError


def change_mode(ctx: click.Context, verb: str, given: dict[str, Any], *, confirmed: bool, as_json: bool) -> int:
    """Send RUN or STOP, if that was confirmed, and tell the result."""
    out = console(ctx)
    if not confirmed:
        raise click.UsageError(f"nothing was sent: {verb} needs --yes-{verb}", ctx)
    try:
        with open_client(ctx, given) as client:
            if verb == "run":
                client.run()
            else:
                client.stop()
    except DiagnosticError as problem:
        return failed(out, "ppi mode", problem.diagnostics, as_json=as_json)
    if as_json:
        from plcgen.output.json import diagnostics_data, dump

        out.result(dump({**diagnostics_data("ppi mode", ()), "station": given["station"], "mode": verb.upper()}))
    else:
        out.result(f"station {given['station']}: {verb.upper()}\n")
    return OK
