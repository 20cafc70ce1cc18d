"""Frozen diagnostics: span, severity, message, notes, and the report that collects them."""

from __future__ import annotations

import enum
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field

from plcgen.base.frozen import frozen


class Severity(enum.IntEnum):
    """How bad it is: an error stops the verb, a warning does not, a note only informs."""

    NOTE = 1
    WARNING = 2
    ERROR = 3

    @property
    def label(self) -> str:
        """Lower-case word used in every output format."""
        return self.name.lower()


@frozen
class Span:
    """A region of a text file; lines and columns count from 1, in characters; the end is exclusive.

    ``line == 0`` means "the file as a whole".
    """

    file: str
    line: int = 0
    column: int = 0
    end_line: int = 0
    end_column: int = 0

    def __str__(self) -> str:
        return f"{self.file}:{self.line}:{self.column}" if self.line else self.file


@dataclass(frozen=True, slots=True)
class Note:
    """A second place that belongs to the same problem, for example the first use of a number."""

    message: str
    span: Span


MAX_MESSAGE = 300
"""Longest message in characters; longer ones quote something that nobody reads to its end."""
MAX_HELP = 1_500
"""Longest help in characters: it may list all keys of a place."""


def _readable(text: str) -> str:
    """Escape what a terminal would not print (or obey), and cut what is too long in the middle."""
    text = _printable(text)
    return text if len(text) <= MAX_MESSAGE else f"{text[: MAX_MESSAGE - 83]}...{text[-80:]}"


def _printable(text: str) -> str:
    if text.isprintable():
        return text
    return "".join(char if char.isprintable() else f"\\u{ord(char):04X}" for char in text)


def _readable_help(text: str) -> str:
    """The same for help, which ends behind a whole entry of its list."""
    text = _printable(text)
    if len(text) <= MAX_HELP:
        return text
    kept = text[: MAX_HELP - 4]
    return f"{kept[: kept.rfind(', ')] if ', ' in kept[MAX_HELP // 2 :] else kept}, .."


@dataclass(frozen=True, slots=True)
class Diagnostic:
    """One problem: stable code, what (message), where (span), how to fix (help), related places.

    Message and help quote the user's text: they are made printable and cut to a readable length.
    """

    code: str
    message: str
    span: Span
    severity: Severity = Severity.ERROR
    help: str = ""
    notes: tuple[Note, ...] = ()

    def __post_init__(self) -> None:
        object.__setattr__(self, "message", _readable(self.message))
        object.__setattr__(self, "help", _readable_help(self.help))

    @property
    def sort_key(self) -> tuple[str, int, int, str, str]:
        """Reading order: by file, then position, then code."""
        return (self.span.file, self.span.line, self.span.column, self.code, self.message)


class PlcgenError(Exception):
    """Root of every exception that plcgen raises on purpose: what the caller gave cannot be used."""


class ArgumentError(PlcgenError, ValueError):
    """An argument of a function of the API is not one of its words, or out of its range."""


class PluginError(PlcgenError):
    """What another distribution registers under an entry point cannot be used; the message names it."""


class DiagnosticError(PlcgenError):
    """Carries diagnostics out of a step that could not go on: a user's problem, never a bug."""

    def __init__(self, diagnostics: Iterable[Diagnostic]) -> None:
        self.diagnostics: tuple[Diagnostic, ...] = tuple(diagnostics)
        super().__init__("; ".join(f"{d.code} {d.message}" for d in self.diagnostics))


def has_errors(diagnostics: Iterable[Diagnostic]) -> bool:
    """Whether one of them is an error."""
    return any(diagnostic.severity is Severity.ERROR for diagnostic in diagnostics)


@dataclass(slots=True)
class Report:
    """Diagnostics in the order they were found; the only mutable value of this package."""

    diagnostics: list[Diagnostic] = field(default_factory=list)

    def add(self, diagnostic: Diagnostic) -> None:
        """Append one diagnostic."""
        self.diagnostics.append(diagnostic)

    def extend(self, diagnostics: Iterable[Diagnostic]) -> None:
        """Append several diagnostics."""
        self.diagnostics.extend(diagnostics)

    @contextmanager
    def catch(self) -> Iterator[None]:
        """Append the diagnostics of an error that ends the block, and go on behind it."""
        try:
            yield
        except DiagnosticError as problem:
            self.extend(problem.diagnostics)

    def __iter__(self) -> Iterator[Diagnostic]:
        return iter(self.sorted())

    def __len__(self) -> int:
        return len(self.diagnostics)

    def sorted(self) -> list[Diagnostic]:
        """Diagnostics in reading order, without exact repetitions."""
        return sorted(dict.fromkeys(self.diagnostics), key=lambda d: d.sort_key)

    def count(self, severity: Severity) -> int:
        """How many diagnostics have exactly this severity."""
        return sum(d.severity is severity for d in self.sorted())

    @property
    def has_errors(self) -> bool:
        """Whether at least one diagnostic is an error."""
        return has_errors(self.diagnostics)

    def raise_on_errors(self) -> None:
        """Raise :class:`DiagnosticError` with everything found so far if an error is among it."""
        if self.has_errors:
            raise DiagnosticError(self.sorted())
