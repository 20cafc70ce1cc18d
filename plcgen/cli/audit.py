"""``plcgen audit``: hand-written buffers, telegrams and the calls that send them against a spec."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from plcgen.cli.options import PATH, console, format_option, output_option, verb

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
@format_option("verification")
@output_option()
def command(*, paths: tuple[Path, ...], spec: Path, format_: OutputFormat, output: Path | None) -> int:
    """Audit hand-written request and response DBs, PPI telegrams, and the calls that send them.

    The spec says what is to be read or written. The data blocks (.db .udt .scl .awl, SimaticML) are matched to
    its jobs by number, name or start values and compared member by member; telegrams are compared byte by byte.
    Exit code 1 if there is an error.
    """
    from plcgen import api

    return console().verification(format_, api.audit(*paths, spec=spec), output)
