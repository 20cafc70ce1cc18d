"""Options of the verbs that talk to a station, and the client they make."""

from __future__ import annotations

import signal
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any, TypeVar

import click

from plcgen.base.diagnostics import DiagnosticError
from plcgen.cli.arguments import ARGUMENTS
from plcgen.cli.options import console

if TYPE_CHECKING:
    from plcgen.base.display.results import Answer
    from plcgen.ppi.client import Client
    from plcgen.ppi.symbols import SymbolTable
    from plcgen.report.registry import OutputFormat

Callback = TypeVar("Callback", bound=Callable[..., Any])


def line_options(verb: Callback) -> Callback:
    """Add ``--port``, ``--baud``, ``--station``, ``--source``, ``--timeout`` and ``--reference``."""
    options = (
        click.option(
            "--port",
            required=True,
            envvar="PLCGEN_PORT",
            metavar="PORT",
            help="/dev/ttyUSB0, COM3, socket://HOST:PORT, rfc2217://HOST:PORT, s7://HOST (Ethernet); or PLCGEN_PORT.",
        ),
        click.option(
            "--baud",
            type=click.IntRange(300),
            default=9600,
            metavar="RATE",
            help="Speed of a serial port.  [default: 9600]",
        ),
        click.option(
            "--station", type=click.IntRange(0, 126), default=2, metavar="N", help="Station of the PLC.  [default: 2]"
        ),
        click.option(
            "--source", type=click.IntRange(0, 126), default=0, metavar="N", help="Our own station.  [default: 0]"
        ),
        click.option(
            "--timeout",
            type=click.FloatRange(0.01, 60),
            default=0.4,
            metavar="SECONDS",
            help="How long to wait for the beginning of an answer.  [default: 0.4]",
        ),
        click.option(
            "--reference",
            type=click.Choice(["check", "ignore"]),
            default="check",
            help="Whether answers must repeat the reference of a request; many gateways do not.  [default: check]",
        ),
    )
    for option in reversed(options):
        verb = option(verb)
    return verb


def open_client(given: dict[str, Any], symbols: SymbolTable | None = None) -> Client:
    """Open the line of ``line_options``. Raises LineError; UsageError if both stations are the same."""
    return open_clients(given, [given["station"]], symbols)[given["station"]]


def open_clients(
    given: dict[str, Any], stations: Sequence[int], symbols: SymbolTable | None = None
) -> dict[int, Client]:
    """Open the line for several stations on it, see ``open_client``; whoever closes one of them closes the line."""
    from plcgen.base.line.opening import open_line
    from plcgen.ppi.client import Client, Settings

    if given["source"] in stations:
        raise click.UsageError(f"--station and --source are both {given['source']}")
    if given["port"].lower().startswith("s7://"):
        if len(stations) > 1:
            raise click.UsageError("s7:// reaches one PLC: --station and several stations belong to PPI")
        from plcgen.ppi.client.iso import open_iso

        client = open_iso(given["port"], Settings(stations[0], given["source"], answer=max(given["timeout"], 2.0)))
        client.symbols = symbols
        return {stations[0]: client}
    line = open_line(given["port"], given["baud"])
    clients = {}
    for station in stations:
        more = {"answer": given["timeout"], "reference": given["reference"]}
        clients[station] = Client(line, Settings(station, given["source"], **more), symbols=symbols)
        clients[station].exchange.notice = console().say
    return clients


@contextmanager
def until_signal() -> Iterator[Callable[[], bool]]:
    """Tell whether SIGINT or SIGTERM asked for the end; a second one ends at once."""
    ended = False

    def end(number: int, _frame: Any) -> None:
        nonlocal ended
        if ended:
            raise KeyboardInterrupt
        ended = bool(number)

    before = {number: signal.signal(number, end) for number in (signal.SIGINT, signal.SIGTERM)}
    try:
        yield lambda: ended
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


def station_answer(kind: str, text: str, /, **data: Any) -> Answer:
    """What a station said in one line."""
    from plcgen.base.display.data import diagnostics_data
    from plcgen.base.display.results import Answer

    return Answer({**diagnostics_data(kind, ()), **data}, lambda _view: f"station {data['station']}: {text}\n")


def failure(kind: str, problem: DiagnosticError) -> Answer:
    """What kept a verb from its result."""
    from plcgen.base.display.data import diagnostics_data
    from plcgen.base.display.results import Answer

    return Answer(diagnostics_data(kind, problem.diagnostics), lambda _view: "", problem.diagnostics)


def ask(format_: OutputFormat, kind: str, words: Sequence[str], question: Callable[[], Answer]) -> int:
    """Deliver the answer to a question, or what kept the verb from it as an answer of this kind."""
    try:
        found = question()
    except DiagnosticError as problem:
        found = failure(kind, problem)
    return console().answer(format_, found, known={ARGUMENTS: " ".join(words)})
