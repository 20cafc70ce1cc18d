"""Text to tokens in one regular expression; every character of the source belongs to exactly one match.

Tokens are kept as three parallel lists (kind, text, start offset). Comments and blank space are no tokens;
they are the gaps between tokens, so ``Tokens.trivia_before`` can hand every one of them back.

All quantifiers that could backtrack are possessive: the time is linear in the length of the text.
"""

from __future__ import annotations

import re
from bisect import bisect_right
from dataclasses import dataclass, field
from itertools import accumulate, compress

from plcgen.base.diagnostics import Span

NAME, LOCAL, QUOTED = "name", "local", "quoted"
INT, REAL, STRING, TYPED, POINTER, ADDRESS = "int", "real", "string", "typed", "pointer", "address"
ERROR, EOF = "error", "end of file"
_TRIVIA, _NESTED = "", "nested comment"

KEYWORDS = frozenset(
    """IF THEN ELSIF ELSE END_IF CASE OF END_CASE FOR TO BY DO END_FOR WHILE END_WHILE REPEAT UNTIL END_REPEAT
    EXIT CONTINUE RETURN GOTO REGION END_REGION AND OR XOR NOT MOD DIV TRUE FALSE ARRAY STRUCT END_STRUCT
    VAR VAR_INPUT VAR_OUTPUT VAR_IN_OUT VAR_TEMP END_VAR CONST END_CONST LABEL END_LABEL BEGIN
    FUNCTION_BLOCK END_FUNCTION_BLOCK FUNCTION END_FUNCTION ORGANIZATION_BLOCK END_ORGANIZATION_BLOCK
    DATA_BLOCK END_DATA_BLOCK TYPE END_TYPE""".split()
)
WORDS = KEYWORDS | {NAME, QUOTED, ADDRESS}
"""Kinds that may stand where only a name makes sense: after a dot, before ``:=`` in a call, before ``:``."""

