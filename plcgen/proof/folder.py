"""What lies in an output folder: manifest, blocks from the text sources, blocks from SimaticML."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field
from functools import partial
from html import unescape
from pathlib import Path

from plcgen.base.diagnostics import Diagnostic, Span
from plcgen.project.target import Target
from plcgen.proof.making import attempted
from plcgen.s7.layout.shapes import TypeTable
from plcgen.s7.read.generated import generated_documents, generated_sources
from plcgen.s7.read.text import read_source
from plcgen.s7.types.blocks import Block
from plcgen.s7.xml.reading.documents import read_simaticml

_BAR = re.compile(r"(?<!\\)\|")
_MARKED = re.compile(r"(?P<code>(?P<fence>`+)(?!`).*?(?<!`)(?P=fence)(?!`))|\\(?P<sign>[!-/:-@\[-`{-~])|&#?\w+;")
"""What a viewer shows as something else than what stands there, and code (CommonMark: 2.4, 2.5, 6.1)."""


@dataclass(slots=True)
class Folder:
    """Blocks by upper-case name, with the file each came from; ``problems`` is what could not be read.

    ``encoding`` is that of the sources.
    """

    path: Path
    encoding: str = "utf-8-sig"
    text: TypeTable = field(default_factory=TypeTable)
    xml: TypeTable = field(default_factory=TypeTable)
    files: dict[str, Path] = field(default_factory=dict)
    problems: list[Diagnostic] = field(default_factory=list)
    _pieces: dict[Path, dict[str, str]] = field(default_factory=dict, repr=False)

    def place(self, name: str) -> Span:
        """Where a block of the text sources stands."""
        block = self.text.get(name.upper())
        if block is not None and block.span is not None:
            return block.span
        return Span(str(self.files.get(name.upper(), self.path)))

    def text_of(self, name: str) -> str:
        """The lines of a block in its source, up to the next block of the same file."""
        file = self.files[name.upper()]
        if file not in self._pieces:
            lines = file.read_text(self.encoding, "replace").splitlines(keepends=True)
            starts = [(self.place(key).line - 1, key) for key, path in self.files.items() if path == file]
            starts.sort()
            ends = [*(line for line, _ in starts[1:]), len(lines)]
            self._pieces[file] = {
                key: "".join(lines[start:end]) for (start, key), end in zip(starts, ends, strict=True)
            }
        return self._pieces[file][name.upper()]

    def read(self, file: Path, reader: Callable[[], tuple[Iterable[Block], Iterable[Diagnostic]]]) -> list[Block]:
        """Blocks of a file; what is wrong with it, whatever it is, joins the problems."""
        found: list[Block] = []

        def look() -> Iterable[Diagnostic]:
            blocks, problems = reader()
            found.extend(blocks)
            return problems

        self.problems += attempted(look, Span(str(file)))
        return found


def read_folder(path: Path, where: Target, progress: Callable[[str, int, int], None] | None = None) -> Folder:
    """Read every generated source and every generated SimaticML block document of a folder."""
    folder = Folder(path, where.encoding)
    sources, documents = generated_sources(path), generated_documents(path)
    total = len(sources) + len(documents)
    for number, source in enumerate(sources):
        encoding = "cp1252" if where.v5 else None
        for block in folder.read(source, partial(read_source, source, where.dialect, encoding=encoding)):
            earlier = folder.files.get(block.name.upper())
            if earlier is not None:
                message = f'block "{block.name}" is declared a second time, first in {earlier.name}'
                folder.problems.append(Diagnostic("PG610", message, block.span or Span(str(source))))
                continue
            folder.text[block.name.upper()] = block
            folder.files[block.name.upper()] = source
        if progress is not None and number % 50 == 0:
            progress("read", number, total)
    for number, document in enumerate(documents, len(sources)):
        blocks = folder.read(document, partial(read_simaticml, document, classic=where.classic))
        folder.xml.update((block.name.upper(), block) for block in blocks)
        if progress is not None and number % 50 == 0:
            progress("read", number, total)
    return folder


def table_rows(text: str) -> Iterator[list[str]]:
    """Cells of every row of the Markdown tables in a text as a viewer shows them; their rules of dashes have none."""
    for line in text.splitlines():
        if line.startswith("| "):
            yield [rendered(cell) for cell in _BAR.split(line)[1:-1]]


def rendered(line: str) -> str:
    """A line of Markdown as a viewer shows it, with single blanks; spans of code are as they stand there."""
    return plain(_MARKED.sub(lambda mark: mark["code"] or mark["sign"] or unescape(mark[0]), line))


def plain(text: str) -> str:
    """A text with single blanks."""
    return " ".join(text.split())
