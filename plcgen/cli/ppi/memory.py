"""``plcgen ppi backup``, ``restore`` and ``compare``: memory of an S7-200 as a file, and back."""

from __future__ import annotations

import time
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from plcgen.base.diagnostics import Diagnostic, DiagnosticError, Severity, Span
from plcgen.base.diagnostics.counting import quantity
from plcgen.cli.arguments import ARGUMENTS
from plcgen.cli.options import PATH, console, format_option, output_option, verb
from plcgen.cli.output import OK, PROBLEMS
from plcgen.cli.ppi.connection import ask, line_options, open_client
from plcgen.cli.ppi.places import find_profile, find_symbols, read_places, symbols_option

if TYPE_CHECKING:
    from plcgen.base.display.results import Answer
    from plcgen.base.display.view import View
    from plcgen.ppi.backup import Backup, Difference
    from plcgen.report.registry import OutputFormat

_SHOWN, _BYTES = 20, 8


@verb(
    "backup",
    "plcgen ppi backup VB0[10240] --output press.backup --port /dev/ttyUSB0",
    "plcgen ppi backup VB0[2048] MB0[32] --output pump3.backup --station 3 --port socket://10.0.0.5:4000",
)
@click.argument("words", nargs=-1, required=True, metavar="ADDRESS[N]...")
@line_options
@symbols_option
@output_option("--out")
def backup(*, words: tuple[str, ...], symbols: str | None, output: Path | None, **given: Any) -> int:
    """Read memory into a file with station, CPU type and time; restore and compare take it.

    The bytes come in several telegrams: while the CPU is in RUN, its program may change some of them in between. An
    existing file is never replaced without --force.
    """
    from plcgen.ppi.backup import back_up, require_bytes
    from plcgen.ppi.log.files import iso

    out = console()
    try:
        if output is not None:
            out.replaceable(output, fresh=True)
        asked = read_places(words, find_symbols(symbols), find_profile(None))
        require_bytes([place.item for place in asked])
        with open_client(given) as client, out.progress() as bar:
            found = back_up(client, [place.item for place in asked], iso(time.time()), bar or _silent)
    except DiagnosticError as problem:
        out.complain(problem.diagnostics, {ARGUMENTS: " ".join(words)})
        return PROBLEMS
    out.result(found.text(), output, ("# ", ""), fresh=True)
    return OK


@verb(
    "compare",
    "plcgen ppi compare press.backup --port /dev/ttyUSB0",
    "plcgen ppi compare press.backup --port COM3 --json",
)
@click.argument("file", type=PATH, metavar="FILE")
@line_options
@format_option("answer")
def compare(*, file: Path, format_: OutputFormat, **given: Any) -> int:
    """Compare the memory of a station with a backup; exit code 1 if it differs."""
    from plcgen.ppi.backup import compare as differences
    from plcgen.ppi.backup import load_backup, other_cpu

    def question() -> Answer:
        stored = load_backup(file)
        with open_client(given) as client, console().progress() as bar:
            told = other_cpu(client.info(), stored, given["port"], Severity.WARNING)
            return _answer("ppi compare", stored, differences(client, stored, bar or _silent), told, given["port"])

    return ask(format_, "ppi compare", (), question)


@verb(
    "restore",
    "plcgen ppi restore press.backup --port /dev/ttyUSB0 --yes-write",
)
@click.argument("file", type=PATH, metavar="FILE")
@click.option("--yes-write", is_flag=True, help="Write the memory; without this option it is only shown what would be.")
@line_options
@format_option("answer")
def restore(*, file: Path, yes_write: bool, format_: OutputFormat, **given: Any) -> int:
    """Write a backup into a station of the same CPU type, and read it back; only with --yes-write.

    It stops at the first refused item and says what is written already. Exit code 1 then, and if what is read back
    differs; 2 without --yes-write.
    """
    from plcgen.ppi.backup import load_backup
    from plcgen.ppi.backup import restore as write_back

    def question() -> Answer:
        stored = load_backup(file)
        if not yes_write:
            console().say(f"would be written to station {given['station']}: {_summary(stored)}")
            raise click.UsageError("nothing was written: restore needs --yes-write")
        with open_client(given) as client, console().progress() as bar:
            left = write_back(client, stored, bar or _silent)
        return _answer("ppi restore", stored, left, (), given["port"])

    return ask(format_, "ppi restore", (), question)


def _silent(_what: str, _done: int, _total: int) -> None:
    """Show no progress."""


def _summary(stored: Backup) -> str:
    where = ", ".join(piece.address for piece in stored.pieces)
    return f"{where} of {stored.cpu}, station {stored.station}, {stored.time}"


def _answer(kind: str, stored: Backup, found: Sequence[Difference], told: Sequence[Diagnostic], line: str) -> Answer:
    """What was compared and what differs, with one diagnostic for all of it."""
    from plcgen.base.display.data import diagnostics_data
    from plcgen.base.display.results import Answer

    diagnostics = list(told)
    if found:
        size = quantity(sum(len(each.now) for each in found), "byte")
        first, message = found[0].backup.address, f"{size} not as in the backup, the first at"
        help_ = "a CPU in RUN changes its memory itself" if kind == "ppi compare" else "does the program write there?"
        diagnostics.append(Diagnostic("PG727", f"{message} {first}", Span(line), help=help_))
    rows = [{"address": each.backup.address, "backup": _hex(each.backup.data), "now": _hex(each.now)} for each in found]
    data = {
        **diagnostics_data(kind, diagnostics),
        "station": stored.station,
        "cpu": stored.cpu,
        "time": stored.time,
        "memory": [piece.address for piece in stored.pieces],
        "differences": rows,
    }

    def text(view: View) -> str:
        from plcgen.base.display.table import text_table

        done = "written, and read back" if kind == "ppi restore" else "compared"
        shown = [(each.backup.address, _start(each.backup.data), _start(each.now)) for each in found[:_SHOWN]]
        lines = [f"{done}: {_summary(stored)}"]
        if shown:
            lines += text_table(("address", "backup", "now"), shown, limit=view.width)
        if len(found) > _SHOWN:
            lines.append(f"  ... {len(found) - _SHOWN} more places")
        return "\n".join(lines) + "\n"

    return Answer(data, text, diagnostics)


def _hex(data: bytes) -> str:
    return data.hex().upper()


def _start(data: bytes) -> str:
    return data[:_BYTES].hex(" ").upper() + (" ..." if len(data) > _BYTES else "")
