"""``plcgen schema``: the shape of a spec and the devices it may name."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from plcgen.cli.options import console, format_option, output_option, verb
from plcgen.cli.output import OK

if TYPE_CHECKING:
    from plcgen.display.results import Answer
    from plcgen.output.registry import OutputFormat


@verb(
    "schema",
    "plcgen schema --output plcgen.schema.json",
    "plcgen schema --devices",
)
@click.option("--devices", is_flag=True, help="List the device profiles instead.")
@format_option("answer")
@output_option
def command(*, devices: bool, format_: OutputFormat, output: Path | None) -> int:
    """Print the JSON schema of a spec for your editor, or the known devices."""
    out = console()
    if devices:
        return out.answer(format_, _devices(), output)
    from plcgen import api
    from plcgen.display.data import dump

    out.result(dump(api.schema()), output)
    return OK


def _devices() -> Answer:
    from plcgen.display.data import head
    from plcgen.display.results import Answer
    from plcgen.display.table import text_table
    from plcgen.protocols.ds47.devices import device_names, find_device

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
