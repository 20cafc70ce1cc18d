"""The lines of the generated sources behind the bytes of a telegram: where a member is declared, where it is set."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from pathlib import Path

from plcgen.base.files.files import read_bounded
from plcgen.build.sheet import ExchangeSheet, Message
from plcgen.report.review.model import Excerpt, SourceLine
from plcgen.s7.read.generated import generated_sources
from plcgen.s7.read.text import MAX_BYTES, decode_source

_HEAD = re.compile(r'\s*(?:TYPE|DATA_BLOCK|FUNCTION_BLOCK|FUNCTION|ORGANIZATION_BLOCK)\s+"?([^"\s:]+)"?', re.IGNORECASE)
_MEMBER = re.compile(r'\s*"?([A-Za-z_][A-Za-z0-9_]*)"?(?:\s*\{[^}]*\})?\s*:(?!=)')
_QUOTED = re.compile(r'"([^"]+)"')
_SET = re.compile(r'\.\s*"?([A-Za-z_][A-Za-z0-9_]*)"?\s*:=')
Lines = list[tuple[int, str]]
"""Lines of a source with their numbers."""


def excerpts(sources: Iterable[tuple[str, str]], exchanges: tuple[ExchangeSheet, ...]) -> Iterator[Excerpt]:
    """Of every buffer its declaration, of every request the statements of its block that set a member.

    ``sources`` are names and texts.
    """
    known = dict(_blocks(sources))
    homes = {one.request.home.name for one in exchanges}
    seen: set[str] = set()
    for exchange in exchanges:
        for message in (exchange.request, *exchange.answers):
            if message.home.name in seen:
                continue
            seen.add(message.home.name)
            file, lines = known.get(message.home.name.upper(), ("", []))
            found = list(_declared(lines, message))
            if found:
                yield Excerpt(message.home.name, file, tuple(found))
        file, lines = known.get(exchange.block.upper(), ("", []))
        used = list(_used(lines, exchange.request, homes))
        if used:
            yield Excerpt(exchange.request.home.name, file, tuple(used))


def sources_of(folder: Path) -> Iterator[tuple[str, str]]:
    """The generated sources of a folder, as far as they can be read."""
    for path in generated_sources(folder):
        try:
            data = read_bounded(path, MAX_BYTES)
        except OSError:
            continue
        text = decode_source(data, path.name) if len(data) <= MAX_BYTES else None
        if isinstance(text, str):
            yield path.relative_to(folder).as_posix() if path.is_relative_to(folder) else path.name, text


def _blocks(sources: Iterable[tuple[str, str]]) -> Iterator[tuple[str, tuple[str, Lines]]]:
    """Every block by its name in capitals: its file and its lines."""
    for name, text in sources:
        lines: Lines = []
        for number, line in enumerate(text.splitlines(), 1):
            if head := _HEAD.match(line):
                lines = []
                yield head[1].upper(), (name, lines)
            lines.append((number, line))


def _declared(lines: Lines, message: Message) -> Iterator[SourceLine]:
    offsets = {field.name.upper(): field.offset for field in message.fields if field.name}
    for number, line in lines:
        match = _MEMBER.match(line)
        if match and match[1].upper() in offsets:
            yield SourceLine(number, line.strip(), offsets.pop(match[1].upper()))


def _used(lines: Lines, request: Message, homes: set[str]) -> Iterator[SourceLine]:
    """A block may set members of several requests: each line is of the one that it names."""
    offsets = {field.name.upper(): field.offset for field in request.fields if field.name}
    for number, line in lines:
        match, named = _SET.search(line), set(_QUOTED.findall(line))
        if named & homes and request.home.name not in named:
            continue
        if match and match[1].upper() in offsets and "request" in line.lower():
            yield SourceLine(number, line.strip(), offsets[match[1].upper()])
