"""``plcgen live compare``: what a spec writes, against real drives."""

from __future__ import annotations

from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from plcgen.cli.live.places import (
    comparison,
    drive_option,
    object_number,
    object_options,
    open_channel,
    open_drive,
    read_address,
    read_station,
    timeout_option,
)
from plcgen.cli.live.specs import choose_drive, drive_plan
from plcgen.cli.options import PATH, device_option, format_option, verb
from plcgen.cli.ppi.connection import ask

if TYPE_CHECKING:
    from plcgen.base.display.results import Answer
    from plcgen.ds47.plan.nouns import DrivePlan
    from plcgen.report.registry import OutputFormat

_LISTS = {".csv", ".xlsx", ".txt"}


@verb(
    "compare",
    "plcgen live compare job.yaml --drive 192.168.0.5",
    "plcgen live compare line.yaml --drive fan01=192.168.0.5 --drive fan02=pn://192.168.0.6",
    "plcgen live compare backup.csv --port pn://192.168.0.5 --device sinamics-s120",
)
@click.argument("file", type=PATH, metavar="SPEC|LIST")
@drive_option(several=True)
@device_option("Device profile, for a list; a spec names its own.")
@object_options
@timeout_option
@format_option("answer")
def command(*, file: Path, given: tuple[str, ...], timeout: float, format_: OutputFormat, **more: Any) -> int:
    """Compare drives with the values that the jobs of a spec write, or one drive with a list of its parameters.

    A constant of a spec must have the same value in the drive; for an input, the value is shown. Drives without an
    address are skipped and listed. A list is one of live backup, STARTER, SCOUT or Startdrive (CSV, XLSX): every value
    that can be adjusted must be in the drive. Its address begins with pn://; --device and --do are for lists.
    Exit code 1 if something deviates or could not be read.
    """

    def question() -> Answer:
        if file.suffix.lower() in _LISTS:
            return _list(file, given, timeout, **more)
        if any(value is not None for value in more.values()):
            raise click.UsageError("--device and --do are for a list: a spec names its own")
        from plcgen.ds47.live.comparison import compare_drives

        plan = drive_plan(file)
        places = {key: read_address(host) for key, host in _by_drive(plan, given).items()}
        devices = {drive.key: drive.device for drive in plan.drives}
        with ExitStack() as open_:
            readers = {
                key: open_.enter_context(open_drive(where, timeout, devices[key])) for key, where in places.items()
            }
            rows = list(compare_drives(plan, readers))
        skipped = [drive.key for drive in plan.drives if drive.key not in places]
        return comparison("live compare", rows, "job", skipped)

    return ask(format_, "live compare", (str(file), *given), question)


def _list(file: Path, given: tuple[str, ...], timeout: float, *, device: str | None, number: int | None) -> Answer:
    """A list against one drive."""
    from plcgen.ds47.catalogue.lists import load_list
    from plcgen.ds47.devices import find_device
    from plcgen.ds47.live.backup import compare_list

    if len(given) != 1:
        raise click.UsageError("a list belongs to one drive: give one address")
    if device is None:
        raise click.UsageError("a list does not say of which device it is: name it with --device")
    where, known, listed = read_station(given[0]), find_device(device), load_list(file)
    with open_channel(where, timeout, known) as channel:
        rows = list(compare_list(channel, listed.parameters, file.name, known, object_number(number, known)))
    return comparison("live compare", rows, "list", listed.skipped)


def _by_drive(plan: DrivePlan, given: tuple[str, ...]) -> dict[str, str]:
    """Addresses by the key of the drive; one without a key if the spec has one drive."""
    found: dict[str, str] = {}
    for text in given:
        key, equals, host = text.rpartition("=")
        remedy = f"write --drive {plan.drives[0].key}={text}"
        found[choose_drive(plan, key if equals else None, remedy)] = host
    return found
