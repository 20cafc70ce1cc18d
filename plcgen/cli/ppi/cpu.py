"""``plcgen ppi info``, ``run`` and ``stop``: what an S7-200 is, and its mode."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import click

from plcgen.cli.options import format_option, verb
from plcgen.cli.ppi.connection import ask, line_options, open_client, station_answer

if TYPE_CHECKING:
    from plcgen.base.display.results import Answer
    from plcgen.report.registry import OutputFormat


@verb(
    "info",
    "plcgen ppi info --port /dev/ttyUSB0",
    "plcgen ppi info --port socket://10.0.0.5:4000 --station 3 --json",
)
@line_options
@format_option("answer")
def info(*, format_: OutputFormat, **given: Any) -> int:
    """Show the CPU type and firmware that the station reports in its system area."""

    def question() -> Answer:
        with open_client(given) as client:
            cpu = client.info()
        text = f"{cpu.type}, firmware {cpu.firmware}" if cpu.firmware else cpu.type
        data = {"station": given["station"], "type": cpu.type, "firmware": cpu.firmware, "text": cpu.text}
        return station_answer("ppi info", text, **data)

    return ask(format_, "ppi info", (), question)


def _mode(name: str, help_: str) -> click.Command:
    """Make the verb ``run`` or ``stop``; without ``--yes-run`` or ``--yes-stop`` it sends nothing."""

    @verb(name, f"plcgen ppi {name} --port /dev/ttyUSB0 --yes-{name}", help=help_)
    @click.option(
        f"--yes-{name}", "confirmed", is_flag=True, help="Confirm the command; without this option nothing is sent."
    )
    @line_options
    @format_option("answer")
    def command(*, confirmed: bool, format_: OutputFormat, **given: Any) -> int:
        if not confirmed:
            raise click.UsageError(f"nothing was sent: {name} needs --yes-{name}")

        def question() -> Answer:
            with open_client(given) as client:
                (client.run if name == "run" else client.stop)()
            return station_answer("ppi mode", name.upper(), station=given["station"], mode=name.upper())

        return ask(format_, "ppi mode", (), question)

    return command


run = _mode(
    "run",
    """Put the CPU into RUN; only with --yes-run.

    The program starts, outputs become active. The mode selector must be at RUN or TERM. Exit code 1 if the CPU refuses,
    2 without --yes-run.
    """,
)
stop = _mode(
    "stop",
    """Put the CPU into STOP; only with --yes-stop.

    The program ends, outputs take their substitute values. Exit code 1 if the CPU refuses, 2 without --yes-stop.
    """,
)
