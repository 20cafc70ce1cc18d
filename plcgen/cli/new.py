"""``plcgen new``: a commented spec to start from."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from plcgen.cli.completed import toolchains
from plcgen.cli.options import PATH, console, device_option, force_option, verb
from plcgen.cli.output import OK
from plcgen.s7.types.system import FAMILIES
from plcgen.workbench.starter import FAQ_DEVICE, FAQ_FAMILY, KINDS, RECIPES, faq_starter, ppi_starter, starter, usable

if TYPE_CHECKING:
    from plcgen.ds47.device import Device


@verb(
    "new",
    "plcgen new",
    "plcgen new press.yaml --device sinamics-dcm --family s7-300",
    "plcgen new fan.yaml --device sinamics-g120 --job actual-values --job faults",
    "plcgen new dcm.yaml --faq",
    "plcgen new line.yaml --ppi --family s7-1200",
)
@click.argument("path", type=PATH, default="job.yaml", metavar="[PATH]")
@device_option("Device profile.  [default: sinamics-s120; sinamics-dcm with --faq]")
@click.option("--family", type=click.Choice(FAMILIES), help="CPU family.  [default: s7-1500; s7-300 with --faq]")
@click.option(
    "--toolchain",
    metavar="TOOL",
    shell_complete=toolchains,
    help="step7-v5 or tia-v13sp1 .. tia-v21.  [default: by family]",
)
@click.option(
    "--job",
    "jobs",
    multiple=True,
    type=click.Choice((*RECIPES, *KINDS)),
    metavar="JOB",
    help=f"A job to start with (repeatable): {', '.join((*RECIPES, *KINDS))}.  "
    "[default: the first three, if the device is known to have them]",
)
@click.option("--faq", is_flag=True, help="The project of Siemens FAQ 109750712, or of another device in its form.")
@click.option("--ppi", is_flag=True, help="A PPI master of S7-200 stations instead of drives.")
@force_option("Overwrite an existing file.")
def command(
    *,
    path: Path,
    device: str | None,
    family: str | None,
    toolchain: str | None,
    jobs: tuple[str, ...],
    faq: bool,
    ppi: bool,
) -> int:
    """Write a commented starter spec (job.yaml); PATH - writes to stdout.

    It begins with reading actual values, setting ramps and reading the fault buffer.
    """
    out = console()
    if faq and (jobs or ppi):
        raise click.UsageError("--faq has the jobs of the FAQ: leave --job and --ppi out")
    device = device or (FAQ_DEVICE if faq else "sinamics-s120")
    family = family or (FAQ_FAMILY if faq else "s7-1500")
    tool, name = _toolchain(family, toolchain), "job.yaml" if path == Path("-") else path.name
    if ppi:
        text = ppi_starter(name, family, tool)
    else:
        profile = _device(device, path.parent)
        known = usable(profile)
        for job in jobs:
            if job not in known and job not in KINDS:
                offered = f"available: {', '.join(known)}" if known else "no job is available"
                raise click.UsageError(f"the catalogue of {device} does not confirm what --job {job} needs; {offered}")
        text = faq_starter(name, profile, family, tool) if faq else starter(name, profile, family, tool, jobs)
        if faq or set(jobs) & set(KINDS):
            _hold(text, device)
    if path == Path("-"):
        out.result(text)
        return OK
    out.result(text, path, fresh=True)
    out.say(f"next: plcgen check {path}")
    return OK


def _hold(text: str, device: str) -> None:
    """Refuse a job that the device cannot have: ``check`` would."""
    import tempfile

    from plcgen import api

    with tempfile.TemporaryDirectory(prefix="plcgen-new-") as room:
        spec = Path(room) / "job.yaml"
        spec.write_text(text, "utf-8")
        wrong = [one for one in api.check(spec).diagnostics if one.severity.label == "error"]
    if wrong:
        raise click.UsageError(f"{device} cannot have such a job: {wrong[0].message}")


def _toolchain(family: str, given: str | None) -> str:
    from typing import get_args

    from plcgen.base.diagnostics.suggest import did_you_mean
    from plcgen.project.schema import Toolchain
    from plcgen.project.target import combination_problem, toolchain_id

    known = get_args(Toolchain)
    tool = toolchain_id(given or "tia-v17")
    if tool not in known:
        hint = did_you_mean(tool, known)
        message = f'unknown toolchain "{tool}"{f", {hint}" if hint else ""}; known: {", ".join(known)}'
        raise click.UsageError(message)
    problem = combination_problem(family, tool)
    if problem:
        raise click.UsageError(problem)
    return tool


def _device(key: str, folder: Path) -> Device:
    """The device of a new spec in ``folder``, as that spec will find it."""
    from plcgen.base.diagnostics import DiagnosticError, Report, Span
    from plcgen.ds47.devices import Catalogue

    report = Report()
    found = Catalogue(folder).find(key, Span("--device"), report)
    if found is None:
        told = report.sorted()[0]
        if told.span.line:
            raise DiagnosticError(report)
        raise click.UsageError(f"{told.message}, {told.help}")
    if not found.parameters:
        raise click.UsageError(f"the profile {key} has no parameters to start from")
    return found
