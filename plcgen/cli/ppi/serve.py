"""``plcgen ppi serve``: be an S7-200."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from plcgen.base.diagnostics.counting import quantity
from plcgen.cli.options import PATH, console, stream_option, verb
from plcgen.cli.output import OK, Console
from plcgen.cli.ppi.connection import until_signal
from plcgen.cli.ppi.places import find_symbols, symbols_option

if TYPE_CHECKING:
    from plcgen.base.line.model import Line
    from plcgen.base.line.tcp import TcpServer
    from plcgen.ppi.sim import Bus, Traffic


@verb(
    "serve",
    "plcgen ppi serve                                  a CPU 224 on a pseudo terminal",
    "plcgen ppi serve --cpu 226 --set VW100=1234 --log",
    "plcgen ppi serve --values plant.yaml --tcp 0.0.0.0:4000",
    "plcgen ppi serve --port /dev/ttyUSB0 --baud 19200",
    "plcgen ppi serve --fault not_ready:times=always --fault fcs:after=3",
)
@click.option("--values", "file", type=PATH, metavar="FILE", help="Stations, values and faults from a YAML file.")
@click.option("--cpu", metavar="CPU", help="221, 222, 224R1, 224, 224XP, 226, ST20 or ST40.  [default: 224]")
@click.option("--station", type=click.IntRange(0, 126), metavar="N", help="Address of the station.  [default: 2]")
@click.option("--set", "sets", multiple=True, metavar="ADDRESS=VALUE", help="Give an address or symbol a value.")
@symbols_option
@click.option(
    "--tcp", metavar="HOST:PORT", help="Listen for connections, as a serial server does; port 0 means any free port."
)
@click.option("--port", metavar="DEVICE", help="Use a serial port instead of a pseudo terminal.")
@click.option(
    "--baud", type=click.IntRange(300), default=9600, metavar="RATE", help="Speed of --port.  [default: 9600]"
)
@click.option(
    "--idle",
    type=click.FloatRange(0),
    default=600.0,
    metavar="SECONDS",
    help="End a connection that is silent for this long; 0: never.  [default: 600]",
)
@click.option("--fault", "faults", multiple=True, metavar="KIND[:KEY=VALUE,...]", help="Inject a fault on the line.")
@click.option("--log", is_flag=True, help="Show every frame, decoded.")
@stream_option
def command(*, as_json: bool, log: bool, baud: int, idle: float, **given: Any) -> int:
    """Simulate one or more S7-200 stations until Ctrl-C.

    The first line of the output is the name of the line to open: a pseudo terminal, unless --tcp or --port is given.
    """
    if given["tcp"] is not None and given["port"] is not None:
        raise click.UsageError("--tcp and --port cannot be used together: a station has one line")
    out = console()
    bus = _bus(given["file"], given["cpu"], given["station"], given["symbols"], given["sets"], given["faults"])
    line = _line(given["tcp"], given["port"], baud)
    show = _Show(out, as_json=as_json, log=log)
    bus.listener = show.frame
    try:
        _serve(bus, line, show, idle)
    finally:
        line.close()
    show.ended(bus)
    return OK


def _bus(
    file: Path | None,
    cpu: str | None,
    address: int | None,
    table: str | None,
    sets: Sequence[str],
    faults: Sequence[str],
) -> Bus:
    """Everything that was told about the stations, with all mistakes at once."""
    from plcgen.base.diagnostics import DiagnosticError, Report
    from plcgen.base.files.text import read_text
    from plcgen.ppi.sim.bus import Bus
    from plcgen.ppi.sim.faults import parse_fault
    from plcgen.ppi.sim.load import load_bus, set_address
    from plcgen.ppi.wire.address import address_text

    report = Report()
    bus = Bus()
    with report.catch():
        found = find_symbols(table)
        symbols = {} if found is None else {entry.name: address_text(entry.item) for entry in found.symbols}
        text = "{}" if file is None else read_text(file)
        bus = load_bus(text, "--cpu" if file is None else str(file), cpu, address, symbols)
    for text in faults:
        with report.catch():
            bus.faults.append(parse_fault(text))
    for text in sets if bus.stations else ():
        with report.catch():
            set_address(bus, text)
    if report.diagnostics:
        raise DiagnosticError(report.diagnostics)
    return bus


def _line(tcp: str | None, port: str | None, baud: int) -> Line | TcpServer:
    if tcp is not None:
        from plcgen.base.line.tcp import TcpServer

        return TcpServer(tcp)
    if port is not None:
        from plcgen.base.line.serial import SerialLine

        return SerialLine(port, baud)
    from plcgen.base.line.pty import PtyLine

    return PtyLine()


def _serve(bus: Bus, line: Line | TcpServer, show: _Show, idle: float) -> None:
    """Serve until SIGINT or SIGTERM; a second signal ends at once."""
    from plcgen.base.line.tcp import TcpServer
    from plcgen.ppi.sim.serve import serve_line, serve_tcp

    with until_signal() as ended:
        show.opened(bus, line)
        if isinstance(line, TcpServer):
            serve_tcp(bus, line, ended, tell=show.tell, idle=idle)
        else:
            serve_line(bus, line, ended)


class _Show:
    """What the verb says: the name of the line, frames if wanted, and chatter."""

    def __init__(self, out: Console, *, as_json: bool, log: bool) -> None:
        from plcgen.ppi.texts import TrafficText

        self.out, self.as_json, self.log = out, as_json, log
        self.text = TrafficText()

    def opened(self, bus: Bus, line: Line | TcpServer) -> None:
        if self.as_json:
            stations = [
                {"address": station.address, "cpu": station.cpu.memory.profile.title, "mode": station.mode.value}
                for station in bus.stations.values()
            ]
            self._json({"event": "open", "line": line.name, "stations": stations})
        else:
            self.out.result(f"{line.name}\n")
        for station in bus.stations.values():
            what = f"{station.cpu.memory.profile.title}, station {station.address}, {station.mode.value.upper()}"
            self.out.say(f"{what}, on {line.name}")
        self.out.say("Ctrl-C ends")

    def frame(self, entry: Traffic) -> None:
        if self.as_json:
            self._json(self.text.data(entry))
        elif self.log:
            self.out.result(self.text.line(entry, self.out.view()) + "\n")

    def tell(self, text: str) -> None:
        if self.as_json:
            self._json({"event": "connection", "text": text})
        else:
            self.out.say(text)

    def ended(self, bus: Bus) -> None:
        executed = sum(station.executed for station in bus.stations.values())
        if self.as_json:
            self._json({"event": "end", "requests": executed})
        else:
            self.out.say(f"ended after {quantity(executed, 'request')}")

    def _json(self, data: dict[str, Any]) -> None:
        self.out.result(json.dumps(data) + "\n")
