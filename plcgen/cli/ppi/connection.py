"""Options of the verbs that talk to a station, and the client they make."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any, TypeVar

import click

from plcgen.cli.arguments import ARGUMENTS
from plcgen.cli.output import PROBLEMS, Console
from plcgen.diagnostics import Diagnostic

if TYPE_CHECKING:
    from plcgen.protocols.ppi.client import Client
    from plcgen.protocols.ppi.symbols import SymbolTable

Callback = TypeVar("Callback", bound=Callable[..., Any])


def line_options(verb: Callback) -> Callback:
    """Add ``--port``, ``--baud``, ``--station``, ``--source`` and ``--timeout``."""
    options = (
        click.option(
            "--port",
            required=True,
            envvar="PLCGEN_PORT",
            metavar="PORT",
            help="/dev/ttyUSB0, COM3, a pseudo terminal or socket://HOST:PORT; or PLCGEN_PORT.",
        ),
        click.option(
            "--baud",
            type=click.IntRange(300),
            default=9600,
            metavar="RATE",
            help="Speed of a serial port.  [default: 9600]",
        ),
        click.option("--station", type=click.IntRange(0, 126), default=2, metavar="N", help="The PLC.  [default: 2]"),
        click.option("--source", type=click.IntRange(0, 126), default=0, metavar="N", help="Ourselves.  [default: 0]"),
        click.option(
            "--timeout",
            type=click.FloatRange(0.01, 60),
            default=0.4,
            metavar="SECONDS",
            help="Wait for the beginning of an answer.  [default: 0.4]",
        ),
    )
    for option in reversed(options):
        verb = option(verb)
    return verb


def open_client(ctx: click.Context, given: dict[str, Any], symbols: SymbolTable | None = None) -> Client:
    """Open the line of ``line_options``. Raises LineError; UsageError if both stations are the same."""
    from plcgen.protocols.ppi.client import Client, Settings

    station, source = given["station"], given["source"]
    if station == source:
        raise click.UsageError(f"--station and --source are both {station}", ctx)
    settings = Settings(station=station, own=source, answer=given["timeout"])
    return Client.open(given["port"], rate=given["baud"], settings=settings, symbols=symbols)


def failed(out: Console, kind: str, found: Sequence[Diagnostic], words: Sequence[str] = (), *, as_json: bool) -> int:
    """Show what kept a verb from its result, in the form asked for, and return its exit code."""
    if as_json:
        from plcgen.output.json import diagnostics_data, dump

        out.result(dump(diagnostics_data(kind, found)))
    else:
        out.complain(found, {ARGUMENTS: " ".join(words)})
    return PROBLEMS
