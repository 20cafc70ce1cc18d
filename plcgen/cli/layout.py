"""``plcgen layout``: where every byte lies."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING

import click

from plcgen.cli.options import CONTEXT, PATH, Verb, common_options, console, format_options
from plcgen.cli.output import OK, PROBLEMS, Console, is_terminal

if TYPE_CHECKING:
    from plcgen.api import Family, LayoutResult

_BOM = "\ufeff"


@click.command(
    "layout",
    cls=Verb,
    context_settings=CONTEXT,
    examples=(
        "plcgen layout job.yaml",
        "plcgen layout old_project.awl types.udt --block DB3",
        "plcgen layout exported_project/ --format csv --out layout.csv",
        "plcgen layout exported_project/ --format html --out layout.html",
    ),
)
@click.argument("paths", nargs=-1, required=True, type=PATH, metavar="SPEC|FILE|FOLDER...")
@format_options("text", "markdown", "csv", "json", "svg", "html")
@click.option("--block", default="", metavar="NAME", help="Only this block: its name, or DB3, UDT5, FB7.")
@click.option("--expand", is_flag=True, help="Every element of every array, not only the first.")
@click.option(
    "--family",
    type=click.Choice(["s7-300", "s7-400", "s7-1200", "s7-1500"]),
    metavar="FAMILY",
    help="Whose WRREC, RDREC and TON lie in the blocks: s7-300, s7-400, s7-1200 or s7-1500.",
)
@click.option("--grid/--no-grid", default=True, help="Draw requests byte by byte (text).  [default: grid]")
@click.option("--separator", default=";", metavar="CHARACTER", help="Between the cells of csv.  [default: ;]")
@click.option(
    "-o", "--out", "--output", "output", type=PATH, metavar="FILE", help="Write the result to FILE instead of stdout."
)
@click.option("--force", is_flag=True, help="Overwrite FILE.")
@common_options
@click.pass_context
def command(
    ctx: click.Context,
    paths: tuple[Path, ...],
    format_: str,
    block: str,
    expand: bool,  # noqa: FBT001 - click's signature
    family: Family | None,
    output: Path | None,
    force: bool,  # noqa: FBT001
    grid: bool,  # noqa: FBT001
    separator: str,
) -> int:
    """Show offset, address, type, start value and comment of every member, and every gap.

    For a spec: the request and response data blocks of every telegram. For PLC sources (.db .udt .scl .awl, TIA
    exports .xml, folders of them): every block in them, with the standard-access layout a CPU gives it; types may
    stand in other files.
    """
    from plcgen import api

    out = console(ctx)
    if len(separator) != 1 or separator in "\"\r\n'":
        raise click.UsageError("--separator is one character, for example ; or ,", ctx)
    result = api.layout(*dict.fromkeys(paths), family=family, block=block, expand=expand)
    if format_ != "json":
        out.complain(result.diagnostics)
    if result.blocks or format_ == "json":
        out.result(_spelled(result, format_, out, output, grid=grid, separator=separator), output, force=force)
    elif result.ok:
        nothing = f", {output} is not written" if output is not None else ""
        out.say(f"no data block, type or function block in {' '.join(map(str, paths[:3]))}: no layout{nothing}")
    return OK if result.ok else PROBLEMS


def _spelled(
    result: LayoutResult, format_: str, out: Console, output: Path | None, *, grid: bool, separator: str
) -> str:
    """The result in one of the formats."""
    if format_ == "json":
        from plcgen.output.json import diagnostic_data
        from plcgen.review.layout.data import layout_json

        return layout_json(result.blocks, [diagnostic_data(d) for d in result.diagnostics], ok=result.ok)
    if format_ == "csv":
        from plcgen.review.layout.data import layout_csv

        return (_BOM if output is not None else "") + layout_csv(result.blocks, separator)
    if format_ in {"svg", "html"}:
        from plcgen.review.layout import page as layout_page

        return layout_page.html(result.blocks) if format_ == "html" else layout_page.svg(result.blocks)
    from plcgen.review.layout.tables import layout_markdown, layout_text

    if format_ == "markdown":
        return layout_markdown(result.blocks)
    screen = output is None and is_terminal(sys.stdout)
    width = out.out_width if screen else 0
    return layout_text(result.blocks, color=out.out_color and output is None, grid=grid, width=width)
