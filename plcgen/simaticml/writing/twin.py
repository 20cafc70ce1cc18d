"""The document of a generated code block, made from the text of its source: both can never differ.

Generated blocks are alike: most of their lines occur in every job. What a line becomes is therefore kept, keyed by
its text and by what its names stand for in the block; a text that cannot be taken line by line is parsed as a
whole. Both ways give the same document.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import TYPE_CHECKING

from plcgen.s7.blocks import Block, BlockKind, Section, SectionKind
from plcgen.s7.types import Elementary, StringType
from plcgen.scl.declarations import blocks, trim_code
from plcgen.scl.lexer import tokenize
from plcgen.scl.parser import parse
from plcgen.simaticml.datatypes import innermost
from plcgen.simaticml.escape import attribute
from plcgen.simaticml.writing.documents import Setting, document
from plcgen.simaticml.writing.scope import BlockScope
from plcgen.simaticml.writing.structured_text import elements, is_plain, numbered_pieces

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping

    from plcgen.s7.types import Member

_SECTION = re.compile(r"(VAR|VAR_INPUT|VAR_OUTPUT|VAR_IN_OUT|VAR_TEMP)( CONSTANT)?", re.ASCII)
_KINDS = {
    "VAR": SectionKind.STATIC, "VAR_INPUT": SectionKind.INPUT, "VAR_OUTPUT": SectionKind.OUTPUT,
    "VAR_IN_OUT": SectionKind.IN_OUT, "VAR_TEMP": SectionKind.TEMP,
}  # fmt: skip
_TEMPORARY = frozenset({BlockKind.FC, BlockKind.OB})
_WORD = re.compile(r"[^\W\d]\w*")
_QUOTED = re.compile(r'"([^"\n]*)"')
_CALLED = re.compile(r'"([^"\n]*)"\s*\(')
_JOINED = (".", "[", "(", "^", ":", "-")
"""What goes on with the operand of the line before."""

_NAMES = {True: "\ua66e", False: "\ue000"}
"""Stand for a quoted name in a line that is kept: one that needs no quotes, and one that does."""

_PLACES = re.compile("[" + "".join(_NAMES.values()) + "]")
_NAME_MATTERS = ('"(', '" (', '."', '":')
"""Where it matters what a quoted name is: a call, a member, peripheral access."""

_HERE = "\ua66f"
"""Stands for the code in its document."""
_LONG = 20_000
"""Characters of a paragraph that nobody writes twice: it is taken line by line at once."""
_LARGE = 3000
"""Characters of a line's elements that are kept only if the line comes again: calls of a thousand instances do not."""
_NOT_BY_LINE = ("(*", "(/", "'", "GOTO", "\0", *_NAMES.values())
"""A code with one of these is not taken line by line: comments and texts may have brackets inside, labels are far."""


class _Whole(Exception):  # noqa: N818 - control flow
    """This text has to be parsed as a whole."""


def read_block(text: str) -> Block:
    """Return the one code block of a generated source.

    Raises ValueError if the text is not exactly one block without errors: then the generator is wrong.
    """
    try:
        return _quick(text)
    except _Whole:
        pass
    result = parse(text, "generated")
    found, problems = blocks(result)
    problems = [*result.diagnostics, *problems]
    if problems or len(found) != 1:
        raise ValueError(f"a generated source does not parse: {problems[:1] or len(found)}")
    return found[0]


def code_document(block: Block, setting: Setting, known: tuple[Block, ...] = ()) -> str:
    """Document of an FB, FC or OB; ``known`` are the blocks it may call."""
    return "".join(code_pieces(block, setting, known))


def code_pieces(block: Block, setting: Setting, known: tuple[Block, ...] = ()) -> Iterator[str]:
    """The same, piece by piece: that of a caller of ten thousand jobs has 80 MB."""
    if not block.code:
        yield document(block, setting)[0]
        return
    head, _, tail = document(block, setting, _HERE)[0].partition(_HERE)
    yield head
    yield from numbered_pieces(_pieces(block.code, _Meanings(BlockScope.of(block, known), setting)))
    yield tail


