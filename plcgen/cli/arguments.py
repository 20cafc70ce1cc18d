"""Words of the command line with their places, so that an error points at its word."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from plcgen.base.diagnostics import Diagnostic, DiagnosticError, Span

ARGUMENTS = "<arguments>"


@dataclass(frozen=True, slots=True)
class Argument:
    """One argument and where it stands in the joined command line (column from 1)."""

    text: str
    column: int

    @property
    def span(self) -> Span:
        """Place in the joined command line."""
        return Span(ARGUMENTS, 1, self.column, 1, self.column + len(self.text))

    def problem(self, code: str, message: str, help_: str = "") -> DiagnosticError:
        """Build the error that points at this argument."""
        return DiagnosticError([Diagnostic(code, message, self.span, help=help_)])


def arguments(words: Sequence[str]) -> list[Argument]:
    """Give every word its column in ``" ".join(words)``."""
    placed: list[Argument] = []
    column = 1
    for word in words:
        placed.append(Argument(word, column))
        column += len(word) + 1
    return placed
