"""``plcgen verify``: run what was generated."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Literal

import click

from plcgen.api import default_folder
from plcgen.cli.options import PATH, console, folder_option, format_option, output_option, strict_option, verb
from plcgen.cli.watch import watch_option

if TYPE_CHECKING:
    from plcgen.output.registry import OutputFormat


@verb(
    "verify",
    "plcgen verify job.yaml",
    "plcgen verify machines/",
    "plcgen verify job.yaml --drive press3.yaml",
    "plcgen verify job.yaml --faults full --engine",
    "plcgen verify job.yaml --format junit --output verify.xml",
)
@click.argument("paths", nargs=-1, type=PATH, metavar="SPEC|FOLDER...")
@folder_option("Generated folder")
@click.option("--drive", type=PATH, metavar="FILE", help="Drive file: the parameters of your real drive.")
@click.option(
    "--faults",
    type=click.Choice(["none", "quick", "full"]),
    default="quick",
    show_default=True,
    help="How many faults the generated SCL runs through.",
)
@click.option("--engine", is_flag=True, help="Run the proof of the drive engine, even of one that is known.")
@click.option("--oracle", type=click.Choice(["tshark"]), help="Show every telegram to Wireshark's dissector, too.")
@strict_option
@format_option("verification")
@output_option
@watch_option(generated=True)
def command(
    *,
    paths: tuple[Path, ...],
    folder: Path | None,
    drive: Path | None,
    faults: Literal["none", "quick", "full"],
    engine: bool,
    oracle: Literal["tshark"] | None,
    strict: bool,
    format_: OutputFormat,
    output: Path | None,
) -> int:
    """Run the files in a generated folder against a simulated drive and compare every byte.

    What lies on disk is read back, laid out and held to the telegrams, executed scan by scan and fed with
    errors. Exit code 1 if any check fails; a check that could not be run is listed and fails nothing. Each spec has
    its own folder; a folder named here stands for the specs below it.
    """
    from plcgen import api
    from plcgen.cli.specs import find_specs, one_folder

    out = console()
    specs = find_specs(paths)
    one_folder(specs, folder)
    found = []
    for spec in specs:
        with out.progress() as progress:
            target = folder or default_folder(spec)
            result = api.verify(
                spec, target, drive=drive, faults=faults, engine=engine, oracle=oracle, strict=strict, progress=progress
            )
        found.append(result)
    if len(found) == 1:
        return out.verification(format_, found[0], output)
    return out.verifications(format_, found, output)
