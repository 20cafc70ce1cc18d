"""``plcgen audit``: hand-written buffers and record calls against a spec."""

from __future__ import annotations

from pathlib import Path

import click

from plcgen.cli.options import CONTEXT, FORMATS, PATH, Verb, common_options, console, format_options, output_option
from plcgen.cli.output import OK, PROBLEMS
from plcgen.cli.sources import SourceCache


@click.command(
    "audit",
    cls=Verb,
    context_settings=CONTEXT,
    examples=(
        "plcgen audit project/*.db --spec job.yaml",
        "plcgen audit old_project.awl types.udt --spec job.yaml",
        "plcgen audit exports/ --spec job.yaml --format sarif --output audit.sarif",
    ),
)
@click.argument("paths", nargs=-1, required=True, type=PATH, metavar="FILE|FOLDER...")
@click.option("--spec", required=True, type=PATH, metavar="FILE", help="Spec that says what is read and written.")
@format_options(*FORMATS)
@output_option
@common_options
@click.pass_context
def command(ctx: click.Context, paths: tuple[Path, ...], spec: Path, format_: str, output: Path | None) -> int:
    """Audit request and response DBs that somebody wrote by hand, and the calls that send them.

    The spec says what is to be read or written; the data blocks (.db .udt .scl .awl, SimaticML) are matched to
    its jobs by number, name or start values, and compared member by member. Exit code 1 if there is an error.
    """
    from plcgen import api

    out = console(ctx)
    result = api.audit(*paths, spec=spec)
    if format_ == "text":
        from plcgen.output.verification import troubles, verification_text

        color = out.out_color and output is None
        shown = troubles(result) if out.quiet else result
        if not out.quiet or not result.ok:
            out.result(verification_text(shown, SourceCache().line, color=color, width=out.out_width), output)
    else:
        from plcgen.cli.formats import verification_in

        out.result(verification_in(format_, result, "audit"), output)
    return OK if result.ok else PROBLEMS
