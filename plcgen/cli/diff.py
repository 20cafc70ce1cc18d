"""``plcgen diff``: what changed for others between two versions of sources or specs."""

from __future__ import annotations

from pathlib import Path

import click

from plcgen.cli.options import CONTEXT, PATH, Verb, common_options, console, format_options, output_option
from plcgen.cli.output import OK, PROBLEMS

FAIL_ON = ("breaking", "compatible", "any", "never")


@click.command(
    "diff",
    cls=Verb,
    context_settings=CONTEXT,
    examples=(
        "plcgen diff old/plc plc",
        "plcgen diff old.db new.db --verbose",
        "plcgen diff main/job.yaml job.yaml --format markdown",
        "plcgen diff old/plc plc --policy member-renamed=compatible --fail-on any",
        "plcgen diff --list-changes",
    ),
)
@click.argument("paths", nargs=-1, type=PATH, metavar="OLD NEW")
@click.option(
    "--fail-on",
    type=click.Choice(FAIL_ON),
    default="breaking",
    show_default=True,
    help="Exit code 1 if there is a change of this class or a worse one.",
)
@click.option("--policy", multiple=True, metavar="ID=CLASS|FILE", help="Classify changes otherwise (repeatable).")
@click.option("-v", "--verbose", is_flag=True, help="List every moved member and every changed line.")
@click.option("--classic", is_flag=True, help="SimaticML documents are for S7-300/400.")
@click.option("--list-changes", is_flag=True, help="Print all kinds of changes with their classes.")
@format_options("text", "markdown", "json", "sarif")
@output_option
@common_options
@click.pass_context
def command(
    ctx: click.Context,
    paths: tuple[Path, ...],
    fail_on: str,
    policy: tuple[str, ...],
    verbose: bool,  # noqa: FBT001 - click's signature
    classic: bool,  # noqa: FBT001
    list_changes: bool,  # noqa: FBT001
    format_: str,
    output: Path | None,
) -> int:
    """Compare two versions of PLC sources or specs by what others notice.

    OLD and NEW are files (.scl .udt .db .awl, SimaticML), folders or specs. Every change is breaking, compatible
    or documentation; layout, comments, blanks and the order of files are no changes.
    """
    from plcgen.review.compare import texts as report

    out = console(ctx)
    if list_changes:
        from plcgen.output.table import text_table

        lines = text_table(("id", "class", "change", "because"), report.changes_table(), indent=0)
        out.result("\n".join(lines) + "\n", output)
        return OK
    if len(paths) != 2:
        raise click.UsageError("give two versions: OLD and NEW", ctx)
    from plcgen import api

    result = api.diff(paths[0], paths[1], policy=policy, classic=classic)
    if format_ == "json":
        out.result(report.comparison_json(result, fail_on), output)
    elif format_ == "sarif":
        out.result(report.comparison_sarif(result, fail_on), output)
    else:
        out.complain(result.diagnostics)
        if format_ == "markdown":
            text = report.comparison_markdown(result, fail_on, verbose=verbose)
        else:
            color = out.out_color and output is None
            text = report.comparison_text(result, fail_on, verbose=verbose, color=color, width=out.out_width)
        if result.readable or result.changes:
            out.result(text, output)
    return OK if result.readable and not result.failing(fail_on) else PROBLEMS
