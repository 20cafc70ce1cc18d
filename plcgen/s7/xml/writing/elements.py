"""Single elements of StructuredText as strings: trivia, tokens, constants, variables of one name.

``SLOT`` stands for every UId until the network is numbered: the elements of one name are the same wherever it stands.
"""

from __future__ import annotations

from functools import lru_cache

from plcgen.s7.scl.lexer import split_trivia
from plcgen.s7.xml.escape import attribute, content

SLOT = "\0"
"""Stands for a UId until the network is numbered."""

UID = f'UId="{SLOT}"'
"""The attribute of every element."""

HAS_QUOTES = f'<BooleanAttribute Name="HasQuotes" {UID}>true</BooleanAttribute>'
"""Says of a name that it stands in quotes though it would need none."""

HAS_HASH = f'<BooleanAttribute Name="HasHash" {UID}>true</BooleanAttribute>'
"""Says of a name behind a dot that it begins with #, as in ``#a.#b``."""

TAB = "    "
"""What a tab becomes: StructuredText has blanks only."""


@lru_cache(maxsize=4096)
def trivia(gap: str, culture: str) -> str:
    """Elements of a gap between two tokens: blanks, line breaks and comments in a language."""
    out: list[str] = []
    begin = breaks = 0
    for comment in split_trivia(gap, 0):
        blank = gap[begin : comment.start]
        begin = comment.start + len(comment.text)
        if breaks and (blank or comment.text != "\n"):
            out.append(_new_line(breaks))
            breaks = 0
        if blank:
            out.append(_blank(blank))
        if comment.text == "\n":
            breaks += 1
        else:
            out.append(_comment(comment.text, culture))
    if breaks:
        out.append(_new_line(breaks))
    if begin < len(gap):
        out.append(_blank(gap[begin:]))
    return "".join(out)


def _new_line(count: int) -> str:
    return f'<NewLine Num="{count}" {UID} />\n' if count > 1 else f"<NewLine {UID} />\n"


def _blank(gap: str) -> str:
    count = len(gap.replace("\t", TAB))
    return f'<Blank Num="{count}" {UID} />' if count > 1 else f"<Blank {UID} />"


def _comment(text: str, culture: str) -> str:
    """``// text`` ends with its line, ``(* text *)`` is inserted, ``(/* text */)`` can be translated."""
    if text.startswith("//"):
        return f"<LineComment {UID}><Text {UID}>{content(text[2:])}</Text></LineComment>"
    if text.startswith("(/*"):
        inner = content(text[3:].removesuffix("*/)"))
        language = f'<MultiLanguageText Lang="{culture}" {UID}>{inner}</MultiLanguageText>'
        return f'<Comment Inserted="true" {UID}>{language}</Comment>'
    inner = content(text[2:].removesuffix("*)").removesuffix("*/"))
    return f'<LineComment Inserted="true" {UID}><Text {UID}>{inner}</Text></LineComment>'


@lru_cache(maxsize=1024)
def token(text: str) -> str:
    """A keyword, operator or other sign."""
    return f'<Token Text="{attribute(text)}" {UID} />'


@lru_cache(maxsize=4096)
def constant(scope: str, text: str) -> str:
    """An operand that is its own value."""
    value = f"<ConstantValue {UID}>{content(text)}</ConstantValue>"
    return f'<Access Scope="{scope}" {UID}><Constant {UID}>{value}</Constant></Access>'


@lru_cache(maxsize=4096)
def named_constant(scope: str, name: str, *, quoted: bool) -> str:
    """A constant by its name."""
    return f'<Access Scope="{scope}" {UID}>{_named("Constant", name, quoted=quoted)}</Access>'


@lru_cache(maxsize=4096)
def simple_symbol(scope: str, name: str, *, quoted: bool) -> str:
    """A variable of one component."""
    return f'<Access Scope="{scope}" {UID}><Symbol {UID}>{_named("Component", name, quoted=quoted)}</Symbol></Access>'


def _named(tag: str, name: str, *, quoted: bool) -> str:
    head = f'<{tag} Name="{attribute(name)}" {UID}'
    return f"{head}>{HAS_QUOTES}</{tag}>" if quoted else f"{head} />"
