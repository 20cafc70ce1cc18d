"""Blocks and types, and ``parse``: text in, tree and diagnostics out, never an exception."""

from __future__ import annotations

import re
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from plcgen.diagnostics import Diagnostic, Span
from plcgen.scl import ast
from plcgen.scl.cursor import Abort, Fault, lexical_error, unquote
from plcgen.scl.lexer import ADDRESS, EOF, ERROR, INT, LOCAL, NAME, QUOTED, Tokens, tokenize
from plcgen.scl.parser_declarations import SECTIONS, UNIT_ENDS, UNIT_KEYWORDS, DeclarationParser
from plcgen.scl.parser_statements import StatementParser

if TYPE_CHECKING:
    from plcgen.scl.dialect import Dialect

MAX_CHARACTERS = 8 * 1024 * 1024
"""Longer sources are refused with PG802."""

_PROPERTIES = frozenset({"TITLE", "AUTHOR", "NAME", "FAMILY", "VERSION"})
_FLAGS = frozenset({"NON_RETAIN", "RETAIN", "KNOW_HOW_PROTECT", "READ_ONLY", "UNLINKED", "CODE_VERSION1", "STANDARD"})
_VERSION = re.compile(r"[ \t]*('[^'\n]*'|[0-9.]+)")
_QUOTED_VALUE = re.compile(r"[ \t]*'([^'\n]*)'")
_NO_BLOCK = (
    "a source consists of FUNCTION_BLOCK, FUNCTION, ORGANIZATION_BLOCK, DATA_BLOCK and TYPE, each with its END: "
    "put statements into a block"
)
_TITLE = re.compile(r"(?im)^[ \t]*+TITLE[ \t]*+=[^\n]*+")
_NAMESPACES = frozenset({"NAMESPACE", "USING", "END_NAMESPACE"})
_NUMBERED = frozenset({"DB", "FB", "FC", "OB", "UDT", "SFB", "SFC"})


@dataclass(frozen=True, slots=True)
class ParseResult:
    """Units in source order, every diagnostic in reading order, and the tokens for spans and comments."""

    units: tuple[ast.Unit, ...]
    diagnostics: tuple[Diagnostic, ...]
    tokens: Tokens

    def span(self, node: ast.Node) -> Span:
        """Where a node stands."""
        return self.tokens.span(node.start, node.end)


