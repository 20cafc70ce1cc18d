"""``plcgen lock``: a layout in the repository, and the check that nothing moved since."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import click

from plcgen.base.diagnostics.counting import quantity
from plcgen.cli.diff import FAIL_ON
from plcgen.cli.options import PATH, console, format_option, output_option, verb
from plcgen.cli.output import OK, PROBLEMS

if TYPE_CHECKING:
    from plcgen.cli.output import Console
    from plcgen.report.registry import OutputFormat
    from plcgen.s7.compare.model import Comparison


@verb(
    "lock",
    "plcgen lock plc",
    "plcgen lock --check",
    "plcgen lock job.yaml --out job.lock.json",
    "plcgen lock --check --fail-on breaking --format sarif --output lock.sarif",
)
@click.argument("paths", nargs=-1, type=PATH, metavar="[SPEC|FILE|FOLDER]...")
@click.option("--out", "path", type=PATH, default="plcgen.lock.json", show_default=True, help="The lock file.")
@click.option("--check", is_flag=True, help="Write nothing; exit 1 if the sources differ from the lock.")
@click.option(
    "--fail-on",
    type=click.Choice(FAIL_ON),
    default="any",
    show_default=True,
    help="With --check: exit code 1 only for this class or a worse one.",
)
@click.option("--policy", multiple=True, metavar="ID=CLASS|FILE", help="Classify changes differently, as in diff.")
@click.option("-v", "--verbose", is_flag=True, help="List every moved member.")
@click.option("--classic", is_flag=True, help="SimaticML documents are for S7-300/400.")
@click.option("--keep-going", is_flag=True, help="Leave out files that cannot be read, with a warning.")
@format_option("comparison")
@output_option()
def command(
    *,
    paths: tuple[Path, ...],
    path: Path,
    check: bool,
    fail_on: str,
    policy: tuple[str, ...],
    verbose: bool,
    classic: bool,
    keep_going: bool,
    format_: OutputFormat,
    output: Path | None,
) -> int:
    """Record where every member of the blocks is in a lock file, or check that nothing has moved.

    Commit the file. --check shows old and new offsets, classified as in diff. Without paths, both use the
    sources that the lock names.
    """
    from plcgen import api

    out = console()
    if check:
        result = api.check_lock(*paths, lock=path, policy=policy, classic=classic, keep_going=keep_going)
        return _show(out, result, fail_on, format_, output, verbose=verbose)
    if format_.name != "text" or output is not None:
        raise click.UsageError("--format and --output belong to --check")
    written = api.lock(*paths, out=path, classic=classic, force=out.force, keep_going=keep_going)
    out.complain(written.diagnostics)
    if not written.ok:
        out.say("nothing was written")
        return PROBLEMS
    what = "wrote" if written.changed else "unchanged:"
    out.say(f"{what} {written.path.as_posix()}, {quantity(written.blocks, 'block')}")
    return OK


def _show(
    out: Console, result: Comparison, fail_on: str, format_: OutputFormat, output: Path | None, *, verbose: bool
) -> int:
    text = format_.name == "text"
    result = replace(result, diagnostics=(*result.diagnostics, *out.weakened))
    if not format_.complete:
        out.complain(result.diagnostics)
    if result.changes or not text:
        out.show(format_, "comparison", result, output, fail_on=fail_on, verbose=verbose)
    if text and result.changes:
        out.say(f"intended? write the lock again: plcgen lock --out {result.old}")
    elif text and result.readable:
        out.say(f"{quantity(result.compared, 'block')} as in {result.old}")
    return OK if result.readable and not result.failing(fail_on) else PROBLEMS
