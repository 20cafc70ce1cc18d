"""The frame around the verbs: help, usage, streams, exit codes, what gets imported."""

import os
import re
import shutil
import subprocess
import sys

import click
import pytest

from plcgen import __version__
from plcgen.base.diagnostics import Diagnostic, DiagnosticError, Span
from plcgen.cli import main, output
from tests.projects import FAQ, ROOT


def test_a_file_without_rights_is_a_problem_of_the_file(plcgen, good, monkeypatch):
    """Not wrong usage: what reads it says what is wrong."""
    monkeypatch.setattr("os.access", lambda *_, **__: False)
    assert plcgen("check", good).code == 0


def test_version(plcgen):
    """Name and version on stdout, exit code 0."""
    for option in ("--version", "-V"):
        result = plcgen(option)
        assert (result.code, result.out, result.err) == (0, f"plcgen {__version__}\n", "")


def test_help_lists_the_verbs_in_the_order_of_the_workflow(plcgen):
    """Every verb with its summary, each section in order; no arguments mean the same."""
    result = plcgen("-h")
    assert result.code == 0
    positions = [result.out.index(f"\n  {verb} ") for verb in main.cli.verbs]
    assert positions == sorted(positions)
    assert plcgen().out == result.out
    assert plcgen("--help").out == result.out


@pytest.mark.parametrize("verb", main.cli.verbs)
def test_every_verb_has_help_with_an_example_that_starts_with_its_name(plcgen, verb):
    """-h works everywhere, fits 80 columns, shows at least one command to copy."""
    result = plcgen(verb, "-h")
    assert result.code == 0
    assert "Examples:" in result.out
    assert f"plcgen {verb}" in result.out.split("Examples:")[1]


@pytest.mark.parametrize("verb", main.cli.verbs)
def test_summary_of_a_verb_is_the_first_line_of_its_own_help(verb):
    """The static table and the verb's module say compatible things: the verb exists and has a docstring."""
    command = main.cli.get_command(click.Context(main.cli), verb)
    assert command.name == verb
    assert command.help


@pytest.mark.parametrize(
    ("args", "message"),
    [
        (["chekc"], 'error[PG901]: there is no verb "chekc", did you mean "check"?\nhelp: plcgen -h\n'),
        (
            ["x.yaml"],
            (
                'error[PG901]: there is no verb "x.yaml": a verb comes first, '
                "for example plcgen check x.yaml\nhelp: plcgen -h\n"
            ),
        ),
        (["help"], 'error[PG901]: there is no verb "help": it is an option, plcgen --help\nhelp: plcgen -h\n'),
        (["check"], 'error[PG901]: name a spec or a folder, or set "specs" in plcgen.toml\nhelp: plcgen check -h\n'),
        (["explain"], "error[PG901]: give a code, for example PG209, or --list\nhelp: plcgen explain -h\n"),
        (["encode", "a", "b", "c"], "error[PG901]: give one spec and at most one job\nhelp: plcgen encode -h\n"),
    ],
)
def test_usage_errors(plcgen, args, message):
    """A wrong command line: exit code 2, stdout stays empty, one error and the way to the help."""
    result = plcgen(*args)
    assert (result.code, result.out, result.err) == (2, "", message)


def test_unknown_option_is_suggested(plcgen):
    """A typing error in an option names the option that was meant."""
    result = plcgen("check", "--fromat", "json", "x.yaml")
    assert result.code == 2
    assert "--format" in result.err.splitlines()[0]


def test_group_options_work_before_and_behind_the_verb(plcgen, bad):
    """--color and --quiet may stand on either side."""
    before = plcgen("--color", "always", "--quiet", "check", bad)
    behind = plcgen("check", bad, "--color", "always", "-q")
    assert before == behind
    assert "\x1b[1;31merror" in before.out
    assert before.err == ""


