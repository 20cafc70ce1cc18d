"""Streams and exit codes, decided once: results own stdout, everything said about them goes to stderr."""

from __future__ import annotations

import contextlib
import io
import os
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, TextIO

from plcgen.base.replacing import replace_file

if TYPE_CHECKING:
    from plcgen.base.diagnostics import Diagnostic
    from plcgen.base.display.results import Answer
    from plcgen.base.display.view import View
    from plcgen.proof.checks import Verification
    from plcgen.report.registry import OutputFormat

OK = 0
PROBLEMS = 1
USAGE = 2
INTERNAL = 70
INTERRUPTED = 130
CLOSED = 141

ColorMode = Literal["auto", "always", "never"]
SENDS_NOTHING = "only printed: whoever sends these bytes acts on the machine"
FALLBACK_WIDTH = 100
_WIDEST = 160
_BAR = 24
_PROGRESS_PAUSE = 0.08
MAX_RESULT = 64 * 1024 * 1024
"""Bytes of an earlier result that is known as one."""


class ClosedOutputError(Exception):
    """Whoever read our output has gone: ``plcgen layout x.yaml | head``."""


class OutputError(Exception):
    """A result could not be delivered: the message says where and why."""


def prepare_streams() -> None:
    """Make every character printable somewhere: UTF-8 into files and pipes, ``?`` where a console lacks one.

    PYTHONUNBUFFERED lets Python write without a buffer, and what the system does not take at once is lost without an
    error: such a stream gets a buffer, which is emptied after every line.
    """
    for name in ("stdout", "stderr"):
        stream = getattr(sys, name)
        raw = getattr(stream, "buffer", None)
        if isinstance(raw, io.RawIOBase) and stream is getattr(sys, f"__{name}__"):  # not a caller's
            buffer = io.BufferedWriter(raw)
            stream = io.TextIOWrapper(buffer, stream.encoding, stream.errors, line_buffering=True)
            setattr(sys, name, stream)
        reconfigure = getattr(stream, "reconfigure", None)
        if reconfigure is None:
            continue
        if stream.isatty():
            reconfigure(errors="replace")
        else:
            reconfigure(encoding="utf-8", errors="replace", newline="\n")


def is_terminal(stream: TextIO | None) -> bool:
    """Whether a stream is an open terminal."""
    try:
        return stream is not None and stream.isatty()
    except ValueError:
        return False


def wants_color(mode: ColorMode, stream: TextIO | None) -> bool:
    """Resolve ``auto``: a terminal that understands colours, and no NO_COLOR."""
    if mode != "auto":
        return mode == "always"
    if os.environ.get("NO_COLOR") or not is_terminal(stream):
        return False
    if sys.platform == "win32":
        return any(name in os.environ for name in ("WT_SESSION", "ANSICON", "ConEmuANSI", "TERM"))
    return os.environ.get("TERM", "") not in {"", "dumb"}


def terminal_width(stream: TextIO | None) -> int:
    """Columns to write for: COLUMNS, else the terminal, else a fixed width so that files are reproducible."""
    columns = os.environ.get("COLUMNS", "")
    if columns.isdigit() and int(columns) > 0:
        return min(int(columns), _WIDEST)
    if stream is not None and is_terminal(stream):
        with contextlib.suppress(OSError, ValueError):
            return min(os.get_terminal_size(stream.fileno()).columns or FALLBACK_WIDTH, _WIDEST)
    return FALLBACK_WIDTH


