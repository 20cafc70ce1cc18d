"""The verbs that change the mode of an S7-200: RUN and STOP differ in a word."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import click

from plcgen.cli.options import Verb, format_option
from plcgen.cli.ppi.connection import ask, line_options, open_client, station_answer

if TYPE_CHECKING:
    from plcgen.output.registry import Format
    from plcgen.output.results import Answer


def mode_command(verb: str, help_: str) -> click.Command:
    """Make the verb ``run`` or ``stop``; without ``--yes-run`` or ``--yes-stop`` it sends nothing."""

    @click.command(verb, cls=Verb, help=help_, examples=(f"plcgen ppi {verb} --port /dev/ttyUSB0 --yes-{verb}",))
    @click.option(f"--yes-{verb}", "confirmed", is_flag=True, help="Really do it; without it nothing is sent.")
    @line_options
    @format_option("answer")
    def command(*, confirmed: bool, format_: Format, **given: Any) -> int:
        if not confirmed:
            raise click.UsageError(f"nothing was sent: {verb} needs --yes-{verb}")

        def question() -> Answer:
            with open_client(given) as client:
                (client.run if verb == "run" else client.stop)()
            return station_answer("ppi mode", verb.upper(), station=given["station"], mode=verb.upper())

        return ask(format_, "ppi mode", (), question)

    return command
