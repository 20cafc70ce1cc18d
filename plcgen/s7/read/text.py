"""Text sources to blocks: .scl, .udt, .db, and the declarations of .awl and .stl."""

from __future__ import annotations

import codecs
import re
from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING

from plcgen.base.diagnostics import Diagnostic, Severity, Span
from plcgen.base.diagnostics.counting import quantity, shortlist
from plcgen.base.files.files import read_bounded
from plcgen.s7.read.texts import SUFFIX as TEXTS
from plcgen.s7.read.texts import read_texts
from plcgen.s7.scl.declarations import blocks
from plcgen.s7.scl.dialect import Dialect
from plcgen.s7.scl.grammar.documents import is_document
from plcgen.s7.scl.lexer import tokenize
from plcgen.s7.scl.parser import MAX_CHARACTERS, parse

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Mapping

    from plcgen.s7.scl.parser import ParseResult
    from plcgen.s7.types.blocks import Block

MAX_BYTES = 2 * MAX_CHARACTERS
"""Larger files are refused with PG802 before they are read."""

_HIGH = re.compile(rb"[\x80-\xff]+")
_CHINESE = re.compile(rb"(?:[\xa1-\xf7][\xa1-\xfe])+")
_LAST_COMMON = 0xD7
"""First byte of the last of the 3,755 common characters of GB 2312."""
_CYRILLIC = 0xC0
"""First letter of Windows-1251."""
_NO_CENTRAL_EUROPEAN = re.compile(rb"[\x81\x83\x88\x90\x98]")
_SAMPLE = 2000
_WORD = 4
"""So many letters in a row that are no ASCII do not occur in Western languages."""

_DECLARATIONS_ONLY = frozenset({".awl", ".stl"})
_HEAD = 4096
"""So many bytes show whether a file is text."""
_SHOWN = 3
"""So many names of files stand in one message."""
_BOMS = (
    (codecs.BOM_UTF8, "utf-8"),
    (codecs.BOM_UTF32_LE, "utf-32-le"),
    (codecs.BOM_UTF32_BE, "utf-32-be"),
    (codecs.BOM_UTF16_LE, "utf-16-le"),
    (codecs.BOM_UTF16_BE, "utf-16-be"),
)


def read_source(
    path: Path | str,
    dialect: Dialect | None = None,
    *,
    encoding: str | None = None,
    constants: Mapping[str, int] | None = None,
    keep: Callable[[ParseResult], object] | None = None,
) -> tuple[list[Block], list[Diagnostic]]:
    """Blocks of one file and everything wrong with it; a file that cannot be read is a diagnostic too.

    Without ``dialect`` everything is accepted that one of the three compilers accepts. ``encoding`` names the
    code page of an ANSI file (by default it is guessed, see ``code_page``); a byte order mark and valid UTF-8
    come first. ``constants`` are the whole numbers of the project by name. ``keep`` gets the syntax tree.
    """
    loaded = load_text(path, dialect, encoding=encoding)
    if isinstance(loaded, Diagnostic):
        return [], [loaded]
    text, refused = loaded
    texts, problems = read_texts(Path(path)) if is_document(str(path)) else ({}, [])
    found, diagnostics = parse_source(
        text, str(path), dialect, bodies=has_bodies(path), constants=constants, keep=keep, texts=texts
    )
    return found, [*refused, *problems, *diagnostics]


def load_text(
    path: Path | str, dialect: Dialect | None = None, *, encoding: str | None = None
) -> tuple[str, list[Diagnostic]] | Diagnostic:
    """Text of a file, and PG803 if ``dialect`` misreads its encoding; PG802 or PG804 if there is no text to have."""
    file = str(path)
    if Path(path).suffix.lower() == TEXTS:
        message = "these are the texts of a SIMATIC SD document, not the document"
        return Diagnostic("PG804", message, Span(file), help=f"name {Path(path).stem}.s7dcl: it brings its texts")
    try:
        data = read_bounded(Path(path), MAX_BYTES)
    except OSError as error:
        reason = error.strerror or type(error).__name__
        return Diagnostic("PG804", f"the file cannot be read: {reason}", Span(file))
    if len(data) > MAX_BYTES:
        return Diagnostic("PG802", f"the file has more than {MAX_BYTES} bytes", Span(file))
    text = decode_source(data, file, encoding)
    if isinstance(text, Diagnostic):
        return text
    refused = _refused_encoding(data, text, file, dialect)
    if dialect is not None and dialect is not Dialect.TIA_1200_1500 and is_document(file):
        refused.append(Diagnostic("PG803", f"{dialect.label} does not support SIMATIC SD documents", Span(file)))
    return text, refused


