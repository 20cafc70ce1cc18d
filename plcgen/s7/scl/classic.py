"""TIA SCL in the spelling of the older compilers, token by token.

Templates are written once, as the TIA Portal takes them for an S7-1500. What the other compilers write differently
without meaning anything else is changed here; where a program differs, a template of its own is chosen by name.

============================================  ==================================  =====================
TIA Portal                                    STEP 7 V5                           S7-300/400, TIA V13
============================================  ==================================  =====================
``#speed``                                    ``speed``
``Array[0..3] of DInt``                       ``ARRAY[0..3] OF DINT``
``VAR CONSTANT``, ``MAX : Int := 3;``         ``CONST``, ``MAX := 3;``
``TITLE = Pump``, ``VERSION : 0.1`` behind    ``TITLE = 'Pump'``, ``VERSION :
``AUTHOR`` and ``FAMILY``                     '0.1'`` next to it
``VERSION : 0.1`` of a ``TYPE``               (left out)
``{ S7_Optimized_Access := 'FALSE' }``        (left out)
``NON_RETAIN``                                (left out)
``TIME_TCK()``, ``BLKMOV(SRCBLK := a,         ``SFC64()``, ``SFC20(SRCBLK := a,
DSTBLK => b)``                                DSTBLK := b)``
``REGION Start`` .. ``END_REGION``            ``// ---- Start ----``              ``// ---- Start ----``
============================================  ==================================  =====================
"""

from __future__ import annotations

import enum
from collections.abc import Iterator
from functools import lru_cache
from operator import itemgetter

from plcgen.s7.scl.lexer import EOF, KEYWORDS, LOCAL, NAME, Tokens, tokenize
from plcgen.s7.types.data_types import ELEMENTARY


class Spelling(enum.Enum):
    """Which compiler a text is written for."""

    TIA = "TIA Portal"
    NO_REGIONS = "TIA Portal without REGION: S7-300/400, and V13"
    STEP7_V5 = "STEP 7 V5"


FUNCTIONS = {"TIME_TCK": "SFC64", "BLKMOV": "SFC20"}
"""System functions that STEP 7 V5 calls by number: its symbol table need not hold a name for them."""

_LEFT_OUT = frozenset({"NON_RETAIN", "S7_Optimized_Access"})
"""Words whose whole line has no counterpart in STEP 7 V5."""

Edit = tuple[int, int, str]
"""Offsets of a piece of the text, from and to, and what stands there instead."""


def respell(text: str, spelling: Spelling) -> str:
    """Rewrite TIA SCL for a compiler; comments, strings and quoted names stay, and so does text already rewritten.

    ``text`` may be any piece of a source that holds whole lines and whole declarations; line ends are LF.
    """
    if spelling is Spelling.TIA:
        return text
    tokens = tokenize(text, "")
    edits = [*_regions(tokens)] if spelling is Spelling.NO_REGIONS else [*_regions(tokens), *_Step7(tokens).edits()]
    parts: list[str] = []
    done = 0
    for start, end, instead in sorted(edits, key=itemgetter(0, 1)):
        parts += (text[done:start], instead)
        done = end
    return "".join([*parts, text[done:]])


@lru_cache(maxsize=4096)
def respell_expression(text: str, spelling: Spelling) -> str:
    """Rewrite a type or an expression; there are few different ones in a project."""
    return respell(text, spelling)


def _line(text: str, offset: int) -> tuple[int, int]:
    """Offsets of the line around an offset: its begin, and behind its line end."""
    end = text.find("\n", offset)
    return text.rfind("\n", 0, offset) + 1, end + 1 if end >= 0 else len(text)


def _regions(tokens: Tokens) -> Iterator[Edit]:
    source = tokens.source
    for kind, start in zip(tokens.kinds, tokens.starts, strict=True):
        if kind == "REGION":
            end = _line(source, start)[1]
            title = source[start + len(kind) : end].strip()
            yield start, end, f"// ---- {title} ----\n"
        elif kind == "END_REGION":
            yield *_line(source, start), ""


class _Step7:
    """What STEP 7 V5 spells differently inside the lines that stay."""

    def __init__(self, tokens: Tokens) -> None:
        self.tokens, self.source = tokens, tokens.source
        self.constants = False
        self.title_end = -1

    def edits(self) -> Iterator[Edit]:
        """Changes in the order of the text, free text of titles and regions left out."""
        free = 0
        for index, (kind, text, start) in enumerate(
            zip(self.tokens.kinds, self.tokens.texts, self.tokens.starts, strict=True)
        ):
            if start < free or kind == EOF:
                continue
            if kind == "REGION":
                free = _line(self.source, start)[1]
            elif kind == NAME and text in {"TITLE", "VERSION"}:
                free = _line(self.source, start)[1]
                yield from self._title(start, free) if text == "TITLE" else self._version(start)
            elif kind == NAME and text in _LEFT_OUT:
                begin, free = _line(self.source, start)
                yield begin, free, ""
            else:
                yield from self._word(index, kind, text, start)

    def _title(self, start: int, line_end: int) -> Iterator[Edit]:
        begin = self.source.index("=", start) + 1
        self.title_end = line_end
        text = self.source[begin:line_end].strip()
        if not text.startswith("'"):
            yield begin, line_end, f" '{text}'\n"

    def _version(self, start: int) -> Iterator[Edit]:
        begin, end = _line(self.source, start)
        number = self.source[self.source.index(":", start) + 1 : end].strip()
        if number.startswith("'"):
            return
        if self.title_end >= 0:
            yield self.title_end, self.title_end, f"VERSION : '{number}'\n"
        self.title_end = -1
        yield begin, end, ""

    def _word(self, index: int, kind: str, text: str, start: int) -> Iterator[Edit]:
        end = start + len(text)
        before = self.tokens.kinds[index - 1] if index else ""
        if kind == LOCAL:
            yield start, start + 1, ""
        elif kind == "=>":
            yield start, end, ":="
        elif kind == "VAR" and self.tokens.texts[index + 1] == "CONSTANT":
            self.constants = True
            yield start, self.tokens.end(index + 1), "CONST"
        elif kind == "END_VAR" and self.constants:
            self.constants = False
            yield start, end, "END_CONST"
        elif kind == ":" and self.constants:
            value = self.tokens.kinds.index(":=", index)
            yield self.tokens.end(index - 1), self.tokens.starts[value], " "
        elif not text.isupper() and (kind in KEYWORDS or self._type(text, before)):
            yield start, end, text.upper()
        elif kind == NAME and text in FUNCTIONS:
            yield start, end, FUNCTIONS[text]

    def _type(self, text: str, before: str) -> bool:
        return before in {":", "OF"} and not self.constants and text.upper() in ELEMENTARY
