"""A generated folder as a program: sources, tags and block numbers as they lie on disk."""

from __future__ import annotations

import csv
import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path

from plcgen.cpu.program import Program, Source
from plcgen.cpu.type_rules import IecCheck
from plcgen.diagnostics import Diagnostic, DiagnosticError, has_errors
from plcgen.s7.blocks import BlockKind
from plcgen.scl.dialect import Dialect
from plcgen.simaticml.reading.documents import read_simaticml, read_tag_table
from plcgen.sources.generated import generated_documents, generated_sources
from plcgen.sources.symbols import SUFFIXES, read_rows
from plcgen.sources.text import load_text

Tags = dict[str, str | tuple[str, str]]
_HEAD = 1000
_CODE, _DATA = re.compile(rb"<SW\.Blocks\.(FB|FC|OB) "), re.compile(rb"<SW\.(Tags|Blocks\.(GlobalDB|InstanceDB))")


@dataclass(frozen=True, slots=True)
class FolderParts:
    """What a program is made of, read once: sources (file name and text), tags, numbers of data blocks, constants.

    A file that cannot be read stands there as its path.
    """

    sources: tuple[Source, ...]
    tags: Tags
    numbers: dict[str, int]
    constants: dict[str, int]

    def load(
        self,
        dialect: Dialect,
        *,
        coverage: bool = False,
        litter: bool = False,
        iec_check: IecCheck = IecCheck.AS_STATED,
        lean: bool = False,
    ) -> Program:
        """Compile them."""
        return Program.load(
            self.sources,
            dialect,
            tags=self.tags,
            numbers=self.numbers,
            constants=self.constants,
            coverage=coverage,
            litter=litter,
            iec_check=iec_check,
            lean=lean,
        )


def load_folder(
    folder: Path | str,
    dialect: Dialect,
    *,
    coverage: bool = False,
    iec_check: IecCheck = IecCheck.AS_STATED,
    constants: Mapping[str, int] | None = None,
    symbols: Mapping[str, tuple[str, str]] | None = None,
    more: Iterable[Source] = (),
) -> Program:
    """Load the generated sources of a folder; symbols come from ``*.sdf``, tags and numbers from ``xml/*.xml``.

    ``constants`` are system constants by their names; ``symbols`` (address and type by name) and ``more`` are tags and
    sources that do not lie in the folder.
    """
    parts = read_parts(Path(folder), dialect, constants=constants, symbols=symbols, more=more)
    return parts.load(dialect, coverage=coverage, iec_check=iec_check)


def read_parts(
    folder: Path,
    dialect: Dialect,
    *,
    constants: Mapping[str, int] | None = None,
    symbols: Mapping[str, tuple[str, str]] | None = None,
    more: Iterable[Source] = (),
) -> FolderParts:
    """What :func:`load_folder` compiles."""
    tags: Tags = dict(symbols or {})
    numbers: dict[str, int] = {}
    for table in sorted(folder.glob("*.sdf")):
        tags |= read_tag_file(table)
    if (folder / "tags.csv").is_file():
        tags |= read_tags(folder / "tags.csv")
    for document in generated_documents(folder):
        if not _is_code(document):
            found, _ = read_tag_table(document)
            for tag_table in found:
                tags |= {tag.name: (tag.address, tag.type) for tag in tag_table.tags}
            for block in () if found else read_simaticml(document, classic=dialect.classic)[0]:
                if block.kind is BlockKind.DB and block.number is not None:
                    numbers[block.name] = block.number
    return FolderParts((*map(_text, generated_sources(folder)), *more), tags, numbers, dict(constants or {}))


def _text(path: Path) -> Source:
    loaded = load_text(path)
    return path if isinstance(loaded, Diagnostic) else (str(path), loaded[0])


def _is_code(document: Path) -> bool:
    """Whether a document has nothing but a code block, by its head: those of callers are large."""
    with document.open("rb") as file:
        head = file.read(_HEAD)
    return _CODE.search(head) is not None and _DATA.search(head) is None


def read_tag_file(path: Path | str) -> Tags:
    """Symbols of any file that holds some: a table of STEP 7 V5, CSV, or an exported tag table (``.xml``)."""
    path = Path(path)
    if path.suffix.lower() in SUFFIXES:
        rows, found = read_rows(path)
        if found:
            raise DiagnosticError(found)
        return {symbol: (address, type_) for symbol, address, type_ in rows if type_}
    if path.suffix.lower() != ".xml":
        return read_tags(path)
    tables, problems = read_tag_table(path)
    if has_errors(problems):
        raise DiagnosticError(problems)
    return {tag.name: (tag.address, tag.type) for table in tables for tag in table.tags}


def read_tags(path: Path | str) -> Tags:
    """Tag table as CSV: name, data type, logical address, comment; what separates them is told by the header line."""
    with Path(path).open(encoding="utf-8-sig", newline="") as file:
        header = file.readline()
        file.seek(0)
        separator = ";" if header.count(";") > header.count(",") else ","
        rows = [row for row in csv.reader(file, delimiter=separator) if len(row) >= 3]
    return {row[0].strip(): (row[2].strip().removeprefix("%"), row[1].strip()) for row in rows[1:]}
