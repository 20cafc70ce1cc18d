"""IMPORT.md, xml/IMPORT.md and LAYOUT.md in the first language of the project; their templates are English.

``guide.toml`` beside the templates has their headings and sentences, the columns of their tables, and the pieces of
what a cell says. What it has not, such as names and comments of the spec, stays as it is.
"""

from __future__ import annotations

import re
import textwrap
import tomllib
from collections.abc import Iterator, Mapping
from functools import cache, partial

from plcgen.base.resources import templates_dir
from plcgen.build.document import Document
from plcgen.build.phrases import LANGUAGES, title_in, translated
from plcgen.project.nouns import Frame

_WIDTH = 120
_MARK = re.compile(r"#+ |\d+\. |- |")
"""What stands in front of the text of a line."""
_BEGINS = re.compile(r"[#|]|```|- |\d+\. ")
_RULE = re.compile(r"\|(?:-+:?\|)+")
_BAR = re.compile(r"(?<!\\)\|")
_PLACE = re.compile(r"\\\{(\w+)\\\}")
_SPOKEN = frozenset({"phrase", "speed", "title"})
"""Places of a sentence that have a phrase of their own."""


def guide(frame: Frame, path: str, template: str, view: Mapping[str, object]) -> Document:
    """A page for people, in the first language of the project if that is German or Chinese."""
    language = frame.languages[0][:2].lower()
    return Document(path, template, view, voice=partial(said_in, language) if language in LANGUAGES else None)


def said_in(language: str, text: str) -> str:
    """A guide in a language."""
    return "\n".join(_lines(language, text.split("\n")))


def _lines(language: str, lines: list[str]) -> Iterator[str]:
    at, code = 0, False
    while at < len(lines):
        line, end = lines[at], at + 1
        code ^= line.startswith("```")
        if line.startswith("| "):
            header = _RULE.fullmatch("".join(lines[end : end + 1])) is not None
            cells = (_cell(language, cell, header=header) for cell in _BAR.split(line)[1:-1])
            yield f"|{'|'.join(cells)}|"
        elif code or line.startswith("#") or not line:
            yield from [line] if code else _paragraph(language, [line])
        else:
            while end < len(lines) and lines[end] and not _BEGINS.match(lines[end]):
                end += 1
            yield from _paragraph(language, lines[at:end])
        at = end


def _paragraph(language: str, lines: list[str]) -> list[str]:
    """A heading, an item or a paragraph of several lines."""
    text = " ".join(line.strip() for line in lines)
    front = _MARK.match(text)
    mark = front[0] if front else ""
    said = _said("lines", language, text.removeprefix(mark))
    if not said:
        return lines
    if mark.startswith("#"):
        return [f"{mark}{said}"]
    indent = " " * len(mark) if mark[:1].isdigit() else ""
    return textwrap.wrap(
        f"{mark}{said}", _WIDTH, subsequent_indent=indent, break_long_words=False, break_on_hyphens=False
    )


def _cell(language: str, cell: str, *, header: bool) -> str:
    """A cell with its blanks: the title of a column, or a sentence, or some pieces of one; a single word is a name."""
    text = cell.strip()
    if header:
        return cell.replace(text, _said("columns", language, text)) if text else cell
    if " " not in text:
        return cell
    said = _said("cells", language, text) or title_in(text).get(language, "")
    pieces = (_said("pieces", language, piece) or piece for piece in text.split("; "))
    return f" {said or '; '.join(pieces)} "


def _said(part: str, language: str, text: str) -> str:
    """What a part of the book has for a text; empty if it has nothing."""
    for pattern, texts in _book()[part]:
        match = pattern.fullmatch(text)
        if match is None:
            continue
        places = match.groupdict()
        spoken = {name: translated(places[name]).get(language, "") for name in _SPOKEN & places.keys()}
        if all(spoken.values()) or "phrase" not in spoken:
            return texts[language].format(**places | {name: one for name, one in spoken.items() if one})
    return ""


@cache
def _book() -> Mapping[str, list[tuple[re.Pattern[str], Mapping[str, str]]]]:
    """Every part of the book: patterns of whole texts, and what is said for them."""
    found = tomllib.loads((templates_dir() / "text" / "guide.toml").read_text("utf-8"))
    return {
        part: [(_pattern(text), dict(zip(LANGUAGES, texts, strict=True))) for text, texts in rows.items()]
        for part, rows in found.items()
    }


def _pattern(text: str) -> re.Pattern[str]:
    return re.compile(_PLACE.sub(r"(?P<\1>.+?)", re.escape(text)))
