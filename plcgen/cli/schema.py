"""``plcgen schema``: the shapes of files and results."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from plcgen.cli.options import PATH, console, format_option, output_option, verb
from plcgen.cli.output import OK

if TYPE_CHECKING:
    from plcgen.report.registry import OutputFormat

KINDS = (
    "spec", "shared", "drive", "station", "profile", "policy", "lock", "config", "faults",
    "output", "serve", "monitor",
)  # fmt: skip


@verb(
    "schema",
    "plcgen schema --output plcgen.schema.json",
    "plcgen schema --profile acme.yaml --output plcgen.schema.json",
    "plcgen schema output",
)
@click.argument("kind", type=click.Choice(KINDS), default="spec")
@click.option(
    "--profile",
    "profiles",
    multiple=True,
    type=PATH,
    metavar="FILE",
    help="A device profile of your own: its parameter names are offered in a spec, too.",
)
@click.option("--devices", is_flag=True, hidden=True, help="The old name of plcgen devices.")
@format_option("answer")
@output_option()
def command(*, kind: str, profiles: tuple[Path, ...], devices: bool, format_: OutputFormat, output: Path | None) -> int:
    """Print a JSON schema for editors and programs.

    Without an argument, the schema is that of a spec. Others are those of a file that specs include (shared), a drive
    file, station file, device profile, policy, lock, plcgen.toml (config) or file of faults; of what --format json
    writes (output); and of a line of ppi serve and ppi monitor.
    """
    out = console()
    if devices:
        from plcgen.cli.devices import listed

        return out.answer(format_, listed(), output)
    from plcgen import api
    from plcgen.api.schemas import WITH_PROFILES
    from plcgen.base.display.data import dump

    if profiles and kind not in WITH_PROFILES:
        raise click.UsageError(f"--profile belongs to the schemas {' and '.join(WITH_PROFILES)}, not to {kind}")
    found = _config() if kind == "config" else api.schema(kind, profiles=profiles)
    out.result(dump(found), output)
    return OK


def _config() -> dict[str, Any]:
    from plcgen.cli.config import Config
    from plcgen.project.editor import file_schema

    return file_schema("config", "plcgen.toml: the defaults of a repository.", Config)
