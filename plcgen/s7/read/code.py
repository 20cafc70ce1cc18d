"""The code of a block as tokens: what runs, without comments, blanks, region titles and other layout."""

from __future__ import annotations

import hashlib
from bisect import bisect_left
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from plcgen.s7.scl import ast
from plcgen.s7.scl.lexer import STRING
from plcgen.s7.xml.reading.documents import KINDS
from plcgen.s7.xml.reading.xml import TAGS, child, children, local, text

if TYPE_CHECKING:
    from lxml.etree import _Element as Element

    from plcgen.s7.scl.parser import ParseResult

_LAYOUT = frozenset({"Blank", "NewLine", "LineComment", "Comment", "MultilingualText", "Text"})


@dataclass(frozen=True, slots=True)
class Code:
    """``form`` is ``scl``, ``stl``, ``sd`` (drawn networks as text), ``xml`` or empty (no code).

    ``tokens`` and their ``lines`` (from 1) run parallel. ``source`` are all lines of the text; it is not
    that of the file if ``located`` is False.
    """

    form: str = ""
    tokens: tuple[str, ...] = ()
    lines: tuple[int, ...] = ()
    source: tuple[str, ...] = ()
    located: bool = True

    @property
    def digest(self) -> str:
        """First 16 hexadecimal digits of the SHA-256 over the tokens; empty without code."""
        return hashlib.sha256("\n".join(self.tokens).encode()).hexdigest()[:16] if self.tokens else ""

    def line(self, index: int) -> str:
        """Source line of token ``index``; the token itself where there is no text."""
        number = self.lines[index]
        return self.source[number - 1].strip() if 1 <= number <= len(self.source) else self.tokens[index]


def unit_code(unit: ast.Unit, result: ParseResult) -> Code:
    """Tokens of a block behind its declarations; names and keywords in upper case, regions left out.

    Of a SIMATIC SD document they are those inside of its networks, each behind its language if one of them is drawn.
    """
    tokens = result.tokens
    lines = tuple(tokens.source.split("\n"))
    texts: list[str] = []
    numbers: list[int] = []
    skip = -1
    drawn = any(network.drawn for network in unit.networks)
    languages = {network.inside[0]: network.language for network in unit.networks} if drawn else {}
    for index, line in _inside(unit, result) if unit.networks else _body(unit, result):
        if index and tokens.end(index - 1) in languages:
            texts.append(languages[tokens.end(index - 1)])
            numbers.append(line)
        kind, shown = tokens.kinds[index], tokens.texts[index]
        if kind in {"REGION", "END_REGION"}:
            skip = line
        if line == skip:
            continue
        texts.append(shown if kind == STRING else shown.upper())
        numbers.append(line)
    return Code("sd" if drawn else "scl", tuple(texts), tuple(numbers), lines)


def _inside(unit: ast.Unit, result: ParseResult) -> Iterator[tuple[int, int]]:
    """Token indices and lines of what is inside of the networks that are not empty."""
    tokens = result.tokens
    for network in unit.networks:
        if network.drawn or network.statements:
            begin, end = (bisect_left(tokens.starts, offset) for offset in network.inside)
            for index in range(begin, end):
                yield index, tokens.position(tokens.starts[index])[0]


def statement_list_code(unit: ast.Unit, result: ParseResult) -> Code:
    """Tokens of an STL block; titles of the block's networks are comments."""
    tokens = result.tokens
    lines = tuple(tokens.source.split("\n"))
    found = [
        (tokens.texts[index].upper(), line)
        for index, line in _body(unit, result)
        if not lines[line - 1].lstrip().upper().startswith(("TITLE", "NETWORK"))
    ]
    return Code("stl", tuple(text for text, _ in found), tuple(line for _, line in found), lines)


def _body(unit: ast.Unit, result: ParseResult) -> Iterator[tuple[int, int]]:
    """Token indices and lines between the declarations and the end of the block."""
    tokens = result.tokens
    start = max([unit.start, *(section.end for section in unit.sections)])
    if unit.statements:
        start = max(start, 0)
    first, last = bisect_left(tokens.starts, start), bisect_left(tokens.starts, unit.end)
    begin = next((i + 1 for i in range(first, last) if tokens.kinds[i] == "BEGIN"), first)
    if begin == first and not unit.sections and unit.statements:
        begin = bisect_left(tokens.starts, unit.statements[0].start)
    ends = {f"END_{unit.keyword}"}
    for index in range(begin, last):
        if tokens.kinds[index] in ends:
            return
        yield index, tokens.position(tokens.starts[index])[0]


def document_code(root: Element, *, scl: bool = False) -> dict[str, Code]:
    """Code of every block of a SimaticML document by block name: its networks, UIds and comments left out.

    Blocks whose networks are all in SCL are left out without ``scl``: their text says the same.
    """
    found: dict[str, Code] = {}
    for element in children(root):
        if local(element) in KINDS:
            name = text(child(child(element, "AttributeList"), "Name")).strip()
            found[name] = _networks(element, scl=scl)
    return found


def _networks(element: Element, *, scl: bool) -> Code:
    units = children(child(element, "ObjectList"), "SW.Blocks.CompileUnit")
    sources = [child(child(unit, "AttributeList"), "NetworkSource") for unit in units]
    drawn = [source for source in sources if source is not None]
    if not scl and all(TAGS[network.tag] == "StructuredText" for source in drawn for network in source):
        return Code()
    tokens: list[str] = []
    lines: list[int] = []
    for source in drawn:
        pending: list[Element] = [source]
        while pending:
            node = pending.pop()
            tag = TAGS[node.tag]
            if not tag or tag in _LAYOUT:
                continue
            given: Any = node.items()
            attributes = "".join([f" {key}={value}" for key, value in sorted(given) if key != "UId"])
            content = (node.text or "").strip()
            line: object = node.sourceline
            tokens.append(f"{tag}{attributes}{f' {content}' if content else ''}")
            lines.append(line if isinstance(line, int) else 0)
            pending += node.iterchildren(reversed=True)
    return Code("xml", tuple(tokens), tuple(lines)) if tokens else Code()