def has_bodies(path: Path | str) -> bool:
    """Whether the code of a source is read too: that of a statement list is skipped."""
    return Path(path).suffix.lower() not in _DECLARATIONS_ONLY


def is_binary(data: bytes) -> bool:
    """Whether the beginning of a file cannot be that of a text in any encoding of the engineering tools."""
    return b"\0" in data and not any(data.startswith(mark) for mark, _ in _BOMS) and not _unmarked_utf16(data)


def is_binary_file(path: Path) -> bool:
    """Whether a file such as the cross-references of a project (``XRef.db``) is no text; what cannot be read is not."""
    try:
        return is_binary(read_bounded(path, _HEAD)[:_HEAD])
    except OSError:
        return False


def no_text(folder: Path, files: Iterable[Path]) -> list[Diagnostic]:
    """A note that names the files of a folder which have the name of a source and are none."""
    names = sorted(path.name for path in files)
    if not names:
        return []
    shown = shortlist(names, _SHOWN)
    what = quantity(len(names), "file that is no text", "files that are no text")
    return [Diagnostic("PG804", f"{what} in this folder not read: {shown}", Span(str(folder)), Severity.NOTE)]


def parse_source(
    text: str,
    file: str,
    dialect: Dialect | None = None,
    *,
    bodies: bool = True,
    constants: Mapping[str, int] | None = None,
    keep: Callable[[ParseResult], object] | None = None,
    texts: Mapping[str, str] | None = None,
) -> tuple[list[Block], list[Diagnostic]]:
    """Blocks of a source that is already decoded; ``bodies=False`` skips code, as for STL.

    ``constants`` are the whole numbers of the project by name. ``keep`` gets the syntax tree. ``texts`` are the words
    of a SIMATIC SD document by key; PG814 notes the first of its networks whose language is not SCL.
    """
    result = parse(text, file, dialect, bodies=bodies, texts=texts)
    if keep is not None:
        keep(result)
    found, diagnostics = blocks(result, dialect, constants)
    return found, sorted([*result.diagnostics, *diagnostics, *_drawn(result)], key=lambda d: d.sort_key)


def _drawn(result: ParseResult) -> Iterator[Diagnostic]:
    """PG814 for every block with a network that is drawn, at the first one."""
    for unit in result.units:
        network = next((network for network in unit.networks if network.drawn), None)
        if network is not None:
            message = f"a network in {network.language} is not read: only the interface of this block is used"
            yield Diagnostic("PG814", message, result.span(network), Severity.NOTE)


def decode_source(data: bytes, file: str, encoding: str | None = None) -> str | Diagnostic:
    """Text of a source file, or PG804 with the place of the first byte that makes no sense."""
    for mark, name in _BOMS:
        if data.startswith(mark):
            return _decode_as(data[len(mark) :], name, file)
    if b"\0" in data:
        if text := _unmarked_utf16(data):
            return text
        line, column = _place(data, data.index(b"\0"))
        message = "a zero byte in a file without byte order mark: neither ANSI nor UTF-8"
        text = "save it as UTF-8 with BOM"
        return Diagnostic("PG804", message, Span(file, line, column, line, column + 1), help=text)
    try:
        return data.decode("utf-8")
    except UnicodeDecodeError:
        return _decode_as(data, encoding or code_page(data), file)


