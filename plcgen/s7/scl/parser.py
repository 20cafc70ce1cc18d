"""``parse``: text in, tree and diagnostics out, never an exception. Here the parts of the grammar find each other."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, replace

from plcgen.base.diagnostics import Diagnostic, Span
from plcgen.s7.scl import ast, dialects
from plcgen.s7.scl.cursor import Cursor, Halt, lexical_error
from plcgen.s7.scl.dialect import Dialect
from plcgen.s7.scl.grammar.declarations import Declarations
from plcgen.s7.scl.grammar.documents import document_tokens, is_document
from plcgen.s7.scl.grammar.expressions import Expressions, InitialValues
from plcgen.s7.scl.grammar.statements import Branches, CaseLabels, Cases, Statements
from plcgen.s7.scl.grammar.units import Units
from plcgen.s7.scl.lexer import ERROR, Tokens, tokenize

MAX_CHARACTERS = 8 * 1024 * 1024
"""Longer sources are refused with PG802."""

_TITLE = re.compile(r"(?im)^[ \t]*+TITLE[ \t]*+=[^\n]*+")


@dataclass(frozen=True, slots=True)
class ParseResult:
    """Units in source order, every diagnostic in reading order, and the tokens for spans and comments."""

    units: tuple[ast.Unit, ...]
    diagnostics: tuple[Diagnostic, ...]
    tokens: Tokens

    def span(self, node: ast.Node) -> Span:
        """Where a node stands."""
        return self.tokens.span(node.start, node.end)


def parse(
    text: str,
    file: str,
    dialect: Dialect | None = None,
    *,
    bodies: bool = True,
    texts: Mapping[str, str] | None = None,
) -> ParseResult:
    """Parse a source, or a SIMATIC SD document if the name of the file says so; never raises.

    ``dialect`` adds a PG803 for everything its compiler does not accept; None accepts what any of them does.
    ``bodies=False`` skips the code of FB, FC and OB. ``texts`` are the words of a document by key.
    """
    if len(text) > MAX_CHARACTERS:
        large = f"the file has {len(text)} characters, more than {MAX_CHARACTERS}"
        return ParseResult((), (Diagnostic("PG802", large, Span(file)),), tokenize("", file))
    words = (texts or {}) if is_document(file) else None
    if words is not None:
        tokens = document_tokens(text, file)
    else:
        tokens = tokenize(text, file) if bodies else _statement_list(text, file)
    cursor = Cursor(tokens)
    sign_first = dialect is not None and dialect.is_tia
    expressions = Expressions(cursor, sign_first)
    values = InitialValues(cursor, expressions)
    kinds = cursor.kinds
    jump_labels = frozenset(cursor.texts[i + 1].upper() for i, kind in enumerate(kinds) if kind == "GOTO")
    labels = CaseLabels(cursor, expressions, jump_labels)
    statements = Statements(cursor, expressions, values, labels, "END_REGION" in kinds)
    branches = Branches(cursor, expressions, statements)
    cases = Cases(cursor, expressions, labels, statements)
    statements.compound |= {
        "IF": branches.if_statement, "FOR": branches.for_statement, "WHILE": branches.while_statement,
        "REPEAT": branches.repeat_statement, "CASE": cases.case_statement, "REGION": cases.region,
        "EXIT": statements.jump, "CONTINUE": statements.jump, "RETURN": statements.jump, "GOTO": statements.goto,
    }  # fmt: skip
    declarations = Declarations(cursor, expressions, values, words)
    grammar = Units(cursor, declarations, values, statements, bodies, words)
    units = grammar.read()
    grammar.statements.compound.clear()  # its memory is free now, not when the garbage collector comes
    found = cursor.diagnostics + _lexical(cursor)
    if dialect is not None:
        found += dialects.check_dialect(units, tokens, dialect, cursor.free_text)
    unique = dict.fromkeys(found)
    return ParseResult(units, tuple(sorted(unique, key=lambda d: d.sort_key)), tokens)


def parse_value(text: str) -> ast.Expression | None:
    """Parse the initial value that ``text`` begins with; None if it does not begin with one."""
    cursor = Cursor(tokenize(text, ""))
    try:
        return InitialValues(cursor, Expressions(cursor)).read()
    except Halt:
        return None


def _statement_list(text: str, file: str) -> Tokens:
    """Tokens of a statement list, where ``(*`` in the title of a network begins no comment."""
    if "(*" not in text and "/*" not in text:
        return tokenize(text, file)
    text = text.replace("\r\n", "\n").replace("\r", "\n")
    masked = _TITLE.sub(lambda match: match[0].replace("(*", "( ").replace("/*", "/ "), text)
    return replace(tokenize(masked, file), source=text)


def _lexical(cursor: Cursor) -> list[Diagnostic]:
    """Report what is no token outside free text, also where the parser skipped it."""
    if ERROR not in cursor.kinds:
        return []
    tokens = cursor.tokens
    free = iter(sorted(cursor.free_text))
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
        found.append(cursor.diagnostic(message, start, tokens.end(index), text=text))
    return found
