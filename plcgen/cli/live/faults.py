"""``plcgen live faults``: what a drive complains about."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from plcgen.cli.live.places import drive_option, object_number, object_options, open_drive, read_address, timeout_option
from plcgen.cli.options import device_option, format_option, verb
from plcgen.cli.ppi.connection import ask

if TYPE_CHECKING:
    from plcgen.base.display.results import Answer
    from plcgen.report.registry import OutputFormat


@verb(
    "faults",
    "plcgen live faults --port pn://192.168.0.5 --device sinamics-s120 --do 2",
    "plcgen live faults --drive 192.168.0.5 --device sinamics-g120 --history 7",
)
@drive_option()
@device_option("Device profile: drive object, titles of its family.")
@object_options
@click.option("--history", type=click.IntRange(0, 7), default=0, show_default=True, help="Fault cases that have gone.")
@timeout_option
@format_option("answer")
def command(
    *,
    host: str,
    device: str | None,
    number: int | None,
    history: int,
    timeout: float,
    format_: OutputFormat,
) -> int:
    """Show the faults (r0945) and alarms (r2122) of a drive object with their titles and values.

    Exit code 1 if a part of them could not be read; faults alone are no error.
    """
    where = read_address(host)

    def question() -> Answer:
        from plcgen.base.diagnostics import Diagnostic, Span
        from plcgen.base.display.data import diagnostics_data
        from plcgen.base.display.results import Answer
        from plcgen.base.display.table import text_table
        from plcgen.ds47.devices import find_device
        from plcgen.ds47.live.messages import read_messages

        known = find_device(device) if device else None
        object_ = object_number(number, known)
        with open_drive(where, timeout, known) as reader:
            found = read_messages(reader, known, object_, history + 1)
        problems = [
            Diagnostic("PG706", one.doubt, Span(f"{where} r{one.parameter.pnu}[{one.index}]")) for one in found.missing
        ]
        rows = [(one.code, one.title or "(no title known)", one.value, str(one.case)) for one in found.entries]
        lines = [f"{where}, drive object {object_}"]
        lines += text_table(("message", "title", "value", "case"), rows, indent=0) if rows else []
        lines += ["no messages" + " in what could be read" * bool(problems)] if not rows else []
        lines += [f"not asked: {one}, no parameter of {device} is known to have them" for one in found.unknown]
        data = [{"code": one.code, "title": one.title, "value": one.value, "case": one.case} for one in found.entries]
        shown = {**diagnostics_data("live faults", problems), "address": str(where), "drive_object": object_}
        shown |= {"messages": data, "skipped": found.unknown}
        return Answer(shown, lambda _view: "\n".join(lines) + "\n", problems)

    return ask(format_, "live faults", (host,), question)