def instance_document(instance: Block, of: Block, setting: Setting) -> str:
    """Document of an instance DB with the interface of its function block."""
    inside = {SectionKind.INPUT, SectionKind.OUTPUT, SectionKind.IN_OUT, SectionKind.STATIC}
    return document(replace(instance, sections=tuple(s for s in of.sections if s.kind in inside)), setting)[0]


# --- declarations ----------------------------------------------------------------------------------------


def _quick(text: str) -> Block:
    """Header by the parser, declarations line by line."""
    head, found, code = text.partition("\nBEGIN\n")
    first = re.search(r"^VAR", head, re.MULTILINE)
    begin = first.start() if first else len(head)
    keyword = text.partition(" ")[0]
    if not found or "\nBEGIN\n" in code or not text.rstrip().endswith(f"END_{keyword}"):
        raise _Whole
    result = parse(f"{head[:begin]}\nBEGIN\nEND_{keyword}\n", "generated")
    headers, problems = blocks(result)
    if len(headers) != 1 or problems or result.diagnostics:
        raise _Whole
    sections = tuple(_sections(head[begin:], temporary=headers[0].kind in _TEMPORARY))
    stop = code.rfind(f"END_{keyword}")
    return replace(headers[0], sections=sections, code=trim_code("\n" + code[:stop]))


def _sections(text: str, *, temporary: bool) -> Iterator[Section]:
    kind: SectionKind | None = None
    members: list[Member] = []
    for line in text.split("\n"):
        if kind is None:
            opened = _SECTION.fullmatch(line)
            if opened is None and line:
                raise _Whole
            if opened is not None:
                kind = SectionKind.CONSTANT if opened[2] else _KINDS[opened[1]]
                kind = SectionKind.TEMP if temporary and kind is SectionKind.STATIC else kind
                members = []
        elif line == "END_VAR":
            yield Section(kind, tuple(members))
            kind = None
        else:
            members.append(_declared(line))
    if kind is not None:
        raise _Whole


@lru_cache(maxsize=16384)
def _declared(line: str) -> Member:
    """The one member that a line declares, by the parser."""
    result = parse(f"FUNCTION_BLOCK x\nVAR\n{line}\nEND_VAR\nEND_FUNCTION_BLOCK", "generated")
    found, problems = blocks(result)
    if result.diagnostics or problems or len(found) != 1 or len(found[0].sections) != 1:
        raise _Whole
    members = found[0].sections[0].members
    if len(members) != 1:
        raise _Whole
    return members[0]


# --- code ------------------------------------------------------------------------------------------------


@dataclass(slots=True)
class _Meanings:
    """What the names of a block stand for and how its version writes them, as a part of the key of a line."""

    scope: BlockScope
    setting: Setting
    names: Mapping[str, str | None] | None = None

    def of(self, chunk: str) -> tuple[str | None, ...]:
        """Meaning of every name in a piece of code that the block or the project declares."""
        if self.names is None:
            names: dict[str, str | None] = dict.fromkeys(self.scope.constants, "constant")
            for name, type_ in self.scope.types.items():
                names[name] = "variable" if isinstance(innermost(type_), Elementary | StringType) else repr(type_)
            self.names = names
        words, called = _names(chunk)
        quotes = "quotes" if self.setting.version.marks_quotes else None
        local = (quotes, *map(self.names.get, words))
        return local + tuple(self.scope.instances.get(name) or name for name in called) if called else local


