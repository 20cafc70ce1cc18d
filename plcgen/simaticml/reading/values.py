"""What may stand for a value in a document: a literal, or a start value made of literals; nothing else is code."""

from __future__ import annotations

import re
from functools import lru_cache

from plcgen.scl.lexer import ADDRESS, EOF, INT, LOCAL, NAME, POINTER, QUOTED, REAL, STRING, TYPED, tokenize

SINGLE = re.compile(r"[^\s;,:(){}\[\]'\"/]+").fullmatch
"""Whether a value is one word without brackets, quotes and slashes, as numbers are."""
_PARTS = frozenset(
    {INT, REAL, STRING, TYPED, POINTER, NAME, QUOTED, LOCAL, ADDRESS, EOF, "TRUE", "FALSE", "-", "+", "*", "/"}
    | {"(", ")", "[", "]", ",", ".", ":="}
)


@lru_cache(maxsize=4096)
def is_literal(text: str) -> bool:
    """Whether a constant is one literal and nothing more: a number, a text, a pointer."""
    if SINGLE(text):
        return True
    kinds = tokenize(text, "").kinds
    return len(kinds) == 2 and kinds[0] in {STRING, TYPED, POINTER} and text == text.strip()


@lru_cache(maxsize=4096)
def is_start_value(text: str) -> bool:
    """Whether a start value is made of literals, names, brackets and commas only, without comments."""
    if is_literal(text):
        return True
    tokens = tokenize(text, "")
    if not _PARTS.issuperset(tokens.kinds):
        return False
    return all(comment.text == "\n" for n in range(len(tokens.kinds)) for comment in tokens.trivia_before(n))
