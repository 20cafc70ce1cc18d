"""The position in the token list, and how the parser reports what it did not expect."""

from __future__ import annotations

import re
from typing import NoReturn

from plcgen.base.diagnostics import Diagnostic, Note
from plcgen.s7.scl import ast
from plcgen.s7.scl.lexer import EOF, ERROR, NAME, WORDS, Tokens

MAX_NESTING = 100
"""Statements, parentheses, structures and calls inside each other."""

MAX_OPERATORS = 1000
"""Operators of one expression: with MAX_NESTING the bound for the depth of the tree."""

MAX_ERRORS = 100
"""After so many errors the rest of a file is not looked at."""

_REPLACEMENTS = {
    "!": "write NOT, or <> for !=", "|": "write OR", "~": "write NOT", "\\": "write /", "?": "write IF .. THEN .. ELSE",
    **dict.fromkeys("‘’“”„«»`´", "write a straight ' around a text, a straight \" around a name"),
    **dict.fromkeys("；：，（）＝。", "switch the keyboard to half-width characters"),
}  # fmt: skip
"""Characters of other languages, of word processors and of Chinese keyboards."""
_LINE_COMMENT = re.compile(r"[ \t]*(?://([^\n]*)|\(\*((?:(?!\*\))[^\n])*)\*\))")


class Halt(Exception):  # noqa: N818 - control flow inside the parser, never seen outside
    """A diagnostic that ends what is being read."""

    def __init__(self, diagnostic: Diagnostic) -> None:
        self.diagnostic = diagnostic
        super().__init__(diagnostic.message)


class SyntaxFault(Halt):
    """On its way to the next synchronisation point."""


class Abort(Halt):
    """The rest of the file is not parsed; no ``SyntaxFault``, so that nothing on the way catches it."""


