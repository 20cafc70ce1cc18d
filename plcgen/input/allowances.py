"""``# plcgen: allow PG228 read in list manual LH13``: a comment that accepts a warning, with the reason.

It stands on the line that the warning names, or on a line of its own above it. The warning becomes a note that gives
the reason, and a note is left out. An error cannot be allowed.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace

from plcgen.diagnostics import Diagnostic, Note, Severity, Span

_COMMENT = re.compile(r"(?:\A|(?<=\s))(?:#|//)\s*plcgen:\s*allow\s+(PG[0-9]{3})\b(.*)")
_NOTHING = re.compile(r"\s*(?:(?:#|//).*)?\Z")


@dataclass(frozen=True, slots=True)
class Allowance:
    """One such comment: the code, the reason, where the comment stands, and the line that it is about."""

    code: str
    reason: str
    span: Span
    line: int

    def covers(self, diagnostic: Diagnostic) -> bool:
        """Whether it is about this diagnostic."""
        place = diagnostic.span
        return (diagnostic.code, place.file, place.line) == (self.code, self.span.file, self.line)

    def settle(self, diagnostic: Diagnostic) -> Diagnostic:
        """The warning as a note with the reason."""
        note = Note(f"allowed: {self.reason}", self.span)
        return replace(diagnostic, severity=Severity.NOTE, help="", notes=(*diagnostic.notes, note))


def allowances(text: str, file: str) -> tuple[Allowance, ...]:
    """Every such comment of a text."""
    return tuple(_found(text, file)) if "plcgen:" in text else ()


def _found(text: str, file: str) -> Iterator[Allowance]:
    lines = text.splitlines()
    for number, line in enumerate(lines, 1):
        found = _COMMENT.search(line)
        if found is None:
            continue
        about = number
        if not line[: found.start()].strip():
            below = (n for n, each in enumerate(lines[number:], number + 1) if not _NOTHING.match(each))
            about = next(below, number)
        span = Span(file, number, found.start() + 1, number, found.end() + 1)
        yield Allowance(found[1], found[2].strip(" \t:-*)"), span, about)


def settled(diagnostics: Iterable[Diagnostic], allowed: tuple[Allowance, ...]) -> Iterator[Diagnostic]:
    """The diagnostics with what is allowed for a reason: warnings as notes, notes left out."""
    for diagnostic in diagnostics:
        reason = next((each for each in allowed if each.reason and each.covers(diagnostic)), None)
        if reason is None or diagnostic.severity is Severity.ERROR:
            yield diagnostic
        elif diagnostic.severity is Severity.WARNING:
            yield reason.settle(diagnostic)


def idle(diagnostics: Iterable[Diagnostic], allowed: tuple[Allowance, ...]) -> Iterator[Diagnostic]:
    """PG111 for every comment that allows nothing: it has no reason, or what it allows is not reported there."""
    found = list(diagnostics)
    for each in allowed:
        if not each.reason:
            message, help_ = f"{each.code} is not allowed without a reason", "write the reason after the code"
        elif not any(map(each.covers, found)):
            message = f"there is nothing to allow: {each.code} is not reported here"
            help_ = "remove the comment, or put it on the line of the warning, or above it"
        else:
            continue
        yield Diagnostic("PG111", message, each.span, Severity.WARNING, help=help_)