@pytest.mark.parametrize(
    ("problem", "code", "text"),
    [
        (RuntimeError("boom\nline two"), 70, "error[PG902]: internal error: RuntimeError: boom line two\n"),
        (KeyboardInterrupt(), 130, "error: interrupted\n"),
        (click.Abort(), 130, "error: interrupted\n"),
        (output.ClosedOutputError(), 141, ""),
        (BrokenPipeError(), 141, ""),
        (output.OutputError("cannot write x"), 1, "error: cannot write x\n"),
        (PermissionError(13, "Permission denied", "x.yaml"), 1, "error: x.yaml: Permission denied\n"),
        (OSError("bare"), 70, "error[PG902]: internal error: OSError: bare\n"),
        (DiagnosticError([Diagnostic("PG101", "m", Span("x"))]), 1, "error[PG101]: m\n"),
        (click.UsageError("Wrong"), 2, "error[PG901]: wrong\n"),
        (SystemExit(3), 3, ""),
    ],
)
def test_every_end_has_its_exit_code(monkeypatch, capsys, problem, code, text):
    """Errors of the user, of the surroundings and of the tool are told apart; none shows a traceback."""

    def fail(**_):
        raise problem

    monkeypatch.delenv("PLCGEN_DEBUG", raising=False)
    monkeypatch.setattr(main.cli, "main", fail)
    monkeypatch.setattr(output, "abandon_stdout", lambda: None)
    assert main.run([]) == code
    captured = capsys.readouterr()
    assert text in captured.err
    assert "Traceback" not in captured.err
    assert captured.out == ""


def test_debug_shows_the_traceback(monkeypatch, capsys):
    """PLCGEN_DEBUG=1 is for those who fix the bug."""

    def fail(**_):
        raise RuntimeError("boom")

    monkeypatch.setenv("PLCGEN_DEBUG", "1")
    monkeypatch.setattr(main.cli, "main", fail)
    assert main.run([]) == 70
    assert "Traceback" in capsys.readouterr().err


def imported(*args):
    """Modules a command imports, by a real process."""
    code = f"import sys; sys.argv = ['plcgen', *{args!r}]\nfrom plcgen.__main__ import main\n"
    code += "main()\nprint(*sys.modules, sep='\\n', file=sys.stderr)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    return set(done.stderr.split())


HEAVY = {"pydantic", "yaml", "jinja2", "lxml", "plcgen.project.schema"}


def test_version_imports_no_click():
    """--version answers before anything is loaded."""
    assert not imported("--version") & (HEAVY | {"click", "plcgen.cli.main", "plcgen.api"})


@pytest.mark.slow
def test_a_check_leaves_out_what_other_verbs_need():
    """Neither their results, nor CPU types, templates or XML."""
    others = {"plcgen.api.sources", "plcgen.api.telegrams", "plcgen.s7.tables.tables", "plcgen.project.cpus"}
    others |= {"jinja2", "lxml"}
    assert not imported("check", "--quiet", str(FAQ)) & others


@pytest.mark.parametrize("args", [["-h"], ["check", "-h"], ["explain", "0x11"], ["completion", "bash"]])
def test_help_and_small_verbs_import_nothing_heavy(args):
    """Help and explanations need no YAML, no validation, no templates, no XML."""
    assert not imported(*args) & HEAVY


def test_decode_imports_no_spec_machinery():
    """A telegram is decoded without pydantic and YAML."""
    assert not imported("decode", "03020201") & HEAVY


