"""``plcgen verify``: run what was generated."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import click

from plcgen.api import default_folder
from plcgen.cli.options import (
    PATH,
    console,
    faults_option,
    folder_option,
    format_option,
    output_option,
    strict_option,
    verb,
)
from plcgen.cli.watch import watch_option
from plcgen.proof.effort import Faults

if TYPE_CHECKING:
    from plcgen.report.registry import OutputFormat


@verb(
    "verify",
    "plcgen verify job.yaml",
    "plcgen verify machines/",
    "plcgen verify job.yaml --drive press3.yaml",
    "plcgen verify job.yaml --faults full",
    "plcgen verify job.yaml --format junit --output verify.xml",
)
@click.argument("paths", nargs=-1, type=PATH, metavar="SPEC|FOLDER...")
@folder_option("Generated folder")
@click.option("--drive", type=PATH, metavar="FILE", help="Drive file that describes a drive of your own.")
@faults_option()
@click.option("--oracle", type=click.Choice(["tshark"]), help="Also check every telegram with Wireshark's dissector.")
@click.option("--cache", type=PATH, metavar="DIR", help="Where verdicts are kept.  [default: the user's cache folder]")
@click.option("--no-cache", is_flag=True, help="Run everything, and store no verdicts.")
@click.option("--scheduler", metavar="ADDRESS", help="Execute on a Dask cluster, such as tcp://host:8786.")
@click.option("--ledger", is_flag=True, help="List everything the result rests on, with its source.")
@strict_option
@format_option("verification")
@output_option()
@watch_option(generated=True)
def command(
    *,
    paths: tuple[Path, ...],
    folder: Path | None,
    drive: Path | None,
    faults: Faults,
    oracle: Literal["tshark"] | None,
    cache: Path | None,
    no_cache: bool,
    scheduler: str | None,
    ledger: bool,
    strict: bool,
    format_: OutputFormat,
    output: Path | None,
) -> int:
    """Run the files in a generated folder against a simulated drive and compare every byte.

    The files on disk are read back, their layout is compared with the telegrams, and they are executed scan by scan,
    with injected errors. Exit code 1 if any check fails; a check that could not be run is listed but does not fail.
    Each spec has its own folder; a folder given here stands for the specs below it.
    """
    from plcgen import api
    from plcgen.cli.specs import find_specs, one_folder
    from plcgen.project.together import same_plc

    out = console()
    specs = find_specs(paths, out)
    one_folder(specs, folder)
    together = same_plc(specs)
    kept = None if no_cache else _cache(cache)
    found = []
    for spec in specs:
        with out.progress() as progress:
            target = folder or default_folder(spec)
            result = api.verify(
                spec, target, drive=drive, faults=faults, oracle=oracle, strict=strict,
                progress=progress, scheduler=scheduler, cache=kept,
            )  # fmt: skip
        found.append(replace(result, diagnostics=(*result.diagnostics, *together.get(spec, ()))))
    if len(found) == 1:
        return out.verification(format_, found[0], output, ledger=ledger)
    return out.verifications(format_, found, output, ledger=ledger)


def _cache(given: Path | None) -> Path | None:
    """Where verdicts are kept: as the command line or plcgen.toml says, else the environment or the system."""
    from plcgen.proof.cache import OFF, chosen_folder

    if given is None:
        return chosen_folder()
    return None if str(given).lower() in OFF else given
