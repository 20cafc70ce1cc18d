"""``plcgen simulate``: watch the generated blocks run."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from plcgen.api import default_folder
from plcgen.cli.options import PATH, console, folder_option, format_option, output_option, verb
from plcgen.cli.output import OK, PROBLEMS, USAGE, Console

if TYPE_CHECKING:
    from plcgen.report.registry import OutputFormat
    from plcgen.report.trace.model import Trace

_MAX_SCANS = 10_000_000


@verb(
    "simulate",
    "plcgen simulate job.yaml",
    "plcgen simulate job.yaml --job read_speed --fault busy:times=2",
    "plcgen simulate job.yaml --set setRamps.rampUpTime=5.0 --fault error:number=2",
    "plcgen simulate job.yaml --with my_main.scl --watch MyData.step",
    "plcgen simulate job.yaml --format vcd --output run.vcd",
)
@click.argument("spec", type=PATH)
@folder_option("Generated folder")
@click.option("--job", "jobs", multiple=True, metavar="NAME", help="Start this job only; may be repeated.")
@click.option(
    "--scans", type=click.IntRange(1, _MAX_SCANS), metavar="N", help="End after N scans.  [default: all jobs ended]"
)
@click.option("--scan-time", default="10ms", metavar="TIME", help="Length of a scan.  [default: 10ms]")
@click.option("--set", "sets", multiple=True, metavar="MEMBER=VALUE[@SCAN]", help="Give a member or tag a value.")
@click.option("--inputs", type=PATH, metavar="FILE", help="Values from a file, one MEMBER=VALUE@SCAN a line.")
@click.option(
    "--watch",
    "watches",
    multiple=True,
    metavar="MEMBER",
    help="Record and show a member or tag; '*' records every member of every data block.",
)
@click.option("--fault", "faults", multiple=True, metavar="KIND[:KEY=VALUE,...]", help="Inject a fault at a partner.")
@click.option("--faults", "fault_file", type=PATH, metavar="FILE", help="Faults from a YAML file.")
@click.option("--drive", "drives", multiple=True, metavar="[DRIVE=]FILE", help="Drive or station file.")
@click.option("--with", "own", type=PATH, multiple=True, metavar="FILE", help="Run this SCL, UDT or DB source too.")
@format_option("trace")
@output_option()
def command(*, spec: Path, folder: Path | None, format_: OutputFormat, output: Path | None, **more: Any) -> int:
    """Run the files in a generated folder in a simulated CPU against simulated drives and stations, scan by scan.

    Every scan in which something changes is shown: states of the jobs, calls of system blocks, telegrams decoded,
    values. A cyclic OB among the files of --with runs instead of the generated example. Exit code 1 if a job
    ends in error or the program misuses a system block.
    """
    from plcgen import api

    out = console()
    with out.progress() as progress:
        trace = api.simulate(spec, folder or default_folder(spec), progress=progress, **more)
    if any(diagnostic.code == "PG901" for diagnostic in trace.diagnostics):
        out.complain(trace.diagnostics)
        return USAGE
    _show(out, trace, format_, output)
    return OK if trace.ok else PROBLEMS


def _show(out: Console, trace: Trace, format_: OutputFormat, output: Path | None) -> None:
    """Deliver the result; what is wrong with it goes to stderr unless the format holds it."""
    if not trace.scans and not format_.complete:
        out.complain(trace.diagnostics)
        return
    out.show(format_, "trace", trace, output)
    if not format_.complete and format_.name != "text":
        from plcgen.report.trace.text import run_summary

        out.complain(trace.diagnostics)
        out.say(run_summary(trace))
