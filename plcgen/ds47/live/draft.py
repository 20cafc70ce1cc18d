"""A backup while it is made: a file that grows in chunks, and from which a broken-off one goes on."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from plcgen.base.diagnostics import Diagnostic, DiagnosticError, Span
from plcgen.base.files.text import read_text
from plcgen.ds47.live.backup import HEADINGS, SavedParameter, lines, rows

_CHUNK, _REFUSED = "#. ", "#! "


class Draft:
    """The file next to ``target``. Its first line says of what it is; a chunk ends with a line of its last number.

    Raises:
        DiagnosticError: PG501 if there is one already and nobody wants to go on with it, or it is of another drive.
    """

    def __init__(self, target: Path, head: str, *, resume: bool) -> None:
        self.path = target.with_name(f"{target.name}.part")
        self._text = f"# {head}\n{lines([HEADINGS])}"
        if not self.path.exists():
            self.path.write_text(self._text, "utf-8", newline="\n")
            return
        if not resume:
            raise self._problem("a backup was broken off here", "go on with --resume, or remove the file")
        known = read_text(self.path)
        if not known.startswith(self._text):
            raise self._problem("it is of another drive", f"this one begins with: # {head}")
        at = known.rfind(f"\n{_CHUNK}")
        end = known.find("\n", at + 1) + 1
        self._text = known[:end] if at >= 0 and end else self._text
        self.path.write_text(self._text, "utf-8", newline="\n")

    @property
    def last(self) -> int:
        """The last number that is in it, 0 if there is none."""
        ended = [line for line in self._text.splitlines() if line.startswith(_CHUNK)]
        return int(ended[-1].removeprefix(_CHUNK)) if ended else 0

    def add(self, chunk: Sequence[SavedParameter]) -> None:
        """Write parameters behind those that are there."""
        text = "".join(
            f"{_REFUSED}{one.parameter.pnu} {one.refusal}\n" if one.refusal else lines(rows(one)) for one in chunk
        )
        text += f"{_CHUNK}{chunk[-1].parameter.pnu}\n"
        self._text += text
        with self.path.open("a", encoding="utf-8", newline="\n") as file:
            file.write(text)

    def finished(self) -> tuple[str, Sequence[str]]:
        """The list, and what was refused: number and why."""
        every = self._text.splitlines(keepends=True)
        kept = "".join(line for line in every if not line.startswith((_CHUNK, _REFUSED)))
        return kept, [line.removeprefix(_REFUSED).rstrip("\n") for line in every if line.startswith(_REFUSED)]

    def _problem(self, message: str, help_: str) -> DiagnosticError:
        return DiagnosticError([Diagnostic("PG501", message, Span(self.path.as_posix()), help=help_)])