class Parser(DeclarationParser, StatementParser):
    """The whole grammar; ``bodies=False`` reads declarations and skips code (for STL sources)."""

    def __init__(self, tokens: Tokens, *, bodies: bool = True) -> None:
        super().__init__(tokens)
        self.bodies = bodies
        self.comment_lines: list[str] = []
        self.code_start = 0
        gotos = (i + 1 for i, kind in enumerate(self.kinds) if kind == "GOTO")
        self.has_regions = "END_REGION" in self.kinds
        self.jump_labels = frozenset(self.texts[i].upper() for i in gotos)

    def source(self) -> tuple[ast.Unit, ...]:
        """Units up to the end of the file."""
        units: list[ast.Unit] = []
        try:
            while self.kinds[self.pos] != EOF:
                if self.kinds[self.pos] == "{":
                    self.skip_pragma()
                    continue
                if self.upper() in _NAMESPACES:
                    self.namespace()
                    continue
                if self.kinds[self.pos] not in UNIT_KEYWORDS:
                    if self.foreign_unit() or self.misspelt_unit():
                        continue
                    found = self.expected("a block or TYPE").diagnostic
                    self.report(found if found.help else replace(found, help=_NO_BLOCK))
                    self.skip_to_unit()
                    continue
                self.recover_unit(units)
        except Abort as abort:
            self.diagnostics.append(abort.diagnostic)
        return tuple(units)

    def namespace(self) -> None:
        """``NAMESPACE a.b``, ``USING a.b;`` and ``END_NAMESPACE``: blocks keep their own names."""
        closing = self.upper() == "END_NAMESPACE"
        self.pos += 1
        while not closing and self.kinds[self.pos] in {NAME, QUOTED}:
            self.pos += 1
            closing = not self.accept(".")
        self.accept(";")

    def recover_unit(self, units: list[ast.Unit]) -> None:
        """One unit; a fault that nothing inside could catch costs the unit."""
        self.depth = 0
        self.open.clear()
        self.case_depth, self.open_regions = -1, 0
        try:
            units.append(self.unit())
        except Abort:
            raise
        except Fault as fault:
            self.report(fault.diagnostic)
            self.skip_to_unit()

    def skip_pragma(self) -> None:
        """Attributes outside every block."""
        try:
            self.attributes()
        except Abort:
            raise
        except Fault as fault:
            self.report(fault.diagnostic)
            self.skip_to_unit()

    def skip_to_unit(self) -> None:
        """Go to the next block keyword, behind an END of a block."""
        while self.kinds[self.pos] != EOF:
            self.pos += 1
            if self.kinds[self.pos] in UNIT_KEYWORDS:
                return
            if self.kinds[self.pos - 1] in UNIT_ENDS:
                return

    # --- header ---------------------------------------------------------------------------------------

    def unit(self) -> ast.Unit:
        """One block or type with everything in it."""
        opener = self.pos
        keyword = self.kinds[opener]
        self.pos += 1
        self.skip_access()
        quoted = self.kinds[self.pos] == QUOTED
        name = self.block_name()
        self.skip_inheritance()
        return_type = None
        if keyword == "FUNCTION" and self.accept(":"):
            return_type = self.type_spec()
        elif keyword == "TYPE":
            self.accept(":")
        self.comment_lines = []
        attributes, properties, flags = self.header()
        if keyword == "FUNCTION" and return_type is None and self.accept(":"):
            return_type = self.type_spec()
        self.collect_comment()
        comment = "\n".join(self.comment_lines)
        sections, body_type = self.declaration_part(keyword)
        if isinstance(body_type, ast.TypeName):
            more = self.header()
            attributes, properties, flags = attributes + more[0], properties + more[1], flags + more[2]
        statements = self.code(keyword)
        code = self.code_start, self.start
        if not self.accept("END_" + keyword):
            self.missing_end(keyword)
        self.accept(";")
        return ast.Unit(
            self.starts[opener], self.last_end, keyword, name, quoted, return_type, attributes, properties,
            flags, comment, sections, body_type, statements, code,
        )  # fmt: skip

    def missing_end(self, keyword: str) -> None:
        """Report it and go on at a place where a block can begin."""
        open_comment = self.kinds[self.pos] == EOF and self.kinds[self.pos - 1] == ERROR
        if not open_comment:
            self.report(self.expected("END_" + keyword).diagnostic)
        if self.kinds[self.pos] in UNIT_ENDS:
            self.pos += 1
        elif self.kinds[self.pos] not in UNIT_KEYWORDS:
            self.skip_to_unit()

    def block_name(self) -> str:
        """``"name"``, ``DB3``, ``FB 471`` or ``%DB3``."""
        kind, text = self.kinds[self.pos], self.texts[self.pos]
        if kind not in {NAME, QUOTED, ADDRESS}:
            raise self.expected("a block name")
        self.pos += 1
        if kind == NAME and text.upper() in _NUMBERED and self.kinds[self.pos] == INT:
            self.pos += 1
            return text + self.texts[self.pos - 1]
        return unquote(text).lstrip("%") if kind == ADDRESS else unquote(text)

    def header(self) -> tuple[tuple[ast.Attribute, ...], tuple[tuple[str, str], ...], tuple[str, ...]]:
        """Attributes, properties and flags in any order."""
        attributes: list[ast.Attribute] = []
        properties: list[tuple[str, str]] = []
        flags: list[str] = []
        while True:
            upper = self.upper()
            if self.kinds[self.pos] == "{":
                self.collect_comment()
                attributes.extend(self.attributes())
            elif upper in _PROPERTIES and self.kind(1) in {":", "="}:
                self.collect_comment()
                self.pos += 2
                properties.append((upper, self.property_value(upper)))
            elif upper in _FLAGS:
                self.collect_comment()
                self.pos += 1
                flags.append(upper)
                self.accept(";")
            else:
                return tuple(attributes), tuple(properties), tuple(flags)

    def property_value(self, key: str) -> str:
        """Free text to the end of the line, or a literal in quotes."""
        pattern = _VERSION if key == "VERSION" else _QUOTED_VALUE
        if match := pattern.match(self.tokens.source, self.last_end):
            self.skip_to(match.end())
            self.accept(";")
            return match[1].strip("'")
        text = self.rest_of_line()
        return text if key == "TITLE" else text.split("//")[0].rstrip("; \t")

    def collect_comment(self) -> None:
        """Keep the ``//`` lines before the current token: between header lines they describe the block."""
        free_end = self.free_text[-1][1] if self.free_text else 0
        for comment in self.tokens.trivia_before(self.pos):
            if comment.text.startswith("//") and comment.start >= free_end:
                self.comment_lines.append(comment.text[2:].strip())

    # --- parts ----------------------------------------------------------------------------------------

    def declaration_part(self, keyword: str) -> tuple[tuple[ast.Section, ...], ast.TypeSpec | None]:
        """Sections; for a DB or TYPE also its structure or the type it is made from."""
        sections: list[ast.Section] = []
        body_type: ast.TypeSpec | None = None
        data = keyword in {"DATA_BLOCK", "TYPE"}
        while True:
            kind = self.kinds[self.pos]
            if kind in SECTIONS or (kind == NAME and self.joined_section()):
                sections.append(self.section())
            elif kind == NAME and not data and self.misspelt_section():
                continue
            elif data and body_type is None and kind in {"STRUCT", "ARRAY", NAME, QUOTED, "{"}:
                body_type = self.type_spec()
                if keyword == "TYPE" and self.kinds[self.pos] == "(":
                    sections.append(self.named_values(body_type))
                if keyword == "TYPE" and self.accept(":="):
                    self.initial_value()
                self.accept(";")
            elif kind == ";":
                self.pos += 1
            elif kind in {"END_VAR", "END_CONST", "END_LABEL", "END_STRUCT"}:
                self.report(self.fault(f"{kind} without an open section").diagnostic)
                self.pos += 1
            else:
                return tuple(sections), body_type

    def at_unit(self) -> bool:
        """Whether a line begins here with the header of a block: in a statement list END is missing then."""
        return (
            self.kinds[self.pos] in UNIT_KEYWORDS
            and self.kind(1) in {NAME, QUOTED, ADDRESS}
            and "\n" in self.tokens.source[self.last_end : self.start]
        )

    def code(self, keyword: str) -> ast.Body:
        """Statements, or nothing if bodies are not wanted; a stray END costs one message."""
        self.accept("BEGIN")
        self.code_start = self.last_end
        if keyword == "TYPE":
            return ()
        self.data = keyword == "DATA_BLOCK"
        if not self.bodies and keyword != "DATA_BLOCK":
            begin = self.start
            self.code_start = -1
            while self.kinds[self.pos] not in UNIT_ENDS and self.kinds[self.pos] != EOF and not self.at_unit():
                self.pos += 1
            self.free_text.append((begin, self.start))
            return ()
        found: list[ast.Statement] = []
        while True:
            found.extend(self.body())
            kind = self.kinds[self.pos]
            if kind in UNIT_ENDS or kind in UNIT_KEYWORDS or kind == EOF:
                return tuple(found)
            self.report(self.fault(f"{kind} without its beginning").diagnostic)
            self.pos += 1
            self.accept(";")


