"""``plcgen ppi stop``: put an S7-200 into STOP."""

from __future__ import annotations

from typing import Any

import click

from plcgen.cli.options import CONTEXT, Verb, common_options, json_option
from plcgen.cli.ppi.connection import line_options
from plcgen.cli.ppi.mode import change_mode


@click.command(
    "stop",
    cls=Verb,
    context_settings=CONTEXT,
    examples=("plcgen ppi stop --port /dev/ttyUSB0 --yes-stop",),
)
@click.option("--yes-stop", "confirmed", is_flag=True, help="Really do it; without it nothing is sent.")
@line_options
@json_option
@common_options
@click.pass_context
def command(ctx: click.Context, /, *, confirmed: bool, as_json: bool, **given: Any) -> int:
    """Put the CPU into STOP; only with --yes-stop.

    The program ends, outputs take their substitute values. Exit code 1 if the CPU refuses, 2 without --yes-stop.
    """
    return change_mode(ctx, "stop", given, confirmed=confirmed, as_json=as_json)