@dataclass(slots=True)
class Console:
    """Where a verb writes: results, chatter, problems, progress."""

    quiet: bool = False
    color: ColorMode = "auto"
    force: bool = False
    """Whether a result may replace any file."""
    weakened: Sequence[Diagnostic] = ()
    """Where the repository itself asks for less than the verb would do: every result says so."""
    _written: set[str] = field(default_factory=set, repr=False)
    """Hashes of the results that this call has put into files."""

    def view(self, output: Path | None = None, **looks: Any) -> View:
        """How a result on stdout, or in a file, shall look; ``looks`` are fields of View."""
        from plcgen.base.display.view import View
        from plcgen.cli.sources import SourceCache

        out = sys.stdout
        target: Literal["file", "screen", "pipe"] = "file" if output else "screen" if is_terminal(out) else "pipe"
        color = output is None and wants_color(self.color, out)
        return View(color, terminal_width(out), SourceCache().line, target, **looks)

    def show(
        self,
        format_: OutputFormat,
        kind: str,
        result: Any,
        output: Path | None = None,
        **looks: Any,
    ) -> None:
        """Deliver a result in a format."""
        self.result(format_.render(kind, result, self.view(output, **looks)), output, format_.comment)

    def answer(
        self, format_: OutputFormat, found: Answer, output: Path | None = None, known: dict[str, str] | None = None
    ) -> int:
        """Deliver an answer and return the exit code: whether an error stands in its diagnostics."""
        from plcgen.base.diagnostics import has_errors

        self.show(format_, "answer", found, output)
        if not format_.complete:
            self.complain(found.diagnostics, known)
        return PROBLEMS if has_errors(found.diagnostics) else OK

    def verification(
        self, format_: OutputFormat, result: Verification, output: Path | None = None, *, ledger: bool = False
    ) -> int:
        """Deliver what was verified and return the exit code; ``--quiet`` leaves the troubles of a text."""
        from plcgen.report.verification import troubles

        short = self.quiet and format_.name == "text"
        result = replace(result, diagnostics=(*result.diagnostics, *self.weakened))
        if not (short and result.ok):
            self.show(format_, "verification", troubles(result) if short else result, output, ledger=ledger)
        elif self.weakened:
            self.complain(self.weakened)
        return OK if result.ok else PROBLEMS

    def verifications(
        self, format_: OutputFormat, found: Sequence[Verification], output: Path | None = None, *, ledger: bool = False
    ) -> int:
        """Deliver what was verified of several specs and return the exit code, as :meth:`verification` does for one."""
        from plcgen.report.verification import troubles

        short = self.quiet and format_.name == "text"
        found = [replace(each, diagnostics=(*each.diagnostics, *self.weakened)) for each in found]
        shown = [troubles(each) for each in found if not each.ok] if short else found
        if shown:
            self.show(format_, "verifications", shown, output, ledger=ledger)
        elif self.weakened:
            self.complain(self.weakened)
        return OK if all(each.ok for each in found) else PROBLEMS

    def result(
        self, text: str, output: Path | None = None, comment: tuple[str, str] | None = None, *, fresh: bool = False
    ) -> None:
        """Deliver a result to stdout, or to a file if one is given (UTF-8, LF).

        ``comment`` is what stands around a remark: a file ends with one by which it is known as a result. ``fresh``:
        what the user goes on with himself; it replaces nothing, not even a result.
        """
        if output is not None:
            if comment is not None:
                from plcgen.report.seal import sealed

                text = sealed(text, comment)
            self._write_file(output, text.encode("utf-8", "replace"), fresh=fresh)
            self.say(f"wrote {output}")
            return
        if sys.stdout is None:
            raise OutputError("cannot write the result: standard output is closed")
        try:
            sys.stdout.write(text)
            sys.stdout.flush()
        except (OSError, ValueError) as problem:
            raise _failed(problem) from problem

    def replaceable(self, output: Path, *, fresh: bool = False) -> str | None:
        """Hash of the file that a result may replace; None if there is none, empty if it may be any.

        Raises:
            OutputError: if it is a folder.
            DiagnosticError: PG501 if it is no result of plcgen, PG502 if somebody changed it since; ``force`` allows
                both.
        """
        if output.is_dir():
            raise OutputError(f"{output} is a folder: name a file")
        if not output.exists():
            return None
        if self.force or not output.is_file():  # a device or FIFO keeps nothing
            return ""
        import hashlib

        from plcgen.base.diagnostics import Diagnostic, DiagnosticError, Span
        from plcgen.base.files.files import read_bounded
        from plcgen.report.seal import has_seal, is_result

        data = read_bounded(output, MAX_RESULT)
        known = hashlib.sha256(data).hexdigest()
        if not fresh and (known in self._written or (len(data) <= MAX_RESULT and is_result(data))):
            return known
        code, message = "PG501", "the file exists" + ("" if fresh else ", and plcgen did not write it")
        if not fresh and has_seal(data):
            code, message = "PG502", "the file was changed since plcgen wrote it"
        help_ = "use another name, or --force to overwrite it"
        raise DiagnosticError([Diagnostic(code, message, Span(output.as_posix()), help=help_)])

    def _write_file(self, path: Path, data: bytes, *, fresh: bool) -> None:
        try:
            known = self.replaceable(path, fresh=fresh)
            replace_file(path, data, known)
        except FileExistsError as problem:
            from plcgen.base.diagnostics import Diagnostic, DiagnosticError, Span

            message = "the file was changed while plcgen was running: it is kept as it is now"
            changed = Diagnostic("PG509", message, Span(path.as_posix()), help="look at it, then run plcgen again")
            raise DiagnosticError([changed]) from problem
        except OSError as problem:
            raise OutputError(f"cannot write {path}: {problem.strerror or problem}") from problem
        import hashlib

        self._written.add(hashlib.sha256(data).hexdigest())

    def say(self, text: str) -> None:
        """Tell the person at the terminal something; ``--quiet`` drops it."""
        if not self.quiet:
            _to_stderr(_lines(text))

    def complain(self, diagnostics: Sequence[Diagnostic], known: dict[str, str] | None = None) -> None:
        """Show diagnostics on stderr, for verbs whose result is something else.

        ``known`` holds texts that are no files, for the excerpts.
        """
        if diagnostics:
            from plcgen.base.display.excerpts import diagnostics_text
            from plcgen.base.display.view import View
            from plcgen.cli.sources import SourceCache

            color, width = wants_color(self.color, sys.stderr), terminal_width(sys.stderr)
            _to_stderr(diagnostics_text(diagnostics, View(color, width, SourceCache(known).line)))

    @contextlib.contextmanager
    def progress(self) -> Iterator[Callable[[str, int, int], None] | None]:
        """Give long work a progress bar on stderr; None where nobody would see it."""
        if self.quiet or not is_terminal(sys.stderr):
            yield None
            return
        bar = _Bar(terminal_width(sys.stderr))
        try:
            yield bar.show
        finally:
            bar.clear()