class Cursor:
    """Tokens, position, depth and the diagnostics found so far: what the parts of the grammar share."""

    def __init__(self, tokens: Tokens) -> None:
        self.tokens = tokens
        self.kinds = tokens.kinds
        self.texts = tokens.texts
        self.starts = tokens.starts
        self.pos = 0
        self.depth = 0
        self.diagnostics: list[Diagnostic] = []
        self.free_text: list[tuple[int, int]] = []

    # --- errors ---------------------------------------------------------------------------------------

    def describe(self, index: int) -> str:
        """How a message names a token."""
        text = self.texts[index]
        if not text:
            return EOF
        return f"'{text}'" if len(text) <= 40 else f"'{text[:37]}...'"

    def diagnostic(
        self,
        message: str,
        start: int,
        end: int,
        *,
        code: str = "PG801",
        text: str = "",
        notes: tuple[Note, ...] = (),
    ) -> Diagnostic:
        """Return an error at a range of offsets; ``text`` says how to fix it."""
        return Diagnostic(code, message, self.tokens.span(start, end), help=text, notes=notes)

    def fault(self, message: str, *, index: int | None = None, text: str = "") -> SyntaxFault:
        """Return a syntax error at a token, by default the current one."""
        index = self.pos if index is None else index
        if self.kinds[index] == ERROR:
            message, text = lexical_error(self.texts[index])
        return SyntaxFault(
            self.diagnostic(message, self.starts[index], max(self.tokens.end(index), self.starts[index]), text=text)
        )

    def expected(self, what: str, text: str = "") -> SyntaxFault:
        """Return the usual message; ``text`` says how to fix it."""
        return self.fault(f"expected {what}, found {self.describe(self.pos)}", text=text)

    def report(self, found: Diagnostic | SyntaxFault) -> None:
        """Keep a diagnostic; too many of them end the run."""
        self.diagnostics.append(found.diagnostic if isinstance(found, SyntaxFault) else found)
        if len(self.diagnostics) >= MAX_ERRORS:
            raise Abort(self.diagnostic("too many errors, the rest of the file was not read", 0, 0))

    def enter(self) -> None:
        """One level deeper; the caller decrements ``depth`` when it returns normally."""
        self.depth += 1
        if self.depth > MAX_NESTING:
            self.too_deep(f"more than {MAX_NESTING} levels of nesting")

    def too_deep(self, message: str) -> NoReturn:
        """PG802, and the end of this file."""
        raise Abort(
            self.diagnostic(message, self.starts[self.pos], self.tokens.end(self.pos), code="PG802", text="split it up")
        )

    # --- moving on ------------------------------------------------------------------------------------

    def expect(self, kind: str) -> int:
        """Step over a token of this kind and return its index."""
        pos = self.pos
        if self.kinds[pos] != kind:
            raise self.expected(kind if kind.isupper() else f"'{kind}'")
        self.pos = pos + 1
        return pos

    def accept(self, kind: str) -> bool:
        """Step over a token if it is of this kind."""
        if self.kinds[self.pos] == kind:
            self.pos += 1
            return True
        return False

    def word(self, what: str) -> str:
        """Step over a name, quoted or not, and return it without quotes."""
        pos = self.pos
        if self.kinds[pos] not in WORDS:
            raise self.expected(what)
        self.pos = pos + 1
        return unquote(self.texts[pos])

    @property
    def start(self) -> int:
        """Offset of the current token."""
        return self.starts[self.pos]

    @property
    def last_end(self) -> int:
        """Offset behind the token before the current one."""
        return self.tokens.end(self.pos - 1) if self.pos else 0

    def upper(self) -> str:
        """Upper-case text of an unquoted name at the position, else an empty string."""
        return self.texts[self.pos].upper() if self.kinds[self.pos] == NAME else ""

    def kind(self, ahead: int) -> str:
        """Kind of a later token; EOF behind the end."""
        index = self.pos + ahead
        return self.kinds[index] if index < len(self.kinds) else EOF

    def skip_to(self, offset: int) -> None:
        """Leave everything before ``offset`` unread: it is free text."""
        self.free_text.append((self.start, offset))
        while self.starts[self.pos] < offset and self.kinds[self.pos] != EOF:
            self.pos += 1

    def rest_of_line(self) -> str:
        """Take the raw text from behind the last token to the end of its line."""
        begin = self.last_end
        end = self.tokens.source.find("\n", begin)
        end = len(self.tokens.source) if end < 0 else end
        self.skip_to(end)
        return self.tokens.source[begin:end].strip()

    def trailing_comment(self, pos: int) -> str:
        """Return the comment on the same line behind the token before ``pos``."""
        match = _LINE_COMMENT.match(self.tokens.source, self.tokens.end(pos - 1))
        return (match[1] or match[2] or "").strip() if match else ""

    # --- attributes -----------------------------------------------------------------------------------

    def attributes(self) -> tuple[ast.Attribute, ...]:
        """``{ a := 'x'; b := 'y' }``, any number of such groups, or nothing."""
        found: list[ast.Attribute] = []
        while self.kinds[self.pos] == "{":
            self.pos += 1
            while not self.accept("}"):
                start = self.start
                name = self.word("an attribute name or '}'")
                while self.accept("."):
                    name += "." + self.word("a name")
                value = ""
                if self.accept(":=") or self.accept("="):
                    # return the literal behind ``:=`` without quotes
                    pos = self.pos
                    if self.kinds[pos] in {EOF, ERROR, ";", "}", ","}:
                        raise self.expected("an attribute value")
                    self.pos += 1
                    text = self.texts[pos]
                    value = text[1:-1] if text[0] in "'\"" else text
                found.append(ast.Attribute(start, self.last_end, name, value))
                if not (self.accept(";") or self.accept(",")) and self.kinds[self.pos] != "}":
                    raise self.expected("';' or '}'")
        return tuple(found)


def unquote(text: str) -> str:
    """Return a name without quotes."""
    return text[1 : text.rindex('"')] if text[:1] == '"' else text


def lexical_error(text: str) -> tuple[str, str]:
    """Message and fix for a token that is none."""
    first = text[0]
    if first == "'":
        return "the string is not closed on its line", "add the closing ', write an apostrophe as $'"
    if first == '"':
        return "the quoted name is not closed on its line", 'add the closing "'
    if text.startswith(("(*", "(/*", "/*")):
        return "the comment is never closed", {"(/": "add */)", "/*": "add */"}.get(text[:2], "add *)")
    if text[0] in _REPLACEMENTS:
        return f"unexpected character {first!r} (U+{ord(first):04X})", _REPLACEMENTS[first]
    if first == "#":
        return "'#' without a name", "write the name of a local variable directly after it"
    return f"unexpected character {text[0]!r} (U+{ord(first):04X})", ""
