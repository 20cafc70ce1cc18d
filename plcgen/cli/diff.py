"""``plcgen diff``: what changed for others between two versions of sources or specs."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import click

from plcgen.cli.options import PATH, console, format_option, output_option, verb
from plcgen.cli.output import OK, PROBLEMS

if TYPE_CHECKING:
    from plcgen.report.registry import OutputFormat

FAIL_ON = ("breaking", "compatible", "any", "never")


@verb(
    "diff",
    "plcgen diff old/plc plc",
    "plcgen diff old.db new.db --verbose",
    "plcgen diff HEAD~1 job.yaml --format markdown",
    "plcgen diff old/plc plc --policy member-renamed=compatible --fail-on any",
    "plcgen diff --list-changes",
)
@click.argument("paths", nargs=-1, type=PATH, metavar="OLD NEW")
@click.option(
    "--fail-on",
    type=click.Choice(FAIL_ON),
    default="breaking",
    show_default=True,
    help="Exit code 1 if there is a change of this class or a worse one.",
)
@click.option("--policy", multiple=True, metavar="ID=CLASS|FILE", help="Classify changes differently (repeatable).")
@click.option("-v", "--verbose", is_flag=True, help="List every moved member and every changed line.")
@click.option("--classic", is_flag=True, help="SimaticML documents are for S7-300/400.")
@click.option("--keep-going", is_flag=True, help="Leave out files that cannot be read, with a warning.")
@click.option("--list-changes", is_flag=True, help="Print all kinds of changes with their classes.")
@format_option("comparison")
@output_option()
def command(
    *,
    paths: tuple[Path, ...],
    fail_on: str,
    policy: tuple[str, ...],
    verbose: bool,
    classic: bool,
    keep_going: bool,
    list_changes: bool,
    format_: OutputFormat,
    output: Path | None,
) -> int:
    """Compare two versions of PLC sources or specs as HMIs, PLCs and drives see them.

    OLD and NEW are files (.scl .udt .db .awl, SimaticML), folders, specs or layout locks. A git revision for one of
    them means the other as it was there; HEAD~1:job.yaml names a file. Every change is breaking, compatible or
    documentation. Formatting, comments in code and the order of files do not count as changes.
    """
    out = console()
    if list_changes:
        from plcgen.base.display.table import text_table
        from plcgen.s7.compare.text import changes_table

        lines = text_table(("id", "class", "change", "because"), changes_table(), indent=0)
        out.result("\n".join(lines) + "\n", output, ("# ", ""))
        return OK
    if len(paths) != 2:
        raise click.UsageError("give two versions: OLD and NEW, for example plcgen diff HEAD~1 job.yaml")
    from plcgen import api

    result = api.diff(paths[0], paths[1], policy=policy, classic=classic, keep_going=keep_going)
    result = replace(result, diagnostics=(*result.diagnostics, *out.weakened))
    if not format_.complete:
        out.complain(result.diagnostics)
    if format_.complete or result.readable or result.changes:
        out.show(format_, "comparison", result, output, fail_on=fail_on, verbose=verbose)
    return OK if result.readable and not result.failing(fail_on) else PROBLEMS
