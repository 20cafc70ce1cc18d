"""``plcgen ppi monitor``: values again and again, as a live table or line by line."""

from __future__ import annotations

import shutil
import sys
import time
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import click

from plcgen.base.diagnostics import Diagnostic, DiagnosticError
from plcgen.cli.arguments import ARGUMENTS
from plcgen.cli.options import console, stream_option, verb
from plcgen.cli.output import OK, PROBLEMS, Console, is_terminal
from plcgen.cli.ppi.connection import failure, line_options, open_client
from plcgen.cli.ppi.places import cpu_option, symbols_option

if TYPE_CHECKING:
    from plcgen.ppi.client import Client, Reading
    from plcgen.ppi.client.values import Place


@verb(
    "monitor",
    "plcgen ppi monitor VW100 M0.0 T32 --port /dev/ttyUSB0",
    "plcgen ppi monitor level:REAL --symbols press.csv --interval 0.2 --port COM3",
    "plcgen ppi monitor VB0 --count 10 --json --port socket://10.0.0.5:4000 > log.jsonl",
)
@click.argument("words", nargs=-1, required=True, metavar="ADDRESS...")
@click.option(
    "--interval",
    type=click.FloatRange(0, 3600),
    default=1.0,
    metavar="SECONDS",
    help="Time from one read to the next.  [default: 1]",
)
@click.option("--count", type=click.IntRange(1), metavar="N", help="End after N reads.  [default: at Ctrl-C]")
@line_options
@cpu_option
@symbols_option
@stream_option
def command(
    *,
    words: tuple[str, ...],
    cpu: str | None,
    symbols: str | None,
    interval: float,
    count: int | None,
    as_json: bool,
    **given: Any,
) -> int:
    """Read values again and again: a live table on a terminal, otherwise a line (with --json an object) for each read.

    A station that does not answer is asked again; a lost line ends the command. Exit code 1 if the last read failed.
    """
    from plcgen.cli.ppi.places import find_profile, find_symbols, read_places
    from plcgen.report.formats import json, text

    try:
        table = find_symbols(symbols)
        asked = read_places(words, table, find_profile(cpu))
        with open_client(given, table) as client:
            return _watch(console(), client, asked, (interval, count), as_json=as_json)
    except DiagnosticError as problem:
        known = {ARGUMENTS: " ".join(words)}
        return console().answer(json.FORMAT if as_json else text.FORMAT, failure("ppi monitor", problem), known=known)


def _watch(
    out: Console, client: Client, asked: Sequence[Place], how: tuple[float, int | None], *, as_json: bool
) -> int:
    from plcgen.ppi.client import ClientError

    interval, count = how
    screen = _Screen(out, as_json=as_json)
    good, number = True, 0
    due = time.monotonic()
    try:
        while count is None or number < count:
            if number:
                due = max(due + interval, time.monotonic())
                time.sleep(max(0.0, due - time.monotonic()))
            number += 1
            try:
                readings = client.read(*asked)
            except ClientError as problem:
                good = False
                screen.missed(problem.diagnostics)
            else:
                good = all(reading.ok for reading in readings)
                screen.show(readings)
    except KeyboardInterrupt:
        screen.end()
    return OK if good else PROBLEMS


class _Screen:
    """Where the readings go: redrawn in place on a terminal, otherwise one line each."""

    def __init__(self, out: Console, *, as_json: bool) -> None:
        self.out, self.as_json = out, as_json
        self.live = is_terminal(sys.stdout) and not as_json
        self._drawn = 0
        self._before: tuple[Reading, ...] = ()

    def show(self, readings: tuple[Reading, ...]) -> None:
        """Show one read."""
        from plcgen.ppi.client.texts import reading_line, readings_row, readings_table

        clock = _clock()
        if self.as_json:
            self.out.result(readings_row(clock, readings))
        elif self.live:
            lines = readings_table(readings, self._before, self.out.view())
            self._draw([*lines, clock])
        else:
            self.out.result(f"{clock}  {reading_line(readings)}\n")
        self._before = readings

    def missed(self, found: Sequence[Diagnostic]) -> None:
        """Show that a read failed; the values before stay on the screen."""
        from plcgen.ppi.client.texts import readings_row, readings_table

        if self.as_json:
            self.out.result(readings_row(_clock(), (), found))
        elif self.live:
            text = "; ".join(f"{diagnostic.code} {diagnostic.message}" for diagnostic in found)
            self._draw([*readings_table(self._before, (), self.out.view()), f"{_clock()}  {text}"])
        else:
            self.out.complain(found)

    def _draw(self, lines: list[str]) -> None:
        room = shutil.get_terminal_size().lines - 1
        if len(lines) > room > 2:  # what has left the screen at the top could not be drawn over
            lines = [*lines[: room - 2], f"  ... {len(lines) - room + 1} more", lines[-1]]
        up = f"\x1b[{self._drawn}F\x1b[J" if self._drawn else ""
        self.out.result(up + "\n".join(lines) + "\n")
        self._drawn = sum(line.count("\n") + 1 for line in lines)

    def end(self) -> None:
        """Leave the last table where it is."""
        if self.live:
            self.out.say("")


def _clock() -> str:
    now = time.time()
    return time.strftime("%H:%M:%S", time.localtime(now)) + f".{int(now * 1000) % 1000:03d}"
