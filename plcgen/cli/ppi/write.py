"""``plcgen ppi write``: change values of an S7-200."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import click

from plcgen.cli.options import console, format_option, verb
from plcgen.cli.ppi.connection import ask, line_options, open_client
from plcgen.cli.ppi.places import cpu_option, symbols_option

if TYPE_CHECKING:
    from plcgen.base.display.results import Answer
    from plcgen.report.registry import OutputFormat


@verb(
    "write",
    "plcgen ppi write VW100=1234 M0.0=1 --port /dev/ttyUSB0 --yes-write",
    "plcgen ppi write VD200:REAL=1.5 VB0[21]:STRING='Recipe 7' --port COM3 --yes-write",
    "plcgen ppi write setpoint=16#04D2 --symbols press.csv --port socket://10.0.0.5:4000 --yes-write",
)
@click.argument("words", nargs=-1, required=True, metavar="ADDRESS=VALUE...")
@click.option("--yes-write", is_flag=True, help="Write the values; without this option they are only shown.")
@line_options
@cpu_option
@symbols_option
@format_option("answer")
def command(
    *,
    words: tuple[str, ...],
    cpu: str | None,
    symbols: str | None,
    yes_write: bool,
    format_: OutputFormat,
    **given: Any,
) -> int:
    """Write values to addresses or symbols; only with --yes-write, since a machine may move.

    Values: 1234, -5, 16#04D2, 2#1010, 1.5, 0 or 1 for bits, several with commas for VB0[4]; text for CHAR and STRING.
    All values are checked before the first telegram is sent. Exit code 1 if the station refuses an item, 2 without
    --yes-write.
    """
    from plcgen.cli.ppi.places import find_profile, find_symbols, read_assignments
    from plcgen.ppi.client.texts import entries_text, written_answer

    def question() -> Answer:
        entries = read_assignments(words, find_symbols(symbols), find_profile(cpu))
        if not yes_write:
            console().say(entries_text(entries))
            raise click.UsageError("nothing was written: writing needs --yes-write")
        with open_client(given) as client:
            written = client.write_items(entries)
        return written_answer(given["port"], entries, written)

    return ask(format_, "ppi write", words, question)