def test_closed_pipe_is_quiet():
    """A reader that goes away ends the work: no traceback, no message, exit code 141."""
    script = (
        "import subprocess, sys\n"
        "p = subprocess.Popen([sys.executable, '-m', 'plcgen', 'explain', '--list'], stdout=subprocess.PIPE,"
        " stderr=subprocess.PIPE)\n"
        "p.stdout.close()\n"
        "err = p.stderr.read()\n"
        "print(p.wait(), err.decode())\n"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert done.stdout == "141 \n"


@pytest.mark.skipif(os.name != "posix", reason="needs a shell that closes descriptors")
@pytest.mark.parametrize(
    ("redirect", "reason"), [(">&-", "standard output is closed"), (">/dev/full", "No space left on device")]
)
def test_a_result_that_cannot_be_delivered_is_an_error(redirect, reason):
    """A closed stdout or a full disk is told, with exit code 1."""
    done = subprocess.run(
        ["sh", "-c", f"exec {sys.executable} -m plcgen explain 0x11 {redirect}"],
        capture_output=True,
        text=True,
        check=False,
    )
    assert (done.returncode, done.stderr) == (1, f"error: cannot write the result: {reason}\n")


UNMEASURED = {name: value for name, value in os.environ.items() if not name.startswith("COVERAGE_")}
"""Where files are limited, no data of coverage can be written either."""


@pytest.mark.skipif(os.name != "posix", reason="needs a shell that limits the size of files")
@pytest.mark.parametrize("unbuffered", ["", "1"])
def test_a_result_that_is_cut_off_is_an_error(tmp_path, unbuffered):
    """Half a result is never a success, also where PYTHONUNBUFFERED is set, as in most containers."""
    done = subprocess.run(
        ["sh", "-c", f"ulimit -f 64; exec {sys.executable} -m plcgen schema > {tmp_path}/schema.json"],
        env=UNMEASURED | {"PYTHONUNBUFFERED": unbuffered},
        capture_output=True,
        text=True,
        check=False,
    )
    assert (done.returncode, done.stderr) == (1, "error: cannot write the result: File too large\n")


@pytest.mark.skipif(os.name != "posix", reason="needs a shell that limits the size of files")
@pytest.mark.parametrize("command", ["schema --force --output", "new --force"])
def test_a_file_that_cannot_be_written_stays_as_it_was(tmp_path, command):
    """A full disk costs nobody the file that was there."""
    (tmp_path / "kept").write_text("mine", "utf-8")
    done = subprocess.run(
        ["sh", "-c", f"ulimit -f 0; exec {sys.executable} -m plcgen {command} kept"],
        cwd=tmp_path,
        env=UNMEASURED | {"PYTHONDONTWRITEBYTECODE": "1"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert (done.returncode, done.stderr) == (1, "error: cannot write kept: File too large\n")
    assert {path.name: path.read_text("utf-8") for path in tmp_path.iterdir()} == {"kept": "mine"}


def test_ascii_console_does_not_crash(process, tmp_path):
    """Characters that a console lacks are replaced; files and pipes are UTF-8 whatever the locale says."""
    (tmp_path / "job.yaml").write_text("plc: {name: 加工站, family: x}\n", encoding="utf-8")
    done = process("check", "job.yaml", env={"PYTHONIOENCODING": "cp1252", "PYTHONUTF8": "0"})
    assert done.returncode == 1
    assert "加工站" in done.stdout.decode("utf-8")
    assert b"Traceback" not in done.stderr


@pytest.mark.slow
@pytest.mark.skipif(sys.platform != "linux", reason="needs file names that are no text")
@pytest.mark.parametrize("format_", ["text", "json", "sarif", "junit", "github"])
def test_file_names_that_are_no_text(process, format_):
    """A name with bytes that are no UTF-8 can be reported in every format."""
    done = process("check", os.fsdecode(b"\xff.yaml"), "--format", format_)
    assert done.returncode == 1
    assert b"PG110" in done.stdout
    assert b"PG902" not in done.stderr


def test_interrupt_in_a_real_process():
    """Ctrl-C ends with 130 and one line."""
    code = (
        "import sys, plcgen.api\n"
        "def stop(*_, **__): raise KeyboardInterrupt\n"
        "plcgen.api.check = stop\n"
        "from plcgen.cli.main import run\n"
        "sys.exit(run(['check', 'x.yaml']))\n"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout) == (130, "")
    assert done.stderr.strip() == "error: interrupted"


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish", "powershell"])
def test_completion(plcgen, shell):
    """A script for each shell that calls plcgen back."""
    result = plcgen("completion", shell)
    assert result.code == 0
    assert re.search(rf"_PLCGEN_COMPLETE ?= ?'?{shell}_complete", result.out)


@pytest.mark.parametrize(
    ("words", "current", "expected"),
    [
        (["new", "--device"], "sinamics-s12", ["sinamics-s120"]),
        (["encode", "read", "--device"], "sinamics-s12", ["sinamics-s120"]),
        (["live", "read", "--device"], "sinamics-s12", ["sinamics-s120"]),
        (["catalogue", "show", "--device"], "sinamics-s12", ["sinamics-s120"]),
        (["catalogue", "import", "--device"], "sinamics-s12", ["sinamics-s120"]),
        (["new", "--toolchain"], "tia-v2", ["tia-v20", "tia-v21"]),
        (["explain"], "pg20", ["PG201", "PG202", "PG203", "PG204", "PG205", "PG206", "PG207", "PG208", "PG209"]),
        ([], "rev", ["review"]),
        (["new"], "'--dev'", ["--device"]),
        (["explain", "&calc"], "$(x)", []),
    ],
)
def test_powershell_is_answered_with_values(process, words, current, expected):
    """Words come one a line, answers with kind, value and text; PowerShell wants a text that is not empty."""
    asked = {"_PLCGEN_COMPLETE": "powershell_complete", "COMP_WORDS": "\n".join(["plcgen", *words])}
    done = process(env={**asked, "COMP_CURRENT": current})
    lines = [line.split("\t") for line in done.stdout.decode().splitlines() if line]
    assert [line[1] for line in lines] == expected
    assert all(len(line) == 3 and line[0] == "plain" and line[2] for line in lines)


def test_powershell_completes(tmp_path):
    """The script as PowerShell runs it."""
    if shutil.which("pwsh") is None:
        pytest.skip("not run: pwsh is not installed")
    (tmp_path / "plcgen").write_text(f'#!/bin/sh\nexec {sys.executable} -m plcgen "$@"\n', "utf-8")
    (tmp_path / "plcgen").chmod(0o755)
    script = (
        "plcgen completion powershell | Out-String | Invoke-Expression; $line = 'plcgen new --device sinamics-s12';"
        "(TabExpansion2 -inputScript $line -cursorColumn $line.Length).CompletionMatches.CompletionText"
    )
    path = f"{tmp_path}{os.pathsep}{os.environ['PATH']}"
    environment = {**os.environ, "PATH": path, "PYTHONPATH": str(ROOT)}
    done = subprocess.run(
        ["pwsh", "-NoProfile", "-Command", script], capture_output=True, text=True, check=True, env=environment
    )
    assert done.stdout.split() == ["sinamics-s120"]


def test_completion_of_verbs(process):
    """The shell's question is answered with verbs."""
    done = process(env={"_PLCGEN_COMPLETE": "bash_complete", "COMP_WORDS": "plcgen ch", "COMP_CWORD": "1"})
    assert done.stdout.decode().split() == ["plain,check"]
    assert done.returncode == 0


@pytest.mark.parametrize(
    ("mode", "tty", "env", "expected"),
    [
        ("always", False, {}, True),
        ("never", True, {}, False),
        ("auto", True, {"TERM": "xterm"}, True),
        ("auto", False, {"TERM": "xterm"}, False),
        ("auto", True, {"TERM": "xterm", "NO_COLOR": "1"}, False),
        ("auto", True, {"TERM": "dumb"}, False),
    ],
)
def test_colour_rules(monkeypatch, mode, tty, env, expected):
    """Auto means: a terminal, and nobody said NO_COLOR."""

    class Stream:
        def isatty(self):
            return tty

    for name in ("NO_COLOR", "TERM", "WT_SESSION"):
        monkeypatch.delenv(name, raising=False)
    for name, value in env.items():
        monkeypatch.setenv(name, value)
    monkeypatch.setattr(sys, "platform", "linux")
    assert output.wants_color(mode, Stream()) is expected


def test_progress_bar_only_on_a_terminal(monkeypatch, capsys):
    """Nobody watching: no callback. A terminal: one line that is cleared at the end."""
    console = output.Console()
    with console.progress() as callback:
        assert callback is None
    monkeypatch.setattr(output, "is_terminal", lambda _: True)
    monkeypatch.setenv("COLUMNS", "60")
    with console.progress() as callback:
        callback("faults", 6, 12)
    err = capsys.readouterr().err
    assert "[############............] 6/12 faults" in err
    assert err.endswith("\r" + " " * 59 + "\r")
    with output.Console(quiet=True).progress() as callback:
        assert callback is None
