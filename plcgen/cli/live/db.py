"""``plcgen live db``: data blocks in a real CPU, against a spec."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from plcgen.cli.live.places import comparison, read_partner, timeout_option
from plcgen.cli.options import PATH, format_option, verb
from plcgen.cli.ppi.connection import ask

if TYPE_CHECKING:
    from plcgen.base.display.results import Answer
    from plcgen.report.registry import OutputFormat

_SLOTS = {"s7-300": 2, "s7-400": 3, "s7-1200": 1, "s7-1500": 1}
"""Where the CPU usually is; an S7-400 may have it elsewhere."""


@verb("db", "plcgen live db job.yaml --cpu 192.168.0.1", "plcgen live db job.yaml --cpu 192.168.0.1 --slot 4")
@click.argument("spec", type=PATH)
@click.option("--cpu", "host", required=True, metavar="ADDRESS", help="IPv4 address of the CPU, or ADDRESS:PORT.")
@click.option("--rack", type=click.IntRange(0, 7), default=0, show_default=True, metavar="N")
@click.option("--slot", type=click.IntRange(0, 31), metavar="N", help="Slot of the CPU.  [default: by family]")
@click.option(
    "--all", "every", is_flag=True, help="Include blocks whose number the spec does not give (default for V5)."
)
@timeout_option
@format_option("answer")
def command(
    *, spec: Path, host: str, rack: int, slot: int | None, every: bool, timeout: float, format_: OutputFormat
) -> int:
    """Compare the data blocks of a spec with those in a CPU.

    For telegrams that have a number in the spec, length, constants and start values must be those of the spec; what
    the program changes (reference, inputs) is only shown. For commands, units and recipes, the length counts. Their
    numbers are those of the symbol table (STEP 7 V5) or of the XML documents; where sources were compiled in the TIA
    Portal, they may differ, so --all is needed to include them. S7-1200/1500: PUT/GET must be permitted.
    """

    def question() -> Answer:
        from plcgen.cli.live.specs import drive_project
        from plcgen.ds47.live.comparison import compare_buffers
        from plcgen.ds47.live.connection import S7Connection
        from plcgen.ds47.live.stored import compare_stored, stored

        project, plan = drive_project(spec)
        numbered = every or plan.target.v5
        if not numbered and not any(job.pinned for job in plan.jobs):
            raise click.UsageError("no data block of the spec has a number of its own: --all asks for the others")
        where = read_partner(host, "--cpu", rack, _SLOTS[plan.target.family] if slot is None else slot)
        with S7Connection(where, timeout) as reader:
            rows = list(compare_buffers(plan, reader))
            rows += compare_stored(project, plan, reader) if numbered else ()
        skipped = [] if numbered else [f'"{block.name}" (--all asks)' for block in stored(plan)]
        return comparison("live db", rows, "what", skipped)

    return ask(format_, "live db", (str(spec), host), question)
