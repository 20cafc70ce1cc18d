"""Blocks and types: header, declarations, code, END; what stands between them."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from textwrap import dedent

from plcgen.s7.scl import ast
from plcgen.s7.scl.cursor import Abort, Cursor, SyntaxFault, unquote
from plcgen.s7.scl.grammar import mistakes
from plcgen.s7.scl.grammar.declarations import Declarations
from plcgen.s7.scl.grammar.documents import Header, Networks
from plcgen.s7.scl.grammar.expressions import InitialValues
from plcgen.s7.scl.grammar.mistakes import SECTIONS, UNIT_ENDS, UNITS
from plcgen.s7.scl.grammar.statements import Statements
from plcgen.s7.scl.lexer import ADDRESS, EOF, ERROR, INT, NAME, QUOTED

_PROPERTIES = frozenset({"TITLE", "AUTHOR", "NAME", "FAMILY", "VERSION"})
_FLAGS = frozenset({"NON_RETAIN", "RETAIN", "KNOW_HOW_PROTECT", "READ_ONLY", "UNLINKED", "CODE_VERSION1", "STANDARD"})
_VERSION = re.compile(r"[ \t]*('[^'\n]*'|[0-9.]+)")
_QUOTED_VALUE = re.compile(r"[ \t]*'([^'\n]*)'")
_NO_BLOCK = (
    "a source consists of FUNCTION_BLOCK, FUNCTION, ORGANIZATION_BLOCK, DATA_BLOCK and TYPE, each with its END: "
    "put statements into a block"
)
_NAMESPACES = frozenset({"NAMESPACE", "USING", "END_NAMESPACE"})
_NUMBERED = frozenset({"DB", "FB", "FC", "OB", "UDT", "SFB", "SFC"})


@dataclass(slots=True, eq=False)
class Units:
    """All of a source; ``bodies=False`` reads declarations and skips code (for STL sources).

    ``texts`` are the words of a SIMATIC SD document by key, None for SCL; ``before`` are the attributes in front of a
    block of such a document.
    """

    cursor: Cursor
    declarations: Declarations
    values: InitialValues
    statements: Statements
    bodies: bool
    texts: Mapping[str, str] | None = None
    before: tuple[ast.Attribute, ...] = ()
    comment_lines: list[str] = field(default_factory=list)
    code_start: int = 0

    def read(self) -> tuple[ast.Unit, ...]:
        """Units up to the end of the file."""
        cursor = self.cursor
        units: list[ast.Unit] = []
        try:
            while cursor.kinds[cursor.pos] != EOF:
                if cursor.kinds[cursor.pos] == "{":
                    self.skip_pragma()
                    continue
                if cursor.upper() in _NAMESPACES:
                    self.namespace()
                    continue
                if cursor.kinds[cursor.pos] not in UNITS:
                    if mistakes.unit(cursor) or mistakes.misspelt_unit(cursor):
                        continue
                    found = cursor.expected("a block or TYPE").diagnostic
                    cursor.report(found if found.help else replace(found, help=_NO_BLOCK))
                    self.skip_to_unit()
                    continue
                # one unit; a fault that nothing inside could catch costs the unit
                self.cursor.depth = 0
                try:
                    units.append(self.unit())
                except SyntaxFault as fault:
                    self.cursor.report(fault)
                    self.skip_to_unit()
        except Abort as abort:
            cursor.diagnostics.append(abort.diagnostic)
        return tuple(units)

    def namespace(self) -> None:
        """``NAMESPACE a.b``, ``USING a.b;`` and ``END_NAMESPACE``: blocks keep their own names."""
        cursor = self.cursor
        closing = cursor.upper() == "END_NAMESPACE"
        cursor.pos += 1
        while not closing and cursor.kinds[cursor.pos] in {NAME, QUOTED}:
            cursor.pos += 1
            closing = not cursor.accept(".")
        cursor.accept(";")

    def skip_pragma(self) -> None:
        """Attributes outside every block; in a SIMATIC SD document they belong to the next one."""
        try:
            self.before += self.cursor.attributes()
        except SyntaxFault as fault:
            self.cursor.report(fault)
            self.skip_to_unit()

    def skip_to_unit(self) -> None:
        """Go to the next block keyword, behind an END of a block."""
        cursor = self.cursor
        while cursor.kinds[cursor.pos] != EOF:
            cursor.pos += 1
            if cursor.kinds[cursor.pos] in UNITS:
                return
            if cursor.kinds[cursor.pos - 1] in UNIT_ENDS:
                return

    def unit(self) -> ast.Unit:
        """One block or type with everything in it."""
        cursor = self.cursor
        opener = cursor.pos
        keyword = cursor.kinds[opener]
        cursor.pos += 1
        mistakes.skip_access(cursor)
        if self.texts is not None and keyword == "TYPE":
            self.before += cursor.attributes()
        quoted = cursor.kinds[cursor.pos] == QUOTED
        name = self.block_name()
        mistakes.skip_inheritance(cursor)
        return_type = None
        if keyword == "FUNCTION" and cursor.accept(":"):
            return_type = self.declarations.type_spec()
        elif keyword == "TYPE" or (self.texts is not None and keyword == "DATA_BLOCK"):
            cursor.accept(":")
        self.comment_lines = []
        attributes, properties, flags = self.header()
        if keyword == "FUNCTION" and return_type is None and cursor.accept(":"):
            return_type = self.declarations.type_spec()
        self.collect_comment()
        comment = dedent("\n".join(self.comment_lines))
        if self.texts is not None:
            said = Header.of(keyword, self.before, self.texts)
            attributes, properties, flags = (
                said.attributes + attributes, said.properties + properties, said.flags + flags
            )  # fmt: skip
            comment = said.comment or comment
        self.before = ()
        sections, body_type = self.declaration_part(keyword)
        if isinstance(body_type, ast.TypeName):
            more = self.header()
            attributes, properties, flags = attributes + more[0], properties + more[1], flags + more[2]
        networks = (
            Networks(cursor, self.statements).read()
            if (self.texts is not None and self.bodies and keyword not in {"DATA_BLOCK", "TYPE"})
            else ()
        )
        if networks:
            drawn = any(network.drawn for network in networks)
            statements = () if drawn else tuple(one for network in networks for one in network.statements)
            code = (-1 if drawn else networks[0].inside[0]), networks[-1].inside[1]
        else:
            statements = self.code(keyword)
            code = self.code_start, cursor.start
        if not cursor.accept("END_" + keyword):
            self.missing_end(keyword)
        cursor.accept(";")
        return ast.Unit(
            cursor.starts[opener], cursor.last_end, keyword, name, quoted, return_type, attributes, properties,
            flags, comment, sections, body_type, statements, code, networks,
        )  # fmt: skip

    def missing_end(self, keyword: str) -> None:
        """Report it and go on at a place where a block can begin."""
        cursor = self.cursor
        open_comment = cursor.kinds[cursor.pos] == EOF and cursor.kinds[cursor.pos - 1] == ERROR
        if not open_comment:
            cursor.report(cursor.expected("END_" + keyword))
        if cursor.kinds[cursor.pos] in UNIT_ENDS:
            cursor.pos += 1
        elif cursor.kinds[cursor.pos] not in UNITS:
            self.skip_to_unit()

    def block_name(self) -> str:
        """``"name"``, ``DB3``, ``FB 471`` or ``%DB3``."""
        cursor = self.cursor
        kind, text = cursor.kinds[cursor.pos], cursor.texts[cursor.pos]
        if kind not in {NAME, QUOTED, ADDRESS}:
            raise cursor.expected("a block name")
        cursor.pos += 1
        if kind == NAME and text.upper() in _NUMBERED and cursor.kinds[cursor.pos] == INT:
            cursor.pos += 1
            return text + cursor.texts[cursor.pos - 1]
        return unquote(text).lstrip("%") if kind == ADDRESS else unquote(text)

    def header(self) -> tuple[tuple[ast.Attribute, ...], tuple[tuple[str, str], ...], tuple[str, ...]]:
        """Attributes, properties and flags in any order."""
        cursor = self.cursor
        attributes: list[ast.Attribute] = []
        properties: list[tuple[str, str]] = []
        flags: list[str] = []
        while True:
            upper = cursor.upper()
            if cursor.kinds[cursor.pos] == "{":
                self.collect_comment()
                attributes.extend(cursor.attributes())
            elif upper in _PROPERTIES and cursor.kind(1) in {":", "="}:
                self.collect_comment()
                cursor.pos += 2
                properties.append((upper, self.property_value(upper)))
            elif upper in _FLAGS:
                self.collect_comment()
                cursor.pos += 1
                flags.append(upper)
                cursor.accept(";")
            else:
                return tuple(attributes), tuple(properties), tuple(flags)

    def property_value(self, key: str) -> str:
        """Free text to the end of the line, or a literal in quotes."""
        cursor = self.cursor
        pattern = _VERSION if key == "VERSION" else _QUOTED_VALUE
        if match := pattern.match(cursor.tokens.source, cursor.last_end):
            cursor.skip_to(match.end())
            cursor.accept(";")
            return match[1].strip("'")
        text = cursor.rest_of_line()
        return text if key == "TITLE" else text.split("//")[0].rstrip("; \t")

    def collect_comment(self) -> None:
        """Keep the ``//`` lines before the current token: between header lines they describe the block.

        What all of them are indented by is the style of whoever wrote them, the rest is part of the text.
        """
        cursor = self.cursor
        free_end = cursor.free_text[-1][1] if cursor.free_text else 0
        for comment in cursor.tokens.trivia_before(cursor.pos):
            if comment.text.startswith("//") and comment.start >= free_end:
                self.comment_lines.append(comment.text[2:].rstrip())

    def declaration_part(self, keyword: str) -> tuple[tuple[ast.Section, ...], ast.TypeSpec | None]:
        """Sections; for a DB or TYPE also its structure or the type it is made from."""
        cursor = self.cursor
        sections: list[ast.Section] = []
        body_type: ast.TypeSpec | None = None
        data = keyword in {"DATA_BLOCK", "TYPE"}
        while True:
            kind = cursor.kinds[cursor.pos]
            if kind in SECTIONS or (kind == NAME and self.declarations.joined_section()):
                sections.append(self.declarations.section())
            elif kind == NAME and not data and mistakes.misspelt_section(cursor):
                continue
            elif (
                data
                and body_type is None
                and kind in {"STRUCT", "ARRAY", NAME, QUOTED, "{"}
                and not (sections and self.texts is not None)  # start values of a SIMATIC SD document
            ):
                body_type = self.declarations.type_spec()
                if keyword == "TYPE" and cursor.kinds[cursor.pos] == "(":
                    sections.append(self.declarations.named_values(body_type))
                if keyword == "TYPE" and cursor.accept(":="):
                    self.values.read()
                cursor.accept(";")
            elif kind == ";":
                cursor.pos += 1
            elif kind in {"END_VAR", "END_CONST", "END_LABEL", "END_STRUCT"}:
                cursor.report(cursor.fault(f"{kind} without an open section"))
                cursor.pos += 1
            else:
                return tuple(sections), body_type

    def at_unit(self) -> bool:
        """Whether a line begins here with the header of a block: in a statement list END is missing then."""
        cursor = self.cursor
        return (
            cursor.kinds[cursor.pos] in UNITS
            and cursor.kind(1) in {NAME, QUOTED, ADDRESS}
            and "\n" in cursor.tokens.source[cursor.last_end : cursor.start]
        )

    def code(self, keyword: str) -> ast.Body:
        """Statements, or nothing if bodies are not wanted; a stray END costs one message."""
        cursor = self.cursor
        cursor.accept("BEGIN")
        self.code_start = cursor.last_end
        if keyword == "TYPE":
            return ()
        self.statements.data = keyword == "DATA_BLOCK"
        if not self.bodies and keyword != "DATA_BLOCK":
            begin = cursor.start
            self.code_start = -1
            while cursor.kinds[cursor.pos] not in UNIT_ENDS and cursor.kinds[cursor.pos] != EOF and not self.at_unit():
                cursor.pos += 1
            cursor.free_text.append((begin, cursor.start))
            return ()
        found: list[ast.Statement] = []
        while True:
            found.extend(self.statements.body())
            kind = cursor.kinds[cursor.pos]
            if kind in UNIT_ENDS or kind in UNITS or kind == EOF:
                return tuple(found)
            cursor.report(cursor.fault(f"{kind} without its beginning"))
            cursor.pos += 1
            cursor.accept(";")
