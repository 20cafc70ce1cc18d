"""``plcgen layout``: where every byte lies."""

from __future__ import annotations

from pathlib import Path

import click

from plcgen.cli.options import CONTEXT, PATH, Verb, common_options, console, format_options, output_option
from plcgen.cli.output import OK, PROBLEMS


@click.command(
    "layout",
    cls=Verb,
    context_settings=CONTEXT,
    examples=(
        "plcgen layout job.yaml",
        "plcgen layout job_generated/db/*.db --format csv",
        "plcgen layout old_project.awl types.udt",
    ),
)
@click.argument("paths", nargs=-1, required=True, type=PATH, metavar="SPEC|FILE...")
@format_options("text", "markdown", "csv", "json")
@click.option("--grid/--no-grid", default=True, help="Draw requests byte by byte (text).  [default: grid]")
@click.option("--s7-1500", "s7_1500", is_flag=True, help="Sources are for S7-1200/1500: their WRREC and RDREC.")
@output_option
@common_options
@click.pass_context
def command(
    ctx: click.Context,
    paths: tuple[Path, ...],
    format_: str,
    grid: bool,  # noqa: FBT001 - click's signature
    s7_1500: bool,  # noqa: FBT001
    output: Path | None,
) -> int:
    """Show offset, address, type and start value of every member.

    For a spec: the request and response data blocks of every telegram. For PLC text sources (.db .udt .scl
    .awl): every block in them, with the standard-access layout a CPU gives it; types may stand in other files.
    """
    from plcgen import api
    from plcgen.report import layout as report

    out = console(ctx)
    result = api.layout(*dict.fromkeys(paths), s7_1500=s7_1500)
    if format_ == "json":
        from plcgen.report.json import diagnostic_data

        data = [diagnostic_data(d) for d in result.diagnostics]
        out.result(report.layout_json(result.blocks, data, ok=result.ok), output)
        return OK if result.ok else PROBLEMS
    out.complain(result.diagnostics)
    if format_ == "markdown":
        text = report.layout_markdown(result.blocks)
    elif format_ == "csv":
        text = report.layout_csv(result.blocks)
    else:
        color = out.out_color and output is None
        text = report.layout_text(result.blocks, color=color, grid=grid, width=out.out_width)
    if result.blocks or output is not None:
        out.result(text, output)
    elif result.ok:
        out.say("no data block, type or function block found")
    return OK if result.ok else PROBLEMS
