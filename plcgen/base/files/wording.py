"""What a YAML parser says, in words of the text instead of the YAML specification."""

from __future__ import annotations

import re
from typing import Any


def reader_position(problem: Any, text: str) -> int:
    """Index of the character YAML does not allow; libyaml counts bytes, the Python reader characters."""
    if isinstance(problem.character, int):
        return len(text.encode()[: problem.position].decode(errors="ignore"))
    return max(0, min(int(problem.position), len(text)))


def at_tab(text: str, mark: Any) -> bool:
    """Whether a tab stands at or before the place a parser stumbled over."""
    lines = text.splitlines() if mark is not None else []
    return mark is not None and mark.line < len(lines) and "\t" in lines[mark.line][: mark.column + 1]


_NAME_BEFORE = re.compile(r"[A-Za-z_]\w*(?=[ \t]*\Z)")
_INDEX = re.compile(r"\[([ 0-9.…–-]*[0-9])")


def at_bracket(text: str, mark: Any) -> tuple[str, str] | None:
    """What and what to do where a parser stumbled over the index of a name; None if it did not.

    Indexes close behind their names are hidden from the parser, see ``brackets``: this one stands apart or is open.
    """
    lines = text.splitlines() if mark is not None else []
    if mark is None or mark.line >= len(lines):
        return None
    line = lines[mark.line]
    name, index = _NAME_BEFORE.search(line[: mark.column]), _INDEX.match(line[mark.column :])
    if name is None or index is None:
        return None
    return (
        "an index that YAML takes for a list",
        f"write {name[0]}[{index[1].strip()}], closed and without a space before it",
    )


_WORDING = (
    ("did not find expected", "expected"),
    ("<block end>", "the end of this block"),
    ("<document start>", "a new document"),
    ("flow sequence", "list in [ ]"),
    ("flow mapping", "mapping in { }"),
    ("block sequence", "list"),
    ("block collection", "list"),
    ("block mapping", "mapping"),
    ("simple key", "key"),
    ("plain scalar", "text"),
    ("quoted scalar", "text in quotes"),
    ("block scalar", "text block"),
    ("found unexpected end of stream", "the file ends here"),
    ("could not find expected ':'", "expected a colon after the key"),
    ("found character that cannot start any token", "this character is not allowed here"),
)


def plain_words(problem: str | None, context: str | None) -> str:
    """A parser's message in words of the text, not of the YAML specification."""
    useful = context and "token" not in context
    text = f"{problem or 'not readable as YAML'}{f' ({context})' if useful else ''}"
    for jargon, plain in _WORDING:
        text = text.replace(jargon, plain)
    return text
