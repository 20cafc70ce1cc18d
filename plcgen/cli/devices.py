"""``plcgen devices``: the devices that a spec may name."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from plcgen.cli.options import console, format_option, output_option, verb

if TYPE_CHECKING:
    from plcgen.base.display.results import Answer
    from plcgen.report.registry import OutputFormat


@verb("devices", "plcgen devices", "plcgen devices --json")
@format_option("answer")
@output_option()
def command(*, format_: OutputFormat, output: Path | None) -> int:
    """List the device profiles: their titles, drive objects, record indexes, and how many parameters each knows."""
    return console().answer(format_, listed(), output)


def listed() -> Answer:
    """All devices, as a table and as data."""
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
