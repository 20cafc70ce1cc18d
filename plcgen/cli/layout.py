"""``plcgen layout``: where every byte lies."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from plcgen.base.diagnostics.counting import quantity
from plcgen.cli.options import PATH, console, format_option, output_option, verb
from plcgen.cli.output import OK, PROBLEMS
from plcgen.s7.types.system import FAMILIES

if TYPE_CHECKING:
    from plcgen.api import Family
    from plcgen.report.registry import OutputFormat


@verb(
    "layout",
    "plcgen layout job.yaml",
    "plcgen layout old_project.awl types.udt --block DB3",
    "plcgen layout exported_project/ --format csv --out layout.csv",
    "plcgen layout exported_project/ --format html --out layout.html",
)
@click.argument("paths", nargs=-1, required=True, type=PATH, metavar="SPEC|FILE|FOLDER...")
@format_option("layout")
@click.option("--block", default="", metavar="NAME", help="Only this block: its name, or DB3, UDT5, FB7.")
@click.option("--expand", is_flag=True, help="Show every element of every array, not only the first.")
@click.option(
    "--family",
    type=click.Choice(FAMILIES),
    metavar="FAMILY",
    help="CPU family whose WRREC, RDREC and TON are in the blocks: s7-300, s7-400, s7-1200 or s7-1500.",
)
@click.option("--grid/--no-grid", default=True, help="Draw requests byte by byte (text).  [default: grid]")
@click.option("--separator", default=";", metavar="CHARACTER", help="Separator between the cells of csv.  [default: ;]")
@output_option("--out")
def command(
    *,
    paths: tuple[Path, ...],
    format_: OutputFormat,
    block: str,
    expand: bool,
    family: Family | None,
    output: Path | None,
    grid: bool,
    separator: str,
) -> int:
    """Show offset, address, type, start value and comment of every member, and every gap.

    For a spec: request and response of every telegram, in data blocks or in the instance. For PLC sources (.db .udt
    .scl .awl, TIA exports .xml, folders of them): every block in them, with the standard-access layout that a CPU
    gives it; types may be in other files.
    """
    from plcgen import api

    out = console()
    if len(separator) != 1 or separator in "\"\r\n'":
        raise click.UsageError("--separator is one character, for example ; or ,")
    result = api.layout(*dict.fromkeys(paths), family=family, block=block, expand=expand)
    if not format_.complete:
        out.complain(result.diagnostics)
    if result.blocks or format_.complete:
        out.show(format_, "layout", result, output, grid=grid, separator=separator)
    elif result.ok:
        nothing = f", {output} is not written" if output is not None else ""
        out.say(f"no data block, type or function block in {' '.join(map(str, paths[:3]))}: no layout{nothing}")
    if result.agreed:
        out.say(f"{quantity(result.agreed, 'offset')} of the exports: the same here")
    return OK if result.ok else PROBLEMS
