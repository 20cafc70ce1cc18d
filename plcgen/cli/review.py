"""``plcgen review``: one page with everything that a reviewer must see."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import click

from plcgen.cli.options import PATH, console, faults_option, folder_option, format_option, output_option, verb
from plcgen.cli.output import OK, PROBLEMS, USAGE
from plcgen.proof.effort import Faults

if TYPE_CHECKING:
    from plcgen.report.registry import OutputFormat


@verb(
    "review",
    "plcgen review job.yaml -o review.html",
    "plcgen review job.yaml --against origin/main -o review.html",
    "plcgen review job.yaml --against ../released --format markdown -o review.md",
)
@click.argument("spec", type=PATH)
@folder_option("Generated folder")
@click.option(
    "--against", default="", metavar="REV|FOLDER", help="Compare with a git revision, a folder or another spec."
)
@click.option(
    "--lock", type=PATH, metavar="FILE", help="Layout lock.  [default: plcgen.lock.json beside the spec, if it exists]"
)
@faults_option()
@click.option(
    "--fault",
    default="",
    metavar="KIND[:KEY=VALUE,...]",
    help="Fault in the second recorded run of every job.  [default: busy:times=2; silence on a PPI line]",
)
@format_option("review", default="html")
@output_option()
def command(
    *,
    spec: Path,
    folder: Path | None,
    against: str,
    lock: Path | None,
    faults: Faults,
    fault: str,
    format_: OutputFormat,
    output: Path | None,
) -> int:
    """Verify the generated files and put everything that a reviewer must see on one page.

    Verdict, changes, write list, telegrams byte by byte, layouts, recorded runs, fault matrix, sign-off. Exit code 1
    if a check fails, the lock differs, or something cannot be read; changes from another version are not failures.
    """
    from plcgen import api
    from plcgen.base.diagnostics import DiagnosticError

    out = console()
    try:
        with out.progress() as progress:
            result = api.review(spec, folder, against=against, lock=lock, faults=faults, fault=fault, progress=progress)
    except DiagnosticError as problem:
        out.complain(problem.diagnostics)
        return USAGE
    told = (*result.verification.diagnostics, *out.weakened)
    result = replace(result, verification=replace(result.verification, diagnostics=told))
    out.show(format_, "review", result, output)
    out.complain(out.weakened)
    if not format_.complete and not result.ok:
        stale = [problem for problem in result.problems if problem.code == "PG504"]
        out.complain([problem for problem in result.problems if problem.severity.label == "error"] or stale)
    return OK if result.ok else PROBLEMS
