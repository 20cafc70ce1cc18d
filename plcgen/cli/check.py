"""``plcgen check``: every problem of one or more specs."""

from __future__ import annotations

from pathlib import Path

import click

from plcgen.cli.options import CONTEXT, FORMATS, PATH, Verb, common_options, console, format_options, output_option
from plcgen.cli.output import OK, PROBLEMS
from plcgen.cli.sources import SourceCache


@click.command(
    "check",
    cls=Verb,
    context_settings=CONTEXT,
    examples=(
        "plcgen check job.yaml",
        "plcgen check machines/*.yaml --format github",
        "plcgen check job.yaml --format sarif --output plcgen.sarif",
    ),
)
@click.argument("specs", nargs=-1, required=True, type=PATH, metavar="SPEC...")
@format_options(*FORMATS)
@output_option
@common_options
@click.pass_context
def command(ctx: click.Context, specs: tuple[Path, ...], format_: str, output: Path | None) -> int:
    """Check specs and show every problem at its place.

    Nothing is written. Exit code 1 if there is an error in any spec; warnings alone give 0.
    """
    from plcgen import api
    from plcgen.cli.formats import diagnostics_in
    from plcgen.report.text import diagnostics_text, summary_text

    out = console(ctx)
    results = [api.check(spec) for spec in dict.fromkeys(specs)]
    found = [diagnostic for result in results for diagnostic in result.diagnostics]
    if format_ == "text":
        cache = SourceCache()
        color = out.out_color and output is None
        text = diagnostics_text(found, cache.line, color=color, width=out.out_width)
        if text or output is not None:
            out.result(text, output)
        where = specs[0].as_posix() if len(specs) == 1 else f"{len(results)} specs"
        if text:
            out.say("")
        out.say(summary_text(found, where))
    else:
        subjects = [(result.spec.as_posix(), result.diagnostics) for result in results]
        out.result(diagnostics_in(format_, "check", subjects), output)
    return OK if all(result.ok for result in results) else PROBLEMS
