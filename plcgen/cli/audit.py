"""``plcgen audit``: hand-written buffers and the calls that send them against a spec."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from plcgen.cli.options import PATH, console, format_option, output_option, verb
from plcgen.cli.output import OK, PROBLEMS, USAGE

if TYPE_CHECKING:
    from plcgen.report.registry import OutputFormat


@verb(
    "audit",
    "plcgen audit project/*.db --spec job.yaml",
    "plcgen audit old_project.awl types.udt --spec job.yaml",
    "plcgen audit exports/ --spec job.yaml --format sarif --output audit.sarif",
)
@click.argument("paths", nargs=-1, required=True, type=PATH, metavar="FILE|FOLDER...")
@click.option("--spec", required=True, type=PATH, metavar="FILE", help="Spec that says what is read and written.")
@click.option("--strict", is_flag=True, help="Exit code 1, too, if a check could not be run.")
@format_option("verification")
@output_option()
def command(*, paths: tuple[Path, ...], spec: Path, strict: bool, format_: OutputFormat, output: Path | None) -> int:
    """Audit hand-written request and response DBs, and the calls that send them.

    The spec says what is to be read or written. The data blocks (.db .udt .scl .awl, SimaticML) are matched to
    its jobs by number, name or start values and compared member by member.
    Exit code 1 if there is an error, 2 if nothing of the spec was found in the sources.
    """
    from plcgen import api
    from plcgen.proof.checks import Outcome

    out, result = console(), api.audit(*paths, spec=spec)
    code = out.verification(format_, result, output)
    outcomes = [check.outcome for check in result.checks()]
    if code == OK and all(outcome is Outcome.NOT_RUN for outcome in outcomes):
        out.say("nothing was checked: name the sources with the buffers of this spec, and its calls")
        return USAGE
    if code == OK and strict and Outcome.NOT_RUN in outcomes:
        out.say("--strict: a check that was not run is an error")
        return PROBLEMS
    return code
