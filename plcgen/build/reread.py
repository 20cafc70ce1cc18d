"""Every source is read again before it is written, and held against the nouns that it was made from.

What a template prints cannot leave its place (see ``holes``), and what a spec says has no characters that end a line:
this is the third look, by the front end that reads everybody's sources. What it finds is a defect of plcgen or of a
plugin, and nothing is written.
"""

from __future__ import annotations

import hashlib
import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace

from plcgen.base.diagnostics import Diagnostic, DiagnosticError, Span
from plcgen.build.holes import left_its_place
from plcgen.build.nouns import Command, MemberRow, StartAssignment
from plcgen.s7.scl.declarations import blocks
from plcgen.s7.scl.parser import parse
from plcgen.s7.types.blocks import Block, SectionKind
from plcgen.s7.types.data_types import Member, inner_members

_PARAMETERS = (SectionKind.INPUT, SectionKind.OUTPUT)


@dataclass(frozen=True, slots=True)
class Promise:
    """What a source holds: one block of this kind and name; of a type or data block all members and start values.

    ``say`` gives the text that a source has for a comment; ``commands`` are those whose pins a function block has.
    Without ``texts`` comments and values are not looked at.
    """

    kind: str
    name: str
    say: Callable[[str], str]
    members: Sequence[MemberRow] | None = None
    assignments: Sequence[StartAssignment] = ()
    starts: bool = True
    commands: Sequence[Command] = ()
    texts: bool = True

    def broken(self, block: Block) -> Iterator[str]:
        """What a block says otherwise."""
        if (block.kind, block.name) != (self.kind, self.name):
            yield f"it is {block.kind} {block.name}"
        if self.members is not None:
            yield from self.told(self.members, block.members, "")
            if self.assigned([(one.path, one.literal) for one in block.assignments]):
                yield "it assigns other start values"
        declared = {member.name for kind in _PARAMETERS for member in block.section(kind)}
        for command in self.commands:
            rows = (*command.signals, *(value.member for value in (*command.inputs, *command.outputs)))
            yield from (f"it has no {pin}" for row in rows if (pin := command.pin(row.name)) not in declared)

    def assigned(self, found: list[tuple[str, str]]) -> bool:
        """Whether other start values are assigned than planned."""
        if not self.texts:
            return len(found) != len(self.assignments)
        return found != [one[:2] for one in self.assignments]

    def without_texts(self) -> Promise:
        """The same for a block that is like the one that is meant, but for comments and values."""
        return replace(self, texts=False)

    def comments(self) -> Iterator[str]:
        """The comments of a type or data block, as its template writes them."""
        for row in self.members or ():
            if row.text or row.members:
                yield self.shown(row.text)
            yield from (self.shown(inner.text) for inner in row.members)
        yield from (self.shown(one.text) for one in self.assignments if one.text)

    def shown(self, text: str) -> str:
        """A comment as a source has it, blanks aside."""
        return " ".join(self.say(text).split())

    def told(self, rows: Sequence[MemberRow], members: Sequence[Member], above: str) -> Iterator[str]:
        """Members that are others, or have another comment or start value."""
        if len(rows) != len(members):
            yield f"it has {len(members)} members {above}where {len(rows)} are meant"
            return
        for row, member in zip(rows, members, strict=True):
            planned, read = (row.name, ""), (member.name, "")
            if self.texts:
                planned = f"{row.name} := {row.start if self.starts else ''}", self.shown(row.text)
                read = f"{member.name} := {member.start or ''}", " ".join(member.comment.split())
            if planned != read:
                yield f"{row.name} is {member.name} := {member.start}, {member.comment}"
            if row.members:
                yield from self.told(row.members, inner_members(member.type), f"in {row.name} ")


_INERT = re.compile(r"\"[^\"\n]*\"|'(?:[^'$\n]|\$[^\n])*'|//[^\n]*|\(\*.*?\*\)|\b16#[0-9A-Fa-f_]+|\b\d+", re.DOTALL)
_CLASS = {'"': '""', "'": "''", "/": "//", "(": "(**)"}
_NAMED = re.compile(r"\w+ \"([^\"\n]+)\"")


class Reading:
    """Reads the sources of one project again.

    Of sources that differ in numbers, in comments and in texts between quotes alone, only the first one is parsed: jobs
    of one shape are many. Of the others the comments are compared, and what the parsed one has in common with them.
    ``harmless`` makes the same source again with harmless texts, see ``left_its_place``: once for each such shape.
    """

    def __init__(self) -> None:
        self._known: dict[bytes, Block] = {}
        self._held: set[bytes] = set()

    def alone(self, text: str, path: str, promise: Promise, harmless: Callable[[], str]) -> Block:
        """The block of a source, whatever was read before."""
        key = hashlib.blake2b(_INERT.sub(lambda found: _CLASS.get(found[0][0], "0"), text).encode()).digest()
        if key not in self._held:
            self._held.add(key)
            _hold(text, path, harmless())
        return reread(text, path, promise)

    def alike(self, text: str, path: str, promise: Promise, harmless: Callable[[], str]) -> Block:
        """The block of a source, or one that is like it but for its name, numbers and comments."""
        comments: list[str] = []

        def inert(found: re.Match[str]) -> str:
            if found[0].startswith("//"):
                comments.append(" ".join(found[0][2:].split()))
            return _CLASS.get(found[0][0], "0")

        named = _NAMED.match(text)
        key = hashlib.blake2b(_INERT.sub(inert, text).encode(), digest_size=16).digest()
        known = self._known.get(key)
        if known is None or named is None:
            _hold(text, path, harmless())
            known = self._known[key] = reread(text, path, promise)
            return known
        if promise.members is not None and comments != list(promise.comments()):
            raise DiagnosticError([not_meant(path, "it has other comments")])
        return _kept(replace(known, name=named[1]), path, promise.without_texts())


def _hold(text: str, path: str, harmless: str) -> None:
    stray = left_its_place(text, harmless)
    if stray:
        raise DiagnosticError([not_meant(path, f'"{stray[:40]}" would not stay at its place')])


def reread(text: str, path: str, promise: Promise) -> Block:
    """The block of a finished source. Raises DiagnosticError, PG510, if it is not the one that was meant."""
    result = parse(text, path)
    found, problems = blocks(result)
    wrong = [f"line {one.span.line}: {one.message}" for one in (*result.diagnostics, *problems)]
    wrong += [f"it has {len(found)} blocks"] if len(found) != 1 else []
    if wrong:
        raise DiagnosticError([not_meant(path, wrong[0])])
    return _kept(found[0], path, promise)


def _kept(block: Block, path: str, promise: Promise) -> Block:
    wrong = next(iter(promise.broken(block)), "")
    if wrong:
        raise DiagnosticError([not_meant(path, wrong)])
    return block


def not_meant(path: str, what: str) -> Diagnostic:
    """PG510: a source would say something else than the plan."""
    message = f"this source would not say what is planned: {what}"
    return Diagnostic("PG510", message, Span(path), help="please report this with the spec; nothing was written")
