"""``plcgen live device``: be a drive on PROFINET, for records alone."""

from __future__ import annotations

import signal
import socket
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from plcgen.base.diagnostics.counting import quantity
from plcgen.cli.options import PATH, console, device_option, verb
from plcgen.cli.output import OK

if TYPE_CHECKING:
    from plcgen.ds47.sim.drive import Drive


@verb(
    "device",
    "plcgen live device drive.yaml --pn 127.0.0.1",
    "plcgen live device --device sinamics-s120 --pn 127.0.0.1:34964",
)
@click.argument("file", type=PATH, required=False, metavar="[FILE]")
@device_option("Simulate a drive object with all parameters of this device instead of a file.")
@click.option("--do", "number", type=click.IntRange(0, 255), metavar="N", help="Drive object of --device.")
@click.option(
    "--pn", "address", required=True, metavar="IP[:PORT]", help="Own address; port 34964, or 0 for any free one."
)
@click.option("--slot", default="1.1", metavar="SLOT.SUBSLOT", help="Parameter access point.  [default: 1.1]")
def command(*, file: Path | None, device: str | None, number: int | None, address: str, slot: str) -> int:
    """Simulate a drive on PROFINET until Ctrl-C: application relations with device access, and records in them.

    There is no cyclic data, no alarm and no DCP: a controller cannot use it. The first line of the output is the
    address for --port.
    """
    from plcgen.cli.live.places import PN, read_station
    from plcgen.ds47.sim.pn_device import PnDevice, serve_udp

    if (file is None) == (device is None):
        raise click.UsageError("give a drive file or --device")
    host, _, port = address.partition(":")
    any_port = port == "0"
    station = read_station(f"{PN}{host}{':' + port if port and not any_port else ''}/{slot}", "--pn")
    out = console()
    ended: list[int] = []
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as where:
        try:
            where.bind((station.host, 0 if any_port else station.port))
        except OSError as problem:
            raise click.UsageError(f"cannot listen on {address}: {problem.strerror}") from problem
        served = PnDevice(_drive(file, device, number), (station.slot, station.subslot), port=where.getsockname()[1])
        before = {one: signal.signal(one, _noted(ended)) for one in (signal.SIGINT, signal.SIGTERM)}
        try:
            out.result(f"{PN}{station.host}:{served.port}/{station.slot}.{station.subslot}\n")
            out.say("Ctrl-C ends")
            serve_udp(served, where, lambda: bool(ended))
        finally:
            for one, handler in before.items():
                signal.signal(one, handler)
    out.say(f"ended after {quantity(sum(served.done.values()), 'call')}")
    return OK


def _noted(ended: list[int]) -> Any:
    """A handler that remembers the signal; a second one ends at once."""

    def handler(number: int, _frame: Any) -> None:
        if ended:
            raise KeyboardInterrupt
        ended.append(number)

    return handler


def _drive(file: Path | None, device: str | None, number: int | None) -> Drive:
    from plcgen.base.files.text import read_text
    from plcgen.ds47.devices import find_device
    from plcgen.ds47.sim.listed import listed_drive
    from plcgen.ds47.sim.load import load_drive

    if file is not None:
        return load_drive(read_text(file), str(file))
    known = find_device(device or "")
    object_ = known.drive_object if number is None else number
    return listed_drive(known, object_, known.object_type(object_))
