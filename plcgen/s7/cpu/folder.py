"""A generated folder as a program: sources, tags and block numbers as they lie on disk."""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path

from plcgen.base.diagnostics import Diagnostic, DiagnosticError, Span, has_errors
from plcgen.base.files.files import read_bounded
from plcgen.s7.cpu.program import Program, Source
from plcgen.s7.cpu.type_rules import IecCheck
from plcgen.s7.read.generated import generated_documents, generated_sources
from plcgen.s7.read.symbols import MAX_BYTES, SUFFIXES, read_rows
from plcgen.s7.read.text import decode_source, load_text
from plcgen.s7.scl.dialect import Dialect
from plcgen.s7.types.blocks import BlockKind
from plcgen.s7.xml.reading.documents import read_simaticml, read_tag_table

Tags = dict[str, str | tuple[str, str]]
_COLUMNS = ("name", "data type", "logical address")
_HEAD = 1000
_LARGE = 1024 * 1024
"""Characters of sources beyond which their trees are not kept: they take more than ten times as much memory."""
_CODE, _DATA = re.compile(rb"<SW\.Blocks\.(FB|FC|OB) "), re.compile(rb"<SW\.(Tags|Blocks\.(GlobalDB|InstanceDB))")

_NUMBERED = re.compile(r"^\| (\S{1,125}) \| DB(\d{1,5}) \|$", re.MULTILINE)
"""A row of IMPORT.md that gives a data block its number."""


@dataclass(frozen=True, slots=True)
class FolderParts:
    """What a program is made of, read once: sources (file name and text), tags, numbers of data blocks, constants.

    A file that cannot be read stands there as its path.
    """

    sources: tuple[Source, ...]
    tags: Tags
    numbers: dict[str, int]
    constants: dict[str, int]

    @property
    def large(self) -> bool:
        """Whether memory counts for more than the time to parse every block twice."""
        return sum(len(source[1]) for source in self.sources if isinstance(source, tuple)) > _LARGE

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
    """Load the generated sources of a folder; symbols come from ``*.sdf``, tags and numbers from ``xml/*.xml``,
    without documents the numbers from IMPORT.md.

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
    guide = folder / "IMPORT.md"
    if not numbers and guide.is_file():  # without documents, whoever imports gives the numbers that matter by hand
        rows = _NUMBERED.findall(read_bounded(guide, MAX_BYTES).decode("utf-8", "replace"))
        numbers = {name: int(number) for name, number in rows}
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
        tags = read_tags(path)
        if not tags:
            message = "there is no tag in this file: expected name, data type, logical address"
            raise DiagnosticError([Diagnostic("PG804", message, Span(str(path)))])
        return tags
    tables, problems = read_tag_table(path)
    if has_errors(problems):
        raise DiagnosticError(problems)
    return {tag.name: (tag.address, tag.type) for table in tables for tag in table.tags}


def read_tags(path: Path | str) -> Tags:
    """Tag table as CSV: name, data type, logical address, in this order or as the titles of the first line say.

    What separates the columns is told by the first line. Raises DiagnosticError (PG802, PG804) for what is no text.
    """
    path = Path(path)
    data = read_bounded(path, MAX_BYTES)
    if data.startswith(b"PK\x03\x04"):
        text: str | Diagnostic = Diagnostic("PG804", "a workbook, not text", Span(str(path)), help="save it as CSV")
    elif len(data) > MAX_BYTES:
        text = Diagnostic("PG802", f"the tag table has more than {MAX_BYTES} bytes", Span(str(path)))
    else:
        text = decode_source(data, str(path))
    if isinstance(text, Diagnostic):
        raise DiagnosticError([text])
    header = text.partition("\n")[0]
    separator = ";" if header.count(";") > header.count(",") else ","
    rows = [row for row in csv.reader(io.StringIO(text, newline=""), delimiter=separator) if len(row) >= len(_COLUMNS)]
    titles = [cell.strip().lower() for cell in rows[0]] if rows else []
    name, type_, address = (titles.index(title) if title in titles else n for n, title in enumerate(_COLUMNS))
    titled = bool(rows) and not any(map(str.isdigit, rows[0][address]))
    return {
        row[name].strip(): (row[address].strip().removeprefix("%"), row[type_].strip())
        for row in rows[titled:]
        if len(row) > max(name, type_, address)
    }
