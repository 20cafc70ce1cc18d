"""``# plcgen: allow PG228 read in list manual LH13``: a comment that accepts a warning, with the reason.

It stands on the line that the warning names, or on a line of its own above it. The warning becomes a note that gives
the reason, and a note is left out. An error cannot be allowed.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace

from plcgen.base.diagnostics import Diagnostic, Note, Severity, Span
from plcgen.base.files.printed import says_something

_COMMENT = re.compile(r"(?:\A|(?<=\s))(?:#|//)\s*plcgen:\s*allow\s+(PG[0-9]{3})\b(.*)")
_NOTHING = re.compile(r"\s*(?:(?:#|//).*)?\Z")


@dataclass(frozen=True, slots=True)
class Allowance:
    """One such comment: the code, the reason, where the comment stands, and the line that it is about."""

    code: str
    reason: str
    span: Span
    line: int

    @property
    def about(self) -> Place:
        """What it is about."""
        return self.code, self.span.file, self.line

    @property
    def has_reason(self) -> bool:
        """Whether it says why."""
        return says_something(self.reason)

    def settle(self, diagnostic: Diagnostic) -> Diagnostic:
        """The warning as a note with the reason."""
        note = Note(f"allowed: {self.reason}", self.span)
        return replace(diagnostic, severity=Severity.NOTE, help="", notes=(*diagnostic.notes, note))


def allowances(text: str, file: str) -> tuple[Allowance, ...]:
    """Every such comment of a text."""
    return tuple(_found(text, file)) if "plcgen:" in text else ()


def _found(text: str, file: str) -> Iterator[Allowance]:
    lines = text.splitlines()
    found: list[Allowance] = []
    below = 0
    for number in range(len(lines), 0, -1):
        line = lines[number - 1]
        comment = _COMMENT.search(line)
        if comment is not None:
            about = number if line[: comment.start()].strip() or not below else below
            span = Span(file, number, comment.start() + 1, number, comment.end() + 1)
            found.append(Allowance(comment[1], comment[2].strip(" \t:-*)"), span, about))
        if not _NOTHING.match(line):
            below = number
    return reversed(found)


Place = tuple[str, str, int]
"""Code, file and line: what a comment is about, and what a diagnostic is."""


def _place(diagnostic: Diagnostic) -> Place:
    return diagnostic.code, diagnostic.span.file, diagnostic.span.line


def settled(diagnostics: Iterable[Diagnostic], allowed: tuple[Allowance, ...]) -> Iterator[Diagnostic]:
    """The diagnostics with what is allowed for a reason: warnings as notes, notes left out."""
    reasons = {each.about: each for each in reversed(allowed) if each.has_reason}
    for diagnostic in diagnostics:
        reason = reasons.get(_place(diagnostic))
        if reason is None or diagnostic.severity is Severity.ERROR:
            yield diagnostic
        elif diagnostic.severity is Severity.WARNING:
            yield reason.settle(diagnostic)


def idle(diagnostics: Iterable[Diagnostic], allowed: tuple[Allowance, ...]) -> Iterator[Diagnostic]:
    """PG111 for every comment that allows nothing: it has no reason, or what it allows is not reported there."""
    found = set(map(_place, diagnostics))
    for each in allowed:
        if not each.has_reason:
            message, help_ = f"{each.code} is not allowed without a reason", "write the reason after the code"
        elif each.about not in found:
            message = f"there is nothing to allow: {each.code} is not reported here"
            help_ = "remove the comment, or put it on the line of the warning, or above it"
        else:
            continue
        yield Diagnostic("PG111", message, each.span, Severity.WARNING, help=help_)
