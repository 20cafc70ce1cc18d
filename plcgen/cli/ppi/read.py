"""``plcgen ppi read``: values of an S7-200."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import click

from plcgen.cli.options import format_option, verb
from plcgen.cli.ppi.connection import ask, line_options, open_client
from plcgen.cli.ppi.places import cpu_option, symbols_option

if TYPE_CHECKING:
    from plcgen.base.display.results import Answer
    from plcgen.report.registry import OutputFormat


@verb(
    "read",
    "plcgen ppi read VB100 M0.0 T32 --port /dev/ttyUSB0",
    "plcgen ppi read VD200:REAL VB0[21]:STRING --port socket://192.168.1.50:4000",
    "plcgen ppi read pump_speed level:REAL --symbols press.csv --port COM3",
    "plcgen ppi read VB0[1000] --port /dev/ttyUSB0 --json",
)
@click.argument("words", nargs=-1, required=True, metavar="ADDRESS...")
@line_options
@cpu_option
@symbols_option
@format_option("answer")
def command(
    *, words: tuple[str, ...], cpu: str | None, symbols: str | None, format_: OutputFormat, **given: Any
) -> int:
    """Read values by address or symbol, in as few telegrams as possible.

    A type after a colon says how to read the bytes: BYTE, WORD, INT, DWORD, DINT, REAL, CHAR, STRING. Without one
    bytes, words and double words are unsigned numbers. Exit code 1 if the station refuses an item.
    """
    from plcgen.cli.ppi.places import find_profile, find_symbols, read_places
    from plcgen.ppi.client.texts import readings_answer

    def question() -> Answer:
        table = find_symbols(symbols)
        asked = read_places(words, table, find_profile(cpu))
        with open_client(given, table) as client:
            return readings_answer(given["port"], client.read(*asked))

    return ask(format_, "ppi values", words, question)
