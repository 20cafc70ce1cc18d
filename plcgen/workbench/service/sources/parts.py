"""A large source in parts, a block each, so that an edit of one block leaves what is known of the others as it is."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import count, takewhile
from typing import TYPE_CHECKING

from plcgen.base.diagnostics import Diagnostic, Span
from plcgen.project.allowances import allowances, settled
from plcgen.s7.cpu.sources import with_start_values
from plcgen.s7.scl.grammar.documents import is_document
from plcgen.workbench.service.documents import Document
from plcgen.workbench.service.sources.version import Around, SourceState

if TYPE_CHECKING:
    from plcgen.s7.types.blocks import Block

PART = "\0"
"""Stands between the path of a file and the number of a part, in what spans call that part."""
LARGE = 600
"""Lines from which on a file is taken apart."""
_numbers = count()


@dataclass(frozen=True)
class SourceFile:
    """A version of a file: its parts, each with the number of lines in front of it."""

    document: Document
    around: Around
    parts: tuple[tuple[int, SourceState], ...]

    @classmethod
    def of(cls, document: Document, around: Around) -> SourceFile:
        """A file that is read as a whole; a large one without errors is taken apart."""
        whole = SourceState(document, around, document.file)
        file = cls(document, around, ((0, whole),))
        if len(document.lines) >= LARGE and not is_document(document.path.name) and not whole.problems:
            return file.known(tuple(_cut(whole, around)))
        return file.known(file.parts)

    def known(self, parts: tuple[tuple[int, SourceState], ...]) -> SourceFile:
        """This file in other parts, which see each other from now on."""
        found = replace(self, parts=parts)
        self.around.inside = _Inside(found) if len(parts) > 1 else {}
        return found

    @cached_property
    def blocks(self) -> Sequence[Block]:
        """The blocks of all parts."""
        return [block for _, state in self.parts for block in state.blocks]

    @cached_property
    def declared(self) -> Mapping[str, Block]:
        """Its blocks by name in upper case; of two with one name the first."""
        return {block.name.upper(): block for block in reversed(self.blocks)}

    @cached_property
    def diagnostics(self) -> Sequence[Diagnostic]:
        """What ``check`` says of it, less what its comments allow."""
        problems = [one for _, state in self.parts for one in state.problems]
        found = with_start_values([state.result for _, state in self.parts], problems)
        told = [_moved(one, self) if len(self.parts) > 1 else one for one in found]
        return tuple(settled(told, allowances(self.document.text, self.document.file)))

    def at(self, line: int) -> tuple[SourceState, int]:
        """The part in which a line is, and which line of it that is."""
        first, state = self.parts[bisect_right([first for first, _ in self.parts], max(line, 1) - 1) - 1]
        return state, line - first

    def real(self, place: Span) -> Span:
        """A place of a part as one of the file."""
        first = self._firsts.get(place.file)
        return (
            place
            if first is None
            else replace(place, file=self.document.file, line=place.line + first, end_line=place.end_line + first)
        )

    @cached_property
    def _firsts(self) -> Mapping[str, int]:
        return {state.file: first for first, state in self.parts}

    def after(self, document: Document) -> SourceFile | None:
        """The file after an edit inside one part; None if it must be read as a whole."""
        if len(self.parts) < 2:
            return None
        old, new = self.document.lines, document.lines
        before = sum(1 for _ in takewhile(_alike, zip(old, new, strict=False)))
        most = min(len(old), len(new)) - before
        behind = min(sum(1 for _ in takewhile(_alike, zip(reversed(old), reversed(new), strict=False))), most)
        grown = len(new) - len(old)
        ends = [*(first for first, _ in self.parts[1:]), len(old)]
        for number, ((first, state), end) in enumerate(zip(self.parts, ends, strict=True)):
            if first <= before and len(old) - behind <= end:
                changed = _part(document, first, end + grown, self.around)
                if not _same_block(state, changed):
                    return None
                below = tuple((start + grown, one) for start, one in self.parts[number + 1 :])
                return replace(self, document=document).known((*self.parts[:number], (first, changed), *below))
        return None


class _Inside(Mapping[str, "Block"]):
    """The blocks of a file by name, asked for only when one is looked up."""

    def __init__(self, file: SourceFile) -> None:
        self._file = file

    def __getitem__(self, key: str) -> Block:
        return self._file.declared[key]

    def __iter__(self) -> Iterator[str]:
        return iter(self._file.declared)

    def __len__(self) -> int:
        return len(self._file.declared)


def _alike(pair: tuple[str, str]) -> bool:
    return pair[0] == pair[1]


def _cut(whole: SourceState, around: Around) -> Iterator[tuple[int, SourceState]]:
    """A part for each block, with what stands in front of it; the whole if two blocks share a line."""
    units, document = whole.result.units, whole.document
    ends = [whole.tokens.position(unit.end)[0] for unit in units[:-1]]
    starts = [whole.tokens.position(unit.start)[0] for unit in units[1:]]
    if any(start <= end for start, end in zip(starts, ends, strict=True)):
        ends = []
    firsts = [0, *ends]
    for first, end in zip(firsts, [*ends, len(document.lines)], strict=True):
        yield (first, _part(document, first, end, around)) if ends else (0, whole)


def _part(document: Document, first: int, end: int, around: Around) -> SourceState:
    text = "\n".join(document.lines[first:end]) + ("\n" if end < len(document.lines) else "")
    return SourceState(Document(document.path, text), around, f"{document.file}{PART}{next(_numbers)}")


def _same_block(old: SourceState, new: SourceState) -> bool:
    """Whether a part is still one block, from its first word to its last: then the others are read as before."""
    both = (old, new)
    if any(len(one.result.units) != 1 for one in both):
        return False
    words = [(one.tokens.texts[0].upper(), one.tokens.kinds[-2]) for one in both if len(one.tokens.kinds) > 1]
    ends = [one.result.units[0].end <= one.tokens.end(len(one.tokens.kinds) - 2) for one in both]
    return len(words) == 2 and words[0] == words[1] and all(ends)


def _moved(one: Diagnostic, file: SourceFile) -> Diagnostic:
    notes = tuple(replace(note, span=file.real(note.span)) for note in one.notes)
    return replace(one, span=file.real(one.span), notes=notes)
