"""Texts and names from outside as types: what a file may put into a source, a document, a message.

Every text of a schema is one of these types, and so is every key that whoever writes the file chooses: a text is one
line, in which nothing ends the line, nothing is invisible and nothing turns the direction of reading. A test walks the
schemas and tries every place.
"""

from __future__ import annotations

import re
import unicodedata
from typing import Annotated

from pydantic import AfterValidator, Field, WithJsonSchema

from plcgen.base.files.lookalikes import disguise
from plcgen.base.files.validation import problem

MAX_TEXT = 1000
"""Longest text in characters."""
MAX_NAME = 128
"""Longest name in characters: that of a tag of the TIA Portal; targets have limits of their own."""

MAX_STORED = 2000
"""Longest text in characters of a file that plcgen writes itself: a member with its type and start value."""

_FILLERS = re.compile("[\u034f\u115f\u1160\u17b4\u17b5\u2800\u3164\uffa0]")
"""Letters and marks that are printable by their category, and show nothing."""
_LETTER = re.compile(r"[^\W\d_]")


def unprintable(text: str) -> str:
    """The first character that a printed text must not have; empty if there is none.

    Control and format characters (Cc, Cf), line and paragraph separators of every script, direction marks, surrogates,
    characters that nobody has assigned, and letters that show nothing. Spaces of other widths are spaces.
    """
    if text.isprintable() and (text.isascii() or not _FILLERS.search(text)):
        return ""
    odd = (c for c in text if _FILLERS.match(c) or not (c.isprintable() or unicodedata.category(c) == "Zs"))
    return next(odd, "")


def says_something(reason: str) -> bool:
    """Whether a text gives a reason: it has a word, at least of two letters."""
    return len(_LETTER.findall(reason)) > 1


def printed(value: str) -> str:
    """The text itself. Raises what a validator raises if it has a character that a printed text must not have."""
    odd = unprintable(value)
    if odd:
        line = odd in "\n\r\v\f\x1c\x1d\x1e\x85\u2028\u2029"
        help_ = "write the text in one line; behind >- YAML makes one line of several" if line else "remove it"
        message = f"the character U+{ord(odd):04X} is not allowed: a text is one line of printable characters"
        raise problem(message, help_=help_)
    return value


def _not_blank(value: str) -> str:
    if not value.strip():
        raise problem("a text is one line of printable characters, not empty", help_="write it, or leave the key out")
    return value


def _name(value: str) -> str:
    pretended = disguise(value)
    if pretended:
        raise problem(f'"{value}" {pretended}', code="PG414", help_="write the whole name in the letters of one script")
    return _not_blank(value)


def _reason(value: str) -> str:
    if not says_something(value):
        raise problem(f'"{value}" is no reason', help_="say in a few words why: a reviewer reads it")
    return value


def _printed_if_text(value: object) -> object:
    return printed(value) if isinstance(value, str) else value


_Bounded = Annotated[str, Field(max_length=MAX_TEXT)]
Printed = Annotated[_Bounded, AfterValidator(printed)]
"""Text for people, in one line: a comment, a title, a path."""
Stored = Annotated[str, Field(max_length=MAX_STORED), AfterValidator(printed)]
"""What plcgen has written into a file that it reads again, which anybody may have changed since."""
_SOME_TEXT = WithJsonSchema({"type": "string", "minLength": 1, "maxLength": MAX_TEXT})
Line = Annotated[Printed, AfterValidator(_not_blank), _SOME_TEXT]
"""A text that is not blank."""
Reason = Annotated[Printed, AfterValidator(_reason), _SOME_TEXT]
"""Why something is done that can do harm: a text with a word in it."""
Name = Annotated[
    str,
    Field(max_length=MAX_NAME),
    AfterValidator(printed),
    AfterValidator(_name),
    WithJsonSchema({"type": "string", "minLength": 1, "maxLength": MAX_NAME}),
]
"""What something is called, or how it is referred to: a key, a member, a block, a parameter."""
Value = Annotated[bool | int | float | _Bounded, AfterValidator(_printed_if_text)]
"""A value of a parameter or an address: a number, a truth value, or text, whose characters are bounded like others."""
