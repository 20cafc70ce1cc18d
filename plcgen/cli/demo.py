"""``plcgen demo``: the shipped examples, from spec to verdict."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from plcgen.api import default_folder
from plcgen.base.diagnostics.counting import quantity
from plcgen.base.replacing import replace_file
from plcgen.cli.options import PATH, console, faults_option, verb
from plcgen.cli.output import OK, PROBLEMS, Console, OutputError
from plcgen.proof.effort import Faults

if TYPE_CHECKING:
    from plcgen.api import GenerateResult
    from plcgen.proof.checks import Verification

_NAME = 26
"""Longest name of a shipped spec, in characters."""


@verb(
    "demo",
    "plcgen demo",
    "plcgen demo /tmp/plcgen",
)
@click.argument("folder", type=PATH, default="plcgen-demo", metavar="[DIR]")
@faults_option(None, "quick for small specs, none for others")
def command(*, folder: Path, faults: Faults | None) -> int:
    """Copy the shipped specs to DIR (plcgen-demo), generate their blocks and verify them, one line per spec.

    Specs that you changed in DIR are kept and used; nothing outside DIR is touched.
    """
    out = console()
    specs = _copy(out, folder)
    good = [_one(out, spec, faults) for spec in specs]
    out.result(f"\n{sum(good)} of {len(good)} specs generated and verified without an error\n")
    out.say(f"the whole report of one: plcgen verify {specs[0]}")
    out.say(f"look around in {folder}; change a spec there and run plcgen demo {folder} again")
    return OK if all(good) else PROBLEMS


def _copy(out: Console, folder: Path) -> list[Path]:
    """Copy the specs that are not there yet."""
    from plcgen.base.resources import specs_dir

    folder.mkdir(parents=True, exist_ok=True)
    copies: list[Path] = []
    copied = 0
    for source in sorted(specs_dir().glob("*.yaml")):
        target = folder / source.name
        data = source.read_bytes()
        if not target.exists():
            try:
                replace_file(target, data, None)
            except OSError as problem:
                raise OutputError(f"cannot write {target}: {problem.strerror or problem}") from problem
            copied += 1
        elif target.read_bytes() != data:
            out.say(f"kept {target}: it differs from the shipped one")
        copies.append(target)
    if copied:
        out.say(f"{quantity(copied, 'spec')} copied to {folder}")
    return copies


def _one(out: Console, spec: Path, faults: Faults | None) -> bool:
    """Generate and verify one spec and tell it in a line; True if all is well."""
    from plcgen import api
    from plcgen.report.formats import text

    with out.progress() as progress:
        made = api.generate(spec, default_folder(spec), progress=progress)
    out.complain([d for d in made.diagnostics if d.severity.label != "note"])
    if not made.ok or made.target is None:
        out.result(f"{spec.stem:<{_NAME}}  error: nothing was generated\n")
        return False
    runs = faults or ("quick" if _small(spec) else "none")
    with out.progress() as progress:
        result = api.verify(spec, made.folder, faults=runs, progress=progress)
    out.result(_line(spec, made, result, runs))
    if not result.ok:
        out.verification(text.FORMAT, result)
    return result.ok


def _line(spec: Path, made: GenerateResult, result: Verification, runs: str) -> str:
    checks = list(result.checks())
    bad = sum(check.outcome.value == "error" for check in checks)
    good = sum(check.outcome.value == "ok" for check in checks)
    files = len(made.written) + len(made.unchanged)
    verdict = f"{good} checks ok" if result.ok else f"{bad} of {len(checks)} checks failed"
    rest = "" if runs != "none" else "; without faults"
    target = f"{made.target.family}, {made.target.toolchain}" if made.target else ""
    return f"{spec.stem:<{_NAME}}  {target:<19}  {files:>3} files  {verdict}{rest}\n"


def _small(spec: Path) -> bool:
    """Whether faults take a second or two, not ten: a single drive, and jobs of one telegram."""
    from plcgen.project.opening import open_spec

    project = open_spec(spec).project
    if project is None or len(project.loaded.root.find(["drives"]).pairs) != 1:
        return False
    return all(len(job.telegrams) == 1 for job in project.jobs)