def _unmarked_utf16(data: bytes) -> str:
    """Text of UTF-16 without byte order mark; empty if the bytes are none.

    Keywords, blanks and line ends make every source mostly ASCII, and no source has a zero character.
    """
    head = data[: 2 * _SAMPLE]
    zeros = head[0::2].count(0), head[1::2].count(0)
    if len(data) % 2 or 4 * max(zeros) < len(head) // 2:
        return ""
    try:
        text = data.decode("utf-16-be" if zeros[0] > zeros[1] else "utf-16-le")
    except UnicodeDecodeError:
        return ""
    return "" if "\0" in text else text


def code_page(data: bytes) -> str:
    """Guess the code page of an ANSI source from the runs of bytes above 7Fh that its comments and names leave.

    Western texts have single such bytes, Cyrillic words consist of them, and GB 2312 always has two per
    character. Polish and Czech sources show by bytes that Windows-1252 does not have.
    """
    runs = [match.group() for match in islice(_HIGH.finditer(data), _SAMPLE)]
    high = b"".join(runs)
    if any(len(run) >= _WORD for run in runs):
        first_bytes = high[::2]
        common = sum(byte <= _LAST_COMMON for byte in first_bytes)
        if all(_CHINESE.fullmatch(run) for run in runs) and 2 * common > len(first_bytes):
            return "gb18030"
        letters = sum(byte >= _CYRILLIC for byte in high)
        if len(high) >= 3 * len(runs) and 10 * letters >= 9 * len(high):
            return "cp1251"
    try:
        data.decode("cp1252")
    except UnicodeDecodeError:
        return "cp1252" if _NO_CENTRAL_EUROPEAN.search(data) else "cp1250"
    return "cp1252"


def _refused_encoding(data: bytes, text: str, file: str, dialect: Dialect | None) -> list[Diagnostic]:
    """Report an encoding that the target misreads: UTF-8 needs its mark in TIA, V5 knows ANSI only.

    TIA takes ANSI, UCS2, and UTF-8, UTF-16 and UTF-32 with byte order mark (help of the TIA Portal, "Using external
    source files"). Other UTF-8 is read as ANSI: names and texts get wrong, comments only become unreadable.
    """
    if dialect is None or (data.isascii() and b"\0" not in data):
        return []
    marked = any(data.startswith(mark) for mark, _ in _BOMS)
    severity = Severity.ERROR
    if dialect.is_tia and not marked and b"\0" not in data and _is_utf8(data):
        what, help_ = "UTF-8 without byte order mark", "save it as UTF-8 with BOM"
        if all(token.isascii() for token in tokenize(text, file).texts):
            what, severity = f"{what}: the comments become unreadable", Severity.WARNING
    elif not dialect.is_tia and (marked or b"\0" in data or _is_utf8(data)):
        what, help_ = "Unicode sources", "save it in the code page of the engineering station"
    else:
        return []
    return [Diagnostic("PG803", f"{dialect.label} does not support {what}", Span(file), severity, help=help_)]


def _is_utf8(data: bytes) -> bool:
    try:
        data.decode("utf-8")
    except UnicodeDecodeError:
        return False
    return True


def _decode_as(data: bytes, name: str, file: str) -> str | Diagnostic:
    try:
        return data.decode(name)
    except UnicodeDecodeError as error:
        unit = {"utf-16": 2, "utf-32": 4}.get(name[:6], 1)
        line, column = _place(data[: error.start].decode(name, "replace").encode("latin-1", "replace"), None)
        found = data[error.start : error.start + unit].hex(" ").upper()
        message = f"the bytes {found} are no {name.upper()} text"
        text = "save it as UTF-8 with BOM, or name its code page"
        return Diagnostic("PG804", message, Span(file, line, column, line, column + 1), help=text)
    except LookupError:
        return Diagnostic("PG804", f"unknown code page {name}", Span(file))


def _place(data: bytes, offset: int | None) -> tuple[int, int]:
    """Line and column, from 1, of a byte offset; None means the end."""
    before = data[:offset]
    return before.count(b"\n") + 1, len(before) - (before.rfind(b"\n") + 1) + 1