@lru_cache(maxsize=65536)
def _names(chunk: str) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Words of a piece of code, and the quoted names that it calls, in upper case."""
    return tuple(dict.fromkeys(_WORD.findall(chunk.upper()))), tuple(_CALLED.findall(chunk.upper()))


class _Kept:
    """What pieces of code became, by their text and the meaning of their names; bounded."""

    def __init__(self, limit: int) -> None:
        self.limit = limit
        self.pieces: dict[tuple[str, tuple[str | None, ...]], str] = {}
        self.seen: set[int] = set()

    def keep(self, key: tuple[str, tuple[str | None, ...]], piece: str, *, at_once: bool) -> None:
        """Keep a piece, or note that it occurred: what comes only once is not worth the memory."""
        if len(self.pieces) >= self.limit or len(self.seen) >= 16 * self.limit:
            self.pieces.clear()
            self.seen.clear()
        mark = hash(key)
        if at_once or mark in self.seen:
            self.pieces[key] = piece
        else:
            self.seen.add(mark)


_LINES = _Kept(32768)
_PARAGRAPHS = _Kept(1024)


def _pieces(code: str, meanings: _Meanings) -> Iterator[str]:
    """Elements of the code, piece by piece; with ``SLOT`` for the UIds."""
    if any(mark in code for mark in _NOT_BY_LINE):
        yield elements(tokenize(code, "generated"), 0, len(code), meanings.scope, meanings.setting)
        return
    paragraphs = [f"{paragraph}\n\n" for paragraph in code.split("\n\n")]
    paragraphs[-1] = paragraphs[-1][:-2]
    if not all(map(_is_closed, paragraphs)):
        paragraphs = [code]
    for paragraph in paragraphs:
        if len(paragraph) > _LONG:
            yield from (_piece(chunk, meanings, _LINES, _written) for chunk in _chunks(paragraph))
        else:
            yield _piece(paragraph, meanings, _PARAGRAPHS, _by_line)


def _by_line(paragraph: str, meanings: _Meanings) -> str:
    return "".join([_piece(chunk, meanings, _LINES, _written) for chunk in _chunks(paragraph)])


def _written(chunk: str, meanings: _Meanings) -> str:
    return elements(tokenize(chunk, "generated"), 0, len(chunk), meanings.scope, meanings.setting)


def _piece(text: str, meanings: _Meanings, kept: _Kept, write: Callable[[str, _Meanings], str]) -> str:
    """Elements of a piece of code: quoted names are put in where they do not change the elements."""
    names = _QUOTED.findall(text) if '"' in text and not any(mark in text for mark in _NAME_MATTERS) else ()
    template = _QUOTED.sub(lambda found: f'"{_NAMES[is_plain(found[1])]}"', text) if names else text
    key = template, meanings.of(template)
    piece = kept.pieces.get(key)
    if piece is None:
        piece = write(template, meanings)
        kept.keep(key, piece, at_once=kept is _LINES and len(piece) < _LARGE)
    if not names:
        return piece
    parts = _PLACES.split(piece)
    filled = [part for pair in zip(parts, map(attribute, names), strict=False) for part in pair]
    return "".join([*filled, parts[-1]])


@lru_cache(maxsize=4096)
def _is_closed(paragraph: str) -> bool:
    """Whether a paragraph ends outside of brackets and does not begin inside an operand."""
    depth = 0
    for line in paragraph.split("\n"):
        text = line.partition("//")[0]
        depth += text.count("(") + text.count("[") - text.count(")") - text.count("]")
    return not depth and not paragraph.lstrip().startswith((*_JOINED, "\n"))


def _chunks(code: str) -> Iterator[str]:
    """Whole statements or parts of them that begin and end at the end of a line, outside of brackets."""
    lines = code.split("\n")
    last = len(lines) - 1
    held: list[str] = []
    depth = 0
    for number, line in enumerate(lines):
        held.append(line)
        text = line.partition("//")[0] if "/" in line else line
        depth += text.count("(") + text.count("[") - text.count(")") - text.count("]")
        if number == last:
            yield "\n".join(held)
        elif not depth and lines[number + 1] and not lines[number + 1].lstrip().startswith(_JOINED):
            held.append("")
            yield "\n".join(held)
            held = []
