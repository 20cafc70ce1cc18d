"""``plcgen ppi``: the group of verbs for S7-200 stations."""

from __future__ import annotations

import click

from plcgen.cli.groups import Sections, VerbGroup
from plcgen.cli.options import CONTEXT, common_options
from plcgen.cli.output import OK

SECTIONS: Sections = (
    (
        "Telegrams",
        (
            ("encode", "Print request telegrams as hex."),
            ("decode", "Explain telegrams and captures byte by byte."),
        ),
    ),
    ("Simulate", (("serve", "Be an S7-200 on a pseudo terminal, serial port or TCP port."),)),
)


@click.command(
    "ppi",
    cls=VerbGroup,
    sections=SECTIONS,
    package="plcgen.cli.ppi",
    context_settings=CONTEXT,
    invoke_without_command=True,
    examples=(
        "plcgen ppi encode read VB100 M0.0",
        "plcgen ppi decode 10 02 00 5C 5E 16",
    ),
)
@common_options
@click.pass_context
def command(ctx: click.Context) -> int:
    """Talk to S7-200 PLCs over PPI: telegrams, values, a simulated station."""
    if ctx.invoked_subcommand is None:
        click.echo(ctx.get_help())
    return OK
