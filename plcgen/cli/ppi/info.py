"""``plcgen ppi info``: which CPU answers."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import click

from plcgen.cli.options import Verb, format_option
from plcgen.cli.ppi.connection import ask, line_options, open_client, station_answer

if TYPE_CHECKING:
    from plcgen.output.registry import Format
    from plcgen.output.results import Answer


@click.command(
    "info",
    cls=Verb,
    examples=(
        "plcgen ppi info --port /dev/ttyUSB0",
        "plcgen ppi info --port socket://10.0.0.5:4000 --station 3 --json",
    ),
)
@line_options
@format_option("answer")
def command(*, format_: Format, **given: Any) -> int:
    """Show the CPU type and firmware that the station reports in its system area."""

    def question() -> Answer:
        with open_client(given) as client:
            info = client.info()
        text = f"{info.type}, firmware {info.firmware}" if info.firmware else info.type
        data = {"station": given["station"], "type": info.type, "firmware": info.firmware, "text": info.text}
        return station_answer("ppi info", text, **data)

    return ask(format_, "ppi info", (), question)
