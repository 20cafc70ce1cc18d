"""The lines of the generated sources behind the bytes of a telegram: where a member is declared, where it is set."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

from plcgen.base.files.files import read_bounded
from plcgen.build.sheet import ExchangeSheet, Message
from plcgen.report.review.model import Excerpt, SourceLine
from plcgen.s7.read.generated import generated_sources
from plcgen.s7.read.text import decode_source

_MAX_SOURCE = 2 * 1024 * 1024
_MEMBER = re.compile(r'\s*"?([A-Za-z_][A-Za-z0-9_]*)"?(?:\s*\{[^}]*\})?\s*:(?!=)')
_SET = re.compile(r'\.\s*"?([A-Za-z_][A-Za-z0-9_]*)"?\s*:=')


def excerpts(folder: Path, exchanges: tuple[ExchangeSheet, ...]) -> Iterator[Excerpt]:
    """Of every buffer its declaration, of every request the statements of its block that set a member."""
    files = {path.stem.upper(): path for path in generated_sources(folder)}
    seen: set[str] = set()
    for exchange in exchanges:
        for message in (exchange.request, *exchange.answers):
            if message.home.name in seen:
                continue
            seen.add(message.home.name)
            lines = _lines(files.get(message.home.name.upper()))
            found = list(_declared(lines, message))
            if found:
                yield Excerpt(message.home.name, _name(files, message.home.name, folder), tuple(found))
        used = list(_used(_lines(files.get(exchange.block.upper())), exchange.request))
        if used:
            yield Excerpt(exchange.request.home.name, _name(files, exchange.block, folder), tuple(used))


def _name(files: dict[str, Path], name: str, folder: Path) -> str:
    path = files[name.upper()]
    return path.relative_to(folder).as_posix() if path.is_relative_to(folder) else path.name


def _lines(path: Path | None) -> list[str]:
    if path is None:
        return []
    try:
        data = read_bounded(path, _MAX_SOURCE)
    except OSError:
        return []
    text = decode_source(data, path.name) if len(data) <= _MAX_SOURCE else None
    return text.splitlines() if isinstance(text, str) else []


def _declared(lines: list[str], message: Message) -> Iterator[SourceLine]:
    offsets = {field.name.upper(): field.offset for field in message.fields if field.name}
    for number, line in enumerate(lines, 1):
        match = _MEMBER.match(line)
        if match and match[1].upper() in offsets:
            yield SourceLine(number, line.strip(), offsets.pop(match[1].upper()))


def _used(lines: list[str], request: Message) -> Iterator[SourceLine]:
    offsets = {field.name.upper(): field.offset for field in request.fields if field.name}
    for number, line in enumerate(lines, 1):
        match = _SET.search(line)
        if match and match[1].upper() in offsets and "request" in line.lower():
            yield SourceLine(number, line.strip(), offsets[match[1].upper()])