@dataclass(slots=True)
class _Bar:
    """One line on stderr, redrawn at most a dozen times a second."""

    width: int
    last: float = 0.0
    drawn: bool = False

    def show(self, what: str, done: int, total: int) -> None:
        now = time.monotonic()
        if now - self.last < _PROGRESS_PAUSE:
            return
        from plcgen.base.display.cells import clean, cut, pad

        self.last, self.drawn = now, True
        filled = _BAR * min(done, total) // total if total > 0 else 0
        count = f"[{'#' * filled}{'.' * (_BAR - filled)}] {done}/{total}" if total > 0 else str(done)
        text = f"{count} {clean(what)}"
        _to_stderr("\r" + pad(cut(text, self.width - 1), self.width - 1))

    def clear(self) -> None:
        if self.drawn:
            _to_stderr("\r" + " " * (self.width - 1) + "\r")


def error_line(text: str, code: str = "") -> None:
    """Write an error without a place to stderr, whatever ``--quiet`` says."""
    _to_stderr(_lines(f"error{f'[{code}]' if code else ''}: {text}"))


def error_detail(text: str) -> None:
    """Write one line of a list below an error."""
    _to_stderr(_lines(f"  {text}"))


def help_line(text: str) -> None:
    """Write the way out below an error."""
    _to_stderr(_lines(f"help: {text}"))


def _lines(text: str) -> str:
    """Lines that quote what somebody else wrote, without what a terminal would obey."""
    if text.replace("\n", "").isprintable():
        return text + "\n"
    from plcgen.base.display.cells import clean

    return "".join(f"{clean(line)}\n" for line in text.split("\n"))


def _to_stderr(text: str) -> None:
    if sys.stderr is not None:
        with contextlib.suppress(OSError, ValueError):
            sys.stderr.write(text)
            sys.stderr.flush()


def _failed(problem: OSError | ValueError) -> Exception:
    """Sort a failed write: a closed pipe is quiet (Windows says EINVAL), everything else is told."""
    import errno

    if isinstance(problem, OSError) and problem.errno in {errno.EPIPE, errno.EINVAL, errno.ESHUTDOWN}:
        return ClosedOutputError()
    reason = problem.strerror if isinstance(problem, OSError) and problem.strerror else str(problem)
    return OutputError(f"cannot write the result: {reason}")


def abandon_stdout() -> None:
    """Point stdout at nothing, so that the interpreter's last flush cannot fail again."""
    with contextlib.suppress(OSError, ValueError, AttributeError):
        descriptor = os.open(os.devnull, os.O_WRONLY)
        os.dup2(descriptor, sys.stdout.fileno())
        os.close(descriptor)
