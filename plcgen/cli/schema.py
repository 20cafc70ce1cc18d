"""``plcgen schema``: the shapes of files and results, and the devices that a spec may name."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from plcgen.cli.options import PATH, console, format_option, output_option, verb
from plcgen.cli.output import OK

if TYPE_CHECKING:
    from plcgen.base.display.results import Answer
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
    "plcgen schema --devices",
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
@click.option("--devices", is_flag=True, help="List the device profiles instead.")
@format_option("answer")
@output_option()
def command(*, kind: str, profiles: tuple[Path, ...], devices: bool, format_: OutputFormat, output: Path | None) -> int:
    """Print a JSON schema for editors and programs, or the known devices.

    Without an argument, the schema is that of a spec. Others are those of a file that specs include (shared), a drive
    file, station file, device profile, policy, lock, plcgen.toml (config) or file of faults; of what --format json
    writes (output); and of a line of ppi serve and ppi monitor.
    """
    out = console()
    if devices:
        return out.answer(format_, _devices(), output)
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


def _devices() -> Answer:
    from plcgen.base.display.data import head
    from plcgen.base.display.results import Answer
    from plcgen.base.display.table import text_table
    from plcgen.ds47.devices import device_names, find_device

    found = [find_device(name) for name in device_names()]
    data = [
        {
            "key": d.key,
            "title": d.title,
            "source": d.source,
            "drive_object": d.drive_object,
            "record_index": {"default": d.default_index, **d.record_index},
            "parameters": [f"P{pnu}" for pnu in sorted(d.parameters)],
        }
        for d in found
    ]
    header = ("device", "title", "drive object", "record index", "parameters")
    rows = [
        (d.key, d.title, str(d.drive_object), f"{d.record_index[d.default_index]:04X}h", str(len(d.parameters)))
        for d in found
    ]
    text = "\n".join(text_table(header, rows, right=frozenset({2, 4}), indent=0)) + "\n"
    return Answer({**head("devices", ok=True), "devices": data}, lambda _view: text)
