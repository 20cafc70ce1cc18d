"""``plcgen ppi log``: values of stations kept in a file."""

from __future__ import annotations

import math
import os
import re
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from plcgen.base.diagnostics import DiagnosticError
from plcgen.cli.arguments import ARGUMENTS
from plcgen.cli.options import PATH, console, verb
from plcgen.cli.output import OK, PROBLEMS
from plcgen.cli.ppi.connection import line_options, open_clients, until_signal
from plcgen.cli.ppi.places import cpu_option, find_profile, find_symbols, read_places, symbols_option

if TYPE_CHECKING:
    from plcgen.ppi.log.files import Channel, Rotation

_STATION = re.compile(r"\s*([0-9]{1,3}):(.*)", re.DOTALL)
_SIZE = re.compile(r"([0-9]{1,6})(kB|MB|GB)", re.IGNORECASE)
_UNITS = {"kb": 10**3, "mb": 10**6, "gb": 10**9}


@verb(
    "log",
    "plcgen ppi log VW100 M0.0 --out press.csv --port /dev/ttyUSB0",
    "plcgen ppi log 2:VD200:REAL 3:VW10 --out plant.sqlite --interval 5 --port COM3",
    "plcgen ppi log level:REAL --symbols press.csv --changes --deadband 0.5 --out level.jsonl --port COM3",
    "plcgen ppi log VW100 --out press.csv --rotate day --keep 30 --port socket://10.0.0.5:4000",
    "plcgen ppi log VW100 M0.0 --out press.csv --mqtt mqtt://10.0.0.6/plant/press --port COM3",
)
@click.argument("words", nargs=-1, required=True, metavar="[STATION:]ADDRESS...")
@click.option(
    "--out", "file", type=PATH, required=True, metavar="FILE", help="Append to FILE: .csv, .jsonl or .sqlite."
)
@click.option(
    "--interval",
    type=click.FloatRange(0.01, 86400),
    default=1.0,
    metavar="SECONDS",
    help="Time from one read to the next.  [default: 1]",
)
@click.option("--changes", is_flag=True, help="Write a row only when a value or the state of a station has changed.")
@click.option(
    "--deadband",
    "deadbands",
    multiple=True,
    metavar="[ADDRESS=]NUMBER",
    help="With --changes: a number counts as changed when it differs by more than this from the last row.",
)
@click.option(
    "--heartbeat",
    type=click.FloatRange(0.1, 86400),
    default=60.0,
    metavar="SECONDS",
    help="With --changes: write a row at least this often.  [default: 60]",
)
@click.option("--rotate", metavar="WHEN", help="Begin a new file every hour, every day, or from a size on: 100MB.")
@click.option("--keep", type=click.IntRange(1), metavar="N", help="With --rotate: remove all but N old files.")
@click.option(
    "--mqtt",
    metavar="URL",
    help="Publish each changed value, too: mqtt://[USER@]HOST[:PORT]/TOPIC, or mqtts://; password in "
    "PLCGEN_MQTT_PASSWORD.",
)
@click.option("--count", type=click.IntRange(1), metavar="N", help="End after N reads.  [default: at Ctrl-C]")
@line_options
@cpu_option
@symbols_option
def command(*, words: tuple[str, ...], file: Path, deadbands: tuple[str, ...], **given: Any) -> int:
    """Keep values of one or several stations in a file until Ctrl-C or SIGTERM.

    One row per read, or per change with --changes: time, state, since when it is bad and why, a column per value. What
    is lost, station, line or room on the disk, is tried again forever, and gaps are marked. Exit code 1 if the last
    read failed or rows could not be written.
    """
    from plcgen.ppi.log.files import Channel, Keeper, iso, opener, require_columns
    from plcgen.ppi.log.logger import Clock, Logger, Pace, Stations
    from plcgen.ppi.log.mqtt import Publisher, Target, paho_client

    out, rotation = console(), _rotation(given["rotate"], given["keep"])
    numbers, plain = _stations(words, given["station"])
    try:
        places = read_places(plain, find_symbols(given["symbols"]), find_profile(given["cpu"]))
        rows = zip(numbers, places, words, strict=True)
        channels = _with_deadbands([Channel(station, place, word.strip()) for station, place, word in rows], deadbands)
        require_columns(channels, ARGUMENTS)
        target = Target.of(given["mqtt"]) if given["mqtt"] else None
        broker = paho_client(target, os.environ) if target else None
        keeper = Keeper(file, opener(file, channels), iso, out.say, rotation)
    except DiagnosticError as problem:
        out.complain(problem.diagnostics, {ARGUMENTS: " ".join(plain)})
        return PROBLEMS
    clock = Clock()
    stations = Stations(lambda numbers: open_clients(given, numbers), channels, clock.now)
    pace = Pace(given["interval"], given["changes"], given["heartbeat"])
    with until_signal() as ended:
        out.say(f"logging {len(channels)} values to {file}; Ctrl-C ends")
        if target:
            publisher = Publisher(target, channels, broker, iso, out.say)
            logger = Logger(channels, stations, keeper, pace, clock, out.say, publisher.add)
            good = logger.run(ended, given["count"]) & publisher.close()
        else:
            good = Logger(channels, stations, keeper, pace, clock, out.say).run(ended, given["count"])
    if keeper.waiting:
        from plcgen.ppi.log.files import json_lines

        out.result(json_lines(channels, keeper.waiting))
    return OK if good else PROBLEMS


def _stations(words: Sequence[str], usual: int) -> tuple[list[int], list[str]]:
    """Split ``3:VW100`` into station and address; what has none is of the usual station."""
    found = [_STATION.fullmatch(word) for word in words]
    stations = [int(match[1]) if match else usual for match in found]
    for station in stations:
        if station > 126:
            raise click.UsageError(f"a station is 0 to 126, not {station}")
    return stations, [match[2] if match else word for match, word in zip(found, words, strict=True)]


def _with_deadbands(channels: Sequence[Channel], texts: Sequence[str]) -> list[Channel]:
    """Give channels their deadbands; one without a name is for all that have none of their own."""
    from dataclasses import replace

    bands: dict[str, float] = {}
    for text in texts:
        name, _, number = text.rpartition("=")
        try:
            value = float(number)
        except ValueError:
            value = math.nan
        if not 0 <= value < math.inf:
            raise click.UsageError(f"--deadband {text}: a number from 0 on, or ADDRESS=NUMBER")
        bands[name.strip().casefold()] = value
    unknown = bands.keys() - {channel.name.casefold() for channel in channels} - {""}
    if unknown:
        raise click.UsageError(f"--deadband: {min(unknown)} is not logged")
    usual = bands.get("", 0.0)
    return [replace(channel, deadband=bands.get(channel.name.casefold(), usual)) for channel in channels]


def _rotation(text: str | None, keep: int | None) -> Rotation:
    from plcgen.ppi.log.files import Rotation

    if text is None:
        if keep is not None:
            raise click.UsageError("--keep needs --rotate")
        return Rotation()
    if text == "hour":
        return Rotation("hour", keep=keep)
    if text == "day":
        return Rotation("day", keep=keep)
    size = _SIZE.fullmatch(text)
    if size is None or not int(size[1]):
        raise click.UsageError(f"--rotate {text}: hour, day, or a size: 500kB, 100MB, 1GB")
    return Rotation(size=int(size[1]) * _UNITS[size[2].lower()], keep=keep)
