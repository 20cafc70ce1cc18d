"""``plcgen catalogue import``: a parameter list of an engineering tool, laid over the catalogue."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from plcgen.base.diagnostics.counting import quantity
from plcgen.cli.options import PATH, console, device_option, force_option, format_option, verb

if TYPE_CHECKING:
    from plcgen.base.display.results import Answer
    from plcgen.ds47.catalogue.merging import Merged
    from plcgen.ds47.catalogue.own_list import Inventory, OwnList
    from plcgen.report.registry import OutputFormat


@verb(
    "import",
    "plcgen catalogue import expert_list.csv --device sinamics-g120",
    "plcgen catalogue import expert_list.csv --device sinamics-g120 --profile pump_drive.yaml",
    "plcgen catalogue import r980.csv --device sinamics-s120",
)
@click.argument("file", type=PATH, metavar="FILE")
@device_option(required=True)
@click.option("--profile", type=PATH, metavar="FILE", help="Write a profile with the result, for device: ./FILE.")
@force_option("Overwrite an existing profile.")
@format_option("answer")
def command(*, file: Path, device: str, profile: Path | None, format_: OutputFormat) -> int:
    """Show what a parameter list (CSV or XLSX of STARTER, SCOUT or Startdrive) says beyond the catalogue.

    The shipped catalogue does not change: --profile writes a profile of your own, in which the facts of the list are
    graded as read and its values as observed.

    For a file with the values of r980 (the parameter numbers that a drive has), it shows which of them are in the
    catalogue.
    """
    from plcgen.ds47.catalogue import lists, merging
    from plcgen.ds47.catalogue.own_list import compare_own_list, read_own_list
    from plcgen.ds47.devices import find_device

    out = console()
    sheets = lists.load_sheets(file)
    own = read_own_list(sheets, file)
    if own is not None:
        if profile is not None:
            raise click.UsageError(f"{file} has only numbers: there is nothing to write into a profile")
        return out.answer(format_, _numbers(own, compare_own_list(find_device(device), own), device))
    result = merging.merge_list(find_device(device), lists.listed(sheets, file), f"parameter list {file.name}")
    if profile is not None and profile.exists() and profile.samefile(file):
        raise click.UsageError(f"{profile} is the list itself: write the profile to another file")
    code = out.answer(format_, _answer(result))
    if profile is not None:
        out.result(merging.profile_text(result.device), profile, fresh=True)
        out.say(f"in a spec beside it: device: ./{profile.name}")
    return code


def _answer(result: Merged) -> Answer:
    from plcgen.base.display.data import head
    from plcgen.base.display.results import Answer
    from plcgen.base.display.table import text_table
    from plcgen.ds47.catalogue.merging import NEW

    header = ("parameter", "fact", "catalogue", "known", "list")
    rows = [(one.parameter, one.fact, one.known, one.grade, one.listed) for one in result.changes]
    new = sum(one.fact == NEW for one in result.changes)
    lines = text_table(header, rows, indent=0) if rows else []
    others = quantity(len(rows) - new, "fact differs or was not read before", "facts differ or were not read before")
    told = f"{quantity(new, 'new parameter')}, {others}"
    text = "\n".join([*lines, *result.skipped, "", told]).lstrip("\n") + "\n"
    data = {
        **head("catalogue import", ok=True),
        "changes": [dict(zip(header, row, strict=True)) for row in rows],
        "skipped": list(result.skipped),
    }
    return Answer(data, lambda _view: text)


def _numbers(own: OwnList, found: Inventory, device: str) -> Answer:
    """Which numbers of a drive the catalogue knows, which not, and which it has that the drive has not."""
    from textwrap import fill

    from plcgen.base.display.data import head
    from plcgen.base.display.results import Answer

    parts = {
        "known": (f"known to {device}", [one.label for one in found.both]),
        "unknown": ("only in the drive", [str(pnu) for pnu in found.drive]),
        "missing": ("only in the catalogue", [one.label for one in found.catalogue]),
    }
    lines = [f"{quantity(len(own.lines), 'parameter')} in the drive"]
    for told, numbers in parts.values():
        lines += ["", f"{told}: {len(numbers)}"]
        lines += [fill(" ".join(numbers), 100, initial_indent="  ", subsequent_indent="  ")] if numbers else []
    if own.continues is not None:
        lines += ["", f"the list continues in r{own.continues}, which is not in the file: read it, too"]
    elif not own.ended:
        lines += ["", "there is no 0 at the end: if the array has more elements, read them, too"]
    data = {key: numbers for key, (_, numbers) in parts.items()}
    shown = {**head("catalogue numbers", ok=True), **data, "continues": own.continues, "ended": own.ended}
    return Answer(shown, lambda _view: "\n".join(lines) + "\n")
