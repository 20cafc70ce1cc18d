"""``plcgen catalogue diff``: two versions of what is known about a device."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from plcgen.base.diagnostics.counting import quantity
from plcgen.cli.completed import devices
from plcgen.cli.options import console, format_option, verb

if TYPE_CHECKING:
    from plcgen.report.registry import OutputFormat


@verb(
    "diff",
    "plcgen catalogue diff sinamics-g120 ./pump_drive.yaml",
    "plcgen catalogue diff ./v1/acme.yaml ./v2/acme.yaml",
)
@click.argument("old", metavar="OLD", shell_complete=devices)
@click.argument("new", metavar="NEW", shell_complete=devices)
@format_option("answer")
def command(*, old: str, new: str, format_: OutputFormat) -> int:
    """Show which facts about parameters differ between two device profiles, given as device names or paths."""
    from plcgen.base.display.data import head
    from plcgen.base.display.results import Answer
    from plcgen.base.display.table import text_table
    from plcgen.ds47.catalogue.drift import changes
    from plcgen.ds47.devices import find_device

    found = list(changes(find_device(old), find_device(new)))
    header = ("parameter", "fact", "old", "new", "grade")
    rows = [(one.parameter, one.fact, one.old, one.new, one.grade) for one in found]
    lines = text_table(header[:4], [row[:4] for row in rows], indent=0) if rows else []
    text = "\n".join([*lines, quantity(len(rows), "fact differs", "facts differ")]) + "\n"
    data = {**head("catalogue diff", ok=True), "changes": [dict(zip(header, row, strict=True)) for row in rows]}
    return console().answer(format_, Answer(data, lambda _view: text))
