"""``plcgen ppi migrate``: the symbols of an S7-200 as sources of an S7-1200."""

from __future__ import annotations

from collections import Counter
from pathlib import Path
from typing import TYPE_CHECKING

import click

from plcgen.base.diagnostics.counting import quantity
from plcgen.cli.options import PATH, console, force_option, format_option, verb
from plcgen.cli.ppi.connection import ask

if TYPE_CHECKING:
    from plcgen.base.display.results import Answer
    from plcgen.base.display.view import View
    from plcgen.ppi.migration import Migration
    from plcgen.report.registry import OutputFormat

_SHOWN = 20
_KEYS = ("symbol", "address", "type", "way", "read", "write", "note")


@verb(
    "migrate",
    "plcgen ppi migrate press.csv",
    "plcgen ppi migrate press.csv --types types.csv --out press_s7-1200 --json",
)
@click.argument("table", type=PATH, metavar="FILE")
@click.option(
    "--types",
    type=PATH,
    metavar="FILE",
    help="Types of symbols as CSV: Symbol, Type (INT, DINT, REAL ...).",
)
@click.option(
    "--out", "folder", type=PATH, metavar="DIR", help="Output folder.  [default: <FILE>_s7-1200 beside the file]"
)
@force_option("Overwrite files that exist.")
@format_option("answer")
def command(*, table: Path, types: Path | None, folder: Path | None, format_: OutputFormat) -> int:
    """Turn a symbol table of Micro/WIN into a data block with the offsets of V, and a tag table for M, I and Q.

    Symbols of V that overlap or lie at odd addresses become parts of others, or bytes with functions that read and
    write them. MIGRATION.csv says of each symbol where it is, and why it is not where it was. Either all files are
    written or none.
    """
    from plcgen.build.writing import add_files
    from plcgen.ppi.migration import files, load_types, migrate
    from plcgen.ppi.symbols import load_symbols

    target = folder or table.with_name(f"{table.stem}_s7-1200")

    def question() -> Answer:
        symbols = load_symbols(table)
        plan = migrate(symbols, str(table), load_types(types, symbols) if types else {})
        return _answer(plan, target, add_files(list(files(plan)), target, force=console().force).written)

    return ask(format_, "ppi migrate", (), question)


def _answer(plan: Migration, target: Path, written: tuple[str, ...]) -> Answer:
    from plcgen.base.display.data import diagnostics_data
    from plcgen.base.display.results import Answer
    from plcgen.ppi.migration import LIST, row

    rows = [row(each) for each in plan.symbols]
    ways = Counter(each.way for each in plan.symbols)
    data = {
        **diagnostics_data("ppi migrate", ()),
        "folder": target.as_posix(),
        "written": list(written),
        "symbols": [dict(zip(_KEYS, cells, strict=True)) for cells in rows],
    }

    def text(view: View) -> str:
        from plcgen.base.display.table import text_table

        counts = (
            quantity(ways["member"], "member of V", "members of V"),
            quantity(ways["part"], "part of a member", "parts of members"),
            f"{ways['bytes']} in bytes",
            quantity(ways["tag"], "tag"),
        )
        said = ", ".join(counts)
        lines = [f"{target}: {said}, {ways['none']} not migrated"]
        noted = [(name, address, way, note) for name, address, _, way, _, _, note in rows if note]
        if noted:
            lines += text_table(("symbol", "S7-200", "way", "note"), noted[:_SHOWN], limit=view.width)
        if len(noted) > _SHOWN:
            lines.append(f"  ... {len(noted) - _SHOWN} more in {LIST}")
        return "\n".join(lines) + "\n"

    return Answer(data, text)
