"""The group of verbs: static help, verbs imported when called, one place that turns every end into an exit code."""

from __future__ import annotations

import errno
import os
import sys
from collections.abc import Sequence
from pathlib import Path

import click

from plcgen._version import __version__
from plcgen.base.interrupts import EndedError, unwinding
from plcgen.cli import output
from plcgen.cli.groups import Sections, VerbGroup

SECTIONS: Sections = (
    (
        "Write a job",
        (
            ("new", "Write a commented starter spec."),
            ("check", "Check specs and show every problem at its place."),
            ("serve", "Open the workbench, a page in the browser for all of it."),
            ("devices", "List the devices that a spec may name."),
            ("schema", "Print the JSON schema of a spec."),
            ("lsp", "Serve an editor: problems, completion, hover."),
        ),
    ),
    (
        "Make the blocks",
        (
            ("generate", "Generate the PLC sources of a spec."),
            ("layout", "Show where every byte of the data blocks lies."),
            ("verify", "Run the generated files against a simulated drive."),
            ("simulate", "Watch the jobs run scan by scan."),
            ("texts", "Write text lists of status words and errors for an HMI."),
            ("convert", "Turn SCL sources into SimaticML and back."),
        ),
    ),
    (
        "Review and guard",
        (
            ("review", "Put everything that a reviewer must see on one page."),
            ("diff", "Compare two versions of sources or specs as HMIs, PLCs and drives see them."),
            ("lock", "Write a layout lock file, or check that nothing has moved."),
            ("audit", "Audit hand-written request and response DBs against a spec."),
        ),
    ),
    (
        "Read telegrams and codes",
        (
            ("encode", "Print the request telegrams of a spec or of one parameter."),
            ("decode", "Explain telegrams and STATUS values byte by byte."),
            ("explain", "Explain a diagnostic code, error number or status word."),
            ("docs", "Show a page of the documentation."),
            ("catalogue", "Show what is known about drive parameters."),
        ),
    ),
    (
        "Talk to devices",
        (
            ("live", "Read from drives and CPUs, and compare with a spec."),
            ("ppi", "Read, write, simulate and decode over PPI (S7-200)."),
        ),
    ),
    (
        "Get to know it",
        (
            ("demo", "Generate and verify the shipped examples."),
            ("completion", "Print the completion script of a shell."),
        ),
    ),
)
_REPORT = "please report this with the command and the spec: it is a bug in plcgen, not in your input"


def _hint(name: str) -> str:
    """Return what a word that is no verb was probably meant as, besides a misspelt verb."""
    if name in {"help", "version"}:
        return f": it is an option, plcgen --{name}"
    if name in {"device", "devices"}:
        return ": plcgen devices lists them"
    if name.lower().endswith((".yaml", ".yml")) or Path(name).is_file():
        return f": a verb comes first, for example plcgen check {name}"
    return ""


cli = VerbGroup(
    "plcgen",
    help="Generate and verify S7 blocks that talk to drives (PROFIdrive data set 47) and S7-200 stations (PPI).",
    sections=SECTIONS,
    package="plcgen.cli",
    hint=_hint,
    examples=(
        "plcgen new job.yaml             a commented spec to start from",
        "plcgen check job.yaml           every problem, with line and remedy",
        "plcgen generate job.yaml        SCL, data blocks, tags, texts",
        "plcgen verify job.yaml          run them against a simulated drive",
    ),
)
click.version_option(__version__, "-V", "--version", message="plcgen %(version)s")(cli)


def run(args: Sequence[str] | None = None) -> int:
    """Run the command line; every way it can end becomes an exit code here and nowhere else."""
    output.prepare_streams()
    if os.environ.get("_PLCGEN_COMPLETE", "").startswith("powershell"):
        from plcgen.cli.powershell import register

        register()
    os.environ.setdefault("PYDANTIC_DISABLE_PLUGINS", "__all__")  # saves the search for plugins we do not use
    try:
        with unwinding():
            code = cli.main(args=None if args is None else list(args), prog_name="plcgen", standalone_mode=False)
    except click.UsageError as problem:
        return _usage(problem)
    except click.ClickException as problem:
        output.error_line(problem.format_message())
        return output.PROBLEMS
    except (click.Abort, KeyboardInterrupt):
        output.error_line("interrupted")
        return output.INTERRUPTED
    except (output.ClosedOutputError, BrokenPipeError):
        output.abandon_stdout()
        return output.CLOSED
    except output.OutputError as problem:
        output.error_line(str(problem))
        output.abandon_stdout()
        return output.PROBLEMS
    except SystemExit as end:
        return _system_exit(end)
    except Exception as problem:  # noqa: BLE001 - the outermost frame: told apart, reported, ended
        return _unexpected(problem)
    return code if isinstance(code, int) else output.OK


def _system_exit(end: SystemExit) -> int:
    """Click leaves this way after a broken pipe of its own (help) and after shell completion, and so does a signal."""
    output.abandon_stdout()
    if isinstance(end, EndedError):
        output.error_line(f"ended by {end}")
    return end.code if isinstance(end.code, int) else output.OK


def _usage(problem: click.UsageError) -> int:
    message = problem.format_message()
    output.error_line(message[:1].lower() + message[1:], "PG901")
    if problem.ctx is not None:
        output.help_line(f"{problem.ctx.command_path} -h")
    return output.USAGE


def _unexpected(problem: Exception) -> int:
    """Tell a user's problem (diagnostics, files) from a bug."""
    from plcgen.base.diagnostics import DiagnosticError, PluginError

    if isinstance(problem, DiagnosticError):
        output.Console().complain(problem.diagnostics)
        return output.PROBLEMS
    if isinstance(problem, PluginError):
        output.error_line(str(problem))
        return output.PROBLEMS
    if os.environ.get("PLCGEN_DEBUG") == "1":
        import traceback

        traceback.print_exception(problem)
    if isinstance(problem, OSError) and problem.filename is not None:
        output.error_line(f"{problem.filename}: {problem.strerror or problem}")
        return output.PROBLEMS
    if isinstance(problem, OSError) and problem.errno in {errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EIO}:
        output.error_line(f"cannot write: {problem.strerror}")
        output.abandon_stdout()
        return output.PROBLEMS
    if isinstance(problem, MemoryError):
        output.error_line("the memory that this process may use ran out")
        output.help_line("give it more, or split the input")
        return output.PROBLEMS
    detail = " ".join(str(problem).split())[:200]
    output.error_line(f"internal error: {type(problem).__name__}: {detail}", "PG902")
    output.help_line(f"{_REPORT}; PLCGEN_DEBUG=1 shows the traceback; plcgen {__version__}, {_python()}")
    return output.INTERNAL


def _python() -> str:
    return f"Python {sys.version.split()[0]} on {sys.platform}"
