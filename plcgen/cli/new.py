"""``plcgen new``: a commented spec to start from."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from plcgen.cli.completed import devices, toolchains
from plcgen.cli.options import PATH, console, verb
from plcgen.cli.output import OK, PROBLEMS, OutputError, error_line, help_line

if TYPE_CHECKING:
    from plcgen.protocols.ds47.device import Device, Parameter

FAMILIES = ("s7-300", "s7-400", "s7-1200", "s7-1500")

STARTER = """\
# A job spec of plcgen. Check it with    plcgen check {file}
# and make the PLC sources with          plcgen generate {file}
# All keys, for your editor:             plcgen schema

plc:
  name: My station
  family: {family} | {families}
  toolchain: {toolchain} | step7-v5, tia-v13sp1, tia-v14 .. tia-v21
  # names: faq | member names as in Siemens FAQ 109750712; default: style guide
  # languages: [en-US, de-DE] | languages of comments, the first is the main one

drives:
  drive1:
    device: {device} | {title}; others: plcgen schema --devices
    {address} | {address_hint}
    drive_object: {drive_object} | {rule}

jobs:
  read_{read_name}:
    drive: drive1
    read:
      - P{read_pnu} | {read_title}
    # - P1234[0..3] | an array: indexes 0 to 3
    # - {{parameter: P1234, type: Unsigned16}} | a parameter that the catalogue does not know
    # trigger: M50.0 | start by this flag; default: a member of DB DriveJobs

  write_{write_name}:
    drive: drive1
    write:
      P{write_pnu}: | {write_title}; without a value: an input of the block
    # P1234: 10.0 | a constant
    # timeout: 10s | for the whole job, all retries included
"""
_COMMENT = 36
"""Column of the comments."""


@verb(
    "new",
    "plcgen new",
    "plcgen new press.yaml --device sinamics-dcm --family s7-300",
)
@click.argument("path", type=PATH, default="job.yaml", metavar="[PATH]")
@click.option(
    "--device",
    default="sinamics-s120",
    metavar="DEVICE",
    shell_complete=devices,
    help="Device profile.  [default: sinamics-s120]",
)
@click.option("--family", type=click.Choice(FAMILIES), default="s7-1500", help="CPU family.  [default: s7-1500]")
@click.option(
    "--toolchain",
    metavar="TOOL",
    shell_complete=toolchains,
    help="step7-v5 or tia-v13sp1 .. tia-v21.  [default: by family]",
)
@click.option("--force", is_flag=True, help="Overwrite an existing file.")
def command(*, path: Path, device: str, family: str, toolchain: str | None, force: bool) -> int:
    """Write a commented starter spec (job.yaml); PATH - writes to stdout."""
    out = console()
    tool = _toolchain(family, toolchain)
    text = starter(path, _device(device, path.parent), family, tool)
    if path == Path("-"):
        out.result(text)
        return OK
    try:
        with path.open("w" if force else "x", encoding="utf-8", newline="\n") as file:
            file.write(text)
    except FileExistsError:
        error_line(f"{path} exists")
        help_line("choose another name, or overwrite it with --force")
        return PROBLEMS
    except OSError as problem:
        raise OutputError(f"cannot write {path}: {problem.strerror or problem}") from problem
    out.say(f"wrote {path}\nnext: plcgen check {path}")
    return OK


def _toolchain(family: str, given: str | None) -> str:
    from typing import get_args

    from plcgen.diagnostics.suggest import did_you_mean
    from plcgen.project.schema import Toolchain
    from plcgen.project.target import combination_problem

    known = get_args(Toolchain)
    tool = given or "tia-v17"
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
    from plcgen.diagnostics import DiagnosticError, Report, Span
    from plcgen.protocols.ds47.devices import Catalogue

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


def starter(path: Path, device: Device, family: str, toolchain: str) -> str:
    """Return the text of a starter spec that passes every check."""
    read, write = _examples(device)
    classic = family in {"s7-300", "s7-400"}
    hint = "logical address, see the hardware configuration" if classic else "hardware identifier, see the tag table"
    file = "job.yaml" if path == Path("-") else path.name
    text = STARTER.format(
        file=file,
        family=family,
        families=", ".join(FAMILIES),
        toolchain=toolchain,
        device=device.key,
        title=device.title,
        address="address: 256" if classic else "hardware_id: 270",
        address_hint=hint,
        drive_object=device.drive_object,
        rule=device.drive_object_rule,
        read_name=read.name or f"p{read.pnu}",
        read_pnu=read.pnu,
        read_title=read.title,
        write_name=write.name or f"p{write.pnu}",
        write_pnu=write.pnu,
        write_title=write.title,
    )
    return "".join(_aligned(line) for line in text.splitlines())


def _aligned(line: str) -> str:
    body, bar, comment = line.partition(" | ")
    return f"{body:<{_COMMENT - 1}} # {comment}\n" if bar else f"{line}\n"


_FAMILIAR = (1120, 1121, 50303, 50304)
"""Ramp times: everybody knows what they do."""


def _examples(device: Device) -> tuple[Parameter, Parameter]:
    """One parameter to read and one to write: harmless, single value, of a known type, preferably a ramp time."""
    known = sorted((p for p in device.parameters.values() if p.type), key=lambda p: p.pnu)
    harmless = [p for p in known if not device.danger(p.pnu) and not p.bico and p.pnu not in device.bases]
    writable = [p for p in harmless if "w" in p.access]
    sure = [p for p in writable if p.grades.get("type") != "recalled"]
    best = [p for p in sure if p.pnu in _FAMILIAR] or [p for p in sure if p.name] or writable or known
    return best[0], best[min(1, len(best) - 1)]
