"""``plcgen verify``: run what was generated."""

from __future__ import annotations

from pathlib import Path
from typing import Literal

import click

from plcgen.api import default_folder
from plcgen.cli.options import CONTEXT, FORMATS, PATH, Verb, common_options, console, format_options, output_option
from plcgen.cli.output import OK, PROBLEMS
from plcgen.cli.sources import SourceCache


@click.command(
    "verify",
    cls=Verb,
    context_settings=CONTEXT,
    examples=(
        "plcgen verify job.yaml",
        "plcgen verify job.yaml --drive press3.yaml",
        "plcgen verify job.yaml --faults full",
        "plcgen verify job.yaml --format junit --output verify.xml",
    ),
)
@click.argument("spec", type=PATH)
@click.option(
    "--out", "folder", type=PATH, metavar="DIR", help="Generated folder.  [default: <spec>_generated beside the spec]"
)
@click.option("--drive", type=PATH, metavar="FILE", help="Drive file: the parameters of your real drive.")
@click.option(
    "--faults",
    type=click.Choice(["none", "quick", "full"]),
    default="quick",
    show_default=True,
    help="How many faults the generated SCL runs through.",
)
@format_options(*FORMATS)
@output_option
@common_options
@click.pass_context
def command(
    ctx: click.Context,
    spec: Path,
    folder: Path | None,
    drive: Path | None,
    faults: Literal["none", "quick", "full"],
    format_: str,
    output: Path | None,
) -> int:
    """Run the files in a generated folder against a simulated drive and compare every byte.

    What lies on disk is read back, laid out by independent calculators, executed scan by scan and fed with
    errors. Exit code 1 if any check fails; a check that could not be run is listed and fails nothing.
    """
    from plcgen import api

    out = console(ctx)
    with out.progress() as progress:
        result = api.verify(spec, folder or default_folder(spec), drive=drive, faults=faults, progress=progress)
    if format_ == "text":
        from plcgen.output.verification import troubles, verification_text

        color = out.out_color and output is None
        shown = troubles(result) if out.quiet else result
        if not out.quiet or not result.ok:
            out.result(verification_text(shown, SourceCache().line, color=color, width=out.out_width), output)
    else:
        from plcgen.cli.formats import verification_in

        out.result(verification_in(format_, result), output)
    return OK if result.ok else PROBLEMS
