"""``plcgen generate``: from a spec to a folder of PLC sources."""

from __future__ import annotations

import dataclasses
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from plcgen.api import default_folder
from plcgen.base.diagnostics.counting import quantity
from plcgen.cli.options import PATH, console, folder_option, format_option, verb
from plcgen.cli.output import OK, PROBLEMS, Console, error_detail, error_line, help_line
from plcgen.cli.watch import watch_option

if TYPE_CHECKING:
    from plcgen.api import GenerateResult
    from plcgen.base.diagnostics import Diagnostic
    from plcgen.report.registry import OutputFormat


@verb(
    "generate",
    "plcgen generate job.yaml",
    "plcgen generate job.yaml --out plc/drives",
    "plcgen generate machines/ --check",
)
@click.argument("paths", nargs=-1, type=PATH, metavar="SPEC|FOLDER...")
@folder_option("Output folder")
@click.option("--check", "check_only", is_flag=True, help="Write nothing; exit 1 if the folder is not up to date.")
@click.option("--diff", is_flag=True, help="Show what would change as a unified diff; write nothing.")
@click.option("--force", is_flag=True, help="Overwrite files that were changed by hand.")
@click.option("--stats", is_flag=True, help="Run an idle scan in the simulated CPU and count its statements.")
@format_option("findings")
@watch_option(generated=False)
def command(
    *,
    paths: tuple[Path, ...],
    folder: Path | None,
    check_only: bool,
    diff: bool,
    force: bool,
    stats: bool,
    format_: OutputFormat,
) -> int:
    """Generate the PLC sources of specs, each into a folder of its own; a folder stands for the specs below it.

    The folder of a spec is replaced as a whole or not at all. Files that you changed by hand are never overwritten
    without --force. With --check the folder is compared, the diff printed, and the exit code is 1 if it is out
    of date: commit the folder and run this in CI. --diff prints the same diff, with exit code 0.
    """
    from plcgen import api
    from plcgen.base.diagnostics import has_errors
    from plcgen.cli.specs import find_specs, one_folder
    from plcgen.project.together import same_plc

    out = console()
    specs = find_specs(paths, out)
    one_folder(specs, folder)
    together = same_plc(specs)
    results = []
    for spec in specs:
        target = folder or default_folder(spec)
        looking = check_only or diff
        with out.progress() as progress:
            result = (
                api.GenerateResult(spec, target, (), (), (), "", ())
                if has_errors(together.get(spec, ()))
                else api.generate(spec, target, check_only=looking, force=force, stats=stats, progress=progress)
            )
        result = dataclasses.replace(
            result, diagnostics=tuple(dict.fromkeys((*result.diagnostics, *together.get(spec, ()))))
        )
        if diff and not check_only:
            found = tuple(d for d in result.diagnostics if d.code != STALE)
            result = dataclasses.replace(result, diagnostics=found)
        if format_.name == "text":
            _show(out, result, looking=looking, stats=stats)
        results.append(result)
    if format_.name != "text":
        _machine(out, results, format_)
    return OK if all(result.ok for result in results) else PROBLEMS


STALE = "PG504"
"""What ``--check`` calls an error and ``--diff`` does not: a file that differs from what would be generated."""


def _show(out: Console, result: GenerateResult, *, looking: bool, stats: bool) -> None:
    from plcgen.base.display.excerpts import count_text
    from plcgen.base.display.paint import paint_diff

    out.complain([d for d in result.diagnostics if d.code != STALE])
    stale = [d for d in result.diagnostics if d.code == STALE]
    if stale:
        _stale(result, stale)
    if result.diff:
        out.result(paint_diff(result.diff, color=out.view().color))
    if stale:
        return
    if looking and all(d.code == STALE for d in result.diagnostics if d.severity.label == "error"):
        out.say(f"{result.folder} is {'not up to date' if result.diff else 'up to date'}")
    elif not result.ok:
        out.say(f"{result.folder}: {count_text(result.diagnostics)}; nothing was written")
    else:
        count = len(result.written)
        parts = [f"{quantity(count, 'file')} written"] if count else []
        parts += [f"{len(result.unchanged)} unchanged"] if result.unchanged else []
        parts += [f"{len(result.removed)} removed"] if result.removed else []
        out.say(f"{result.folder}: {', '.join(parts) or 'nothing to do'}")
        size = None if out.quiet else result.size()
        if size is not None:
            out.say(size.text())
        if stats and result.idle_statements is None:
            out.say("an idle scan could not be run: plcgen verify tells you why")


def _stale(result: GenerateResult, stale: list[Diagnostic]) -> None:
    """Say once what is stale, then name the files; what differs is in the diff."""
    files, differ = ("file", "differs") if len(stale) == 1 else ("files", "differ")
    error_line(f"{len(stale)} {files} of {result.folder} {differ} from the spec", STALE)
    for diagnostic in stale:
        path = Path(diagnostic.span.file)
        name = path.relative_to(result.folder) if path.is_relative_to(result.folder) else path
        error_detail(f"{name.as_posix()}: {diagnostic.message}")
    help_line(f"plcgen generate {result.spec}")


def _machine(out: Console, results: list[GenerateResult], format_: OutputFormat) -> None:
    """One spec has its keys at the top, several have theirs in a list."""
    from plcgen.base.display.results import Findings

    specs = [result.spec.as_posix() for result in results]
    parts = [_data(result) for result in results]
    more = {"specs": specs, **(parts[0] if len(parts) == 1 else {"projects": parts})}
    subjects = [(spec, result.diagnostics) for spec, result in zip(specs, results, strict=True)]
    out.show(format_, "findings", Findings("generate", subjects, more))


def _data(result: GenerateResult) -> dict[str, Any]:
    size = result.size() if result.ok else None
    return {
        "folder": result.folder.as_posix(),
        "written": list(result.written),
        "unchanged": list(result.unchanged),
        "removed": list(result.removed),
        "diff": result.diff,
        "size": None if size is None else size.data(),
    }
