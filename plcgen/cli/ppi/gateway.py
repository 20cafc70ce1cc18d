"""``plcgen ppi gateway``: an ISO-on-TCP server in front of a PPI line."""

from __future__ import annotations

import json
import time
from typing import TYPE_CHECKING, Any

import click

from plcgen.base.diagnostics import Diagnostic, DiagnosticError, Span
from plcgen.cli.options import console, stream_option, verb
from plcgen.cli.output import OK, PROBLEMS, Console
from plcgen.cli.ppi.connection import line_options, open_client, until_signal

if TYPE_CHECKING:
    from plcgen.base.line.tcp import TcpServer

_RIGHT = (
    "ports below 1024 need a right: on Linux run as root, give Python cap_net_bind_service, or set "
    "net.ipv4.ip_unprivileged_port_start=102; or use a port like --tcp 10102, if your client can name one"
)


@verb(
    "gateway",
    "plcgen ppi gateway --port /dev/ttyUSB0                        127.0.0.1, port 102, read-only",
    "plcgen ppi gateway --tcp 10102 --station 3 --port COM3",
    "plcgen ppi gateway --tcp 192.168.1.10:102 --allow-write VB100[20] --allow-write M --port /dev/ttyUSB0",
)
@click.option(
    "--tcp",
    default="102",
    metavar="[HOST:]PORT",
    help="Where to listen; without a host on this machine only.  [default: 102]",
)
@click.option(
    "--allow-write",
    "writable",
    multiple=True,
    metavar="AREA[..]",
    help="Pass writes on to this area, or to this address in it; without it, nothing can be written.",
)
@click.option(
    "--idle",
    type=click.FloatRange(1),
    default=600.0,
    metavar="SECONDS",
    help="End a connection that is silent for this long.  [default: 600]",
)
@line_options
@stream_option
def command(*, tcp: str, writable: tuple[str, ...], idle: float, as_json: bool, **given: Any) -> int:
    """Let S7 clients (snap7, Node-RED, libnodave, HMIs) reach an S7-200 over TCP until Ctrl-C.

    V is data block 1. Reads are passed on, writes only where --allow-write says so, and each is logged; RUN, STOP,
    forcing and everything else never. Nothing is encrypted, and nobody is asked who he is: whoever reaches the port
    reads.
    """
    from plcgen.ppi.gateway import Allowed, Gateway, Passing
    from plcgen.ppi.wire.address import PpiAddressError

    out = console()
    show = _Show(out, as_json=as_json)
    try:
        allowed = Allowed.of(writable)
        open_client(given).close()
        server = _listen(tcp if ":" in tcp else f"127.0.0.1:{tcp}")
    except PpiAddressError as problem:
        out.complain([Diagnostic(problem.code, problem.message, Span("--allow-write"), help=problem.help)])
        return PROBLEMS
    except DiagnosticError as problem:
        out.complain(problem.diagnostics)
        return PROBLEMS
    with until_signal() as ended:
        show.opened(server.name.replace("socket://", "s7://"), writable)
        passing = Passing(lambda: open_client(given), allowed, show.wrote, time.monotonic)
        try:
            Gateway(server, passing, show.tell, idle=idle).serve(ended)
        finally:
            server.close()
    return OK


def _listen(address: str) -> TcpServer:
    from plcgen.base.line.model import LineError
    from plcgen.base.line.tcp import TcpServer

    try:
        return TcpServer(address)
    except LineError as problem:
        if isinstance(problem.__cause__, PermissionError):
            raise LineError("PG720", address, "no permission to use the port", _RIGHT) from problem
        raise


class _Show:
    """What the verb says: its address and every write on stdout, who comes and goes as chatter."""

    def __init__(self, out: Console, *, as_json: bool) -> None:
        self.out, self.as_json = out, as_json

    def opened(self, name: str, writable: tuple[str, ...]) -> None:
        """The address, which a program may wait for."""
        self.out.result(json.dumps({"event": "open", "line": name}) + "\n" if self.as_json else f"{name}\n")
        self.out.say(f"writes are passed on to {', '.join(writable)}" if writable else "read-only")
        if not name.startswith(("s7://127.", "s7://[::1]")):
            self.out.say("other machines reach it: nothing is encrypted, and nobody is asked who he is")
        self.out.say("Ctrl-C ends")

    def wrote(self, who: str, what: str, result: str) -> None:
        """One write, passed on or not."""
        from plcgen.ppi.log.files import iso

        now = iso(time.time())
        who = who.removeprefix("socket://")
        row = {"event": "write", "time": now, "client": who, "write": what, "result": result}
        self.out.result(json.dumps(row) + "\n" if self.as_json else f"{now}  {who}  {what}  {result}\n")

    def tell(self, text: str) -> None:
        """Somebody came or went."""
        self.out.say(text)
