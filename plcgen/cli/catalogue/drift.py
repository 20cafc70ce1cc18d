"""``plcgen catalogue drift``: the parameter list of a drive, against what a spec does with it."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from plcgen.cli.options import PATH, console, format_option, verb

if TYPE_CHECKING:
    from plcgen.report.registry import OutputFormat


@verb(
    "drift",
    "plcgen catalogue drift expert_list.csv job.yaml",
    "plcgen catalogue drift fan01.xlsx line.yaml --drive fan01",
)
@click.argument("file", type=PATH, metavar="LIST")
@click.argument("spec", type=PATH)
@click.option("--drive", metavar="NAME", help="Drive of the spec that the list belongs to.  [default: the only one]")
@format_option("answer")
def command(*, file: Path, spec: Path, drive: str | None, format_: OutputFormat) -> int:
    """Compare the parameter list of a drive (CSV or XLSX) with the jobs of a spec.

    A constant must have the same value in the drive and be within its limits, and every parameter that is read or
    written must exist. Exit code 1 if something has drifted.
    """
    from plcgen.base.diagnostics import Diagnostic, Span
    from plcgen.base.display.data import diagnostics_data
    from plcgen.base.display.results import Answer
    from plcgen.base.display.table import text_table
    from plcgen.cli.live.specs import choose_drive, drive_plan
    from plcgen.ds47.catalogue import lists
    from plcgen.ds47.catalogue.drift import DRIFTED, UNREADABLE
    from plcgen.ds47.catalogue.drift import drift as drifted
    from plcgen.ds47.catalogue.own_list import LISTS, read_own_list

    plan = drive_plan(spec)
    key = choose_drive(plan, drive, "name the one that the list belongs to with --drive")
    sheets = lists.load_sheets(file)
    own = read_own_list(sheets, file)
    if own is not None and not own.ended:
        where = "after the last number of the file" if own.continues is None else f"in r{own.continues}"
        message = f"the list continues {where}: the 0 that ends it is missing"
        raise lists.wrong(file, message, "read the whole list: what is missing from the file might be there")
    listed = lists.ParameterList(own.parameters()) if own is not None else lists.listed(sheets, file)
    silent = LISTS if own is not None else ()
    rows = list(dict.fromkeys(drifted(plan, key, {one.pnu: one for one in listed.parameters}, silent)))
    problems = []
    for row in rows:
        if row.verdict in DRIFTED:
            than = "wanted is" if row.verdict == UNREADABLE else "not"
            why = f": {row.listed}, {than} {row.wanted}" if row.wanted and row.listed else ""
            problems.append(Diagnostic("PG707", f"{row.parameter} of {row.job}: {row.verdict}{why}", Span(str(file))))
    header = ("parameter", "job", "wanted", "list", "verdict")
    cells = [(row.parameter, row.job, row.wanted, row.listed, row.verdict) for row in rows]
    text = "\n".join([*text_table(header, cells, indent=0), *listed.skipped]) + "\n"
    data = [dict(zip(header, row, strict=True)) for row in cells]
    shown = {**diagnostics_data("catalogue drift", problems), "rows": data, "skipped": list(listed.skipped)}
    return console().answer(format_, Answer(shown, lambda _view: text, problems))
