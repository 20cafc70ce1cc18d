"""``plcgen schema``: the shape of a spec and the devices it may name."""

from __future__ import annotations

from pathlib import Path

import click

from plcgen.cli.options import CONTEXT, Verb, common_options, console, json_option, output_option
from plcgen.cli.output import OK


@click.command(
    "schema",
    cls=Verb,
    context_settings=CONTEXT,
    examples=(
        "plcgen schema --output plcgen.schema.json",
        "plcgen schema --devices",
    ),
)
@click.option("--devices", is_flag=True, help="List the device profiles instead.")
@json_option
@output_option
@common_options
@click.pass_context
def command(
    ctx: click.Context,
    devices: bool,  # noqa: FBT001 - click's signature
    as_json: bool,  # noqa: FBT001
    output: Path | None,
) -> int:
    """Print the JSON schema of a spec for your editor, or the known devices."""
    out = console(ctx)
    if not devices:
        from plcgen import api
        from plcgen.output.json import dump

        out.result(dump(api.schema()), output)
        return OK
    from plcgen.output.json import dump, head
    from plcgen.output.table import text_table
    from plcgen.protocols.ds47.devices import device_names, find_device

    found = [find_device(name) for name in device_names()]
    if as_json:
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
        out.result(dump({**head("devices", ok=True), "devices": data}), output)
        return OK
    header = ("device", "title", "drive object", "record index", "parameters")
    rows = [
        (d.key, d.title, str(d.drive_object), f"{d.record_index[d.default_index]:04X}h", str(len(d.parameters)))
        for d in found
    ]
    out.result("\n".join(text_table(header, rows, right=frozenset({2, 4}), indent=0)) + "\n", output)
    return OK