def parse(text: str, file: str, dialect: Dialect | None = None, *, bodies: bool = True) -> ParseResult:
    """Parse a source; never raises.

    ``dialect`` adds a PG803 for everything its compiler does not accept; None accepts what any of them does.
    ``bodies=False`` skips the code of FB, FC and OB.
    """
    if len(text) > MAX_CHARACTERS:
        large = f"the file has {len(text)} characters, more than {MAX_CHARACTERS}"
        return ParseResult((), (Diagnostic("PG802", large, Span(file)),), tokenize("", file))
    tokens = tokenize(text, file) if bodies else _statement_list(text, file)
    parser = Parser(tokens, bodies=bodies)
    units = parser.source()
    found = parser.diagnostics + _lexical(parser)
    if dialect is not None:
        from plcgen.scl import dialects

        found += dialects.check(units, tokens, dialect, parser.free_text)
    unique = dict.fromkeys(found)
    return ParseResult(units, tuple(sorted(unique, key=lambda d: d.sort_key)), tokens)


def _statement_list(text: str, file: str) -> Tokens:
    """Tokens of a statement list, where ``(*`` in the title of a network begins no comment."""
    if "(*" not in text and "/*" not in text:
        return tokenize(text, file)
    text = text.replace("\r\n", "\n").replace("\r", "\n")
    masked = _TITLE.sub(lambda match: match[0].replace("(*", "( ").replace("/*", "/ "), text)
    return replace(tokenize(masked, file), source=text)


def _lexical(parser: Parser) -> list[Diagnostic]:
    """Report what is no token outside free text, also where the parser skipped it."""
    if ERROR not in parser.kinds:
        return []
    tokens = parser.tokens
    free = iter(sorted(parser.free_text))
    current = next(free, None)
    found: list[Diagnostic] = []
    last = -1
    for index, kind in enumerate(tokens.kinds):
        start = tokens.starts[index]
        while current is not None and start >= current[1]:
            current = next(free, None)
        if kind != ERROR or (current is not None and current[0] <= start) or len(found) > 100:
            continue
        same_line = last >= 0 and "\n" not in tokens.source[last:start]
        last = start
        if same_line:
            continue
        message, text = lexical_error(tokens.texts[index])
        found.append(parser.diagnostic(message, start, tokens.end(index), text=text))
    return found


__all__ = ["LOCAL", "ParseResult", "parse"]
