"""``plcgen ppi run``: put an S7-200 into RUN."""

from __future__ import annotations

from typing import Any

import click

from plcgen.cli.options import CONTEXT, Verb, common_options, json_option
from plcgen.cli.ppi.connection import line_options
from plcgen.cli.ppi.mode import change_mode


@click.command(
    "run",
    cls=Verb,
    context_settings=CONTEXT,
    examples=("plcgen ppi run --port /dev/ttyUSB0 --yes-run",),
)
@click.option("--yes-run", "confirmed", is_flag=True, help="Really do it; without it nothing is sent.")
@line_options
@json_option
@common_options
@click.pass_context
def command(ctx: click.Context, /, *, confirmed: bool, as_json: bool, **given: Any) -> int:
    """Put the CPU into RUN; only with --yes-run.

    The program starts, outputs become active. The mode selector must be at RUN or TERM. Exit code 1 if the CPU refuses,
    2 without --yes-run.
    """
    return change_mode(ctx, "run", given, confirmed=confirmed, as_json=as_json)