_MARKS = "\u0300-\u036f\u0483-\u0487\u0591-\u05c7\u064b-\u065f\u0900-\u0dff\u0e31-\u0e4e\u200c\u200d\u20d0-\u20ff"
_WORD = rf"[^\W\d][\w{_MARKS}]*+"
_TEXT = r"'(?:[^'$\n]++|\$>[^$]*+\$<|\$.)*+'"
_ADDRESS = r"(?i:DB\d++\.D(?:B[XBWD]?|[XBWD])?\d++(?:\.\d++)?|(?:P[IEQA]|[IEQAM])(?:[BWDL]\d++|X?\d++\.[0-7]))"
_DATE = (
    r"(?i:(?:D|DATE|DT|DATE_AND_TIME|L?TOD|L?TIME_OF_DAY|LDT|DATE_AND_LTIME|DTL)\#)"
    r"[0-9][0-9_]*+(?:[-:.][0-9]++)*+"
)
_COUNT = r"(?:(?:[ \t]++[A-Z_]++|\s++(?:BYTE|WORD|INT))[ \t]++\d++)?+"
"""``BYTE 10`` behind the start of a pointer, BYTE, WORD and INT on the next line too."""
_BYTES = r"(?<=\b[Bb]\#)\([ \t]*+[0-9]++(?:[ \t]*+,[ \t]*+[0-9]++)++[ \t]*+\)"
"""``B#(1, 2)``: the bytes of a WORD or DWORD in statement lists and their data blocks."""
_NO_KEYWORD = "".join(
    rf"(?<!\b(?i:{word})\#)" for word in "NOT AND OR XOR MOD DIV IF ELSIF CASE WHILE UNTIL TO BY THEN ELSE DO".split()
)
"""``NOT#x`` is a keyword and a local variable, no literal with a type."""
_PREFIXED = "|".join(
    (
        rf"(?i:P\#(?:(?:DB[ \t]*+\d++\.)?[A-Z]{{1,3}}[ \t]*+)?\d++\.\d++{_COUNT})",
        rf"[Pp]\#{{1,2}}(?:\"[^\"\n]*+\"|{_WORD})(?:\.{_WORD})*+",
        _ADDRESS + r"(?!\w)(?::P(?!\w))?+",
        _DATE,
    )
)
"""What begins with one of a few letters: most words do not, and are not tried."""
_BLANK = "\ufeff\x1a"
"""What joined or very old files leave behind: byte order marks and the end mark of DOS."""
_PATTERN = re.compile(
    "|".join(
        (
            rf"(?:[\s{_BLANK}]++|//[^\n]*+)++",
            r"[;,)\]]|:=",  # the most frequent ones, which begin nothing longer
            rf"(?=(?i:[DPIEQAMTL]))(?:{_PREFIXED})",
            rf"{_WORD}(?:\#{_NO_KEYWORD}(?:{_TEXT}|{_BYTES}|[-+]?\w++(?:\#\w++)?+(?:\.[0-9]\w*+(?:(?<=[eE])[-+][0-9]++)?+)?+))?+",
            rf"\#(?:\"[^\"\n]*+\"|{_WORD})",
            r"\"[^\"\n]*+\"(?::P(?!\w))?+",
            r"[0-9][0-9_]*+(?:\#[0-9A-Fa-f_]++|\.[0-9][0-9_]*+(?:[eE][-+]?[0-9]++)?+|[eE][-+]?[0-9]++)?+",
            r"\(\*(?:[^*(]++|\*(?!\))|\((?!\*))*+\*\)",
            r"\(\*",
            r"\(/\*(?:[^*]++|\*(?!/\)))*+(?:\*/\))?+",
            r"/\*(?:[^*]++|\*(?!/))*+(?:\*/)?+",
            r":=|=>|\?=|<=|>=|<>|\*\*=?|\+=|-=|\*=|/=|&=|\.\.|[-+*/&=<>()\[\]{}.,:;^@]",
            r"%[A-Za-z]\w*+(?:\.[A-Za-z0-9]\w*+)*+(?::P(?!\w))?+",
            _TEXT,
            r"['\"][^\n]*+",
            r"[\s\S]",
        )
    )
)
_DELIMITERS = re.compile(r"\(\*|\*\)")
_OPERATORS = frozenset(":= => ?= <= >= <> ** **= += -= *= /= &= .. + - * / & = < > ( ) [ ] { } . , : ; ^ @".split())
_TRIVIA_PARTS = re.compile(r"\n|//[^\n]*+|\(/\*[\s\S]*?\*/\)|/\*[\s\S]*?\*/|\(\*")


@dataclass(frozen=True, slots=True)
class Comment:
    r"""A comment with its delimiters, or a line break (text ``"\n"``), at a character offset."""

    text: str
    start: int


@dataclass(frozen=True, slots=True)
class Tokens:
    r"""All tokens of one file; the last one is ``EOF``. Line ends of ``source`` are always ``\n``."""

    file: str
    source: str
    kinds: list[str]
    texts: list[str]
    starts: list[int]
    _lines: list[int] = field(default_factory=list)

    def text_alone(self) -> Tokens:
        """The same file without its tokens: enough for whoever has the tree, and a tenth of the memory."""
        return Tokens(self.file, self.source, [], [], [], self._lines)

    def end(self, index: int) -> int:
        """Offset just behind token ``index``."""
        return self.starts[index] + len(self.texts[index])

    def position(self, offset: int) -> tuple[int, int]:
        """Line and column, both from 1, of a character offset."""
        if not self._lines:
            self._lines.append(0)
            self._lines.extend(match.end() for match in re.finditer("\n", self.source))
        line = bisect_right(self._lines, offset)
        return line, offset - self._lines[line - 1] + 1

    def span(self, start: int, end: int) -> Span:
        """Return the span of a range of character offsets, for example of ``node.start`` and ``node.end``."""
        line, column = self.position(start)
        if line == len(self._lines) or end < self._lines[line]:
            return Span(self.file, line, column, line, column + end - start)
        return Span(self.file, line, column, *self.position(end))

    def trivia_before(self, index: int) -> list[Comment]:
        """Comments and line breaks between token ``index`` and its predecessor, in source order."""
        offset = self.end(index - 1) if index else 0
        return split_trivia(self.source[offset : self.starts[index]], offset)


