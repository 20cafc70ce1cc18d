"""``plcgen live db``: data blocks of telegrams in a real CPU, against a spec."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from plcgen.cli.live.places import comparison, place, timeout_option
from plcgen.cli.options import PATH, format_option, verb
from plcgen.cli.ppi.connection import ask

if TYPE_CHECKING:
    from plcgen.display.results import Answer
    from plcgen.output.registry import OutputFormat

_SLOTS = {"s7-300": 2, "s7-400": 3, "s7-1200": 1, "s7-1500": 1}
"""Where the CPU usually is; an S7-400 may have it elsewhere."""


@verb("db", "plcgen live db job.yaml --cpu 192.168.0.1", "plcgen live db job.yaml --cpu 192.168.0.1 --slot 4")
@click.argument("spec", type=PATH)
@click.option("--cpu", "host", required=True, metavar="ADDRESS", help="IPv4 address of the CPU, or ADDRESS:PORT.")
@click.option("--rack", type=click.IntRange(0, 7), default=0, show_default=True, metavar="N")
@click.option("--slot", type=click.IntRange(0, 31), metavar="N", help="Slot of the CPU.  [default: by family]")
@timeout_option
@format_option("answer")
def command(*, spec: Path, host: str, rack: int, slot: int | None, timeout: float, format_: OutputFormat) -> int:
    """Compare the data blocks of telegrams that have a number in the spec with those in a CPU.

    Length, constants and start values have to be those of the spec; what the program changes (reference, inputs) is
    shown. Blocks of the job's instance have no number and are not read. S7-1200/1500: PUT/GET must be permitted.
    """

    def question() -> Answer:
        from plcgen.cli.live.specs import drive_plan
        from plcgen.protocols.ds47.live.comparison import compare_blocks
        from plcgen.protocols.ds47.live.connection import S7Connection

        plan = drive_plan(spec)
        where = place(host, "--cpu", rack, _SLOTS[plan.target.family] if slot is None else slot)
        with S7Connection(where, timeout) as reader:
            rows = list(compare_blocks(plan, reader))
        skipped = [] if rows else ["no telegram of the spec has a data block with a number"]
        return comparison("live db", rows, "what", skipped)

    return ask(format_, "live db", (str(spec), host), question)
