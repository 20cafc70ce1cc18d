"""``plcgen live compare``: what a spec writes, against real drives."""

from __future__ import annotations

from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING

import click

from plcgen.cli.live.places import comparison, read_partner, timeout_option
from plcgen.cli.live.specs import choose_drive, drive_plan
from plcgen.cli.options import PATH, format_option, verb
from plcgen.cli.ppi.connection import ask

if TYPE_CHECKING:
    from plcgen.base.display.results import Answer
    from plcgen.ds47.plan.nouns import DrivePlan
    from plcgen.report.registry import OutputFormat


@verb(
    "compare",
    "plcgen live compare job.yaml --drive 192.168.0.5",
    "plcgen live compare line.yaml --drive fan01=192.168.0.5 --drive fan02=192.168.0.6",
)
@click.argument("spec", type=PATH)
@click.option("--drive", "given", multiple=True, required=True, metavar="[DRIVE=]ADDRESS", help="Where a drive is.")
@timeout_option
@format_option("answer")
def command(*, spec: Path, given: tuple[str, ...], timeout: float, format_: OutputFormat) -> int:
    """Compare the values that the jobs of a spec write with what is in the drives.

    A constant must have the same value in the drive; for an input, the value is shown. Drives without an address are
    skipped and listed.
    Exit code 1 if something deviates or could not be read.
    """

    def question() -> Answer:
        from plcgen.ds47.live.comparison import compare_drives
        from plcgen.ds47.live.connection import S7Connection

        plan = drive_plan(spec)
        places = {key: read_partner(host, "--drive") for key, host in _by_drive(plan, given).items()}
        with ExitStack() as open_:
            readers = {key: open_.enter_context(S7Connection(where, timeout)) for key, where in places.items()}
            rows = list(compare_drives(plan, readers))
        skipped = [drive.key for drive in plan.drives if drive.key not in places]
        return comparison("live compare", rows, "job", skipped)

    return ask(format_, "live compare", (str(spec), *given), question)


def _by_drive(plan: DrivePlan, given: tuple[str, ...]) -> dict[str, str]:
    """Addresses by the key of the drive; one without a key if the spec has one drive."""
    found: dict[str, str] = {}
    for text in given:
        key, equals, host = text.rpartition("=")
        remedy = f"write --drive {plan.drives[0].key}={text}"
        found[choose_drive(plan, key if equals else None, remedy)] = host
    return found