def split_trivia(gap: str, offset: int) -> list[Comment]:
    """Take a gap between two tokens apart into comments and line breaks."""
    parts: list[Comment] = []
    pos, nested = 0, True
    while match := _TRIVIA_PARTS.search(gap, pos):
        start, pos = match.span()
        if gap.startswith("(*", start):
            pos, nested = _comment_end(gap, start, nested=nested)
        parts.append(Comment(gap[start:pos], offset + start))
    return parts


def _comment_end(source: str, start: int, *, nested: bool) -> tuple[int, bool]:
    """End of the ``(*`` comment at ``start``, and whether comments nest in this file.

    STEP 7 V5 has an option for it: where the nested reading finds no end, the plain one counts from there on.
    """
    if nested:
        depth = 0
        for match in _DELIMITERS.finditer(source, start):
            depth += 1 if match.group() == "(*" else -1
            if not depth:
                return match.end(), True
    end = source.find("*)", start + 2)
    return (end + 2 if end >= 0 else len(source)), False


def _split_with_nesting(source: str) -> list[str]:
    """Split token by token, the slow way: needed only if a comment contains another one or has no end."""
    texts: list[str] = []
    match_at, pos, size, nested = _PATTERN.match, 0, len(source), True
    while pos < size:
        match = match_at(source, pos)
        text = match.group() if match else source[pos]
        if text == "(*":
            end, nested = _comment_end(source, pos, nested=nested)
            text = source[pos:end]
        texts.append(text)
        pos += len(text)
    return texts


class _Kinds(dict[str, str]):
    """Token text to kind, worked out once per distinct text of a file."""

    def __missing__(self, text: str) -> str:
        self[text] = kind = _classify(text)
        return kind


def _classify(text: str) -> str:
    first = text[0]
    if text in _OPERATORS:
        return text
    if first.isspace() or first in _BLANK or text.startswith("//"):
        return _TRIVIA
    if first == "(":
        closed = (text.startswith("(*") and text.endswith("*)") and len(text) > 3) or text.endswith("*/)")
        return _TRIVIA if closed else _NESTED if text == "(*" else ERROR
    if first == "/":
        return _TRIVIA if text.endswith("*/") and len(text) > 3 else ERROR
    if first == "#":
        return LOCAL if len(text) > 1 else ERROR
    if first == "%":
        return ADDRESS if len(text) > 1 else ERROR
    if first == '"':
        return QUOTED if text.endswith(('"', ":P")) and len(text) > 1 else ERROR
    if first == "'":
        return STRING if _PATTERN_TEXT.fullmatch(text) else ERROR
    if first in "0123456789":
        return INT if "#" in text or text.replace("_", "").isdigit() else REAL
    if "#" in text:
        return POINTER if text[:2] in {"P#", "p#"} else TYPED
    upper = text.upper()
    if upper in KEYWORDS:
        return upper
    if text.isidentifier() or _PATTERN_WORD.fullmatch(text):
        return ADDRESS if text[0] in _AREAS and _SHORT_ADDRESS.fullmatch(text) else NAME
    return ADDRESS if text[0] in "DdPpIiEeQqAaMm" and len(text) > 1 else ERROR


_PATTERN_TEXT = re.compile(_TEXT)
_PATTERN_WORD = re.compile(_WORD)


_SHORT_ADDRESS = re.compile(r"(?i:(?:P[IEQA]|[IEQAM])[BWDL][0-9]+)")
_AREAS = frozenset("PIEQAMpieqam")


def tokenize(text: str, file: str) -> Tokens:
    """Split ``text`` into tokens; what no rule accepts becomes an ``ERROR`` token, nothing is ever raised."""
    source = text.replace("\r\n", "\n").replace("\r", "\n") if "\r" in text else text
    memo = _Kinds()
    texts = _PATTERN.findall(source)
    kinds = list(map(memo.__getitem__, texts))
    if _NESTED in memo.values():
        texts = _split_with_nesting(source)
        kinds = [memo[part] for part in texts]
    starts = list(compress(accumulate(map(len, texts), initial=0), kinds))
    texts = list(compress(texts, kinds))
    kinds = list(filter(None, kinds))
    kinds.append(EOF)
    texts.append("")
    starts.append(len(source))
    return Tokens(file, source, kinds, texts, starts)
