"""Texts of SIMATIC SD (``.s7res``): the comments and titles that a ``.s7dcl`` beside it names by key."""

from __future__ import annotations

from pathlib import Path

from plcgen.base.diagnostics import Diagnostic, Report, Severity, Span
from plcgen.base.files.files import read_bounded
from plcgen.base.files.yaml import MAX_BYTES, YamlNode, parse_yaml

SUFFIX = ".s7res"
_ROOT, _KEY = "MultiLingualTexts", "id"
_AMBIGUOUS = "PG108"
"""A text such as ``NO`` or ``12:30`` that YAML readers take for something else: here everything is text."""


def read_texts(document: Path) -> tuple[dict[str, str], list[Diagnostic]]:
    """Texts by key, of the file that belongs to a document, and what is wrong with it (PG804); none if there is none.

    Of several languages it is the one that the file names first, so that all texts of a file are in one, where they
    have it.
    """
    path = document.with_suffix(SUFFIX)
    if not path.is_file():
        return {}, []
    try:
        data = read_bounded(path, MAX_BYTES)
    except OSError as error:
        reason = error.strerror or type(error).__name__
        return {}, [Diagnostic("PG804", f"the file cannot be read: {reason}", Span(str(path)), Severity.WARNING)]
    if len(data) > MAX_BYTES:
        return {}, [Diagnostic("PG802", f"the file has more than {MAX_BYTES} bytes", Span(str(path)))]
    return parse_texts(data.decode("utf-8-sig", "replace"), str(path))


def parse_texts(text: str, file: str) -> tuple[dict[str, str], list[Diagnostic]]:
    """The same of a text; what cannot be understood costs the comments, not the block: all of it is a warning."""
    report = Report()
    root = parse_yaml(text, file, report)
    wrong = [
        Diagnostic("PG804", found.message, found.span, Severity.WARNING, help=found.help)
        for found in report.diagnostics
        if found.code != _AMBIGUOUS
    ]
    listed = root.get(_ROOT) if root is not None else None
    if root is not None and listed is None and not wrong:
        message = f"a file of texts begins with {_ROOT}:"
        wrong.append(Diagnostic("PG804", message, Span(file, 1, 1), Severity.WARNING))
    texts: dict[str, str] = {}
    first = ""
    for entry in listed.items if listed is not None else ():
        key = entry.get(_KEY)
        languages = {name: value for name, (_, value) in entry.pairs.items() if name != _KEY}
        if key is None or any(not _is_text(value) for value in [key, *languages.values()]):
            message = f"a text is written as {_KEY}: KEY with a line for each language, such as en-US: TEXT"
            wrong.append(Diagnostic("PG804", message, entry.span, Severity.WARNING))
        elif languages:
            first = first or next(iter(languages))
            texts[key.raw] = (languages.get(first) or next(iter(languages.values()))).raw
    return texts, wrong


def _is_text(node: YamlNode) -> bool:
    return node.kind == "scalar"
