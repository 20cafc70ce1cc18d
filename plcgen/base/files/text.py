"""A YAML file as text: bounded, UTF-8, every failure a diagnostic."""

from __future__ import annotations

import codecs
from pathlib import Path

from plcgen.base.diagnostics import Diagnostic, DiagnosticError, Span
from plcgen.base.files.files import read_bounded
from plcgen.base.files.yaml import MAX_BYTES


def read_data(path: Path, most: int, file: str) -> bytes:
    """A file, or one byte more than ``most`` of it. Raises DiagnosticError, PG110."""
    try:
        return read_bounded(path, most)
    except OSError as problem:
        why = "no such file" if isinstance(problem, FileNotFoundError) else problem.strerror or str(problem)
        raise DiagnosticError(
            [Diagnostic("PG110", f"cannot read the file: {why}", Span(file), help="check the path")]
        ) from problem


def read_text(path: Path, file: str | None = None) -> str:
    """Text of a YAML file (UTF-8, with or without BOM, at most ``MAX_BYTES``).

    Raises:
        DiagnosticError: PG110 if it cannot be read, PG102 if it is not UTF-8, PG109 if it is too large.
    """
    name = file or str(path)
    data = read_data(path, MAX_BYTES, name)
    if len(data) > MAX_BYTES:
        message = f"larger than {MAX_BYTES // 1024 // 1024} MiB"
        raise DiagnosticError([Diagnostic("PG109", message, Span(name), help="split the file")])
    if data.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)) or _two_bytes_each(data):
        message = "the file is UTF-16, not UTF-8"
        raise DiagnosticError([Diagnostic("PG102", message, Span(name, 1, 1, 1, 2), help="save the file as UTF-8")])
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as problem:
        line = data.count(b"\n", 0, problem.start) + 1
        column = problem.start - (data.rfind(b"\n", 0, problem.start) + 1) + 1
        raise DiagnosticError(
            [
                Diagnostic(
                    "PG102",
                    f"not UTF-8: byte {data[problem.start]:02X}h cannot be read",
                    Span(name, line, column, line, column + 1),
                    help="save the file as UTF-8",
                )
            ]
        ) from problem


def decoded_list(data: bytes) -> str:
    """Text of a list that some program exported.

    By its byte order mark, else UTF-16 if every other byte is 0, else UTF-8, else Windows-1252.
    """
    if data[:2] in {codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE}:
        return data.decode("utf-16", "replace")
    if _two_bytes_each(data):
        return data.decode("utf-16-le", "replace")
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError:
        return data.decode("cp1252", "replace")


def _two_bytes_each(data: bytes) -> bool:
    """Whether every other byte at the beginning is 0: UTF-16 without a mark."""
    head = data[:200]
    return len(head) > 3 and head[1::2].count(0) > len(head) // 3
